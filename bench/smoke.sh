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
for program in census step parallel small rebuild kernels roofline wide ipc; do
    "$top_builddir/bench/$program" --smoke >"$log" 2>&1
    tap_result $? "bench_${program}__finds_equal_results" "$log"
done

# If this failed, results could not be kept and compared.
for program in census step parallel small rebuild kernels roofline wide ipc; do
    "$top_builddir/bench/$program" --smoke --json 2>/dev/null |
        awk '!/^[{]"program":".*"threads":[0-9]+[}]$/ { print; bad = 1 }
            END { exit bad || NR == 0 }' >"$log"
    tap_result $? "bench_${program}__prints_one_object_a_line" "$log"
done

tap_end
