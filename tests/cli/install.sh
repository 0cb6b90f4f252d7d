#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Installation as a user meets it: where files go, programs compiled against them, scenes found wherever the program stands,
# other compilers, flags and build folders, machines on which nothing can be installed.
set -u
cd "$(dirname "$0")/../.."
. tests/cli/common.sh
MAKE=${MAKE:-make}
unset PZS_SCENES PZS_SOURCES MAKEFLAGS MFLAGS MAKEOVERRIDES

# Files below a folder, sorted.
files() {
    (cd "$1" && find . -type f | sort)
}

# marker FOLDER: a scene that no other folder of scenes has
marker() {
    sed 's/^name: .*/name: marker/' host_tools/scenes/scordelis-lo.yaml >"$1/marker.yaml"
}

# ---- install and uninstall ----------------------------------------------

"$MAKE" --no-print-directory -s B="$B" PREFIX=/opt/shape DESTDIR="$dir/root" install >"$dir/said" 2>&1; check 'make install' $?
top=$dir/root/opt/shape
{
    for file in bin/pzs lib/libpiezoshape.a lib/libpiezoshape32.a \
        lib/cmake/piezoshape/piezoshape-config.cmake lib/cmake/piezoshape/piezoshape-config-version.cmake \
        lib/pkgconfig/piezoshape.pc lib/pkgconfig/piezoshape32.pc share/bash-completion/completions/pzs share/man/man1/pzs.1; do
        echo "./$file"
    done
    (cd include && ls -- *.h) | sed 's/^/.\/include\/piezoshape\//'
    (cd host_tools/scenes && ls -- *.yaml *.msh *.geo scene.schema.json) | sed 's/^/.\/share\/piezoshape\/scenes\//'
} | sort >"$dir/expected"
files "$top" >"$dir/said"; cmp -s "$dir/said" "$dir/expected"; check 'every file in its place' $?
! grep -rlI "$dir" "$top" >"$dir/said"; check 'DESTDIR is in no file' $?
grep -q '^prefix=/opt/shape$' "$top/lib/pkgconfig/piezoshape.pc"; check 'PREFIX is in the pkg-config file' $?

marker "$top/share/piezoshape/scenes"
(cd / && "$top/bin/pzs" list) >"$dir/said" 2>&1; grep -q '^marker ' "$dir/said"; check 'the installed program finds the installed scenes' $?
(cd / && "$top/bin/pzs" solve marker --json) >"$dir/said" 2>&1; check 'and runs one' $?

# ---- programs against the installed library ----------------------------

cat >"$dir/program.c" <<'EOT'
#include <stdio.h>
#include "plate.h"
static pzs_real work[PLATE_CONTROL_BYTES / sizeof(pzs_real) + 1];
static pzs_control control;
int main(void)
{
    const pzs_status status = pzs_control_init(&control, &plate_problem, NULL, work, sizeof work);
    printf("%s %d %s\n", PZS_VERSION_TEXT, PZS_REAL_BITS, pzs_status_text(status));
    return status;
}
EOT
"$top/bin/pzs" tables plate-50-patches --quasi-static --prefix plate -o "$dir/plate.h" >"$dir/said" 2>&1; check 'tables from the installed program' $?
if command -v pkg-config >/dev/null; then
    export PKG_CONFIG_PATH="$top/lib/pkgconfig" PKG_CONFIG_SYSROOT_DIR="$dir/root"
    for library in piezoshape:64 piezoshape32:32; do
        # shellcheck disable=SC2046
        ${CC:-gcc} -std=c99 -Wall -I"$dir" "$dir/program.c" $(pkg-config --cflags --libs "${library%:*}") -o "$dir/program" >"$dir/said" 2>&1 &&
            "$dir/program" >"$dir/said" && grep -q "^$(pkg-config --modversion "${library%:*}") ${library#*:} " "$dir/said"
        check "a C program compiled with pkg-config ${library%:*} runs" $?
    done
    "$MAKE" --no-print-directory -s B="$B" PREFIX="$dir/a prefix" install >"$dir/said" 2>&1
    PKG_CONFIG_PATH="$dir/a prefix/lib/pkgconfig" PKG_CONFIG_SYSROOT_DIR='' sh -c 'eval "set -- $(pkg-config --cflags --libs piezoshape)"; ls "${1#-I}/pzs.h"' >"$dir/said" 2>&1
    check 'pkg-config of a prefix with a blank' $?
else
    skip 'C programs compiled with pkg-config' pkg-config
fi

"$MAKE" --no-print-directory -s PREFIX=/opt/shape DESTDIR="$dir/root" uninstall >"$dir/said" 2>&1 &&
    [ "$(files "$dir/root")" = ./opt/shape/share/piezoshape/scenes/marker.yaml ]; check "make uninstall leaves what it did not install" $?
