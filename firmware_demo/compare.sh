#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Compare what each image printed under QEMU with its host twin: all lines but the costs, bit by bit.
#   compare.sh DIRECTORY IMAGE:TWIN...
set -u
dir=$1
shift
passed=0
failed=0

# field FILE LINE NAME: the value of " NAME=" in the first line that starts with LINE
field() { sed -n "/^$2 /{s/.* $3=\([^ ]*\).*/\1/p;q;}" "$1"; }

printf '%-22s %-10s %-10s %6s %10s %9s %9s %9s %6s\n' image voltages host active iterations mean worst warm stack
for pair in "$@"; do
    target=$dir/${pair%%:*}.out
    host=$dir/${pair##*:}.out
    grep -q '^cost tick' "$target" || continue # no control loop: its lines follow below
    printf '%-22s %-10s %-10s %6s %10s %9s %9s %9s %6s\n' "${pair%%:*}" "$(field "$target" result voltages)" \
        "$(field "$host" result voltages)" "$(field "$target" result active)" "$(field "$target" result iterations)" \
        "$(field "$target" 'cost tick' mean)" "$(field "$target" 'cost tick' worst)" "$(field "$target" 'cost tick' warm)" "$(field "$target" 'cost stack' used)"
done
printf '(mean, worst, warm - a slowly moving target: instructions of one control tick as QEMU executes them, not cycles; stack: bytes)\n\n'

for pair in "$@"; do
    target=$dir/${pair%%:*}.out
    host=$dir/${pair##*:}.out
    sed -n "/^cost tick/d;/^cost stack/d;s/^cost /${pair%%:*}: /p" "$target"
    grep -q '^cost tick' "$target" || grep '^equilibrium \|^modes \|^output \|^result ' "$target"
    grep -v '^cost' "$target" | tr -d '\r' >"$target.bits"
    grep -v '^cost' "$host" >"$target.host"
    if ! grep -q '^exit 0$' "$target"; then
        printf 'not ok %s ended with %s\n' "${pair%%:*}" "$(tail -n 1 "$target")"
        grep FAILED "$target"
        failed=$((failed + 1))
    elif ! diff "$target.host" "$target.bits"; then
        printf 'not ok %s differs from the host\n' "${pair%%:*}"
        failed=$((failed + 1))
    else
        printf 'ok %s same bits as the host, %s drills\n' "${pair%%:*}" "$(grep -c '^drill .* ok' "$target")"
        passed=$((passed + 1))
    fi
    rm -f "$target.bits" "$target.host"
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
