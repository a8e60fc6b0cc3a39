# check.sh - runs `pccdctl check` in a folder of its own; sourced by bash scripts, after tap.sh.
#
# $work is that folder, which goes at the end; $log is what the last command said.
#
#   check STATUS ARGUMENT...   whether it ends with that status; `out` and `err` have what it said

: "${PCCDCTL:?the program to test}" "${PCCD_DAEMON:?the daemon to start}"
unset PCCD_URL

work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-check-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 99
log=$work/log

check() {
    local status=$1 is=0
    shift
    timeout 100 "$PCCDCTL" check --private "$@" >out 2>err || is=$?
    cat out err >"$log"
    [ $is -eq "$status" ]
}
