#!/bin/bash
# compare_smoke.sh - bench/compare says what differs, and of what does not that it does not (TAP).

set -u -o pipefail
: "${top_srcdir:?is set by make check}" "${top_builddir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

names='results__of_one_run_are_the_same
results__tell_what_became_slower
results__tell_what_is_counted_otherwise
results__of_another_answer_fail
results__of_other_positions_are_refused
builds__play_by_turns
builds__tell_what_became_slower'
if ! command -v python3 >/dev/null; then
    for name in $names; do
        tap_skip "compare_$name" "no python3"
    done
    tap_end
    exit
fi

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log

compare() {
    python3 "$top_srcdir/bench/compare" "$@" >"$log" 2>&1
}

# The result in one.json with another value where the expression says so.
changed() {
    python3 -c "
import json, sys
result = json.load(open('$work/one.json'))
frames, settings = result['frames'], result['settings']
counts = result['summary']['counts']
$1
json.dump(result, open('$work/other.json', 'w'))"
}

"$top_builddir/bench/pccd-bench" --small --frames 0-7 --format json -o "$work/one.json" \
    fast-sheet >"$log" 2>&1 || cat "$log"

# If this failed, every comparison would tell of changes.
compare --fail-slower 0 "$work/one.json" "$work/one.json" && grep -q 'no difference' "$log"
tap_result $? compare_results__of_one_run_are_the_same "$log"

# If this failed, a slower build would pass.
changed "
for frame in frames:
    frame['ms']['step'] *= 1.25"
compare "$work/one.json" "$work/other.json" && grep -q '^fast-sheet small .* slower 25.0 %' "$log" &&
    compare --fail-slower 30 "$work/one.json" "$work/other.json" &&
    compare --fail-slower 20 "$work/other.json" "$work/one.json" && grep -q 'faster 20.0 %' "$log" &&
    ! compare --fail-slower 20 "$work/one.json" "$work/other.json" && grep -q 'WRONG' "$log"
tap_result $? compare_results__tell_what_became_slower "$log"

# If this failed, more work in the same time would stay unseen.
changed "counts['box_tests']['all'] *= 2"
compare "$work/one.json" "$work/other.json" && grep -q 'box_tests [0-9]*, now [0-9]* (+100.0 %)' "$log"
tap_result $? compare_results__tell_what_is_counted_otherwise "$log"

# If this failed, a build that is faster because it is wrong would be praised.
changed "settings['hash'] = '2:' + '0' * 32"
compare "$work/one.json" "$work/other.json"
[ $? -eq 1 ] && grep -q 'another answer' "$log" && changed "settings['hash'] = '0' * 32" &&
    compare "$work/one.json" "$work/other.json" && grep -q 'hashes of two versions' "$log"
tap_result $? compare_results__of_another_answer_fail "$log"

# If this failed, times of different scenes would be compared.
changed "settings['input'] = '0' * 32"
compare "$work/one.json" "$work/other.json"
[ $? -eq 2 ] && grep -q 'positions differ' "$log"
tap_result $? compare_results__of_other_positions_are_refused "$log"

# If this failed, two builds could not be compared. (What it says of the times is the machine's.)
compare --scene fast-sheet --rounds 3 --options '--small --frames 0-7' "$top_builddir" "$top_builddir" &&
    grep -q '^fast-sheet small .* noise' "$log" && [ "$(wc -l <"$log")" -eq 1 ]
tap_result $? compare_builds__play_by_turns "$log"

# If this failed, a build that is ten times as slow would pass.
if [ "$(sed -n 's/.*"simd":"\([a-z0-9]*\)".*/\1/p' "$work/one.json")" = scalar ]; then
    tap_skip compare_builds__tell_what_became_slower "no other instruction set"
else
    ! compare --scene fast-sheet --rounds 3 --options '--small --frames 0-7' --fail-slower 20 \
        --options-b '--cpu scalar' "$top_builddir" "$top_builddir" && grep -q ' ms  slower ' "$log"
    tap_result $? compare_builds__tell_what_became_slower "$log"
fi

tap_end
