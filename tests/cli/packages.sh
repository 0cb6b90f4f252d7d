#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The package as projects take it: CMake in C and C++, from its folder and installed; Arduino's layout; Zephyr's module
# against a stub of its CMake functions; PlatformIO's manifest.
set -u
cd "$(dirname "$0")/../.."
. tests/cli/common.sh
MAKE=${MAKE:-make}
top=$(pwd)

version=$(sed -n 's/^.define PZS_VERSION_TEXT "\(.*\)"/\1/p' include/pzs_version.h)
sh firmware_demo/packages/package.sh "$PZS" "$dir" >"$dir/said" 2>&1; check 'make package' $?
package=$dir/piezoshape
(cd lib && find . -name '*.c' | sort) >"$dir/expected"; (cd "$package/src" && find . -name '*.c' | sort) | cmp -s - "$dir/expected"
check 'every source is in the package' $?
tar tzf "$dir/piezoshape-$version.tar.gz" >"$dir/said" && grep -q '^piezoshape/src/control/boxls.c$' "$dir/said"; check 'the archive' $?
! grep -rnF -e '@VERSION@' -e "$top" -e "$dir" "$package" >"$dir/said"; check 'no place of this machine is in it' $?

# ---- CMake ---------------------------------------------------------------

cat >"$dir/mirror.c" <<'EOT'
#include "mirror.h"
static pzs_real work[MIRROR_LOOP_BYTES / sizeof(pzs_real) + 1], readings[MIRROR_READINGS];
static pzs_loop loop;
int main(void)
{
    if (pzs_loop_init(&loop, mirror_blocks, MIRROR_BLOCKS, NULL, work, sizeof work) != PZS_OK)
        return 1;
    for (int k = 0; k < 50; k++)
        if (PZS_IS_ERROR(pzs_loop_tick(&loop, mirror_target, readings)))
            return 2;
    return loop.info.voltage[0] == 0 ? 3 : 0; /* 0: the target moved a voltage */
}
EOT
cp "$dir/mirror.c" "$dir/mirror_cpp.cpp"
cp "$package/examples/mirror/mirror.h" "$dir/mirror.h"
"$PZS" tables firmware_demo/examples/measured/mirror.yaml --prefix mirror -o "$dir/mirror.h" >"$dir/said" 2>&1
if command -v cmake >/dev/null; then
    # project NAME FIRST TARGET LANGUAGES: a project that finds the library by its FIRST line
    project() {
        mkdir "$dir/$1"
        cp "$dir/mirror.c" "$dir/mirror_cpp.cpp" "$dir/mirror.h" "$dir/$1"
        printf '%s\n' 'cmake_minimum_required(VERSION 3.13)' 'project(shape C CXX)' "$2" \
            'foreach(source mirror.c mirror_cpp.cpp)' '  get_filename_component(name ${source} NAME_WE)' \
            '  add_executable(${name} ${source})' "  target_link_libraries(\${name} PRIVATE $3)" 'endforeach()' >"$dir/$1/CMakeLists.txt"
        { cmake -S "$dir/$1" -B "$dir/$1/build" "-DCMAKE_PREFIX_PATH=$dir/root/opt/shape" -DCMAKE_BUILD_TYPE=Release &&
            cmake --build "$dir/$1/build" -j2; } >"$dir/said" 2>&1 &&
            "$dir/$1/build/mirror" && "$dir/$1/build/mirror_cpp"
    }
    "$MAKE" --no-print-directory -s B="$B" PREFIX=/opt/shape DESTDIR="$dir/root" install >"$dir/said" 2>&1
    project folder "add_subdirectory($package piezoshape)" piezoshape::piezoshape; check 'CMake: add_subdirectory of the package, C and C++' $?
    project sources "add_subdirectory($top/firmware_demo/packages piezoshape)" piezoshape::piezoshape; check 'CMake: add_subdirectory of the sources' $?
    project installed 'find_package(piezoshape 0.2 REQUIRED)' piezoshape::piezoshape32; check 'CMake: find_package of the installed library, float' $?
    project double 'find_package(piezoshape REQUIRED)' piezoshape::piezoshape; check 'CMake: find_package of the installed library, double' $?
    ! project older 'find_package(piezoshape 0.1 REQUIRED)' piezoshape::piezoshape && grep -q 'version: 0' "$dir/said"
    check 'CMake: another minor version is refused' $?
    ! cmake -S "$top/firmware_demo/packages" -B "$dir/bits" -DPIEZOSHAPE_REAL_BITS=16 >"$dir/said" 2>&1 && grep -q "'16'; write 32" "$dir/said"
    check 'CMake: a precision that does not exist is refused' $?

    # Zephyr's functions as a stub: what the module asks for is compiled as Zephyr would.
    mkdir "$dir/zephyr"
    cat >"$dir/zephyr/CMakeLists.txt" <<EOT
cmake_minimum_required(VERSION 3.13)
project(zephyr_stub C)
set(CONFIG_PIEZOSHAPE y)
function(zephyr_library_named name)
  add_library(\${name} STATIC)
  set_property(GLOBAL PROPERTY stub_library \${name})
endfunction()
function(zephyr_library_sources)
  target_sources(piezoshape PRIVATE \${ARGV})
endfunction()
function(zephyr_library_compile_options)
  target_compile_options(piezoshape PRIVATE \${ARGV})
endfunction()
function(zephyr_include_directories)
  include_directories(\${ARGV})
  target_include_directories(piezoshape PUBLIC \${ARGV})
endfunction()
function(zephyr_compile_definitions)
  target_compile_definitions(piezoshape PUBLIC \${ARGV})
