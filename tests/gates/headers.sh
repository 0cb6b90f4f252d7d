#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The public headers: each compiles alone as C and as C++; a C++ program links; no name of the library can collide with a
# name of the program; the table format number is tied to the table structs.
#   B (build directory) from the environment
: "${B:=build}" "${CXX:=g++}" "${CLANGXX:=clang++}"
. tests/gates/common.sh

# alone COMPILER LANGUAGE FLAGS...: every public header, options off and on
alone() {
    compiler=$1 language=$2
    shift 2
    tap_needs "$compiler" "headers alone, $compiler $*" || return 0
    for header in include/*.h; do
        for choice in 0 1 modes; do
            printf '#include "%s"\ntypedef int not_empty;\n' "$(basename "$header")" |
                # shellcheck disable=SC2046
                "$compiler" "$@" -pedantic -Wall -Wextra -Werror -Iinclude $(options "$choice") -fsyntax-only \
                    -x "$language" - || echo "$header with $(options "$choice")"
        done
    done >"$scratch/found" 2>&1
    [ ! -s "$scratch/found" ]
    tap $? "each header alone: $compiler $*"
}

alone "$CC" c -std=c99
alone "$CLANG" c -std=c99
alone "$ARM_CC" c -std=c99
alone "$CXX" c++ -std=c++11
alone "$CLANGXX" c++ -std=c++17
lines=$(wc -l <include/pzs_control.h)
[ "$lines" -le 300 ]
tap $? "pzs_control.h has $lines lines, at most 300"

# A program may use every plain word as a name of its own.
words='product sense solve shape force step tick measure reset init check clamp model control'
{
    echo '#include "pzs.h"'
    echo '#include <stdio.h>'
    echo '#ifdef __cplusplus'
    echo 'extern "C" {'
    echo '#endif'
    for word in $words; do echo "int $word(int x); int $word(int x) { return x + 1; }"; done
    echo '#ifdef __cplusplus'
    echo '}'
    echo '#endif'
    echo 'static const pzs_real one[1] = {1}, low[1] = {-1};'
    echo 'static pzs_real work[PZS_CONTROL_BYTES(1, 1) / sizeof(pzs_real) + 1];'
    echo 'int main(void)'
    echo '{'
    echo '    static pzs_control c;'
    echo '    static pzs_problem p;'
    echo '    p.inputs = p.outputs = 1;'
    echo '    p.influence = p.weight = p.upper = p.step_limit = one;'
    echo '    p.lower = low;'
    echo '    p.reference_voltage = low;'
    echo '    if (pzs_problem_seal(&p) != PZS_OK) return 1;'
    echo '    if (pzs_control_init(&c, &p, NULL, work, sizeof work) != PZS_OK) return 2;'
    echo '    if (pzs_tick(&c, low, NULL) != PZS_OK) return 3;'
    echo '    puts(pzs_version());'
    echo "    return $(echo "$words" | sed 's/ /(0) + /g; s/$/(0)/') != $(echo "$words" | wc -w);"
    echo '}'
} >"$scratch/words.c"
cp "$scratch/words.c" "$scratch/words.cpp"

# links COMPILER SOURCE FLAGS...
links() {
    compiler=$1 source=$2
    shift 2
    tap_needs "$compiler" "$compiler links" || return 0
    for bits in 32 64; do
        "$compiler" "$@" -Wall -Wextra -Werror -Iinclude -DPZS_REAL_BITS="$bits" -DPZS_NONLINEAR=1 -DPZS_MODES=1 "$scratch/$source" \
            "$B/$bits/libpiezoshape.a" -lm -o "$scratch/words" 2>&1 && "$scratch/words" >/dev/null || echo "$bits bits"
    done >"$scratch/found"
    [ ! -s "$scratch/found" ]
    tap $? "a program with names of its own links and runs: $compiler $source"
}
links "$CC" words.c -std=c99
links "$CXX" words.cpp -std=c++11
links "$CLANGXX" words.cpp -std=c++17

"$NM" -g --defined-only "$B/32/libpiezoshape.a" "$B/64/libpiezoshape.a" 2>/dev/null |
    awk 'NF == 3 && $3 !~ /^pzs_/ { print $3 }' | sort -u >"$scratch/found"
[ ! -s "$scratch/found" ] && [ -f "$B/64/libpiezoshape.a" ]
tap $? 'every external symbol begins with pzs_'

# The text of the table structs without comments, blanks and names of parameters, which change no byte of a table; its checksum
# is recorded beside the format number.
tables='pzs_rows pzs_element_type pzs_compact_type pzs_node pzs_structure pzs_electrodes pzs_prescribed_resultants pzs_prescribed_motion pzs_nonlinear
    pzs_follower pzs_body pzs_contact_face pzs_limit_rows pzs_sparse_influence pzs_problem pzs_estimator pzs_reading_delay pzs_vibration pzs_governor pzs_feed_forward_table pzs_known_loads pzs_amplifier
    pzs_fault_detection pzs_hysteresis pzs_actuator_curves pzs_supervision
    pzs_selftest_tables pzs_modal_gains pzs_free_functions pzs_sensor_gate pzs_block
    pzs_mass'
cat include/*.h | "$CC" -E -fpreprocessed -P - 2>/dev/null | sed '/^#/d' >"$scratch/bare"
# Every struct with a format number, and every struct of which such a table has an array, is one of these.
awk '
    /^typedef struct pzs_[a-z_]* [{]/ { name = $3; names[++count] = name; text[name] = "" }
    name != "" { text[name] = text[name] " " $0 }
    /^}/ { name = "" }
    END {
        for (i = 1; i <= count; i++) if (text[names[i]] ~ /uint32_t format/) table[names[i]] = 1
        for (again = 1; again;) {
            again = 0
            for (one in table)
                for (i = 1; i <= count; i++)
                    if (!(names[i] in table) && text[one] ~ "[^_a-z]" names[i] " \\**[a-z]") { table[names[i]] = 1; again = 1 }
        }
        for (one in table) print one
    }' "$scratch/bare" | sort >"$scratch/needed"
# shellcheck disable=SC2086
echo $tables | tr ' ' '\n' | sort | comm -23 "$scratch/needed" - | sed 's/$/ is a table struct: add it to `tables` here/' >"$scratch/found"
[ ! -s "$scratch/found" ] && [ -s "$scratch/needed" ]
tap $? "all $(wc -l <"$scratch/needed") table structs are tied to the format number"
for table in $tables; do
    grep -q "^typedef struct $table {" "$scratch/bare" || echo "no struct $table in include/"
    awk -v name="$table" '
        $0 ~ "^typedef struct " name " [{]" { on = 1 }
        on { print }
        on && /^}/ { exit }' "$scratch/bare"
done | tr '\n\t' '  ' |
    sed -E ':again; s/(\(\*[a-z_]+\)\([^()]*[ *])[A-Za-z_0-9]+((\[[0-9]*\])*[,)])/\1\2/; t again' | tr -d ' \n' >"$scratch/structs"
sum=$(cksum <"$scratch/structs" | cut -d' ' -f1)
format=$(sed -n 's/^#define PZS_TABLE_FORMAT \([0-9]*\)u$/\1/p' include/pzs_version.h)
grep -qx "$format $sum" tests/gates/table_format.txt
recorded=$?
[ $recorded -eq 0 ] || echo "format $format has the checksum $sum now. If a table struct has changed, raise PZS_TABLE_FORMAT \
in include/pzs_version.h and append the line 'FORMAT CHECKSUM' to tests/gates/table_format.txt" >"$scratch/found"
tap $recorded "table format $format belongs to the table structs"
tap_end
