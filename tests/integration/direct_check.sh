#!/bin/bash
# direct_check.sh - what works with a daemon works without one: programs of tests, pccdctl.
#
# With PCCD_TEST_URL=direct: these programs need no daemon. Not those whose subject it is:
# its sockets and users, its quotas and options, its death and return, the sandbox, and
# other clients of it while a step is computed.

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCDCTL:?}" "${PCCD_DATA?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT

# If this failed, a program that asks a daemon would find that direct: answers otherwise.
for program in step brief reply flow choice deadline watch replace slot record_filter record_shared observe shared verify warm misuse contract near thick free protocol; do
    PCCD_TEST_URL=direct: timeout 600 "$top_builddir/tests/integration/test_int_$program" \
        >"$work/out" 2>&1
    status=$?
    # A sanitizer owns malloc: what counts its calls has nothing to say.
    if [ "$status" -eq 0 ] && ! grep -q '^ok ' "$work/out" &&
        grep -q -- -DPCCD_SANITIZED "$top_builddir/Makefile"; then
        tap_skip "direct__test_int_${program}_passes" "skips all under a sanitizer"
        continue
    fi
    [ "$status" -ne 0 ] || grep -q '^ok 1 ' "$work/out" || status=1
    # cmocka says "not ok 3 # SKIP name" of a case that was skipped.
    grep -v '^not ok [0-9]* # SKIP' "$work/out" >"$work/log"
    tap_result "$status" "direct__test_int_${program}_passes" "$work/log"
done

# hash_of URL COMMAND...: of the answers that pccdctl tells of.
hash_of() {
    local url=$1
    shift
    timeout 300 "$PCCDCTL" "$@" $url 2>>"$work/log" | awk '$1 == "hash" { print $2 }'
}

# same_hash NAME COMMAND...: by a private daemon and by direct:.
same_hash() {
    local name=$1 there here
    shift
    : >"$work/log"
    there=$(hash_of '--private' "$@")
    here=$(hash_of '--url=direct:' "$@")
    printf 'daemon: %s\ndirect: %s\n' "$there" "$here" >>"$work/log"
    [ -n "$there" ] && [ "$there" = "$here" ]
    tap_result $? "$name" "$work/log"
}

# If this failed, pccdctl would need a daemon, or compute something else without one.
same_hash direct__demo_has_the_daemons_hash demo --steps=30 --output="$work/demo.png"
same_recorded() { # NAME FRAME FRAME
    if [ -e "$PCCD_DATA/$2" ] && [ -e "$PCCD_DATA/$3" ]; then
        same_hash "direct__$1_has_the_daemons_hash" check "$PCCD_DATA/$2" "$PCCD_DATA/$3"
    else
        tap_skip "direct__$1_has_the_daemons_hash" "no frames in \$PCCD_DATA"
    fi
}
same_recorded cloth_funnel cloth-funnel/frames/22{7,8}.ply
same_recorded cloth_ball cloth-ball/frames/cloth_ball9{2,3}.ply
same_recorded n_body n-body-simulation/frames/balls16_1{8,9}.ply

# If this failed, a user would not know what to install.
PCCD_DIRECT=/nonexistent timeout 60 "$PCCDCTL" ping --url=direct: >"$work/out" 2>"$work/log"
[ $? -ne 0 ] && [ ! -s "$work/out" ] && grep -q 'PCCD_DIRECT=/nonexistent' "$work/log"
tap_result $? direct__missing_library_is_said_by_pccdctl "$work/log"

# If this failed, --private would not start a daemon although the command line asks for one.
is_direct() { # OPTION...: whether the process that asks is the one that answers
    PCCD_URL=direct: timeout 60 bash -c 'echo $$ && exec "$0" ping -c 1 --json "$@"' "$PCCDCTL" \
        "$@" >"$work/out" 2>"$work/log" || return 2
    grep -q "\"pid\": $(head -n 1 "$work/out")," "$work/out"
}
is_direct && { is_direct --private; [ $? -eq 1 ]; }
tap_result $? direct__gives_way_to_an_option "$work/log"

tap_end
