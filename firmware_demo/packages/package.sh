#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Assemble the library as one folder that CMake, Zephyr, PlatformIO and Arduino take, and pack it.
# usage: package.sh PZS FOLDER: writes FOLDER/piezoshape, FOLDER/piezoshape-VERSION.tar.gz and .zip
set -eu
pzs=$(realpath "$1")
mkdir -p "$2"
out=$(realpath "$2")
cd "$(dirname "$0")/../.."
version=$(sed -n 's/^#define PZS_VERSION_TEXT "\(.*\)"/\1/p' include/pzs_version.h)
top=$out/piezoshape
here=firmware_demo/packages
# Files of a read-only source folder are copied read-only.
[ ! -d "$top" ] || chmod -R u+w "$top"
rm -rf "$top" "$out/piezoshape-$version.tar.gz" "$out/piezoshape-$version.zip"
mkdir -p "$top/src" "$top/examples/mirror"
cp include/*.h "$top/src"
for room in lib/*/; do
    mkdir "$top/src/$(basename "$room")"
    cp "$room"*.[ch] "$top/src/$(basename "$room")"
done
chmod -R u+w "$top"
# Neither Arduino nor PlatformIO gives a library options of its own: a package is for float.
sed 's/^#define PZS_REAL_BITS 64$/#define PZS_REAL_BITS 32/' include/pzs_config.h >"$top/src/pzs_config.h"
cp LICENSE CHANGELOG.md "$top"
cp "$here/README.md" "$here/CMakeLists.txt" "$top"
cp -r "$here/zephyr" "$top"
for file in library.json library.properties; do
    sed "s/@VERSION@/$version/" "$here/$file.in" >"$top/$file"
done
cp "$here/mirror/mirror.ino" "$top/examples/mirror"
"$pzs" tables firmware_demo/examples/measured/mirror.yaml --prefix mirror -o "$top/examples/mirror/mirror.h"
chmod -R u+w "$top"
tar -C "$out" -czf "$out/piezoshape-$version.tar.gz" piezoshape
if command -v python3 >/dev/null; then
    (cd "$out" && python3 -m zipfile -c "piezoshape-$version.zip" piezoshape)
fi
echo "$out/piezoshape-$version.tar.gz"
