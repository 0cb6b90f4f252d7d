#!/bin/sh
# Install the Debian packages that a command needs and this machine lacks.  setup.sh demo|test|bench
set -eu
case $1 in
demo) want="gcc:gcc make:make /usr/include/yaml.h:libyaml-dev /usr/include/stdio.h:libc6-dev" ;;
test) want="gcc:gcc make:make /usr/include/yaml.h:libyaml-dev /usr/include/cmocka.h:libcmocka-dev clang:clang
    arm-none-eabi-gcc:gcc-arm-none-eabi /usr/lib/arm-none-eabi/include/stdio.h:libnewlib-arm-none-eabi
    /usr/lib/picolibc/arm-none-eabi:picolibc-arm-none-eabi
    qemu-system-arm:qemu-system-arm /usr/bin/python3:python3 /usr/lib/python3/dist-packages/numpy:python3-numpy
    /usr/lib/python3/dist-packages/scipy:python3-scipy" ;;
bench) want="gcc:gcc make:make /usr/include/yaml.h:libyaml-dev /usr/include/x86_64-linux-gnu/cblas.h:libopenblas-dev
    /usr/include/lapacke.h:liblapacke-dev valgrind:valgrind python3:python3 pip3:python3-pip" ;;
*) echo "setup.sh: demo, test or bench" >&2; exit 2 ;;
esac

missing=
for pair in $want; do
    need=${pair%%:*}
    case $need in
    /*) [ -e "$need" ] || missing="$missing ${pair##*:}" ;;
    *) command -v "$need" >/dev/null 2>&1 || missing="$missing ${pair##*:}" ;;
    esac
done
[ -n "$missing" ] || exit 0

echo "installing$missing"
run=
[ "$(id -u)" = 0 ] || run=sudo
export DEBIAN_FRONTEND=noninteractive
$run apt-get update -qq
$run apt-get install -y -qq --no-install-recommends $missing >/dev/null
