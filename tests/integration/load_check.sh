#!/bin/bash
# load_check.sh - the load harness against real daemons, for seconds (TAP).

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

# If it failed, what is near would be answered wrongly among steps, under load or after a
# crash, or the daemon would keep something of it.
load near --near --clients 40 --requests 64 --processes 2 --kill-worker 3 --kill-clients 20 &&
    awk '/^nears / { exit !($2 > 800) }' "$work/near"
tap_result $? load__asks_what_is_near_between_steps "$work/near"

# If it failed, a scene in a batch would be answered otherwise than by itself, under load or
# after a crash; or a scene that fails would fail the others.
load batch --kinds batch --batch 16 --clients 20 --requests 64 --processes 2 --kill-worker 3 \
    --kill-clients 20 &&
    awk '/^answered / { exit !($2 > 18000) }' "$work/batch"
tap_result $? load__batches_are_answered_as_steps "$work/batch"

# If it failed, answers would depend on how many clients there are, or on luck.
load other --clients 120 --requests 16 --processes 1 --depth 1 &&
    grep '^checksum' "$work/crowd" >"$work/sum1" &&
    grep '^checksum' "$work/other" >"$work/sum2" &&
    cmp -s "$work/sum1" "$work/sum2"
tap_result $? load__two_runs_agree "$work/other"

# value FILE KEY...: a number of the report, under the first key the last one.
value() {
    sed "s/.*\"$2\":{\([^}]*\)}.*/\1/" "$1" | tr ',' '\n' | sed -n "s/^\"$3\"://p"
}

# as_often FILE HZ CLIENTS RAMP: whether what a report has of an open loop is what was due in
# the time that the run took by its own clock, to a tenth of a second. A machine that stops the
# run for a while makes it longer, and what was due meanwhile is late, or was not asked.
as_often() {
    awk -v submitted="$(value "$1" clients submitted)" -v unsent="$(value "$1" clients unsent)" \
        -v measured="$(value "$1" clients measured)" -v ramp="$4" -v rate=$(($2 * $3)) \
        -v seconds="$(grep -o '"seconds":[0-9.]*' "$1" | cut -d: -f2)" \
        -v counted="$(grep -o '"measured_s":[0-9.]*' "$1" | cut -d: -f2)" 'BEGIN {
            due = rate * (seconds - ramp / 2)
            last = rate * counted
            slack = rate / 10
            exit !(submitted + unsent >= due - slack && submitted + unsent <= due + slack &&
                measured <= last + slack && measured + unsent >= last - slack)
        }'
}

# If it failed, the report that programs read would not add up, or its percentiles not be in
# order, and the open loop would not ask as often as it says.
load paced --clients 12 --processes 3 --hz 50 --triangles 30..300 --scene wave \
    --ramp 0.5 --warm-up 1.5 --seconds 2 --json --csv "$work/seconds" &&
    [ "$(value "$work/paced" clients submitted)" -eq $((
        $(value "$work/paced" clients answered) + $(value "$work/paced" clients refused) +
        $(value "$work/paced" clients cancelled))) ] &&
    [ "$(value "$work/paced" clients measured)" -eq \
        "$(value "$work/paced" latency_us count)" ] &&
    as_often "$work/paced" 50 12 0.5 &&
    for key in p50 p90 p99 p99.9 p99.99 max; do
        value "$work/paced" latency_us "$key"
    done | sort -n -c &&
    awk -F, 'NF != 8 { exit 1 } END { exit NR < 3 }' "$work/seconds"
tap_result $? load__report_adds_up "$work/paced"

# If it failed, a client that stops for a while would hide what it did not ask meanwhile.
load stalled --clients 8 --processes 2 --hz 100 --depth 1 --stall 0.002,200 --seconds 2 \
    --scene wave --kinds follow --json &&
    [ "$(value "$work/stalled" clients stalled)" -ge 1 ] &&
    [ "$(value "$work/stalled" clients late)" -ge \
        $((15 * $(value "$work/stalled" clients stalled))) ] &&
    awk -v us="$(value "$work/stalled" latency_us p99.99)" 'BEGIN { exit us < 190000 }'
tap_result $? load__stalls_show_in_what_was_due "$work/stalled"

