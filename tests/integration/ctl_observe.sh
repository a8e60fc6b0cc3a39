#!/bin/bash
# tests/integration/ctl_observe.sh - the commands of pccdctl that look at a daemon (TAP).

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}"
# shellcheck source=tests/support/ctl.sh
. "$top_srcdir/tests/support/ctl.sh"

# json EXPRESSION: of the JSON in out, as `j`; Python where it is there.
json() {
    if ! command -v python3 >/dev/null; then
        return 0
    fi
    python3 -c 'import json, sys
j = json.load(open("out"))
sys.exit(0 if eval(sys.argv[1]) else 1)' "$1" >"$log" 2>&1 ||
        { echo "not so: $1"; cat out; } >>"$log"
    [ ! -s "$log" ]
}
frame 1 >a.obj
frame -1 >b.obj

start_daemon s --threads 2
export PCCD_URL="unix:$work/s"

# If it failed, a player would not play what it was given.
ctl load --times 4 a.obj b.obj && says '^steps +4 in ' '^triangles +2$' '^contacts +[4-9]' &&
    ctl load --hz 200 --times 20 --json a.obj b.obj && json 'j["steps"] == 20' &&
    json '0.09 < j["seconds"] and j["contacts"] >= 20 and j["incomplete"] == 0' &&
    ctl load --with a.obj --seconds 0.1 a.obj && says '^triangles +4$'
report load__plays_frames_at_a_rate

# If it failed, who looks what a daemon has done would be shown a step that was made long
# before a batch.
"$top_builddir/pccd-load" --url "$PCCD_URL" --kinds batch --batch 16 --clients 1 --requests 3 \
    --processes 1 >load.log 2>&1 # too short to judge how memory grows
ctl stats --threads && says '^batch of 16 scenes up to step [0-9]+ by [12] threads?' ' scenes ' &&
    ctl stats --threads --json && json 'j["batch"] == 16 and j["thread_records"][0]["scenes"] > 0' &&
    ctl status && says '^last batch of 16 +.* by [12] threads?: ingest ' &&
    ctl list sessions --json && json 'j[0]["batch"] == 0 and j[0]["batch_done"] == 0'
report batch__is_shown_as_the_last_step

"$PCCDCTL" load --hz 100 --seconds 120 a.obj b.obj >/dev/null 2>&1 &
player=$!
pids="$pids $player"
for _ in 1 2 3 4 5 6 7 8 9 10; do
    ctl list objects --json && grep -q object out && break
    sleep 0.2
done

# If it failed, status would tell of another daemon, or nothing of its last step.
ctl status && says "^daemon +pccdd [0-9.]+, process $daemon, protocol 1, " '^up for ' \
    '^sessions +2 open' '^scenes +1 with 1 object; 1 mesh; [24] triangles in all$' '^memory +engine .*, shared ' \
    '^last step +.* by [12] threads?: ingest ' '(^ +|, )merge ' '^latency +steps p50 < ' '^team +2 threads' &&
    ctl status --json && json 'j["pid"] == '"$daemon"' and j["counters"]["sessions_now"] == 2' &&
    json 'j["last_step"]["ns_step"] > 0 and j["steps"]["count"] > 24' &&
    json 'j["steps"]["p50_below_s"] <= j["steps"]["p99_below_s"] and "healthy" in j'
report status__tells_how_the_daemon_is

# If it failed, top would rank or rate sessions wrongly, or draw over a file.
ctl top --once --interval 0.5 && says '^2 sessions; ' '^SESSION +PID +USER' " $player +[a-z]" &&
    ! grep -q "$(printf '\033')" out &&
    ctl top --count 1 --interval 0.5 --json --sort steps &&
    json 'j["sessions"][0]["pid"] == '"$player"' and j["sessions"][0]["steps_per_s"] > 0' &&
    json '0 < j["sessions"][0]["ms"]["ingest"] < j["sessions"][0]["ms_step"]' &&
    json 'j["sessions"][0]["in_per_s"] > 0 and j["sessions"][1]["steps_per_s"] == 0' &&
    ctl top --count 3 --interval 0.05 --json && [ "$(wc -l <out)" = 3 ] &&
    fails 2 'none of ms, steps' top --sort speed
report top__rates_and_sorts_sessions

