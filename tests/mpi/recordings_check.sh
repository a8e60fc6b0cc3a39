#!/bin/bash
# recordings_check.sh - the steps of recordings, and of frames, over 2, 3 and 8 ranks (in make
# mpi-check: 1, 2, 3, 4 and 8): each done once, and the same said as by pccdctl.

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCDCTL:?}" "${PCCD_DATA?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
# shellcheck source=tests/mpi/ranks.sh
. "$top_srcdir/tests/mpi/ranks.sh"
ranks_rest=yes
# shellcheck source=tests/python/find.sh
. "$top_srcdir/tests/python/find.sh"

all=${PCCD_MPI_ALL:-0}
counts=$([ "$all" = 0 ] && echo 2 3 8 || echo 1 2 3 4 8)
work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-mpi-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log
unset PCCD_URL PCCD_RECORD PCCD_RECORD_OPTIONS
cases='replay_says_what_pccdctl_says verify_says_what_pccdctl_says
    replay_stops_at_the_first_difference run_that_is_killed_goes_on
    run_without_one_rank_ends_and_goes_on torn_line_is_done_again
    results_of_something_else_are_refused missing_file_of_one_rank_is_told
    scenes_by_turns_begin_where_they_stand no_rank_waits_until_another_takes_a_message
    usage_is_told_once'

if [ "${PCCD_MPI:-no}" = no ]; then
    for name in $cases; do
        tap_skip "recordings__$name" "no --with-mpi"
    done
    tap_end
    exit
fi

# ---- recordings ------------------------------------------------------------------------

# Random plays with all that a client does: w, w-2, ... In each, what was answered is there.
plays=4
[ "$all" = 0 ] || plays=40
PCCD_RECORD=$work/w PCCD_RECORD_OPTIONS=contacts=1 ranks 1 \
    "$top_builddir/tests/mpi/same_as_one" $plays 60 5 >"$log" 2>&1 ||
    { cat "$log" && exit 99; }
"$PCCDCTL" record -o "$work/none.rec" -- "$PCCDCTL" ping --url direct: >"$log" 2>&1 ||
    { cat "$log" && exit 99; }
plays=()
for file in "$work"/w "$work"/w-*; do # a play may end before anything is answered
    "$PCCDCTL" verify --url direct: --sample 1 "$file" >"$log" 2>&1
    grep -q 'has an answer to check' "$log" || plays+=("$file")
done

# A sheet of 800 triangles that falls on itself, 24 steps: long, by exact arithmetic.
frame() { # DROP
    awk -v drop="$1" 'BEGIN {
        n = 20
        for (y = 0; y <= n; y++)
            for (x = 0; x <= n; x++)
                print "v", x / n, y / n, (x > n / 2 ? drop * (x / n - 0.5) + y / 512 : 0)
        for (y = 0; y < n; y++)
            for (x = 1; x <= n; x++) {
                v = y * (n + 1) + x
                print "f", v, v + 1, v + n + 2
                print "f", v, v + n + 2, v + n + 1
            }
        print "v 0.7 0.5 0.15\nv 0.9 0.5 0.15\nv 0.9 0.6 0.15"
        v = (n + 1) * (n + 1)
        print "f", v + 1, v + 2, v + 3
    }'
}
frame 0 >"$work/a.obj"
frame 1 >"$work/b.obj"
"$PCCDCTL" record -o "$work/sheet.rec" -- "$PCCDCTL" load --url direct: --threads 1 --times 24 \
    "$work/a.obj" "$work/b.obj" >"$log" 2>&1 || { cat "$log" && exit 99; }
cp "$work/sheet.rec" "$work/other.rec"

program() { # RANKS COMMAND ARGUMENT...
    local count=$1
    shift
    ranks "$count" "$top_builddir/pccd-mpi" "$@"
}

# ---- the same answer -------------------------------------------------------------------

