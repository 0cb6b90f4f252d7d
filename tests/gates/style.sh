#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Rules of lib/, the last but one of all code, that no compiler warns of: no allocation, no stdio, no goto, no #if inside a function,
# no array of variable length, no file name or configuration beyond pzs_config.h. Recursion: see stack.sh.
. tests/gates/common.sh

# check NAME: what the awk program in $2 prints about the library's files are faults.
check() {
    awk "$2" lib/*/*.[ch] include/*.h >"$scratch/found"
    [ ! -s "$scratch/found" ]
    tap $? "$1"
}

# Comments and strings are not code: strip them before looking for words.
strip='
    function code(line,    start) {
        gsub(/"([^"\\]|\\.)*"/, "\"\"", line)
        if (inside) { if (!match(line, /\*\//)) return ""; line = substr(line, RSTART + 2); inside = 0 }
        gsub(/\/\*([^*]|\*[^\/])*\*\//, " ", line)
        if (match(line, /\/\*/)) { line = substr(line, 1, RSTART - 1); inside = 1 }
        sub(/\/\/.*/, "", line)
        return line
    }
    FNR == 1 { inside = 0; depth = 0 }
    { line = code($0); where = FILENAME ":" FNR ": " }'

check 'no allocation, no stdio, no goto, no setjmp, no varargs' "$strip"'
    line ~ /(^|[^A-Za-z0-9_])(malloc|calloc|realloc|free|alloca|printf|fprintf|snprintf|puts|setjmp|longjmp|abort|exit|assert)[ \t]*\(/ { print where $0 }
    line ~ /(^|[^A-Za-z0-9_])(goto|va_list|jmp_buf)([^A-Za-z0-9_]|$)/ { print where $0 }
    $0 ~ /#[ \t]*include[ \t]*<(stdio|stdlib|stdarg|setjmp|time|errno|locale|signal|assert)[.]h>/ { print where $0 }'

check 'no #if inside a function' "$strip"'
    line ~ /^[ \t]*#/ { if (depth > 0 && line ~ /^[ \t]*#[ \t]*(if|ifdef|ifndef|else|elif)/) print where $0; next }
    line ~ /^extern "" \{/ { next } # not a function: the linkage of a header for C++
    { opened = gsub(/\{/, "{", line); closed = gsub(/\}/, "}", line); depth += opened - closed; if (depth < 0) depth = 0 }'

check 'switches come from pzs_config.h alone' "$strip"'
    line ~ /^[ \t]*#[ \t]*define[ \t]+PZS_(REAL_BITS|NONLINEAR|MODES|TILE|STEP_PASSES|FOLLOWER|CONTACT|ELECTRIC)([ \t(]|$)/ && FILENAME !~ /pzs_config[.]h/ { print where $0 }'

check 'lines of at most 100 columns, no tabs, no trailing blanks' '
    length($0) > 100 { print FILENAME ":" FNR ": " length($0) " characters" }
    /\t/ { print FILENAME ":" FNR ": tab" }
    /[ ]$/ { print FILENAME ":" FNR ": trailing blank" }'

# A conditional expression is open from its ? to the end of the parenthesis, list item or statement
# that it stands in; `open` holds the number of open ones for each depth of parentheses.
conditionals='
    FNR == 1 { level = 0; split("", open); count = 0 }
    line ~ /^[ \t]*#/ || continues { continues = line ~ /\\$/; next }
    {
        for (i = 1; i <= length(line); i++) {
            c = substr(line, i, 1)
            if (c ~ /[(\[{]/) open[++level] = 0
            if (c ~ /[)\]}]/ && level > 0) level--
            if (c ~ /[;,}]/) open[level] = 0
            if (c ~ /[;{}]/) count = 0
            if (c != "?") continue
            for (k = 0; k <= level; k++) if (open[k] > 0) { print where "nested: " $0; break }
            if (++count == 2 && FILENAME !~ /^tests/) print where "second of a statement: " $0
            open[level]++
        }
    }'
awk "$strip$conditionals" lib/*/*.[ch] include/*.h host_tools/*/*.[ch] host_tools/fmu/component/*.[ch] \
    firmware_demo/*/*.[ch] firmware_demo/*/*/*.[ch] tests/*/*.[ch] >"$scratch/found"
[ ! -s "$scratch/found" ]
tap $? 'conditional expressions: not nested, one in a statement (tests: not nested)'

if tap_needs "$CC" 'no array of variable length, no implicit declaration'; then
    # shellcheck disable=SC2086,SC2046
    "$CC" -std=c99 -fsyntax-only -Werror=vla -Werror=implicit-function-declaration $(options 1) $include $(sources 1) \
        2>"$scratch/found"
    tap $? 'no array of variable length, no implicit declaration'
fi
tap_end