# If it failed, a scene, object or mesh would be hidden, or another one's shown.
ctl list && says "^ *[0-9]+ +$player " '^SESSION .* STEPS INCOMPLETE ' &&
    ctl list --json sessions && json 'len(j) == 2' &&
    json 'all(0 <= s["steps_incomplete"] <= s["steps"] for s in j)' &&
    session=$(python3 -c 'import json
print([s["session"] for s in json.load(open("out")) if s["pid"] == '"$player"'][0])' 2>/dev/null ||
        echo 1) &&
    ctl list scenes --json && json 'len(j) == 1 and j[0]["objects"] == 1' &&
    json 'j[0]["steps"] > 0 and len(j[0]["last_hash"]) == 34' &&
    ctl list objects --json --session "$session" && json 'len(j) == 1 and j[0]["triangles"] == 2' &&
    json 'j[0]["name"] == "a" and j[0]["owner"] == '"$session"' and j[0]["group"] == "0x1" and j[0]["self_collision"]' &&
    json 'j[0]["radius"] == 0 and j[0]["rest_distance"] == 0 and j[0]["rest_rings"] == 0 and j[0]["user_data"] == 0' &&
    ctl list objects && says '^SESSION +SCENE +OBJECT NAME ' '0x[0-9a-f]+ a +0x[0-9a-f]+ +2 +'"$session"' +1 +ffffffffffffffff self +0 +0 +0 +0$' &&
    ctl list pairs --json && json 'j == []' && ctl list pairs && says '^SESSION +SCENE +OBJECT A' &&
    ctl list meshes --json && json 'j[0]["vertices"] == 6 and j[0]["committed"]' &&
    ctl list meshes && says ' 6 +2 +1 +1 committed$' &&
    fails 4 'there is no session 999' list --session 999 &&
    fails 4 'there is no session 10, ' list --session 010 &&
    fails 2 'none of sessions, scenes' list things
report list__shows_what_there_is

# If it failed, nobody could play into another session's scene, or see who takes part in
# it; or a scene's name could control the terminal of whoever lists it; or who waits for a
# step that nobody makes could not be ended.
both=$'bo\033[2Jth'
"$PCCDCTL" load --scene "$both" --hz 50 --seconds 120 a.obj b.obj >/dev/null 2>&1 &
other=$!
pids="$pids $other"
for _ in 1 2 3 4 5 6 7 8 9 10; do
    ctl list scenes && grep -q 'th"' out && break
    sleep 0.2
done
ctl load --scene "$both" --hold --times 3 --json a.obj b.obj && json 'j["steps"] == 3' &&
    ctl list scenes && says ' "bo\\x1b\[2Jth" of .* rw-------, 1 takes part, 0 held$' &&
    ctl list scenes --json &&
    json '[(s["members"], s["rights"], s["writable"]) for s in j if s["name"] == "bo\u001b[2Jth"] == [(1, 384, True)]' &&
    ctl load --scene alone --hold --seconds 0.3 a.obj && says '^steps +0 in 0' &&
    timeout -s INT 1 "$PCCDCTL" load --scene alone --hold a.obj >out 2>err
[ $? -eq 124 ] && says '^steps +0 in ' && fails 2 'only in a shared scene' load --hold a.obj
report load__plays_into_a_shared_scene
kill "$other"
wait "$other" 2>/dev/null
for _ in 1 2 3 4 5 6 7 8 9 10; do
    ctl list && [ "$(grep -c . out)" = 3 ] && break
    sleep 0.2
done

# If it failed, whoever has seen enough of the lines would be told of an error.
: >err
for command in watch 'watch --json' 'top --json --interval 0.01'; do
    # shellcheck disable=SC2086 # words
    timeout 20 "$PCCDCTL" $command 2>>err | head -n 1 >/dev/null
    [ "${PIPESTATUS[0]}" -eq 0 ] || echo "$command: exit status"
done >"$log"
cat err >>"$log"
[ ! -s "$log" ] && { timeout 20 "$PCCDCTL" watch --count 1 >/dev/full 2>err; [ $? -eq 4 ]; } &&
    grep -q 'cannot write' err
report watch__ends_quietly_when_nobody_reads

