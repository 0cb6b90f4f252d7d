#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Worst-case stack of every public function, summed along the call graph gcc writes; no recursion, no frames of
# unknown size, and calls through pointers only where it is known what they reach. 1 KB for a linear image in float,
# 2 KB where every number is double; at large rotation an element's tangent stands on the stack, 406 numbers and what
# makes them.
. tests/gates/common.sh

# check NAME BUDGET_BYTES OPTIONS TARGET_FLAGS BITS
check() {
    name=$1
    budget=$2
    tap_needs "$ARM_CC" "$name" || return 0
    if ! compile "$ARM_CC" "$4" "$3" -DPZS_REAL_BITS="$5" 2>"$scratch/found"; then
        tap 1 "$name"
        return 0
    fi
    cat include/*.h | grep -o 'pzs_[a-z_0-9]*(' | tr -d '(' | sort -u >"$scratch/api"
    awk -v budget="$budget" -v public_names="$scratch/api" '
        BEGIN {
            while ((getline line <public_names) > 0) api[line] = 1
            for (name in api) api[name "_32"] = api[name "_64"] = 1
        }
        # Text of the quoted attribute `key` in a line of the graph.
        function quoted(line, key) {
            if (!match(line, key ": \"[^\"]*\"")) return ""
            return substr(line, RSTART + length(key) + 3, RLENGTH - length(key) - 4)
        }
        function short(title) { sub(/.*:/, "", title); return title }
        function fault(text) { print text; faults++ }

        # Whether an option that is not compiled here defines a function of this name.
        function defined_elsewhere(name,    command, answer) {
            command = "grep -hE \"^[a-z].*[ *]" name "\\\\(\" lib/*/*.c | head -n 1"
            command | getline answer
            close(command)
            return answer != ""
        }

        # What a call through a pointer at FILE:LINE:COLUMN may reach, as lines: a member of a structure has the name of
        # its functions, NAME in other files or pzs_NAME_...
        function targets(title, place,    part, line, found, other, i) {
            split(place, part, ":")
            for (i = 0; i < part[2]; i++) getline line <part[1]
            close(part[1])
            if (!match(substr(line, part[3]), /->[a-z_]+\(/)) { fault("call through a pointer in " short(title)); return "" }
            line = substr(substr(line, part[3]), RSTART + 2, RLENGTH - 3)
            for (other in own)
                if ((short(other) == line && home[other] != home[title]) || other ~ "^pzs_" line "_") found = found "\n" other
            if (found == "" && !defined_elsewhere(line)) fault("the pointer " line " in " short(title) " reaches nothing known")
            return found
        }

        # Bytes below and including a function; the chain is left in path[title]. open marks the current chain.
        function depth(title,    n, list, i, most, bytes, all) {
            if (title in known) return known[title]
            if (title in open) { fault("recursion through " short(title)); return 0 }
            open[title] = 1
            path[title] = short(title) " " own[title] + 0
            all = calls[title]
            n = split(pointers[title], list, "\n")
            for (i = 1; i <= n; i++) if (list[i] != "") all = all targets(title, list[i])
            n = split(all, list, "\n")
            for (i = 1; i <= n; i++) {
                if (list[i] == "") continue
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
                home[title] = label
                sub(/^[^\\]*\\n/, "", home[title])
                sub(/:.*/, "", home[title])
                if (frame !~ /static|bounded/) fault("frame of unknown size in " short(title))
            }
        }
        /^edge:/ {
            source = quoted($0, "sourcename")
            target = quoted($0, "targetname")
            if (target == "__indirect_call") pointers[source] = pointers[source] "\n" quoted($0, "label")
            else calls[source] = calls[source] "\n" target
        }
        END {
            for (title in own) {
                bytes = depth(title)
                if (!(title in api)) continue
                public++
                if (bytes > budget) fault(bytes " bytes: " path[title])
                if (bytes > worst) { worst = bytes; chain = path[title] }
            }
            if (!public) fault("no public function found")
            print worst " bytes of " budget ": " chain > "/dev/stderr"
            exit faults > 0
        }' $(sed 's/o$/ci/' "$scratch/objects") >"$scratch/found" 2>"$scratch/worst"
    tap $? "$name: $(cat "$scratch/worst")"
}

# Bytes that include/pzs_base.h promises: budget IMAGE BYTES_OF_A_REAL
budget() {
    reals=$(sed -n "s/^#define PZS_STACK_$1 (\([0-9]*\)u \* sizeof(pzs_real))\$/\1/p" include/pzs_base.h)
    echo $((${reals:?include/pzs_base.h promises no stack} * $2))
}

check 'Cortex-M4F, float' "$(budget LINEAR 4)" 0 "$on_m4" 32
check 'Cortex-M7, float' "$(budget LINEAR 4)" 0 "$on_m7" 32
check 'Cortex-M7, double' "$(budget LINEAR 8)" 0 "$on_m7" 64
check 'Cortex-M4F, float, modes' "$(budget MODES 4)" modes "$on_m4" 32
check 'Cortex-M7, double, modes' "$(budget MODES 8)" modes "$on_m7" 64
check 'Cortex-M4F, float, nonlinear' "$(budget NONLINEAR 4)" 1 "$on_m4" 32
check 'Cortex-M7, double, nonlinear' "$(budget NONLINEAR 8)" 1 "$on_m7" 64
tap_end
