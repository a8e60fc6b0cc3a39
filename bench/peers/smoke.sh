#!/bin/bash
# smoke.sh - the other libraries still build, run, and find one set of pairs (TAP).
#
# With tiny scenes; the times mean nothing here.

set -u -o pipefail
: "${top_srcdir:?is set by make check}" "${top_builddir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

peers=$top_builddir/bench/peers/peers
if [ ! -x "$peers" ]; then
    tap_skip bench_peers__find_one_set_of_pairs "configure has found no other library"
    tap_end
    exit
fi
log=$(mktemp) || exit 99
trap 'rm -f "$log"' EXIT

# If this failed, the libraries would be timed on different work, or not run at all.
"$peers" --smoke >"$log" 2>&1
tap_result $? bench_peers__find_one_set_of_pairs "$log"

tap_end