# on_terminal COLUMNS COMMAND...: what a terminal of so many columns and eight rows is sent, a
# line each in out, without escape sequences.
on_terminal() {
    local columns=$1
    shift
    TERM=xterm timeout -k 5 60 script -qec "stty cols $columns rows 8; $*" /dev/null </dev/null |
        tr '\r' '\n' | sed 's/\x1b\[[0-9;?]*[A-Za-z]//g' >out
}
fits() { # COLUMNS
    ! grep -E "^.{$(($1 + 1))}" out
}
if command -v script >/dev/null; then
    # Rows and heads have as many words as columns, so no number is cut in two or left out.
    for columns in 20 40 60 80 120 160; do
        on_terminal $columns "$PCCDCTL" top --count 3 --interval 0.05
        says '^SESSION .*CLIENT' &&
            says '^ +[0-9]+ [0-9 a-z]*pccdctl( |$)' && fits "$columns" >>"$log" &&
            awk '/^SESSION/ { words = NF } /pccdctl/ {
                    gsub(/ (KiB|MiB|GiB|B|k|M)( |$)/, "_ ") ; if (NF != words) exit 1 }' out || break
        [ "$columns" != 60 ] || says ' CLIENT +TRIANG STEPS/S MS/STEP' || break
        [ "$columns" != 80 ] || says ' PID .* MS/STEP .*QUEUE' || break
        [ "$columns" != 120 ] || says 'OUT/S$' || break
        [ "$columns" != 160 ] || says ' INGEST .* MERGE .* OUT/S$' || break
    done
    [ "$columns" = 160 ] && [ ! -s "$log" ]
    # If it failed, a number would be cut, or each drawing would leave rows behind on a terminal
    # that is not wide.
    report top__fits_the_terminal
    # If it failed, a list would wrap, and nobody could tell which number is under which head.
    for what in sessions scenes objects pairs meshes; do
        on_terminal 80 "$PCCDCTL" list $what
        says '^SESSION' && fits 80 >>"$log" || break
    done
    [ "$what" = meshes ] && on_terminal 80 "$PCCDCTL" list scenes && says '^SESSION +SCENE .*STEPS +CONTACTS'
    report list__fits_the_terminal
    # If it failed, text beside a number would go on under the numbers of the next line.
    for what in 'check --repeat 0 a.obj b.obj' 'near --distance 9 a.obj b.obj' status stats 'stats --threads' config; do
        on_terminal 120 "$PCCDCTL" "$what" && fits 120 >>"$log" || break
        on_terminal 80 "$PCCDCTL" "$what" && [ -s out ] && fits 80 >>"$log" || break
        [ "${what%% *}" != check ] || says '^verdict +meets first ' '^ {11}of 1 step$' || break
    done
    [ "$what" = config ] && says '^step-max-ms +0 +milliseconds .* it is$' '^ {30}answered as one whose deadline has come; 0: as$' &&
        ctl config && says '^step-max-ms .* whose deadline has come; 0: as long as it takes$'
    report texts__fit_the_terminal
    # If it failed, q would not end it, as it does other programs of that kind.
    printf q | TERM=xterm timeout -k 5 20 script -qec "$PCCDCTL top --interval 60" /dev/null >/dev/null
    report top__ends_with_q
    # If it failed, the prompt of a shell would stand behind half a bar.
    TERM=xterm script -qec "timeout --foreground 1 $PCCDCTL check --repeat 1000000 a.obj b.obj" /dev/null \
        </dev/null >bars
    grep -q '^runs \[' <(tr '\r' '\n' <bars) && [ "$(tail -c 4 bars | od -An -c | tr -d ' ')" = '\r033[K' ]
    report progress__goes_when_the_command_is_ended
    # If it failed, who waits for a large file would not know for what, and how long.
    { yes '# a comment that takes its time' | head -c 17000000; echo; cat a.obj; } >large.obj
    on_terminal 80 "$PCCDCTL" check --repeat 0 large.obj b.obj &&
        says '^reading \(MiB\) \[#*\.*\] [0-9]+/16$' '^contacts +1:'
    report progress__of_a_large_file
    on_terminal 40 "$PCCDCTL" load --seconds 0.3 a.obj b.obj &&
        says '^playing \(ms\) \[#*\.*\] [0-9]+/300$' && grep '^playing' out >bars &&
        mv bars out && fits 39 >"$log"
    # If it failed, the bar would climb down such a terminal.
    report progress__fits_the_terminal
    on_terminal 80 "$PCCDCTL" check --repeat 40000 a.obj b.obj &&
        says '^runs \[#+\.+\] [0-9]+/40001$' '^contacts +1:'
    # If it failed, who measures for long would not know for how long.
    report check__shows_its_repetitions
else
    for name in top__fits_the_terminal list__fits_the_terminal texts__fit_the_terminal top__ends_with_q \
        progress__goes_when_the_command_is_ended progress__of_a_large_file progress__fits_the_terminal \
        check__shows_its_repetitions; do
        tap_skip "$name" "script is not installed"
    done
fi

# If it failed, who watches would not see the steps.
ctl watch --count 3 && says '^ +STEP SESSION +SCENE CONTACTS +MS TH HASH$' &&
    [ "$(grep -cE '^ *[0-9]+ s[0-9]+ +0x[0-9a-f]+ +[0-9]+ +[0-9.]+ +[0-9]+ 2:[0-9a-f]{32}$' out)" = 3 ] &&
    ! grep -E '^.{81}' out &&
    ctl watch --session "$session" --count 1 --json &&
    json 'j["session"] == '"$session"' and j["status"] == "OK" and j["ms"] > 0' &&
    fails 4 'no session 999; pccdctl list shows them' watch --session 999 --count 1 &&
    fails 2 '--scene needs --session' watch --scene 0x100000
report watch__prints_every_step

# If it failed, a setting would be lost, or nonsense taken.
ctl config && says '^threads +2 ' '^queue-max +32768 ' && ctl config get grace && says '^10$' &&
    ctl config set grace 7 && [ ! -s out ] && ctl config get grace && says '^7$' &&
    ctl config list --json && json '[s["value"] for s in j if s["name"] == "grace"] == ["7"]' &&
    json '[s["name"] for s in j if s["changed"]] == ["grace"]' &&
    fails 4 'is not from' config set threads 77 && fails 4 'no setting' config get speed &&
    fails 2 'set NAME VALUE' config set grace
report config__changes_a_running_daemon

# ---- metrics -------------------------------------------------------------------------

