#!/bin/bash
# tests/integration/ctl_operate.sh - the daemon as an operator runs it: its configuration file, its
# log, metrics over HTTP, drain (TAP).

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}"
# shellcheck source=tests/support/ctl.sh
. "$top_srcdir/tests/support/ctl.sh"

frame 1 >a.obj
frame -1 >b.obj

# soon COMMAND...: whether it succeeds within ten seconds.
soon() {
    local i
    for i in $(seq 100); do
        "$@" && return 0
        sleep 0.1
    done
    return 1
}

# setting NAME VALUE: whether the daemon has it so.
setting() { ctl config get "$1" && says "^$2\$"; }

# refused TEXT LINE...: whether a daemon does not start with such a file, and says TEXT.
refused() {
    local text=$1
    shift
    printf '%s\n' "$@" >bad.conf
    timeout 20 "$PCCD_DAEMON" --socket "$work/bad" --config bad.conf >out 2>err
    [ $? -eq 64 ] && grep -qF -- "$text" err
}

# If it failed, a file with a mistake would be half taken, or nobody would learn in which line.
refused 'bad.conf:2: the line is not NAME = VALUE' '# one' 'threads 2' &&
    refused 'bad.conf:1: threds: there is no such setting' 'threds = 2' &&
    refused 'bad.conf:3: --threads: "many" is not a whole number from 1 to 1024' '' '' 'threads = many' &&
    refused 'bad.conf:1: --log-level: "loud" is none of' 'log-level = loud' &&
    refused 'bad.conf:1: supervise: yes or no is wanted' 'supervise = perhaps' &&
    refused 'bad.conf:1: ready-fd: this is for the command line' 'ready-fd = 3' &&
    refused 'bad.conf:1: the line has no value' 'threads =' &&
    refused 'bad.conf:1: the line is too long' "socket = $(printf '%400s' x)" &&
    rm bad.conf && timeout 20 "$PCCD_DAEMON" --config bad.conf >out 2>err
[ $? -eq 64 ] && grep -q 'bad.conf: No such file' err &&
    mkfifo pipe.conf && { timeout 5 "$PCCD_DAEMON" --config pipe.conf >out 2>err; [ $? -eq 64 ]; } &&
    grep -q 'pipe.conf: a pipe cannot be read again' err &&
    { timeout 5 "$PCCD_DAEMON" --socket "$work/bad" --log-file pipe.conf >out 2>err; [ $? -eq 1 ]; } &&
    grep -q 'pipe.conf: Operation not supported' err
report config_file__mistakes_are_named

# Each of these daemons is in its sandbox where the machine has one.
# If it failed, the file would not be read, or win over the command line.
printf '%s\n' '# an operator' 'threads = 1' ' grace=77 ' 'scenes-max = 10' 'log-level = info' >it.conf
start_daemon s --config it.conf --scenes-max 20 --log-file it.log
export PCCD_URL="unix:$work/s"
setting threads 1 && setting grace 77 && setting scenes-max 20 && setting log-level error
report config_file__is_taken_before_the_command_line

# If it failed, a change would need a restart, one with a mistake would be taken in part or unsaid, or
# one that cannot hold at once would be said to.
ctl config set log-level info && ctl config set linger 9 &&
    printf '%s\n' 'threads = 1' 'grace=78' 'queue-max = none' 'linger = 11' 'pin = off' 'threds = 2' \
        'pin = some' 'supervise = 1' 'crashes-max = 0' 'ready-fd = 3' >it.conf &&
    kill -HUP "$daemon" && soon grep -q 'scenes-max = 10: no longer in it.conf' it.log && setting grace 78 &&
    setting linger 11 && setting queue-max 32768 && setting scenes-max 20 &&
    grep -q 'it.conf:3: queue-max: "none" is not a whole number; it stays as it was' it.log &&
    grep -q 'it.conf:5: pin: this holds after a restart' it.log &&
    grep -q 'it.conf:6: threds: there is no such setting; pccdd does not start with that' it.log &&
    grep -q 'it.conf:7: pin: there is no such value;' it.log &&
    grep -q 'it.conf:8: supervise: yes or no is wanted;' it.log &&
    grep -q 'it.conf:9: crashes-max: there is no such value;' it.log &&
    grep -q 'it.conf:10: ready-fd: this is for the command line;' it.log &&
    ! grep -q 'threads: 1, by' it.log && ctl config set grace 5 && : >it.log &&
    kill -HUP "$daemon" && soon grep -q 'it.conf:10: ready-fd: this is for' it.log && # once more
    [ "$(wc -l <it.log)" -eq 6 ] && ! grep -q 'grace\|pin: this' it.log && setting grace 5 && # which the file says as before
    echo 'grace' >it.conf && kill -HUP "$daemon" && soon grep -q 'it.conf:1: the line is not NAME' it.log &&
    rm it.conf && kill -HUP "$daemon" && soon grep -q 'it.conf: No such file.*all stays' it.log &&
    setting grace 5 && ctl check a.obj b.obj
