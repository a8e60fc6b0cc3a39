#!/bin/bash
# test_planner.sh - the planner's path and its edges are what dense samples say (TAP).
#
# Room:     tests/planner.
# Does:     let check.cc judge a path and random edges, and turns.cc ask about small turns.
#           PCCD_EDGES edges with PCCD_SAMPLES samples each, for the table of client/planner/README.md 2000 and 400.

set -u -o pipefail
: "${top_srcdir:?is set by make check}" "${top_builddir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
planner=$top_builddir/client/planner/planner
check=$top_builddir/tests/planner/check
edges=${PCCD_EDGES:-300}
samples=${PCCD_SAMPLES:-100}

if [ ! -x "$planner" ]; then
    for name in finds_a_path_that_is_free calls_nothing_free_that_meets_something \
        refuses_few_free_edges refuses_small_turns_through_a_plate is_built_as_its_page_says; do
        tap_skip "planner__$name" "configure has not found OMPL (on Debian: libompl-dev)"
    done
    tap_end
    exit
fi
log=$(mktemp) || exit 99
trap 'rm -f "$log"' EXIT

timeout 60 "$planner" 2>"$log" | timeout 100 "$check" 1000 >>"$log" 2>&1
# If it failed, who follows the path would hit something, or there would be none.
tap_result $? planner__finds_a_path_that_is_free "$log"

# free and refused edges in $log, which of these are free at every sample
judge() {
    timeout 60 "$planner" --pieces "$1" --edges "$edges" --seed "${PCCD_SEED:-1}" |
        timeout 300 "$check" "$samples" >"$log" 2>&1
}
status=0
for pieces in ${PCCD_PIECES:-1 8}; do # with few, chords are far from the arcs
    judge "$pieces" || status=1
    [ -z "${PCCD_EDGES-}" ] || sed -n "s/^# /# $pieces pieces: /p" "$log"
    [ $status -eq 0 ] || break
done
# If it failed, an edge would be free on its chords, and not on its arcs.
tap_result $status planner__calls_nothing_free_that_meets_something "$log"

judge 32 && awk '/ free; / { free = $2; wasted = $8 } END { exit !(free > 0 && wasted <= free / 50) }' "$log"
# If it failed, planners would find no way where there is one.
tap_result $? planner__refuses_few_free_edges "$log"

timeout 60 "$top_builddir/tests/planner/turns" >"$log" 2>&1
# If it failed, a body could turn through what is thin, by less than OMPL cuts into pieces.
tap_result $? planner__refuses_small_turns_through_a_plate "$log"

line=$(sed -n 's/^    \(c++ .*\)/\1/p' "$top_srcdir/client/planner/README.md")
(cd "$top_srcdir/client/planner" && export PKG_CONFIG_PATH=$top_builddir${PKG_CONFIG_PATH:+:$PKG_CONFIG_PATH} &&
    eval "$line -o /dev/null") >"$log" 2>&1 && [ -n "$line" ]
# If it failed, who builds by hand would look for folders that this release of OMPL does not have.
tap_result $? planner__is_built_as_its_page_says "$log"

tap_end
