#!/bin/bash
# unit_check.sh - the systemd units (TAP).
#
# Room:     tests/integration.
# Does:     have systemd-analyze judge them; hold the service's filter of system calls against
#           what the daemon's own sandbox leaves; serve on a socket that systemd's tool hands
#           over. What is missing here is skipped, by name.

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCDD:?}" "${PCCDCTL:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
export LC_ALL=C SYSTEMD_COLORS=0 SYSTEMD_PAGER=cat

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
units=$top_builddir/daemon/systemd
exposure_max=0.6

have() { command -v "$1" >/dev/null 2>&1; }

# If it failed, a fault in the daemon would reach further than it must.
exposure() {
    systemd-analyze security --offline=true --no-pager "$units/pccdd.service" >"$work/log" 2>&1
    local found
    found=$(sed -n 's/.*Overall exposure level[^:]*: \([0-9.]*\).*/\1/p' "$work/log")
    echo "exposure: ${found:-none}, at most $exposure_max" >>"$work/log"
    awk -v found="${found:-10}" -v max=$exposure_max 'BEGIN { exit !(found <= max) }'
}
name=unit__exposure_is_small
if ! have systemd-analyze; then
    tap_skip $name "no systemd-analyze"
elif ! systemd-analyze security --help 2>&1 | grep -q -e --offline; then
    tap_skip $name "systemd-analyze has no --offline"
else
    exposure
    tap_result $? $name "$work/log"
fi

# If it failed, systemd would not load what make install has put there. The program is the one
# that was built: nothing is installed here.
name=unit__is_understood
if have systemd-analyze; then
    mkdir "$work/units"
    cp "$units/pccdd.socket" "$work/units/"
    sed "s|^ExecStart=[^ ]*|ExecStart=$PCCDD|" "$units/pccdd.service" >"$work/units/pccdd.service"
    SYSTEMD_UNIT_PATH="$work/units:" systemd-analyze verify --man=no "$work/units/pccdd.service" \
        >"$work/log" 2>&1
    ! grep 'pccdd\.\(service\|socket\)' "$work/log" >"$work/found"
    tap_result $? $name "$work/log"
else
    tap_skip $name "no systemd-analyze"
fi

# The system calls of a group, and of the groups in it.
members() {
    local call
    while read -r call; do
        case $call in
        @*) members "$call" ;;
        *) echo "$call" ;;
        esac
    done < <(systemd-analyze syscall-filter "$1" | sed -n 's/^    \([-@a-z_0-9]*\)$/\1/p')
}

# Those that the unit leaves: systemd adds and takes away line by line.
unit_calls() {
    local line word
    : >"$work/calls"
    while read -r line; do
        for word in ${line#\~}; do
            case $word in
            @*) members "$word" ;;
            *) echo "$word" ;;
            esac
        done | sort -u >"$work/some"
        case $line in
        \~*) comm -23 "$work/calls" "$work/some" >"$work/next" ;;
        *) sort -u "$work/calls" "$work/some" >"$work/next" ;;
        esac
        mv "$work/next" "$work/calls"
    done < <(sed -n 's/^SystemCallFilter=//p' "$units/pccdd.service")
    cat "$work/calls"
}

# If it failed, a call that serving needs would fail under systemd, and only there; or the
# daemon could not enter its sandbox.
name=unit__leaves_the_calls_that_serving_needs
if have systemd-analyze; then
    unit_calls >"$work/left"
    {
        sed -n 's/.*SCMP_SYS(\([a-z0-9_]*\)).*/\1/p' "$top_srcdir/daemon/server/sandbox.c"
        printf '%s\n' seccomp execve openat prlimit64 pipe2 eventfd2 epoll_create1 umask clone3
    } | sort -u >"$work/needed"
    comm -23 "$work/needed" "$work/left" >"$work/log"
    [ -s "$work/needed" ] && [ -s "$work/left" ] && [ ! -s "$work/log" ]
    tap_result $? $name "$work/log"
else
    tap_skip $name "no systemd-analyze"
fi

# If it failed, a service that systemd starts for its first client would not serve it.
activated() {
    systemd-socket-activate --seqpacket -l "$work/pccd.sock" "$PCCDD" --threads 1 \
        >"$work/log" 2>&1 &
    local pid=$! rc=1 i
    for i in $(seq 100); do
        [ -S "$work/pccd.sock" ] && break
        sleep 0.1
    done
    PCCD_URL=unix:$work/pccd.sock timeout 60 "$PCCDCTL" ping >>"$work/log" 2>&1 && rc=0
    kill "$pid"
    wait "$pid" || rc=1
    [ -S "$work/pccd.sock" ] || rc=1 # it is systemd's, and stays
    return $rc
}
name=unit__socket_of_systemd_is_served
if have systemd-socket-activate; then
    activated
    tap_result $? $name "$work/log"
else
    tap_skip $name "no systemd-socket-activate"
fi

tap_end