# The rules of Prometheus' text format 0.0.4, of which its node exporter takes nothing else.
text_format() {
    awk '
        function bad(text) { print NR ": " text ": " $0; failed = 1 }
        /\r/ { bad("CR") }
        /^# HELP / { if ($3 in help) bad("metric twice"); help[$3] = 1; next }
        /^# TYPE / {
            if ($3 in type) bad("type twice")
            if (!($3 in help)) bad("no help before it")
            if ($4 !~ /^(counter|gauge|histogram)$/) bad("type")
            if (($4 == "counter") != ($3 ~ /_total$/)) bad("a counter ends with _total, nothing else")
            metric = $3; type[metric] = $4; last = -1; next }
        /^#/ { bad("comment") }
        $0 !~ /^[a-z_:][a-z0-9_:]*([{][a-z_]+="([^"\\]|\\.)*"(,[a-z_]+="([^"\\]|\\.)*")*[}])? [0-9.e+-]+$/ {
            bad("sample") }
        {
            name = $1; sub(/[{].*/, "", name); suffix = substr(name, length(metric) + 1)
            if (substr(name, 1, length(metric)) != metric) bad("of another metric")
            kind = type[metric]
            if (kind != "histogram" && suffix != "") bad("a suffix")
            if (kind == "histogram" && suffix == "_bucket") {
                if ($NF + 0 < last) bad("not cumulative")
                last = $NF + 0; inf = $0 ~ /le="[+]Inf"/ }
            if (kind == "histogram" && suffix == "_count" && (!inf || $NF + 0 != last)) bad("count")
            seen[metric]++
        }
        END {
            for (m in type) if (!seen[m]) { print "no sample of " m; failed = 1 }
            exit failed }' out >"$log" 2>&1
}
# If it failed, a collector would lose all of it, or take a total for a gauge.
ctl metrics && text_format && [ "$(grep -c '^# TYPE' out)" -gt 60 ] &&
    says '^# TYPE pccd_steps_total counter$' '^# TYPE pccd_sessions_now gauge$' \
        '^# TYPE pccd_step_seconds_total counter$' '^pccd_sessions_total [0-9]+$' \
        '^pccd_daemon_info\{name="pccdd ' '^pccd_step_duration_seconds_bucket\{le="1.024e-06"\} ' \
        '^pccd_setting_scenes_max 65536$' '^pccd_setting_step_max_seconds 0$' \
        '^# HELP pccd_setting_shm_max_bytes MiB of .*here: bytes.$' &&
    ! grep -q 'setting_log_level' out &&
    grep '^pccd_' out | sed 's/[{ ].*//' >names && ctl stats --json &&
    sed -n 's/^ *"\([a-z0-9_]*\)": [0-9]*,*$/\1/p' out >counters && [ "$(wc -l <counters)" -gt 45 ] &&
    while read -r counter; do
        case $counter in
        ns_*) counter=${counter#ns_}_seconds ;;
        *_ns) counter=${counter%_ns}_seconds ;;
        esac
        grep -qxE "pccd_${counter%_total}(_total)?" names || echo "not there: $counter"
    done <counters >"$log" && [ ! -s "$log" ]
report metrics__keep_the_rules_of_the_text_format

# If the check could not fail, the test before would say nothing.
ctl metrics && sed -i 's/^pccd_steps_total/pccd_steps/' out && ! text_format &&
    ctl metrics && sed -i 's/^# TYPE pccd_daemon_info gauge/# TYPE pccd_daemon_info info/' out && ! text_format &&
    ctl metrics && sed -i 's/^pccd_step_duration_seconds_count .*/pccd_step_duration_seconds_count 0/' out &&
    ! text_format
report metrics__mistakes_would_be_seen

# If it failed, Prometheus' own tool would find fault with a name, a type or a help text.
if command -v promtool >/dev/null; then
    ctl metrics && promtool check metrics <out >"$log" 2>&1 && [ ! -s "$log" ]
    report metrics__satisfy_promtool
else
    tap_skip metrics__satisfy_promtool "it takes prometheus"
fi

# If it failed, an alert or a chart would ask for a metric that does not exist, and stay silent.
files="$top_srcdir/client/prometheus/pccd.rules.yml $top_srcdir/client/prometheus/pccd.dashboard.json"
ctl metrics && sed -n 's/^\(pccd_[a-z_]*\)[ {].*/\1/p' out | sort -u >names &&
    # shellcheck disable=SC2086 # two files
    grep -oh 'pccd_[a-z_]*[a-z]' $files | sort -u >asked && [ "$(wc -l <asked)" -gt 20 ] &&
    comm -23 asked names >"$log" && [ ! -s "$log" ] && says '^# TYPE pccd_memory_bytes_max gauge$' &&
    ! grep -E '^# HELP [a-z_]+ (of|that) |^# HELP .* these( |,|$)' out # each is read alone
report metrics__have_what_alerts_and_charts_ask_for

# If it failed, Prometheus would not load the alerts, or one would not tell of what it is for.
if command -v promtool >/dev/null; then
    cat >alerts.yml <<YAML
