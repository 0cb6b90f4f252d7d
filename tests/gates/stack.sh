#!/bin/sh
# Worst-case stack of every public function, summed along the call graph gcc writes; no recursion,
# no calls through pointers, no frames of unknown size. 1 KB for an image in float, 2 KB where every number is double.
. tests/gates/common.sh

# check NAME BUDGET_BYTES FLAGS...
check() {
    name=$1
    budget=$2
    shift 2
    tap_needs "$ARM_CC" "$name" || return 0
    rm -f "$scratch"/*
    for file in $(sources 0); do
        # shellcheck disable=SC2086
        if ! "$ARM_CC" -std=c99 -O2 -ffunction-sections -fno-math-errno -ffp-contract=off $include "$@" \
            -fstack-usage -fcallgraph-info=su -c "$file" -o "$scratch/$(basename "$file" .c).o" \
            2>"$scratch/found"; then
            tap 1 "$name"
            return 0
        fi
    done
    awk -v budget="$budget" '
        # Text of the quoted attribute `key` in a line of the graph.
        function quoted(line, key) {
            if (!match(line, key ": \"[^\"]*\"")) return ""
            return substr(line, RSTART + length(key) + 3, RLENGTH - length(key) - 4)
        }
        function short(title) { sub(/.*:/, "", title); return title }
        function fault(text) { print text; faults++ }

        # Bytes below and including a function; the chain is left in path[title]. open marks the current chain.
        function depth(title,    n, list, i, most, bytes) {
            if (title in known) return known[title]
            if (title in open) { fault("recursion through " short(title)); return 0 }
            open[title] = 1
            path[title] = short(title) " " own[title] + 0
            n = split(calls[title], list, "\n")
            for (i = 1; i <= n; i++) {
                if (list[i] == "") continue
                if (list[i] == "__indirect_call") { fault("call through a pointer in " short(title)); continue }
                bytes = depth(list[i])
                if (bytes > most) { most = bytes; path[title] = short(title) " " own[title] + 0 " > " path[list[i]] }
            }
            delete open[title]
            return known[title] = own[title] + most
        }

        /^node:/ {
            label = quoted($0, "label")
            if (match(label, /[0-9]+ bytes \([a-z,]*\)/)) {
                frame = substr(label, RSTART, RLENGTH)
                title = quoted($0, "title")
                own[title] = frame + 0
                if (frame !~ /static|bounded/) fault("frame of unknown size in " short(title))
            }
        }
        /^edge:/ { calls[quoted($0, "sourcename")] = calls[quoted($0, "sourcename")] "\n" quoted($0, "targetname") }
        END {
            for (title in own) {
                bytes = depth(title)
                if (title !~ /^pzs_/) continue
                public++
                if (bytes > budget) fault(bytes " bytes: " path[title])
                if (bytes > worst) { worst = bytes; chain = path[title] }
            }
            if (!public) fault("no public function found")
            print worst " bytes of " budget ": " chain > "/dev/stderr"
            exit faults > 0
        }' "$scratch"/*.ci >"$scratch/found" 2>"$scratch/worst"
    tap $? "$name: $(cat "$scratch/worst")"
}

# shellcheck disable=SC2086
{
    check 'Cortex-M4F, float' 1024 $m4 -DPZS_REAL_BITS=32
    check 'Cortex-M7, float' 1024 $m7 -DPZS_REAL_BITS=32
    check 'Cortex-M7, double' 2048 $m7 -DPZS_REAL_BITS=64
}
tap_end