[ $? -eq 1 ]
report config_file__is_read_again_on_sighup

# If it failed, a pipe in place of a file would stop the daemon, or SIGHUP would have the first of
# several words on a setting hold, or a user who may no longer be a client would go without a word.
mkfifo it.conf && kill -HUP "$daemon" && soon grep -q 'it.conf: a pipe cannot be read again; all stays' it.log &&
    rm it.conf && printf '%s\n' 'grace = 31' 'grace = 32' 'allow-uid = 0' 'allow-uid = 12345' >it.conf &&
    kill -HUP "$daemon" && soon grep -q 'it.conf:4: allow-uid: this holds' it.log && setting grace 32 &&
    ! grep -q 'grace: 31' it.log && : >it.log &&
    printf '%s\n' 'grace = 31' 'grace = 32' 'allow-uid = 0' 'linger = 12' >it.conf &&
    kill -HUP "$daemon" && soon grep -q 'allow-uid = 12345: no longer in it.conf' it.log &&
    setting linger 12 && setting grace 32 && [ "$(grep -c 'grace\|allow-uid' it.log)" -eq 1 ]
report config_file__says_several_things_of_one_option

# If it failed, what renames old logs would have the daemon write to a file that nobody looks at.
rm it.conf && mv it.log old.log && lines=$(wc -l <old.log) && kill -HUP "$daemon" && soon test -s it.log &&
    ctl config set grace 6 && soon grep -q 'grace: 6, was 32' it.log && [ "$(wc -l <old.log)" = "$lines" ] &&
    [ "$(stat -c %a it.log old.log | sort -u)" = 600 ] && mv it.log old.log && mkfifo it.log &&
    kill -HUP "$daemon" && soon grep -q 'it.log: Operation not supported; messages go where they went' old.log &&
    ctl config set grace 7
report log_file__is_opened_anew_on_sighup
kill "$daemon"
wait "$daemon" 2>/dev/null

# If it failed, SIGHUP while the daemon starts, after it has read the file, would be lost.
echo 'grace = 41' >it.conf
rm -f s.lock
"$PCCD_DAEMON" --socket "$work/s" --threads 1 --config it.conf --log-level error 2>s.log &
daemon=$!
pids="$pids $daemon"
soon eval 'until [ -e s.lock ]; do :; done' && echo 'grace = 42' >it.conf && kill -HUP "$daemon" &&
    soon setting grace 42
report config_file__is_read_again_on_sighup_at_start
kill "$daemon"
wait "$daemon" 2>/dev/null

# If it failed, a worker that comes after a crash would have neither the file's change nor the log, or
# none would come as the file has become wrong.
printf '%s\n' 'grace = 7' 'supervise = yes' 'threads = 1' >it.conf
start_daemon s --config it.conf --log-file sup.log --log-level debug
ctl version --json && worker=$(json_value pid) && [ "$worker" != "$daemon" ] &&
    printf '%s\n' 'grace = 8' 'supervise = yes' 'threads = 1' >it.conf && mv sup.log sup.old &&
    kill -HUP "$daemon" && soon grep -q 'grace: 8, by the configuration file' sup.log &&
    soon grep -q 'stands by' sup.log && kill -KILL "$worker" &&
    soon setting grace 8 && soon grep -q 'was ended by signal 9' sup.log &&
    grep -q 'listens on' sup.log &&
    echo 'threads = many' >it.conf && ctl version --json && worker=$(json_value pid) &&
    kill -KILL "$worker" && soon eval "! kill -0 $worker 2>/dev/null" && soon setting grace 8
report config_file__outlives_a_crash_of_the_worker
kill "$daemon"
wait "$daemon" 2>/dev/null

# If it failed, what collects logs would stumble over a line, as a client's name may hold anything.
start_daemon s --threads 1 --log-level debug --log-format json
doomed=$daemon
"$PCCDCTL" load --scene 'a "quoted\" name' --times 2 --hz 100 a.obj b.obj >out 2>err &&
    fails 4 'there is no setting "quo' config get 'quo"te\' && # and what a crash says
    kill -ABRT "$doomed" && ! wait "$doomed" 2>/dev/null && python3 - s.log >"$log" 2>&1 <<'EOF' && [ ! -s "$log" ]
