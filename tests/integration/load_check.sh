#!/bin/bash
# load_check.sh - the load harness against real daemons, for seconds (TAP).
#
# Room:     tests/integration.
# Does:     many clients and many requests; clients killed at random; two runs that agree.
#           What takes minutes: make load, make soak (client/load/local.mk).

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT

# load NAME OPTION...: one run; its report is $work/NAME.
load() {
    local name=$1
    shift
    timeout 300 "$top_builddir/pccd-load" "$@" -- --threads 1 >"$work/$name" 2>&1
}

# If it failed, an answer would be lost, doubled, crossed or wrong under load, or the daemon
# would keep something of clients that are gone.
load crowd --clients 120 --requests 64 --processes 3 --depth 3
tap_result $? load__every_request_is_answered_once "$work/crowd"

# If it failed, a client that dies at the wrong moment would leave something behind, or harm
# the others.
load kills --clients 20 --requests 100 --processes 2 --kill-clients 300 --victims 12
tap_result $? load__killed_clients_leave_nothing "$work/kills"

# If it failed, a daemon that dies would take answers along, or its clients; or the next one
# would not hold the same.
load crashes --clients 20 --requests 100 --processes 2 --kill-worker 8 --kill-clients 40
tap_result $? load__killed_workers_lose_nothing "$work/crashes"

# If it failed, answers would depend on how many clients there are, or on luck.
load other --clients 120 --requests 16 --processes 1 --depth 1 &&
    grep '^checksum' "$work/crowd" >"$work/sum1" &&
    grep '^checksum' "$work/other" >"$work/sum2" &&
    cmp -s "$work/sum1" "$work/sum2"
tap_result $? load__two_runs_agree "$work/other"

tap_end