rule_files: [$top_srcdir/client/prometheus/pccd.rules.yml]
tests:
  - interval: 1m
    input_series:
      - series: pccd_jobs_queued_now
        values: 0x5 2000x10
      - series: pccd_steps_total
        values: 0+600x20
      - series: pccd_steps_incomplete_total
        values: 0+100x20
      - series: pccd_uptime_seconds
        values: 1000+60x5 10+60x14
      - series: pccd_log_lines_lost_total
        values: 0x5 3x14
    alert_rule_test:
      - {eval_time: 4m, alertname: PccdLogIsLost}
      - eval_time: 8m
        alertname: PccdLogIsLost
        exp_alerts:
          - exp_labels: {severity: warning}
            exp_annotations:
              summary: Lines of the log of pccdd could not be written
              description: The disk of the log is full, or nobody reads the pipe that it goes to.
      - {eval_time: 5m, alertname: PccdRequestsWait}
      - eval_time: 9m
        alertname: PccdRequestsWait
        exp_alerts:
          - exp_labels: {severity: warning}
            exp_annotations:
              summary: 2000 requests wait to be computed
              description: pccdctl top tells whose they are.
      - eval_time: 15m
        alertname: PccdStepsAreIncomplete
        exp_alerts:
          - exp_labels: {severity: warning}
            exp_annotations:
              summary: 1.6666666666666667 steps a second have incomplete answers
              description: >-
                Deadlines are too short, results too large for their memory, or steps cancelled.
      - {eval_time: 4m, alertname: PccdRestarted}
      - eval_time: 10m
        alertname: PccdRestarted
        exp_alerts:
          - exp_labels: {severity: info}
            exp_annotations:
              summary: pccdd was started anew
              description: journalctl -u pccdd tells whether it crashed. Clients bring their scenes back.
YAML
    promtool check rules "$top_srcdir/client/prometheus/pccd.rules.yml" >"$log" 2>&1 &&
        promtool test rules alerts.yml >"$log" 2>&1
    report alerts__tell_of_what_they_are_for
else
    tap_skip alerts__tell_of_what_they_are_for "it takes prometheus"
fi

# If it failed, samples would be lost on their way to Prometheus: the file whole, a counter's type, or
# those of a machine's second daemon, which the manual has labelled.
if command -v prometheus-node-exporter >/dev/null && command -v python3 >/dev/null; then
    mkdir textfiles && ctl metrics && cp out textfiles/pccd.prom &&
        label=$(sed -n 's/.*pccdctl metrics | sed \(.*\) >second.prom$/\1/p' "$top_srcdir/client/man/pccdctl.1.scd" |
            tr -d '\\') && eval "sed $label" <out >textfiles/second.prom &&
        python3 - textfiles >scraped 2>"$log" <<'PY'
import socket, subprocess, sys, time, urllib.request

with socket.socket() as chosen:
    chosen.bind(("127.0.0.1", 0))
    address = "127.0.0.1:%d" % chosen.getsockname()[1]
exporter = subprocess.Popen(
    ["prometheus-node-exporter", "--collector.disable-defaults", "--collector.textfile",
     "--collector.textfile.directory=" + sys.argv[1], "--web.listen-address=" + address],
    stderr=subprocess.DEVNULL)
try:
    for attempt in range(100):
        try:
            print(urllib.request.urlopen("http://%s/metrics" % address).read().decode(), end="")
            break
        except OSError:
            time.sleep(0.1)
finally:
    exporter.kill()
PY
    grep -qx 'node_textfile_scrape_error 0' scraped &&
        grep '^# TYPE pccd_' textfiles/pccd.prom | sort >types &&
        grep '^# TYPE pccd_' scraped | sort | diff types - >>"$log" &&
        cat textfiles/*.prom | grep -c '^pccd_' >sent && grep -c '^pccd_' scraped | diff sent - >>"$log" &&
        grep -q '^pccd_step_duration_seconds_bucket{daemon="second",le="+Inf"} ' scraped
    report metrics__reach_prometheus_by_the_node_exporter
else
    tap_skip metrics__reach_prometheus_by_the_node_exporter "it takes prometheus-node-exporter, python3"
fi

# ---- doctor -------------------------------------------------------------------------

# If it failed, a good set-up would be blamed, or a bad one praised.
ctl doctor && says '^ok +socket ' '^ok +versions ' '^ok +ping ' &&
    ! grep -q '^FAIL' out && ctl doctor --json && json 'all(f["verdict"] in ("ok", "warn") for f in j)' &&
    ! PCCD_URL="unix:$work/none" ctl doctor && says '^warn +socket .*none: No such file' '^FAIL +daemon ' \
        '^ +-> start pccdd' &&
    : >file && { PCCD_URL="unix:$work/file" ctl doctor; [ $? -eq 1 ]; } && says '^FAIL +socket .* is no socket$' &&
    OMP_PROC_BIND=true ctl doctor && says '^warn +openmp +set: OMP_PROC_BIND=true$' &&
    chmod 0777 "$work" && { ctl doctor; [ $? -eq 1 ]; } && says '^FAIL +folder .*mode 0777'
status=$?
chmod 0700 "$work"
tap_result $status doctor__finds_what_is_wrong "$log"

# If it failed, nobody would learn that a daemon computes by one thread because what started it was
# bound to one processor.
if [ "$(nproc)" -lt 2 ] || ! command -v taskset >/dev/null; then
    tap_skip doctor__tells_of_a_daemon_that_is_bound "it takes two processors and taskset"
else
    cpu=$(taskset -pc $$ | sed 's/.*: //; s/[-,].*//')
    mkfifo bound.ready
    taskset -c "$cpu" "$PCCD_DAEMON" --socket "$work/bound" --ready-fd 3 3>bound.ready 2>>"$log" &
    bound_pid=$!
    read -r -t 20 -N 1 _ <bound.ready
    ctl doctor --socket "$work/bound" && says '^warn +threads +1 thread of a step, 1 of [0-9]+ processors$' &&
        ctl status --socket "$work/bound" && says '^team +1 thread at most.*; on 1 of [0-9]+ processors'
    status=$?
    kill "$bound_pid" && wait "$bound_pid"
    tap_result $status doctor__tells_of_a_daemon_that_is_bound "$log"