import json, sys
lines = [json.loads(line) for line in open(sys.argv[1])]
if len(lines) < 4:
    print("too few lines")
for line in lines:
    if not set(line) <= {"time", "level", "session", "message"} or line["level"] not in ("info", "debug", "error"):
        print(line)
if not any(line["message"].endswith('there is no setting "quo"te\\"') and line["session"] > 0 for line in lines):
    print("no such message", lines)
said = [line["message"] for line in lines if line["level"] == "error"]
if not ("SIGABRT in process" in said[0] and len(said) > 3 and any("pccdd(" in text for text in said[1:])):
    print("no report of the crash", said)
EOF
if command -v python3 >/dev/null; then
    report log_format__json_is_an_object_a_line
else
    tap_skip log_format__json_is_an_object_a_line "it takes python3"
fi

# If it failed, a full disk would take lines of the log, and nobody would learn of it.
ln -s /dev/full full.log
start_daemon full --threads 1 --log-level info --log-file full.log
PCCD_URL="unix:$work/full" ctl stats --json && lost=$(json_value log_lines_lost) && [ "$lost" -gt 0 ] &&
    PCCD_URL="unix:$work/full" ctl status && says 'of the log could not be written: is there room' &&
    ln -sf there.log full.log && kill -HUP "$daemon" &&
    PCCD_URL="unix:$work/full" ctl config set grace 9 && soon grep -q 'grace: 9' there.log &&
    [ "$(grep -c ' lines could not be written here: No space left on device$' there.log)" -eq 1 ]
report log_file__tells_of_lines_that_a_full_disk_has_taken
kill "$daemon"
wait "$daemon" 2>/dev/null
start_daemon s --threads 1

# ---- metrics over HTTP ---------------------------------------------------------------

# get URL: what the server says, to out, and its status to status.
get() {
    python3 - "$work/http" "$1" "${2:-GET}" >out 2>err <<'EOF'
import http.client, socket, sys
connection = http.client.HTTPConnection("pccd")
connection.sock = socket.socket(socket.AF_UNIX)
connection.sock.connect(sys.argv[1])
connection.request(sys.argv[3], sys.argv[2])
answer = connection.getresponse()
open("status", "w").write("%d %s %s" % (answer.status, answer.getheader("Content-Type"), answer.getheader("Allow")))
sys.stdout.write(answer.read().decode())
EOF
}
status_is() { grep -q "^$1 text/plain; version=0.0.4" status; }
# crowd: whether each of 50 who ask at the same time is answered, beside 150 who say nothing.
crowd() {
    python3 - "$work/http" >out 2>err <<'EOF'
import socket, sys
sockets = [socket.socket(socket.AF_UNIX) for i in range(200)]
for each in sockets:
    each.settimeout(20)
    each.connect(sys.argv[1])
for each in sockets[150:]:
    each.sendall(b"GET /metrics HTTP/1.1\r\nHost: pccd\r\nConnection: close\r\n\r\n")
for each in sockets[150:]:
    answer = b"".join(iter(lambda: each.recv(65536), b""))
    assert answer.startswith(b"HTTP/1.1 200 ") and b"\npccd_steps_total " in answer, answer[:200]
EOF
}
names=(metrics__are_answered_over_http metrics__of_users_are_told_apart
    metrics__of_a_daemon_that_hangs_keep_no_other_waiting)
if ! command -v python3 >/dev/null; then
    for name in "${names[@]}"; do tap_skip "$name" "it takes python3"; done
# Where it can serve, this path is refused at once.
elif fails 4 'without libmicrohttpd' metrics --listen none/http; then
    for name in "${names[@]}"; do tap_skip "$name" "it takes libmicrohttpd"; done
