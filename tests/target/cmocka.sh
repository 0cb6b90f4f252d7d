#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Build CMocka for the Cortex-M boards from Debian's source package, into $B/cmocka-arm/{m4,m7}. Run once.
#   ARM_CC, B from the environment
: "${B:=build}"
. tests/gates/common.sh
dir=$B/cmocka-arm
[ -f "$dir/m4/cmocka.o" ] && [ -f "$dir/m7/cmocka.o" ] && exit 0
mkdir -p "$dir/lists/partial" "$dir/m4" "$dir/m7"
home=$(cd "$dir" && pwd)

# A source list of its own: the machine's is left alone. apt checks the signatures as always.
echo 'deb-src http://deb.debian.org/debian bookworm main' >"$dir/source.list"
fetch() {
    apt-get -qq -o Dir::Etc::sourcelist="$home/source.list" -o Dir::Etc::sourceparts=- -o Dir::State::lists="$home/lists" \
        -o APT::Sandbox::User=root -o Dir::Cache::srcpkgcache='' -o Dir::Cache::pkgcache='' "$@"
}
(cd "$dir" && fetch update && fetch --download-only source cmocka && tar xJf cmocka_*.orig.tar.xz && rm -rf source &&
    mv cmocka-*/ source) || exit 1

for processor in m4 m7; do
    eval "flags=\$$processor"
    # shellcheck disable=SC2086,SC2154
    "$ARM_CC" $flags --specs=picolibc.specs -std=gnu99 -O2 -DHAVE_INTTYPES_H=1 -DHAVE_SIGNAL_H=1 -DHAVE_STRINGS_H=1 \
        -DHAVE_MALLOC_H=1 -D_GNU_SOURCE -I"$dir/source/include" -c "$dir/source/src/cmocka.c" \
        -o "$dir/$processor/cmocka.o" 2>"$dir/$processor/log" || { cat "$dir/$processor/log"; rm -f "$dir"/m?/cmocka.o; exit 1; }
done
