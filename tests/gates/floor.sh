#!/bin/sh
# A file includes only what lies below it. gcc -MM lists what each file includes, directly or not.
. tests/gates/common.sh

# The floor of each file; files not named here do not exist for the library.
cat >"$scratch/floors" <<'EOF'
0 include/pzs_config.h
1 include/pzs.h lib/unrolled
2 lib/guard lib/linalg lib/product
3 lib/boxls lib/boxls_tableau lib/shell lib/shell_corner lib/shell_at
4 lib/sense lib/model
5 lib/control lib/nonlinear lib/face lib/electrode
6 lib/amplifier lib/estimate lib/faults lib/influence_at lib/follower lib/contact lib/contact_check lib/electric
7 host_tools/ firmware_demo/ tests/
EOF

# Lines "FILE INCLUDED" for one file with PZS_NONLINEAR $2. Generated tables include pzs.h alone.
includes() {
    case $1 in
    firmware_demo/*) own='-Ifirmware_demo' ;;
    *) own='-Ihost_tools' ;;
    esac
    # shellcheck disable=SC2086
    "$CC" -std=c99 -MM -MG $include $own -DDEMO_TABLES='"pzs.h"' \
        -DPZS_NONLINEAR="$2" "$1" 2>/dev/null | tr -d '\\' | tr ' ' '\n' |
        grep '\.h$' | sed 's|[^/]*/\.\./||' | grep -vx "$1" | sed "s|^|$1 |"
}

tap_needs "$CC" 'floors' || { tap_end; exit; }
for file in include/*.h lib/*.[ch] host_tools/*.[ch] firmware_demo/*.[ch] tests/*.[ch] tests/*/*.[ch]; do
    [ -f "$file" ] || continue
    includes "$file" 0
    includes "$file" 1
done | sort -u >"$scratch/pairs"

awk '
    function floor_of(file,    i) {
        for (i = 1; i <= names; i++)
            if (index(file, name[i]) == 1 && (name[i] ~ /[\/h]$/ || file ~ ("^" name[i] "[.]"))) return floor[name[i]]
        return -1
    }
    # In lib a file with an underscore belongs to what stands before it: shell_at to shell.
    function stem(file) { sub(/[.][ch]$/, "", file); if (file ~ /^lib/) sub(/_.*/, "", file); return file }
    function folder(file) { sub(/\/.*/, "", file); return file }
    NR == FNR { for (i = 2; i <= NF; i++) { name[++names] = $i; floor[$i] = $1 }; next }
    {
        mine = floor_of($1)
        other = floor_of($2)
        if (other < 0 && $2 ~ /\//) print $2 " has no floor (included by " $1 ")"
        if (mine < 0) print $1 " has no floor"
        if (other < mine || stem($1) == stem($2)) next
        if (mine == 7 && (folder($1) == folder($2) || folder($1) == "tests")) next
        print $1 " (floor " mine ") includes " $2 " (floor " other ")"
    }' "$scratch/floors" "$scratch/pairs" >"$scratch/found"
[ -s "$scratch/pairs" ] && [ ! -s "$scratch/found" ]
tap $? "every include goes down ($(wc -l <"$scratch/pairs") of them)"
tap_end
