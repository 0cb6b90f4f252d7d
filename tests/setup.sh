#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Install the Debian packages that a command needs and this machine lacks.  setup.sh demo|test|bench
# Where that cannot be done, say what is missing and end with 1. SKIP_SETUP=1: all is there, elsewhere.
set -eu
case $1 in
demo) want="gcc:gcc make:make /usr/include/yaml.h:libyaml-dev /usr/include/stdio.h:libc6-dev" ;;
test) want="gcc:gcc make:make /usr/include/yaml.h:libyaml-dev /usr/include/fitsio.h:libcfitsio-dev /usr/include/cmocka.h:libcmocka-dev clang:clang g++:g++ clang-format:clang-format
    arm-none-eabi-gcc:gcc-arm-none-eabi /usr/lib/arm-none-eabi/include/stdio.h:libnewlib-arm-none-eabi
    /usr/lib/picolibc/arm-none-eabi:picolibc-arm-none-eabi
    qemu-system-arm:qemu-system-arm gmsh:gmsh pkg-config:pkg-config /usr/bin/python3:python3 /usr/lib/python3/dist-packages/numpy:python3-numpy
    /usr/lib/python3/dist-packages/scipy:python3-scipy /usr/lib/python3/dist-packages/jsonschema:python3-jsonschema
    /usr/lib/python3/dist-packages/yaml:python3-yaml" ;;
bench) want="gcc:gcc make:make /usr/include/yaml.h:libyaml-dev /usr/include/x86_64-linux-gnu/cblas.h:libopenblas-dev
    /usr/include/lapacke.h:liblapacke-dev valgrind:valgrind python3:python3 pip3:python3-pip" ;;
*) echo "setup.sh: demo, test or bench" >&2; exit 2 ;;
esac

[ -z "${SKIP_SETUP:-}" ] || exit 0
missing=
named=
for pair in $want; do
    need=${pair%%:*}
    case $need in
    /*) [ -e "$need" ] && continue ;;
    *) command -v "$need" >/dev/null 2>&1 && continue ;;
    esac
    missing="$missing ${pair##*:}"
    named="$named $need"
done
[ -n "$missing" ] || exit 0

# refuse WHY: what is missing, by its file or program and by its Debian package
refuse() {
    echo "setup.sh: missing:$named" >&2
    echo "setup.sh: Debian packages:$missing" >&2
    echo "setup.sh: $1; install them, then try again (SKIP_SETUP=1 make ... where they are elsewhere)" >&2
    exit 1
}

command -v apt-get >/dev/null 2>&1 || refuse 'no apt-get here to install them'
run=
if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null 2>&1 || refuse 'not root, and no sudo'
    run=sudo
fi
echo "installing$missing"
export DEBIAN_FRONTEND=noninteractive
$run apt-get update -qq || refuse 'apt-get update failed'
# shellcheck disable=SC2086
$run apt-get install -y -qq --no-install-recommends $missing >/dev/null || refuse 'apt-get install failed'