fi

# If it failed, OpenMP's binding of the first thread would leave a daemon one processor of all.
if [ "$(nproc)" -lt 2 ]; then
    tap_skip threads__are_as_many_where_openmp_binds_the_first "it takes two processors"
else
    mkfifo places.ready
    env -u OMP_PLACES OMP_PROC_BIND=true \
        "$PCCD_DAEMON" --socket "$work/places" --ready-fd 3 3>places.ready 2>>"$log" &
    bound_pid=$!
    read -r -t 20 -N 1 _ <places.ready
    ctl doctor --socket "$work/places" && ! says '^warn +threads ' &&
        ctl status --socket "$work/places" && says "^team +$(nproc) threads at most"
    status=$?
    kill "$bound_pid" && wait "$bound_pid"
    tap_result $status threads__are_as_many_where_openmp_binds_the_first "$log"
fi

# If it failed, nobody would learn why the daemon that a program has started is gone.
cat >dying <<'SH'
#!/bin/sh
echo 'listening' >&2
echo 'the disk is on fire' >&2
echo './dying(+0x1)[0x7f]' >&2
kill -ABRT $$
SH
chmod +x dying
mkdir -m 0700 dead && {
    ! env -u PCCD_URL -u PCCD_LOG XDG_RUNTIME_DIR="$work/dead" timeout 20 "$PCCDCTL" ping --daemon "$work/dying" 2>err
    env -u PCCD_URL -u PCCD_LOG XDG_RUNTIME_DIR="$work/dead" PCCD_DAEMON=$work/dying timeout 20 "$PCCDCTL" \
        load a.obj b.obj >out 2>err
    cat err >>"$log"
    grep -q 'ended at once; it said: the disk is on fire' err &&
        { env -u PCCD_URL XDG_RUNTIME_DIR="$work/dead" timeout 20 "$PCCDCTL" doctor >out; [ $? -eq 1 ]; } &&
        says '^warn +log +the last daemon there has died; it said: the disk is on fire$' &&
        ! env -u PCCD_LOG timeout 20 "$PCCDCTL" ping --private --daemon "$work/dying" 2>err &&
        grep -qF 'ended at once, by signal 6 (Aborted); it said: the disk is on fire' err
}
report doctor__tells_the_last_words_of_a_daemon

# If it failed, the way out that doctor shows to who has no daemon would lead nowhere.
mkdir none && {
    env -u PCCD_URL XDG_RUNTIME_DIR="$work/none" timeout 20 "$PCCDCTL" doctor >out 2>err
    [ $? -eq 0 ] && says '^ok +daemon +none runs, and none is needed$' && ! says '^(warn|FAIL)' &&
        { env -u PCCD_URL XDG_RUNTIME_DIR="$work/none" timeout 20 "$PCCDCTL" top 2>err; [ $? -eq 3 ]; } &&
        grep -q '^pccdctl: no daemon runs; a program that needs one starts it: ' err &&
        advice=$(sed -nE 's/.*\(pccdctl ([a-z]+ FILE) does\).*/\1/p' out) && [ -n "$advice" ] &&
        # shellcheck disable=SC2086 # words
        env -u PCCD_URL XDG_RUNTIME_DIR="$work/none" timeout 20 "$PCCDCTL" ${advice/FILE/a.obj} >out 2>err &&
        env -u PCCD_URL XDG_RUNTIME_DIR="$work/none" timeout 20 "$PCCDCTL" doctor >out 2>err &&
        says '^ok +socket '
}
status=$?
pid=$(sed -nE 's/^ok +versions .* process ([0-9]+);.*/\1/p' out)
[ -z "$pid" ] || kill "$pid"
tap_result $status doctor__knows_how_to_get_a_daemon "$log"

