#!/bin/bash
# smoke.sh - every measurement still builds, runs, and finds equal results (TAP).
#
# With tiny scenes and a few repeats; the times mean nothing here.

set -u -o pipefail
: "${top_srcdir:?is set by make check}" "${top_builddir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

log=$(mktemp) || exit 99
trap 'rm -f "$log"' EXIT

# If this failed, a measured program and what it is compared with would differ in their
# results, or the program would not run at all.
for program in batch distances exact slowest kernels roofline ipc connect thickness thin; do
    "$top_builddir/bench/$program" --smoke >"$log" 2>&1
    tap_result $? "bench_${program}__finds_equal_results" "$log"
done

# If this failed, a table would compare different answers, or a row would not run.
"$top_srcdir/bench/tables.sh" --smoke >"$log" 2>&1 &&
    [ "$(grep -c '^[a-z]*: ' "$log")" -ge 15 ] && [ "$(grep -c '^the first ' "$log")" -ge 15 ]
tap_result $? bench_tables__have_equal_answers_in_every_row "$log"

# If this failed, what it costs to ask could not be compared with what it costs to ask Redis.
"$top_builddir/bench/redis/beside_redis" --smoke >"$log" 2>&1
case $? in
    77) tap_skip bench_beside_redis__finds_equal_results "redis-server is not installed" ;;
    0) tap_result 0 bench_beside_redis__finds_equal_results "$log" ;;
    *) tap_result 1 bench_beside_redis__finds_equal_results "$log" ;;
esac

# If this failed, results could not be kept and compared.
for program in batch distances exact slowest kernels roofline ipc connect thickness thin; do
    "$top_builddir/bench/$program" --smoke --json 2>/dev/null |
        awk '!/^[{]"program":".*"threads":[0-9]+[}]$/ { print; bad = 1 }
            END { exit bad || NR == 0 }' >"$log"
    tap_result $? "bench_${program}__prints_one_object_a_line" "$log"
done

tap_end
