#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# One language: words that were replaced do not come back in the code and the texts of the project. Not read are the tests,
# the list of changes, and the tables of retired words themselves.
# tests/gates/retired_words.txt has a line for each: the retired word (an awk regular expression on a whole word), then
# what to write instead. Words that are retired in one meaning alone ("meaning:") are left to readers.
. tests/gates/common.sh
git ls-files --cached --others --exclude-standard 'lib/*.[ch]' 'include/*.h' 'host_tools/*.[ch]' 'firmware_demo/*.[ch]' '*.md' |
    grep -v -x -e CHANGELOG.md -e CONTRIBUTING.md -e host_tools/scene/scene_retired.c >"$scratch/files"
xargs awk -v list=tests/gates/retired_words.txt '
    BEGIN {
        while ((getline line <list) > 0) {
            if (line ~ /^(#|meaning:)/ || line == "") continue
            split(line, part, /  +/)
            of_library[words + 1] = sub(/^lib:/, "", part[1])
            word[++words] = "(^|[^A-Za-z0-9])" part[1] "([^A-Za-z0-9]|$)"
            use[words] = part[2]
        }
    }
    {
        text = tolower($0)
        gsub(/_/, " ", text)
        for (i = 1; i <= words; i++)
            if (text ~ word[i] && (!of_library[i] || FILENAME ~ /^(lib|include).*[.][ch]$/)) print FILENAME ":" FNR ": write \"" use[i] "\": " $0
    }' <"$scratch/files" >"$scratch/found"
[ ! -s "$scratch/found" ]
tap $? "no retired word ($(grep -v -c -e '^#' -e '^meaning:' tests/gates/retired_words.txt) words)"
tap_end
