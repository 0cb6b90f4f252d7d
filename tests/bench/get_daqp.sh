#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Build DAQP, the peer of bench_step, from its source package into a folder: get_daqp.sh [FOLDER]
# Leaves FOLDER/libdaqp.a and FOLDER/include. Without network it says so and builds nothing.
set -e
folder=${1:-build/daqp}
[ -f "$folder/libdaqp.a" ] && exit 0
rm -rf "$folder"
mkdir -p "$folder"
if ! pip download --quiet --no-binary :all: --no-deps --dest "$folder" daqp==0.11.0 >"$folder/log" 2>&1; then
    echo "get_daqp: no network or no pip, the comparison with DAQP is skipped" >&2
    exit 0
fi
tar -xzf "$folder"/daqp-*.tar.gz -C "$folder" --strip-components=1
mv "$folder/csrc/include" "$folder/include"
for file in "$folder"/csrc/src/*.c; do
    ${CC:-gcc} -O3 -march=native -DNDEBUG -I"$folder/include" -c "$file" -o "$folder/$(basename "$file" .c).o"
done
ar rcs "$folder/libdaqp.a" "$folder"/*.o