# If it failed, who has no runtime folder at all would wait for the daemon to make it.
env -u PCCD_URL XDG_RUNTIME_DIR="$work/absent" timeout 20 "$PCCDCTL" doctor >out 2>err
[ $? -eq 1 ] && says '^FAIL +folder +.*/absent/pccd: No such' '^ +-> .* set XDG_RUNTIME_DIR'
report doctor__tells_of_a_folder_that_cannot_be_made

# If it failed, a script could not read how fast a daemon answers, or which one it is.
ctl ping -c 20 -i 0 --json && json 'j["count"] == 20 and j["pid"] == '"$daemon" &&
    json '0 < j["min_us"] <= j["p50_us"] <= j["p99_us"] <= j["max_us"]' &&
    ctl version --json && json 'j["daemon"]["pid"] == '"$daemon"' and j["daemon"]["protocol"] == 1' &&
    PCCD_URL="unix:$work/none" ctl version --json && json 'j["daemon"] is None and j["library"] != ""'
report ping__and_version_speak_json

# If it failed, who asks for a daemon by an option could not tell that there is none.
ends 3 'no connection' version --private --daemon "$work/none" && says '^library  libpccd ' &&
    ends 3 "nobody listens at $work/none" version --socket "$work/none" &&
    ends 3 "nobody listens at $work/none" version --json --url "unix:$work/none" &&
    json 'j["daemon"] is None' && ctl version --private && says '^daemon   answers'
report version__fails_without_the_daemon_that_was_asked_for

# If it failed, a user could not trace, watch or change the daemon that is their own: root may
# everything, and a sandbox in which the daemon cannot tell who it is refuses everybody else.
# The programs are copied to where every user can reach them, also if the build folder is in a
# home folder of mode 0700.
mkdir plain bin && chmod 0777 plain && chmod 0755 "$work" bin
cp "$PCCDCTL" bin/pccdctl && cp "$PCCD_DAEMON" bin/pccdd && chmod 0755 bin/*
as_plain_user() {
    if [ "$(id -u)" -eq 0 ]; then
        set -- setpriv --reuid=65534 --regid=65534 --clear-groups "$@"
    fi
    (cd plain && env -u PCCD_URL PCCD_DAEMON="$work/bin/pccdd" XDG_RUNTIME_DIR="$work/plain" \
        timeout 60 "$@") >out 2>"$log"
}
as_plain_user "$work/bin/pccdctl" version --private &&
    as_plain_user "$work/bin/pccdctl" config set log-level warn --private &&
    as_plain_user "$work/bin/pccdctl" trace -o trace.json --seconds 0.1 --private &&
    as_plain_user "$work/bin/pccdctl" watch --seconds 0.1 --private
report daemon__lets_its_own_user_do_all
chmod 0700 "$work"

# ---- what all commands have ---------------------------------------------------------

# If it failed, a script could not tell why a command failed.
for command in status top list watch stats metrics ping 'config list' 'trace -o x'; do
    # shellcheck disable=SC2086 # words
    PCCD_URL="unix:$work/none" ctl $command
    [ $? -eq 3 ] && grep -q 'no connection: .*; pccdctl doctor tells' err ||
        echo "$command without a daemon: $(cat err)"
    # shellcheck disable=SC2086
    ctl $command --no-such-option
    [ $? -eq 2 ] || echo "$command with a wrong option"
    # shellcheck disable=SC2086
    ctl $command -h && grep -q -- '--url=URL' out && grep -q -- '--no-color' out ||
        echo "$command -h"
done >"$log"
[ ! -s "$log" ]
report commands__have_the_same_exit_statuses_and_options

# complete WORD...: what bash would offer for the last of the words, in out.
complete_words() {
    bash -c 'source ./pccdctl.bash
        COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
        _pccdctl && printf "%s\n" "${COMPREPLY[@]}"' - "$@" >out 2>err
}
# If it failed, a command or an option could not be completed, or a wrong one would be.
"$PCCDCTL" completion bash >pccdctl.bash && bash -n pccdctl.bash 2>"$log" &&
    complete_words pccdctl '' && says '^status$' '^top$' '^check$' '^completion$' &&
    complete_words pccdctl st && [ "$(sort out | tr '\n' ' ')" = 'stats status ' ] &&
    complete_words pccdctl check --mode '' && [ "$(sort out | tr '\n' ' ')" = 'all any first first-per-pair pairs ' ] &&
    complete_words pccdctl check --mode = p && [ "$(cat out)" = pairs ] &&
    complete_words pccdctl top --sor && [ "$(cat out)" = --sort ] &&
    complete_words pccdctl list '' && says '^meshes$' && complete_words pccdctl check a.o &&
    [ "$(cat out)" = a.obj ] && complete_words pccdctl config g && [ "$(cat out)" = get ] &&
    "$PCCDCTL" --help | sed -n 's/^  \([a-z]*\) .*/\1/p' >commands &&
    while read -r command; do
        "$PCCDCTL" "$command" --help | grep -oE -- '--[a-z][a-z-]*' | sort -u >options
        complete_words pccdctl "$command" -- && while read -r option; do
            grep -qx -- "$option" out || echo "$command $option"
        done <options
    done <commands | grep -vE -- '--(usage|version)$' >"$log"
