#!/bin/bash
# unit_check.sh - the systemd units (TAP).

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCDD:?}" "${PCCDCTL:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
export LC_ALL=C SYSTEMD_COLORS=0 SYSTEMD_PAGER=cat

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
units=$top_builddir/daemon/systemd
# Of the system's service. That of a user can give up only what needs no privilege: as many
# services of users do, it has no file system of its own.
exposure_max=0.6
user_exposure_max=6.0

have() { command -v "$1" >/dev/null 2>&1; }

# exposure SERVICE MAX
exposure() {
    systemd-analyze security --offline=true --no-pager "$1" >"$work/log" 2>&1
    local found
    found=$(sed -n 's/.*Overall exposure level[^:]*: \([0-9.]*\).*/\1/p' "$work/log")
    echo "exposure: ${found:-none}, at most $2" >>"$work/log"
    awk -v found="${found:-10}" -v max="$2" 'BEGIN { exit !(found <= max) }'
}
# If it failed, a fault in the daemon would reach further than it must.
check_exposure() {
    local name=$1
    if ! have systemd-analyze; then
        tap_skip "$name" "no systemd-analyze"
    elif ! systemd-analyze security --help 2>&1 | grep -q -e --offline; then
        tap_skip "$name" "systemd-analyze has no --offline"
    else
        exposure "$2" "$3"
        tap_result $? "$name" "$work/log"
    fi
}
check_exposure unit__exposure_is_small "$units/pccdd.service" $exposure_max
check_exposure unit__of_a_user_gives_up_what_it_can "$units/user/pccdd.service" $user_exposure_max

# If it failed, systemd would not load what make install has put there. The program is the one
# that was built: nothing is installed here.
check_understood() {
    local name=$1 folder=$2
    shift 2
    if ! have systemd-analyze; then
        tap_skip "$name" "no systemd-analyze"
        return
    fi
    rm -rf "$work/units" && mkdir "$work/units"
    cp "$folder/pccdd.socket" "$work/units/"
    sed "s|^ExecStart=[^ ]*|ExecStart=$PCCDD|" "$folder/pccdd.service" \
        >"$work/units/pccdd.service"
    SYSTEMD_UNIT_PATH="$work/units:" systemd-analyze "$@" verify --man=no \
        "$work/units/pccdd.service" "$work/units/pccdd.socket" >"$work/log" 2>&1
    ! grep 'pccdd\.\(service\|socket\)' "$work/log" >"$work/found"
    tap_result $? "$name" "$work/log"
}
check_understood unit__is_understood "$units"
check_understood unit__of_a_user_is_understood "$units/user" --user

# If it failed, clients would look for the user's service elsewhere, and start daemons of
# their own beside it.
name=unit__of_a_user_listens_where_clients_look
{
    grep -n '^ListenSequentialPacket=' "$units/user/pccdd.socket"
    sed -n '/--socket/,/^$/p' "$top_srcdir/client/man/pccdd.8.scd"
} >"$work/log"
grep -q '^[0-9]*:ListenSequentialPacket=%t/pccd/pccd\.sock$' "$work/log" &&
    grep -q 'XDG_RUNTIME_DIR/pccd/pccd\.sock' "$work/log"
tap_result $? "$name" "$work/log"

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

# Those that the unit in file $1 leaves: systemd adds and takes away line by line.
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
    done < <(sed -n 's/^SystemCallFilter=//p' "$1")
    cat "$work/calls"
}

# If it failed, a call that serving needs would fail under systemd, and only there; or the
# daemon could not enter its sandbox.
check_calls() {
    local name=$1
    if ! have systemd-analyze; then
        tap_skip "$name" "no systemd-analyze"
        return
    fi
    unit_calls "$2" >"$work/left"
    {
        sed -n 's/^ *X(\([a-z0-9_]*\)).*/\1/p' "$top_srcdir/daemon/server/sandbox_calls.h"
        sed -n 's/.*SCMP_SYS(\([a-z0-9_]*\)).*/\1/p' "$top_srcdir/daemon/server/sandbox.c" |
            grep -vx 'call\|io_uring_setup' # the name in the loop over that list; the forbidden one
        printf '%s\n' seccomp execve openat prlimit64 pipe2 eventfd2 epoll_create1 umask clone3 \
            socket inotify_init1 landlock_create_ruleset landlock_add_rule landlock_restrict_self
    } | sort -u >"$work/needed"
    comm -23 "$work/needed" "$work/left" >"$work/log"
    [ -s "$work/needed" ] && [ -s "$work/left" ] && [ ! -s "$work/log" ]
    tap_result $? "$name" "$work/log"
}
check_calls unit__leaves_the_calls_that_serving_needs "$units/pccdd.service"
check_calls unit__of_a_user_leaves_the_calls_that_serving_needs "$units/user/pccdd.service"

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