# What pccdctl says of each, in one array, without the time.
one_by_one() { # COMMAND ARGUMENT...
    local file
    for file in "${plays[@]}"; do
        "$PCCDCTL" "$1" --url direct: --json "${@:2}" "$file" || return
    done | grep -v '"seconds"'
}
said() {
    sed 's/^\[{/{/; s/^, {/{/; /^\]$/d' | grep -v '"seconds"'
}
# same COUNTS COMMAND ARGUMENT...: for each number of ranks the report is pccdctl's, and the lines are
# those of one rank.
same() {
    local count numbers=$1 lines=
    shift
    one_by_one "$@" >"$work/one" 2>"$log" || return
    for count in $numbers; do
        rm -f "$work/lines"
        program "$count" "$1" --json --results "$work/lines" "${@:2}" "${plays[@]}" \
            2>"$log" | said >"$work/ranks"
        diff "$work/one" "$work/ranks" >>"$log" || return
        sort "$work/lines" >"$work/sorted"
        [ -n "$lines" ] || cp "$work/sorted" "$work/first"
        lines=$(wc -l <"$work/lines")
        diff "$work/first" "$work/sorted" >>"$log" || return
    done
    [ "$lines" -gt 20 ]
}

# If it failed, the answer would depend on who has computed which step, or on what a rank had
# not seen of the steps before.
same "$counts" replay --keep-going
tap_result $? recordings__replay_says_what_pccdctl_says "$log"

# The same of what exact arithmetic says: of the answers that are recorded, and of new ones.
some=$([ "$all" = 0 ] && echo 3 || echo "$counts")
same "$some" verify --sample 50 --contacts 20 &&
    same "$some" verify --sample 20 --contacts 5 --repeat &&
    # What has no answers is an error, after its report and those before it.
    ! program 2 verify --json --sample 50 "${plays[0]}" "$work/none.rec" >"$work/ranks" 2>"$log" &&
    grep -q 'none.rec: none of 0 steps has an answer to check' "$log" &&
    [ "$(grep -c '"pass": true' "$work/ranks")" -eq 1 ] &&
    [ "$(grep -c '"pass": false' "$work/ranks")" -eq 1 ] && [ "$(tail -n 1 "$work/ranks")" = ']' ]
tap_result $? recordings__verify_says_what_pccdctl_says "$log"

# If it failed, a difference would be reported that is not the first, or be lost in a run that
# goes on. A line that says so stands for a daemon of another kind.
status=0
program 1 replay --results "$work/r" "$work/sheet.rec" >"$log" 2>&1 || status=1
for count in 1 3; do
    grep -v '"step":\(5\|9\|1[0-9]\),' "$work/r" >"$work/r1"
    for step in 5 9; do
        grep "\"step\":$step," "$work/r" |
            sed 's/"outcome":"same","what":""/"outcome":"differs","what":"hash"/' >>"$work/r1"
    done
    program "$count" replay --results "$work/r1" "$work/sheet.rec" >"$work/said$count" 2>>"$log"
    [ $? -eq 1 ] && grep -q '^compared    5 answers .*: 4 the same, 1 not' "$work/said$count" &&
        grep -q '^step 5 has another hash' "$work/said$count" || status=1
    program "$count" replay --keep-going --results "$work/r1" "$work/sheet.rec" \
        >"$work/said$count" 2>>"$log"
    [ $? -eq 1 ] && grep -q '^compared    24 answers .*: 22 the same, 2 not' "$work/said$count" &&
        grep -q '^step 5 has another hash' "$work/said$count" || status=1
done
cat "$work"/said? >>"$log"
tap_result $status recordings__replay_stops_at_the_first_difference "$log"

# Two scenes by turns: in each a needle jumps up and down through a plate, and only where it goes is
# said. If it failed, a rank that does a step of one scene would take the other one, whose steps other
# ranks have done, for where it stood long ago.
name=recordings__scenes_by_turns_begin_where_they_stand
turns_are_the_same() {
    local count
    for count in 1 2 3; do
        program "$count" replay --keep-going "$work/turns" >"$work/said" 2>>"$log"
        cat "$work/said" >>"$log"
        grep -q '^compared    120 answers .*: 120 the same, 0 not' "$work/said" || return
    done
}
if [ -z "$python" ]; then
    tap_skip $name "$no_python"
else
    PCCD_RECORD=$work/turns "$python" - >"$log" 2>&1 <<'EOF' && turns_are_the_same
import numpy as np
import pccd