[ ! -s "$log" ] && [ "$(wc -l <commands)" -ge 15 ]
report completion__bash_knows_every_command_and_option

# offers LINE WORD...: the shell's answers, "LINE: WORD..." a line in out, have this one.
offers() {
    local line=$1
    shift
    grep -qxF -- "$line: $*" out || echo "no \"$line: $*\" in: $(grep -F -- "$line:" out)"
}
completion_lines=('pccdctl st' 'pccdctl check --mode=p' 'pccdctl list m' 'pccdctl config g'
    'pccdctl help li' 'pccdctl top --so')
is_completed() {
    offers 'pccdctl st' stats status
    offers 'pccdctl check --mode=p' "$1pairs"
    offers 'pccdctl list m' meshes
    offers 'pccdctl config g' get
    offers 'pccdctl help li' list
    offers 'pccdctl top --so' --socket --sort
}

# What zsh offers at a terminal: its own compadd, heard.
cat >capture.zsh <<'END'
zmodload zsh/zpty
zpty probe zsh -f -i
zpty -w probe "PROMPT= RPROMPT=; fpath=($PWD/functions \$fpath); autoload -Uz compinit; compinit -u -d $PWD/dump"
zpty -w probe 'compadd() {
    [[ ${@[1,(i)(-|--)]} == *-(O|A|D)\ * ]] || {
        local -a hits; builtin compadd -A hits "$@"; print -l -- $hits >>hits
    }
    builtin compadd "$@"
}'
while IFS= read -r line; do
    : >hits
    zpty -w -n probe "$line"$'\t'
    for i in {1..400}; do sleep 0.1; zpty -r -t probe trash; [[ -s hits ]] && break; done
    sleep 0.2
    words=(${(fo)"$(<hits)"})
    print -r -- "$line: ${(uj: :)words}"
    zpty -w -n probe $'\x15'
done
zpty -d probe
END
name=completion__zsh_offers_what_there_is
if command -v zsh >/dev/null; then
    mkdir functions && "$PCCDCTL" completion zsh >functions/_pccdctl &&
        zsh -n functions/_pccdctl 2>err &&
        printf '%s\n' "${completion_lines[@]}" | timeout 300 zsh -f capture.zsh >out 2>>err
    is_completed '' >"$log"
    cat err >>"$log"
    [ ! -s "$log" ]
    # If it failed, zsh would complain when it starts, or offer other words.
    report $name
else
    tap_skip $name "zsh is not installed"
fi

name=completion__fish_knows_every_command_and_option
if command -v fish >/dev/null; then
    "$PCCDCTL" completion fish >pccdctl.fish
    {
        printf 'source pccdctl.fish\n'
        for line in "${completion_lines[@]}"; do
            printf "echo '%s:' (complete -C '%s' | string replace -r '\\\\t.*' '' | sort)\n" "$line" "$line"
        done
        while read -r command; do
            printf "echo '%s --:' (complete -C 'pccdctl %s --' | string replace -r '\\\\t.*' '')\n" \
                "$command" "$command"
        done <commands
    } >ask.fish
    HOME=$work timeout 120 fish --no-config ask.fish >out 2>"$log"
    is_completed --mode= >>"$log"
    while read -r command; do
        "$PCCDCTL" "$command" --help | grep -oE -- '--[a-z][a-z-]*' | sort -u |
            grep -vxE -- '--(usage|version|help)' | while read -r option; do
            grep -qE -- "^$command --:.* $option( |\$)" out || echo "$command $option"
        done
    done <commands >>"$log"
    [ ! -s "$log" ] && [ -s out ]
    # If it failed, fish would complain, or lack a command or an option.
    report $name
else
    tap_skip $name "fish is not installed"
fi

# ---- for programs --------------------------------------------------------------------

# metrics is text for Prometheus, completion a script, scene and mcp write JSON; the standard output
# of record is its program's.
while read -r command; do
    "$PCCDCTL" "$command" --help | grep -q -- '--json' || echo "$command has no --json"
done < <(grep -vxE 'metrics|completion|record|scene|mcp' commands) >"$log"
[ ! -s "$log" ]
# If it failed, a script would have to read what is meant for people.
report commands__have_json_where_a_program_may_read

ctl demo --steps 3 --output demo.png --json && json 'j["steps"] == 3 and j["incomplete"] == 0' &&
    json 'j["mean_ms"]["step"] > 0 and len(j["hash"]) == 34 and j["hash"][:2] == "2:" and j["picture"] == "demo.png"' &&
    ctl trace -o trace.json --seconds 0.1 --json && json 'j["file"] == "trace.json" and j["lost"] == 0' &&
    ctl trace --seconds 0.001 && says '^trace +pccd-trace.json: ' && [ -s pccd-trace.json ] &&
    ctl config set log-level warn --json && json 'j["name"] == "log-level" and j["value"] == "warn"'
# If it failed, a program could not tell what was done.
report commands__that_make_or_change_something_speak_json

kill $player && wait $player 2>/dev/null
tap_end