# If it failed, an option that everybody may set would make right answers seem wrong.
rm -f "$work/modes"
for mode in all first any pairs first-per-pair; do
    load mode --clients 12 --processes 2 --requests 40 --mode $mode ||
        { echo "--mode $mode" && cat "$work/mode"; } >>"$work/modes"
done
[ ! -e "$work/modes" ]
tap_result $? load__takes_every_mode_of_every_kind "$work/modes"

# If it failed, an overload would look as if less had been asked, and the seconds of a warm-up
# as if nobody had answered.
load overload --clients 4 --processes 2 --rate 50000 --triangles 2k --kinds follow \
    --seconds 2 --json --p99-ms 100
[ $? -eq 1 ] && [ "$(value "$work/overload" clients unsent)" -ge 20000 ] &&
    [ $(($(value "$work/overload" clients unsent) +
        $(value "$work/overload" clients submitted))) -ge 90000 ] &&
    awk -F, 'NR == 2 && ($2 == 0 || $4 != "") { exit 1 } NR == 4 && $4 == "" { exit 1 }' \
        "$work/seconds"
tap_result $? load__tells_what_it_could_not_ask "$work/overload"

# If it failed, a run would end well that was slower than was asked, or a wrong command line
# would start one.
load slow --clients 4 --requests 20 --p99-ms 0.0001
[ $? -eq 1 ] && grep -q '^p99 as asked  *NO' "$work/slow"
tap_result $? load__fails_where_p99_is_missed "$work/slow"
load wrong --triangles 5..2
status=$?
for options in '--hz 60 --rate 100' '--url nowhere' '--url direct: --kill-worker 1'; do
    # shellcheck disable=SC2086 # words
    load contradiction --clients 4 --requests 5 $options
    [ $? -eq 2 ] || { echo "$options" >>"$work/wrong"; status=1; }
done
[ $status -eq 2 ]
tap_result $? load__refuses_a_wrong_command_line "$work/wrong"
load absent --clients 4 --requests 20 --daemon /nowhere/pccdd
# If it failed, a script could not tell an absent daemon from a wrong answer.
status=$?
load unreachable --clients 4 --requests 20 --url "unix:$work/nobody"
[ $? -eq 3 ] && [ $status -eq 3 ] && grep -q 'No such file' "$work/absent" &&
    [ "$(wc -l <"$work/unreachable")" -eq 1 ]
tap_result $? load__tells_that_there_is_no_daemon "$work/absent"

# If it failed, a missing library would look like wrong answers, behind a report of nothing.
PCCD_DIRECT=/nowhere/lib.so load missing --clients 4 --requests 20 --url direct:
[ $? -eq 3 ] && grep -q '/nowhere/lib.so' "$work/missing" &&
    [ "$(wc -l <"$work/missing")" -eq 1 ]
tap_result $? load__tells_that_there_is_no_library "$work/missing"

# If it failed, a long run would end without what was to be written.
status=0
for options in "--csv $work/no/file" "--percentiles $work/no/file"; do
    # shellcheck disable=SC2086 # words
    load unwritten --clients 4 --requests 5 $options
    [ $? -eq 4 ] && ! grep -q '^submitted' "$work/unwritten" || status=1
done
[ $status -eq 0 ]
tap_result $? load__looks_where_it_is_to_write_first "$work/unwritten"

# If it failed, the picture would be missing, or percentiles be those of something else.
load plot --clients 4 --requests 50 --csv "$work/s.csv" --percentiles "$work/p.csv" --json &&
    awk -F, -v us="$(value "$work/plot" latency_us p99)" '
        $1 == "2.000" { exit !($2 == 99 && $3 == sprintf("%.4f", us / 1000)) }' "$work/p.csv" &&
    awk -F, 'NR > 2 && $3 < last { exit 1 } { last = $3 }' "$work/p.csv"
status=$?
if [ $status -eq 0 ] && ! command -v gnuplot >/dev/null; then
    tap_skip load__draws_a_picture 'no gnuplot (apt install gnuplot-nox)'
else
    [ $status -eq 0 ] &&
        gnuplot -e "csv='$work/s.csv'; percentiles='$work/p.csv'; png='$work/plot.png'" \
            "$top_srcdir/client/load/pccd-load.gp" 2>>"$work/plot" &&
        head -c 4 "$work/plot.png" | grep -q PNG
    tap_result $? load__draws_a_picture "$work/plot"
fi

tap_end
