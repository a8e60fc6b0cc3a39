# ctl.sh - runs pccdctl in a folder of its own; sourced by bash scripts of TAP.
#
# $work is that folder, which goes at the end, as the processes in $pids do. out and err in it have
# what the last `ctl` has said; `report` shows them after $log.
#
#   ctl ARGUMENT...                whether it succeeds; 100 s at most
#   ends STATUS TEXT ARGUMENT...   whether it ends so, with TEXT in err: 2 is wrong usage, 3 no
#                                  daemon, 4 any other error
#   fails STATUS TEXT ARGUMENT...  the same, with nothing in out
#   check STATUS ARGUMENT...       pccdctl check --private ends so
#   says PATTERN...                whether each is in a line of out
#   json_value KEY                 of the JSON object in out
#   frame HEIGHT                   an OBJ file of a triangle whose corner is so high above another
#   start_daemon NAME OPTION...    on the socket $work/NAME; $daemon is its process
#   report NAME                    a case, by the status of the command before

: "${PCCDCTL:?the program to test}" "${PCCD_DAEMON:?the daemon to start}"
# shellcheck source=tests/support/tap.sh
. "${BASH_SOURCE[0]%/*}/tap.sh"
unset PCCD_URL PCCD_RECORD PCCD_RECORD_OPTIONS

work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-ctl-XXXXXX") || exit 99
pids=
finish() {
    # shellcheck disable=SC2086 # words
    [ -z "$pids" ] || kill $pids 2>/dev/null
    rm -rf "$work"
}
trap finish EXIT
cd "$work" || exit 99
log=$work/log

ctl() { timeout 100 "$PCCDCTL" "$@" >out 2>err; }

ends() {
    local status=$1 text=$2
    shift 2
    ctl "$@"
    [ $? -eq "$status" ] && grep -qF -- "$text" err
}

fails() { ends "$@" && [ ! -s out ]; }

check() {
    local status=$1
    shift
    ctl check --private "$@"
    [ $? -eq "$status" ]
}

says() {
    local text
    for text; do
        grep -qE -- "$text" out || { echo "no line like: $text"; return 1; }
    done >"$log"
}

# jansson prints one member a line.
json_value() { sed -n "s/^ *\"$1\": \(.*[^,]\),\{0,1\}\$/\1/p" out | head -n 1; }

frame() {
    printf 'v %s\n' '0 0 0' '1 0 0' '0 1 0' "0.25 0.25 $1" "0.75 0.25 $((3 + $1))" \
        "0.25 0.75 $((3 + $1))"
    printf 'f 1 2 3\nf 4 5 6\n'
}

start_daemon() {
    local name=$1
    shift
    rm -f "$name.ready"
    mkfifo "$name.ready"
    "$PCCD_DAEMON" --socket "$work/$name" --log-level error --ready-fd 3 "$@" \
        3>"$name.ready" 2>"$name.log" &
    daemon=$!
    pids="$pids $daemon"
    read -r -t 20 -N 1 _ <"$name.ready"
}

report() {
    local status=$?
    [ "$status" -eq 0 ] || cat "$log" out err >shown 2>/dev/null
    tap_result "$status" "$1" shown
    : >"$log"
}
