#!/bin/bash
# tests/unit/test_eng_sets.sh - the engine's tests, as on a processor that has less.
#
# Room:  engine (daemon/engine/kernel), from outside.
# Does:  run each test that asks for the instruction sets once more for one of the sets but the
#        best, with PCCD_CPU as the last one that there is: what is counted over the sets is
#        less then. The sets take turns; which program has which is drawn (PCCD_SEED). With
#        PCCD_SETS=all each program has every set.
# Does not: run those that wait for a clock, nor the longest (determinism/test_eng_anew and
#        _fuzz), which draw a set at each step.

set -u
. "${top_srcdir:?}/tests/support/tap.sh"
: "${top_builddir:?}"

dir=$(mktemp -d "${TMPDIR:-/tmp}/pccd-sets-XXXXXX") || exit 1
trap 'rm -rf "$dir"' EXIT

programs() {
    (cd "$top_srcdir" && grep -lE 'eng_kernels|way_(kernels|count|choose)' \
        tests/unit/test_eng_*.c tests/determinism/test_eng_golden.c | sed 's/\.c$//')
}

# From the least to the best.
sets() {
    PCCD_CPU='' "$top_builddir/tests/unit/kernel_digest" | cut -d ' ' -f 1 | uniq
}

# run NUMBER SET: the programs whose turn it is; a line for each that failed.
run() {
    local program turn=$seed status=0
    for program in $programs; do
        turn=$((turn + 1))
        [ "${PCCD_SETS-}" = all ] || [ $((turn % count)) -eq "$1" ] || continue
        PCCD_CPU=$2 bash "$top_srcdir/tests/support/cmocka.sh" "$top_builddir/$program" \
            >"$dir/out" 2>"$dir/err" && continue
        status=1
        echo "$program:"
        grep '^not ok' "$dir/out" || tail -n 5 "$dir/err"
    done
    return $status
}

programs=$(programs)
least=$(sets | head -n -1)
count=$(wc -w <<<"$least")
seed=${PCCD_SEED:-$RANDOM}
echo "# PCCD_SEED=$seed"
# If it ran none, nothing below would be asked.
[ "$(wc -w <<<"$programs")" -gt 10 ] && [ -n "$(sets)" ]
tap_result $? "sets__there_are_tests_that_ask_for_them"
number=0
for set in $least; do
    # If it failed, no check would pass on a processor without what comes after this set.
    run $number "$set" >"$dir/log"
    tap_result $? "sets__tests_pass_with_${set}_at_most" "$dir/log"
    number=$((number + 1))
done
tap_end