endfunction()
add_subdirectory($package/zephyr module)
add_executable(mirror $dir/mirror.c)
target_include_directories(mirror PRIVATE $dir)
target_link_libraries(mirror PRIVATE piezoshape m)
EOT
    { cmake -S "$dir/zephyr" -B "$dir/zephyr/build" && cmake --build "$dir/zephyr/build" -j2; } >"$dir/said" 2>&1 && "$dir/zephyr/build/mirror"
    check 'Zephyr: the module builds against a stub of its functions' $?
else
    for what in folder sources float double version precision Zephyr; do skip "CMake: $what" cmake; done
fi

# ---- Arduino -------------------------------------------------------------

arduino_file() {
    for field in name version author maintainer sentence paragraph category url architectures; do
        grep -q "^$field=" "$package/library.properties" || { echo "no field $field" >"$dir/said"; return 1; }
    done
    grep -q "^version=$version\$" "$package/library.properties"
}
arduino_file; check 'Arduino: every field of library.properties' $?
cross=${ARM_PREFIX:-arm-none-eabi-}
if command -v "${cross}g++" >/dev/null; then
    m4='-mthumb -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16'
    mkdir "$dir/arduino" "$dir/core"
    # What the sketch needs of Arduino's core.
    cat >"$dir/core/Arduino.h" <<'EOT'
#include <stddef.h>
struct serial { void begin(long); void println(const char *); };
extern serial Serial;
unsigned long micros();
EOT
    arduino() {
        # Arduino compiles every source below src with src as the only folder of headers, C as gnu11.
        # shellcheck disable=SC2086
        for source in $(find "$package/src" -name '*.c'); do
            "${cross}gcc" $m4 -std=gnu11 -Os -Wall -Wextra -Werror -I"$package/src" -c "$source" \
                -o "$dir/arduino/$(echo "$source" | sed "s|$package/src/||" | tr / _).o" >>"$dir/said" 2>&1 || return 1
        done
        # shellcheck disable=SC2086
        "${cross}g++" $m4 -std=gnu++11 -fno-exceptions -fno-rtti -Os -Wall -Werror -I"$package/src" -I"$dir/core" \
            -include "$dir/core/Arduino.h" -x c++ -c "$package/examples/mirror/mirror.ino" -o "$dir/arduino/mirror.o" >>"$dir/said" 2>&1 || return 1
        # C++ without exceptions needs no library of C++, which the cross compiler of Debian does not have.
        # shellcheck disable=SC2086
        "${cross}g++" $m4 -nostartfiles -nodefaultlibs -Lfirmware_demo/boards -Tfirmware_demo/boards/mps2_an386.ld -Wl,--gc-sections \
            "$dir"/arduino/*.o -lm -lc -lgcc -o "$dir/sketch.elf" >>"$dir/said" 2>&1
    }
    # A core for the sketch: a serial line, a clock of 0.1 s a call, and 50 rounds of loop().
    cat >"$dir/core/main.cpp" <<'EOT'
#include <Arduino.h>
#include "board.h"
void setup();
void loop();
serial Serial;
void serial::begin(long) { board_start(); }
void serial::println(const char *text)
{
    for (; *text; text++)
        board_put(*text);
    board_put('\n');
}
unsigned long micros()
{
    static unsigned long now;
    return now += 100000;
}
int main()
{
    setup();
    for (int tick = 0; tick < 50; tick++)
        loop();
    Serial.println("50 rounds");
    return 0;
}
EOT
    core() {
        for source in start board_mps2; do
            # shellcheck disable=SC2086
            "${cross}gcc" $m4 -std=gnu11 -Os -Ifirmware_demo/boards -c "firmware_demo/boards/$source.c" -o "$dir/arduino/$source.o" || return 1
        done
        # shellcheck disable=SC2086
        "${cross}g++" $m4 -std=gnu++11 -fno-exceptions -fno-rtti -Os -Wall -Werror -I"$dir/core" -Ifirmware_demo/boards \
            -c "$dir/core/main.cpp" -o "$dir/arduino/main.o"
    }
    core >"$dir/said" 2>&1 && arduino; check 'Arduino: sources, sketch and a small core make a program, linked by g++' $?
    if command -v "${QEMU:=qemu-system-arm}" >/dev/null; then
        timeout 120 "$QEMU" -M mps2-an386 -kernel "$dir/sketch.elf" -nographic -monitor none -serial stdio \
            -semihosting-config enable=on,target=native </dev/null >"$dir/said" 2>&1 && [ "$(tr -d '\r' <"$dir/said")" = "ok
50 rounds" ]
        check 'Arduino: the sketch runs' $?
    else
        skip 'Arduino: the sketch runs' qemu-system-arm
    fi
else
    skip 'Arduino: sources and sketch' "${cross}g++"
fi

# ---- PlatformIO ----------------------------------------------------------

python3 -c "
import json,sys
j=json.load(open('$package/library.json'))
assert j['name']=='piezoshape' and j['version']=='$version' and j['license']=='BSD-2-Clause', j
import os
for key in ('srcDir','includeDir'): assert os.path.isfile('$package/'+j['build'][key]+'/'+j['headers']), key
" >"$dir/said" 2>&1; check 'PlatformIO: the manifest names what is there' $?
if command -v pio >/dev/null; then
    (cd "$package" && pio pkg pack -o "$dir/pio.tar.gz") >"$dir/said" 2>&1 && tar tzf "$dir/pio.tar.gz" | grep -q 'src/pzs.h'
    packed=$?
    if grep -q 'Could not load SPDX' "$dir/said"; then
        skip 'PlatformIO: pio packs it' 'network for the list of licences'
    else
        check 'PlatformIO: pio packs it' $packed
    fi
else
    skip 'PlatformIO: pio packs it' pio
fi
echo "1..$n"
[ "$failed" -eq 0 ]
