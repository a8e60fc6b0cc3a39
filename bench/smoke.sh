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

parts='kernel roofline
pair exact
pair distances
client batch
client connect
client death
client ipc
client late'

# If this failed, what is measured and what it is compared with would differ in their
# results, or it would not run at all.
while read -r section part; do
    "$top_builddir/bench/pccd-bench" "$section" "$part" --smoke >"$log" 2>&1
    tap_result $? "bench_${part}__finds_equal_results" "$log"
done <<<"$parts"

# If this failed, a table would compare different answers, or a row would not run.
"$top_srcdir/bench/tables.sh" --smoke >"$log" 2>&1 &&
    [ "$(grep -c '^[a-z]*: ' "$log")" -ge 15 ] && [ "$(grep -c '^the first ' "$log")" -ge 15 ]
tap_result $? bench_tables__have_equal_answers_in_every_row "$log"

# If this failed, what it costs to ask could not be compared with what it costs to ask Redis.
if command -v redis-server >/dev/null; then
    "$top_builddir/bench/pccd-bench" client ipc --smoke trips >"$log" 2>&1 &&
        [ "$(grep -c 'PING, two' "$log")" -ge 4 ]
    tap_result $? bench_beside_redis__finds_equal_results "$log"
else
    tap_skip bench_beside_redis__finds_equal_results "redis-server is not installed"
fi

# If this failed, results could not be kept and compared.
while read -r section part; do
    "$top_builddir/bench/pccd-bench" "$section" "$part" --smoke --json 2>/dev/null |
        awk -v part="$part" '
            part == "ipc" && /^[{]"row":".*"turns":[0-9]+[}]$/ { next }
            part != "ipc" && /^[{]"program":".*"threads":[0-9]+[}]$/ { next }
            { print; bad = 1 }
            END { exit bad || NR == 0 }' >"$log"
    tap_result $? "bench_${part}__prints_one_object_a_line" "$log"
done <<<"$parts"

tap_end
