#!/bin/bash
# test_planner.sh - the planner's path and its edges are what dense samples say (TAP).
#
# Room:     tests/planner.
# Does:     let check.cc judge a path and random edges, and turns.cc ask about thin obstacles.
#           PCCD_EDGES edges with PCCD_SAMPLES samples each; client/planner/README.md has 2000 and 400.

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
        refuses_few_free_edges refuses_what_it_does_not_know proves_turns_in_its_spaces \
        is_built_as_its_page_says; do
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

timeout 60 "$planner" --edges "$edges" --seed "${PCCD_SEED:-1}" | timeout 300 "$check" "$samples" >"$log" 2>&1
# If it failed, an edge would be free between its ends, and meet something on its way.
tap_result $? planner__calls_nothing_free_that_meets_something "$log"
[ -z "${PCCD_EDGES-}" ] || grep '^# ' "$log"

awk '/ free; / { free = $2; wasted = $8 } END { exit !(free > 0 && wasted <= free / 200) }' "$log"
# If it failed, planners would find no way where there is one.
tap_result $? planner__refuses_few_free_edges "$log"

for words in bogus --edges "--edges x" "--edges 0" "--seed 1 --eges 5"; do
    # shellcheck disable=SC2086 # words on purpose
    said=$(timeout 60 "$planner" $words 2>&1)
    [ $? -eq 2 ] && grep -q '^usage: ' <<<"$said" || echo "$words: $said"
done >"$log"
timeout 60 "$planner" --help | grep -q '^usage: ' || echo "--help: no usage" >>"$log"
[ ! -s "$log" ]
# If it failed, who mistypes an option would take the answer to another question.
tap_result $? planner__refuses_what_it_does_not_know "$log"

timeout 60 "$top_builddir/tests/planner/turns" >"$log" 2>&1
# If it failed, a body could turn through what is thin, by less than OMPL interpolates.
tap_result $? planner__proves_turns_in_its_spaces "$log"

line=$(sed -n 's/^    \(c++ .*\)/\1/p' "$top_srcdir/client/planner/README.md")
(cd "$top_srcdir/client/planner" && export PKG_CONFIG_PATH=$top_builddir${PKG_CONFIG_PATH:+:$PKG_CONFIG_PATH} &&
    eval "$line -o /dev/null") >"$log" 2>&1 && [ -n "$line" ]
# If it failed, who builds by hand would look for folders that this release of OMPL does not have.
tap_result $? planner__is_built_as_its_page_says "$log"

tap_end