rm "$top/share/piezoshape/scenes/marker.yaml"
"$MAKE" --no-print-directory -s PREFIX=/opt/shape DESTDIR="$dir/root" uninstall >"$dir/said" 2>&1 && [ ! -e "$top/share/piezoshape" ] && [ ! -s "$dir/said" ]
check 'make uninstall twice, and empty folders' $?

# ---- a clone that was moved ---------------------------------------------

mkdir -p "$dir/moved/build" "$dir/moved/host_tools" "$dir/alone" "$dir/mine"
cp "$PZS" "$dir/moved/build/pzs"
cp -r host_tools/scenes "$dir/moved/host_tools"
marker "$dir/moved/host_tools/scenes"
(cd / && "$dir/moved/build/pzs" list) >"$dir/said" 2>&1; grep -q '^marker ' "$dir/said"; check 'a moved clone finds its own scenes' $?
marker "$dir/mine"
[ "$(PZS_SCENES=$dir/mine "$PZS" list | cut -d' ' -f1)" = marker ]; check 'PZS_SCENES comes first' $?
cp "$PZS" "$dir/alone/pzs"
"$dir/alone/pzs" list >"$dir/said" 2>&1 && ! grep -q '^marker ' "$dir/said"; check 'a program elsewhere finds the scenes of its build' $?
PZS_SCENES=$dir/none "$PZS" list >"$dir/said" 2>&1; [ $? -eq 2 ] && grep -q "PZS_SCENES.*'$dir/none'" "$dir/said"; check 'a folder of scenes that is not there is named' $?

# ---- CC, CFLAGS, B ------------------------------------------------------

printf '#!/bin/sh\necho "$@" >>"%s/calls"\nexec gcc "$@"\n' "$dir" >"$dir/compiler"; chmod +x "$dir/compiler"
mkdir "$dir/clone"
tar cf - --exclude="./$B" --exclude=./build --exclude=./.git . | tar xf - -C "$dir/clone"
files "$dir/clone" >"$dir/before"
(cd / && CC="$dir/compiler" CFLAGS='-O0 -DTOLD_SO' "$MAKE" --no-print-directory -s -j2 -C "$dir/clone" B="$dir/elsewhere" "$dir/elsewhere/pzs") >"$dir/said" 2>&1 &&
    "$dir/elsewhere/pzs" check scordelis-lo >"$dir/said" 2>&1
check 'make -C clone B=/elsewhere' $?
files "$dir/clone" | cmp -s - "$dir/before"; check 'nothing is written into the clone' $?
[ "$(grep -c -e '-c ' "$dir/calls")" -ge 60 ] && ! grep -v -e '-DTOLD_SO' -e '^-dumpmachine$' "$dir/calls" >"$dir/said"; check 'CC and CFLAGS of the environment are in every call' $?
chmod -R a-w "$dir/clone"
sh "$dir/clone/firmware_demo/packages/package.sh" "$PZS" "$dir/pack" >"$dir/said" 2>&1 && [ -z "$(find "$dir/pack" ! -perm -u+w)" ]
check 'a package from a read-only clone may be written to' $?
chmod -R u+w "$dir/clone"
for source in 'gcc gcc' 'clang clang' ; do
    [ "$(CC=${source% *} "$MAKE" -n B="$dir/other" "$dir/other/64/lib/core/guard.o" | grep -c "^${source#* } .*-c lib/core/guard.c")" = 1 ]
    check "CC=${source% *}" $?
done
[ "$(env -u CC "$MAKE" -n B="$dir/other" "$dir/other/64/lib/core/guard.o" | grep -c '^gcc .*-c lib/core/guard.c')" = 1 ]; check 'gcc where no CC is given' $?

# ---- machines on which nothing can be installed -------------------------

mkdir "$dir/bare" "$dir/user"
printf '#!/bin/sh\necho 1000\n' >"$dir/user/id"
printf '#!/bin/sh\necho called >"%s/apt"\n' "$dir" >"$dir/user/apt-get"
chmod +x "$dir/user/id" "$dir/user/apt-get"
shell=$(command -v sh)
PATH="$dir/bare" "$shell" tests/setup.sh demo >"$dir/said" 2>&1; [ $? -eq 1 ] && grep -q 'missing: gcc make' "$dir/said" && grep -q 'no apt-get' "$dir/said"
check 'a system without apt-get: what is missing, by name' $?
PATH="$dir/user" "$shell" tests/setup.sh demo >"$dir/said" 2>&1; [ $? -eq 1 ] && grep -q 'missing: gcc make' "$dir/said" && grep -q 'no sudo' "$dir/said" && [ ! -e "$dir/apt" ]
check 'a user without sudo: the same, and nothing is run' $?
PATH="$dir/bare" SKIP_SETUP=1 "$shell" tests/setup.sh demo >"$dir/said" 2>&1 && [ ! -s "$dir/said" ]; check 'SKIP_SETUP' $?
echo "1..$n"
[ "$failed" -eq 0 ]
