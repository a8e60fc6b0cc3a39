#!/bin/bash
# smoke.sh - the other libraries still build, run, and find one set of pairs; ours finds
# what is near, and how much of a step is safe (TAP).
#
# With tiny scenes; the times mean nothing here.

set -u -o pipefail
: "${top_srcdir:?is set by make check}" "${top_builddir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

log=$(mktemp) || exit 99
trap 'rm -f "$log"' EXIT

# If this failed, the libraries would be timed on different work, or not run at all.
peers=$top_builddir/bench/peers/peers
if [ -x "$peers" ]; then
    "$peers" --smoke >"$log" 2>&1
    tap_result $? bench_peers__find_one_set_of_pairs "$log"
else
    tap_skip bench_peers__find_one_set_of_pairs "configure has found no other library"
fi

# If this failed, times of what is near would be those of wrong answers.
near=$top_builddir/bench/peers/near
"$near" --smoke >"$log" 2>&1
tap_result $? bench_near__says_what_exact_integers_say "$log"

# If this failed, ipc-toolkit would not be asked the same, or not at all.
if grep -q 'ipc-toolkit: skipped' "$log"; then
    tap_skip bench_near__asks_ipc_toolkit "configure was not told where it is"
else
    [ "$(grep -c 'ipc-toolkit, features' "$log")" -ge 3 ]
    tap_result $? bench_near__asks_ipc_toolkit "$log"
fi

# If this failed, a step that is said to be safe would be compared with a wrong one.
"$near" allowed --smoke over-box >"$log" 2>&1 &&
    grep -q 'ours: allowed' "$log"
tap_result $? bench_allowed__is_just_before_the_true_share "$log"

# If this failed, README.md would say what is not so: ours is right on each hard query.
queries=$top_builddir/bench/peers/queries
if [ ! -x "$queries" ]; then
    tap_skip bench_queries__finds_ours_right "configure has not found FCL"
elif "$queries" >"$log" 2>&1; [ $? -eq 77 ]; then
    tap_skip bench_queries__finds_ours_right "no hand-made queries in \$PCCD_DATA"
else
    grep -q '^| pccd | 0 | 0 |$' "$log"
    tap_result $? bench_queries__finds_ours_right "$log"
fi

# If this failed, the time of bodies that turn would be that of wrong answers.
turning=$top_builddir/bench/peers/turning
if [ -x "$turning" ]; then
    env -u PCCD_DATA "$turning" --smoke >"$log" 2>&1 &&
        [ "$(grep -c ' 0 that we call free' "$log")" -eq 12 ] &&
        grep -q '1000 poses.* 0 hits missed' "$log"
    tap_result $? bench_turning__says_what_many_poses_say "$log"
else
    tap_skip bench_turning__says_what_many_poses_say "configure has not found FCL"
fi

tap_end
