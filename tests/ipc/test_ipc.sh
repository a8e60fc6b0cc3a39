#!/bin/bash
# test_ipc.sh - pccd_ipc.hpp beside ipc-toolkit, where configure was told of that (TAP).
#
# Room:     tests/ipc.
# Does:     run check.cc, whose cases are its own, and the example for a moment.

set -u -o pipefail
: "${top_srcdir:?is set by make check}" "${top_builddir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

if [ ! -x "$top_builddir/tests/ipc/check" ]; then
    why="configure was not told where ipc-toolkit is"
    for name in sets candidates steps recorded_scenes cloth; do
        tap_skip "ipc__$name" "$why"
    done
    tap_end
    exit
fi
log=$(mktemp) || exit 99
trap 'rm -f "$log"' EXIT

timeout 500 "$top_builddir/tests/ipc/check" >"$log" 2>&1
status=$?
while read -r line; do
    case $line in
    ok*'# SKIP'*) name=${line#*- } && tap_skip "${name%% *}" "${line#*# SKIP }" ;;
    ok*) tap_result 0 "${line#*- }" "$log" ;;
    'not ok'*) tap_result 1 "${line#*- }" "$log" ;;
    esac
done <"$log"
# If it failed, it would have ended before its last case.
grep -q '^1\.\.' "$log" && [ $status -le 1 ]
tap_result $? ipc__all_cases_were_tried "$log"

# If it failed, who begins with the example would begin with an error, or with forces and
# steps that are not those of ipc-toolkit.
timeout 120 "$top_builddir/client/ipc/cloth" --smoke >"$log" 2>&1 && grep -q 'nothing intersects' "$log"
tap_result $? ipc__cloth_comes_to_rest_on_the_ball "$log"
tap_end