else
    "$PCCDCTL" metrics --listen http 2>http.log &
    server=$!
    pids="$pids $server"
    # If it failed, a monitor would see a daemon that is gone as well, or not see one that is back.
    soon test -S http && get /metrics && status_is 200 && says '^pccd_steps_total [0-9]+$' &&
        [ "$(tail -c 1 out | od -An -c)" = '  \n' ] && get /health && status_is 200 && says '^ok$' &&
        get / && status_is 404 && get /metrics POST && status_is 405 &&
        grep -q ' GET, HEAD$' status && crowd && get /metrics HEAD && status_is 200 &&
        [ ! -s out ] && fails 4 'cannot listen at http: Address already in use' metrics --listen http &&
        fails 4 'cannot listen at s: Address already in use' metrics --listen s && [ -S s ] && # the daemon's
        kill "$daemon" && { wait "$daemon" 2>/dev/null; get /health; } && status_is 503 && says 'no answer' &&
        get /metrics && status_is 503 && start_daemon s --threads 1 && get /health && status_is 200
    report "${names[0]}"
    # If it failed, a monitor that asks a daemon that hangs would keep all others waiting.
    mkdir slow
    kill -STOP "$daemon"
    { cd slow && get /health; } &
    waiting=$!
    asks() { [ "$(ls -l "/proc/$server/fd" | grep -c socket:)" -ge 3 ]; } # listens, is asked, asks
    soon asks && get / && status_is 404 &&
        kill -0 "$waiting" && kill -CONT "$daemon" && wait "$waiting" && grep -q '^200 ' slow/status
    report "${names[2]}"
    # If it failed, an operator could not see whose work fills the machine.
    "$PCCDCTL" load --hz 50 --seconds 60 a.obj b.obj >/dev/null 2>&1 &
    player=$!
    pids="$pids $player"
    user=$(id -u)
    has_steps() { get /metrics && says "^pccd_user_steps\{user=\"$user\"\} [1-9]"; }
    soon has_steps && says "^pccd_user_sessions\{user=\"$user\"\} 2$" \
        "^pccd_user_step_seconds\{user=\"$user\"\} 0\.0*[1-9]" '^# TYPE pccd_user_steps gauge$' &&
        kill -KILL "$server" && { wait "$server" 2>/dev/null; [ -S http ]; } && # a socket of nobody
        { "$PCCDCTL" metrics --listen http 2>http.log & server=$!; pids="$pids $server"; } &&
        soon get /health && status_is 200 && kill "$server" && wait "$server" && [ ! -e http ]
    report "${names[1]}"
    kill "$player"
    wait "$player" 2>/dev/null
fi

# ---- drain ---------------------------------------------------------------------------

# If it failed, a daemon could not be replaced without ending the work of its clients, or a new one
# would not be found, or the old one would stay for ever.
mkfifo hold
"$PCCDCTL" load --hz 100 --seconds 60 a.obj b.obj >/dev/null 2>&1 &
player=$!
pids="$pids $player"
old=$daemon
old_serves() { ctl list && grep -q " $player " out; }
soon old_serves && ctl drain --wait 0.3
[ $? -eq 1 ] && says '^/.*/s is given up; the daemon has 1 client, and ends with the last$' '^still serving' &&
    kill -0 "$old" && start_daemon s --threads 1 && ctl version --json &&
    [ "$(json_value pid)" = "$daemon" ] && kill -0 "$player" &&
    kill "$player" && { wait "$player" 2>/dev/null; soon eval "! kill -0 $old 2>/dev/null"; } &&
    ctl drain --wait 10 && says '^ended$' && ends 3 'no connection' drain
report drain__serves_who_is_there_and_ends
start_daemon s --threads 1 --supervise
ctl drain --wait 10 --json && [ "$(json_value clients) $(json_value ended)" = '0 true' ] && ! kill -0 "$daemon" 2>/dev/null
report drain__ends_a_supervisor_too

# If it failed, a daemon that begins while the one before it is asked would lose its path. The
# first one is stopped when drain has connected to it and waits for its answer.
start_daemon s --threads 1
old=$daemon
kill -STOP "$old"
"$PCCDCTL" drain >drain.out 2>drain.err &
drain=$!
pids="$pids $drain"
soon eval "ls -l /proc/$drain/fd | grep -q socket:" && rm s.lock s && start_daemon s --threads 1 &&
    kill -CONT "$old" && { wait "$drain"; [ $? -eq 4 ]; } && grep -q 'another one has begun' drain.err &&
    [ -S s ] && [ -e s.lock ] && [ "$(ls s.lock.* 2>/dev/null)" = '' ] && ctl version --json &&
    [ "$(json_value pid)" = "$daemon" ] && soon eval "! kill -0 $old 2>/dev/null"
report drain__spares_a_daemon_that_has_begun_meanwhile
kill "$daemon"
wait "$daemon" 2>/dev/null

# If it failed, beside what an earlier daemon has left drain would remove a socket that systemd made,
# and end nothing.
start_daemon s --threads 1 && rm s.lock && echo $$ >s.lock && ends 4 'no daemon holds' drain && [ -S s ] && [ -e s.lock ]
report drain__spares_a_socket_whose_lock_is_not_held

tap_end