plate = np.float64([[0, 0, 0], [4, 0, 0], [0, 4, 0]])
needle = np.float64([[1, 1, 0], [1.1, 1, 1], [1, 1.1, 1]])
dice = np.random.default_rng(7)
with pccd.connect("direct:") as client:
    scenes = []
    for _ in range(2):
        scene = client.scene_create()
        client.scene_add(scene, client.mesh_create(plate, [[0, 1, 2]]))
        mesh = client.mesh_create(needle + (0, 0, 2), [[0, 1, 2]])
        scenes.append((scene, client.scene_add(scene, mesh)))
    found = 0
    for step in range(120):
        scene, body = scenes[step % 2]
        height = dice.uniform(0.5, 3) * (-1 if step // 2 % 2 else 1)
        with client.step_x1(scene, body, needle + (0, 0, height)) as answer:
            found += answer.total
    assert found > 100
EOF
    tap_result $? $name "$log"
fi

# If it failed, a rank that has computed a step would do nothing until the root looks for messages,
# and the root until a rank has computed one: MPI_Send may wait until the other side has called MPI.
binary=$top_builddir/pccd-mpi
[ ! -e "$top_builddir/.libs/pccd-mpi" ] || binary=$top_builddir/.libs/pccd-mpi
nm -D --undefined-only "$binary" >"$log" 2>&1 && grep -qw MPI_Isend "$log" &&
    ! grep -w 'MPI_Send\|MPI_Ssend\|MPI_Rsend' "$log"
tap_result $? recordings__no_rank_waits_until_another_takes_a_message "$log"

# ---- runs that end in the middle -------------------------------------------------------

# A rank that says which process it is.
cat >"$work/rank.sh" <<'EOF'
#!/bin/bash
echo $$ >"$1/pid.${OMPI_COMM_WORLD_RANK:-${PMI_RANK:?}}"
echo $PPID >"$1/pid.starter"
shift
exec "$@"
EOF
slow=(verify --sample 2000 --results "$work/k" "$work/sheet.rec")
expected=$(program 2 verify --sample 2000 --results "$work/whole" "$work/sheet.rec" 2>"$log")
# begin: start it over 3 ranks in the background, as $starter; some lines are there afterwards.
begin() {
    rm -f "$work"/pid.* "$work/k"
    ranks 3 bash "$work/rank.sh" "$work" "$top_builddir/pccd-mpi" "${slow[@]}" \
        >"$work/out" 2>"$log" &
    starter=$!
    for _ in {1..2000}; do
        [ -e "$work/k" ] && [ "$(wc -l <"$work/k")" -gt 4 ] && break
        sleep 0.02
    done
    before=$(wc -l <"$work/k")
    echo "$before lines before it ends" >>"$log"
    [ "$before" -gt 4 ] && [ "$before" -lt 25 ]
}
# again: it goes on, with no step done twice, and says what a run says that was not ended.
again() {
    [ "$(program 2 "${slow[@]}" 2>>"$log")" = "$expected" ] && [ -n "$expected" ] &&
        diff <(sort "$work/whole") <(sort "$work/k") >>"$log" &&
        grep -q 'of 24 steps are there; going on' "$log"
}

# If it failed, a farm that loses its power would begin anew, or take a torn line for a result.
begin && kill -9 "$(cat "$work/pid.starter")" "$(cat "$work/pid.0")" "$(cat "$work/pid.1")" \
    "$(cat "$work/pid.2")"
status=$?
wait "$starter" 2>>"$log"
[ $status -eq 0 ] && again
tap_result $? recordings__run_that_is_killed_goes_on "$log"

# If it failed, a rank that dies would leave the others waiting, or its steps undone.
begin && kill -9 "$(cat "$work/pid.1")"
status=$?
wait "$starter" 2>>"$log"
ended=$?
[ $status -eq 0 ] && [ $ended -ne 0 ] && [ $ended -ne 124 ] && again
tap_result $? recordings__run_without_one_rank_ends_and_goes_on "$log"

# If it failed, what a machine leaves that loses its power while it writes would end every run
# that follows, or count as a result; so would a head that is not whole.
head -n 7 "$work/whole" >"$work/k" && head -c 20 "$work/whole" | tail -c 8 >>"$work/k" &&
    again && head -c 15 "$work/whole" >"$work/k" &&
    [ "$(program 2 "${slow[@]}" 2>>"$log")" = "$expected" ] &&
    diff <(sort "$work/whole") <(sort "$work/k") >>"$log"
tap_result $? recordings__torn_line_is_done_again "$log"

# ---- mistakes --------------------------------------------------------------------------

# refused TEXT FILE ARGUMENT...: the file stays as it is.
refused() {
    local text=$1 file=$2
    shift 2
    cp "$file" "$work/copy"
    program 2 "$@" >"$work/out" 2>"$log"
    [ $? -eq 4 ] && grep -q "$text" "$log" && cmp "$file" "$work/copy" >>"$log" && [ ! -s "$work/out" ]
}

# If it failed, results of one thing would pass for those of another, or a file be lost whose
# name was given by mistake.
echo 'my only copy' >"$work/mine"
printf 'also mine' >"$work/mine2"
refused 'other recordings, options' "$work/whole" verify --sample 1999 --results "$work/whole" \
    "$work/sheet.rec" &&
    refused 'other recordings, options' "$work/whole" replay --results "$work/whole" \
        "$work/sheet.rec" &&
    refused 'other recordings, options' "$work/whole" verify --sample 2000 --results "$work/whole" \
        "$work/w" &&
    refused 'is no file of results' "$work/mine" replay --results "$work/mine" "$work/sheet.rec" &&
    refused 'is no file of results' "$work/mine2" replay --results "$work/mine2" "$work/sheet.rec"
tap_result $? recordings__results_of_something_else_are_refused "$log"

# If it failed, a recording that one rank cannot read, or that is another one there, would hang
# the others, or be done without it.
cat >"$work/folder.sh" <<'EOF'
#!/bin/bash
rank=${OMPI_COMM_WORLD_RANK:-${PMI_RANK:?}}
mkdir -p "$1/of$rank" && cp "$1/sheet.rec" "$1/of$rank" || exit 1
[ "$rank" -ne 2 ] || eval "$2"
cd "$1/of$rank" || exit 1
shift 2
exec "$@"
EOF
# told TEXT CHANGE: what is said when rank 2 has changed its copy.
told() {
    RANKS_SECONDS=60 ranks 3 bash "$work/folder.sh" "$work" "$2" "$top_builddir/pccd-mpi" replay \
        sheet.rec >"$work/out" 2>"$log"
    local status=$?
    [ $status -ne 0 ] && [ $status -ne 124 ] && grep -q "^pccd-mpi: rank 2: sheet.rec: $1" "$log"
}
# shellcheck disable=SC2016
told 'No such file' 'rm "$1/of2/sheet.rec"' &&
    told 'it is another recording than on rank 0' 'cp "$1/w" "$1/of2/sheet.rec"'
tap_result $? recordings__missing_file_of_one_rank_is_told "$log"

# If it failed, each rank would print the help, or a script could not tell wrong usage.
program 2 replay --steps 3..1 "$work/sheet.rec" >"$work/out" 2>"$log"
[ $? -eq 2 ] && [ "$(grep -c 'is not A..B' "$log")" -eq 1 ] &&
    program 2 replay --steps 90 "$work/sheet.rec" >"$work/out" 2>"$log"
[ $? -eq 4 ] && grep -q 'no such step; the last one is 24' "$log" &&
    program 2 help verify >"$work/out" 2>"$log" && [ "$(grep -c '^Usage:' "$work/out")" -eq 1 ]
tap_result $? recordings__usage_is_told_once "$log"

# ---- recorded scenes -------------------------------------------------------------------

if [ "$all" = 0 ]; then
    tap_end
    exit
fi
for scene in cloth-funnel cloth-ball n-body-simulation; do
    name=recordings__replay_of_${scene}_is_the_same
    frames=("$PCCD_DATA/$scene"/frames/*.ply)
    if [ ! -e "${frames[0]}" ]; then
        tap_skip "$name" "no frames in \$PCCD_DATA"
        continue
    fi
    rm -f "$work/scene.rec"
    "$PCCDCTL" record -o "$work/scene.rec" -- "$PCCDCTL" load --url direct: --times 20 \
        "${frames[@]}" >"$log" 2>&1
    status=$?
    for count in $counts; do
        program "$count" replay "$work/scene.rec" 2>>"$log" | tee -a "$log" |
            grep -q '^compared    20 answers .*: 20 the same, 0 not' || status=1
    done
    # If one failed, a real scene would have another answer by ranks that see a part of its steps.
    tap_result $status "$name" "$log"
done
tap_end
