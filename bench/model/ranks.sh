#!/bin/bash
# ranks.sh - counts and times what ranks do, and models what many would.
#
#   ranks.sh FOLDER [WHAT]...
#
#   all      count, time, model; where nothing is named
#   count    with up to 64 ranks, more than there are processors: no times
#   large    10 million triangles on 4 and 16 ranks, added to what was counted: 12 GiB, minutes
#   time     with one rank and two; on an idle machine of two processors
#   replay   recordings of 200 steps and of 1000, dealt to one rank and to two, starting
#            included; idle, too. 8 minutes, and for a while 1.2 GB. Not a part of all
#   model    the tables, of what is in FOLDER
#   smoke    tiny: does it still run?

set -u -o pipefail
: "${top_srcdir:?is set by make}" "${top_builddir:=.}"
: "${1:?is where the results go}"
here=$(cd "$top_srcdir/bench/model" && pwd) || exit 1
top_builddir=$(cd "$top_builddir" && pwd) || exit 1
into=$1
# shellcheck source=tests/mpi/ranks.sh
. "$top_srcdir/tests/mpi/ranks.sh"
RANKS_SECONDS=3600
mkdir -p "$into" || exit 1

ball=cloth-ball/frames/cloth_ball
balls=n-body-simulation/frames/balls16_
scenes="layers=80,5,41,21 layers=251,5,41,21 cloth-ball=${ball}92.ply+${ball}93.ply,1,1,21
    n-body=${balls}18.ply+${balls}19.ply,1,1,21 cloth-ball=${ball}92.ply+${ball}93.ply,40,24,21"
counts='1 2 4 8 16 64'
steady=layers=251,5,161,0 # how often ghosts are chosen when it has gone on for long
steady_ranks=8
sheet=sheet=360,5,2,21
large=500
modelled=layers/5
lengths='200 1000' # of recordings
turns=5

# run FILE RANKS SCENE,PARTS,ON,FRO [alone]; a scene that is not here is left out.
run() {
    local words status
    IFS=, read -r -a words <<<"$3"
    ranks "$2" "$top_builddir/bench/model/ranks" "${words[0]/+/,}" "${words[@]:1}" ${4:+"$4"} >"$into/run" 2>"$into/log"
    status=$?
    if grep -q 'no scene' "$into/log"; then
        echo "ranks.sh: skipped, not in \$PCCD_DATA: ${words[0]}" >&2
        return 0
    fi
    [ "$status" -eq 0 ] || { cat "$into/log" >&2; return 1; }
    [ -e "$1" ] || sed 1q "$into/run" >"$1"
    sed 1d "$into/run" >>"$1"
}

count() {
    local file=$into/counts.csv scene number fro
    [ "${1:-}" = more ] || rm -f "$file"
    for scene in $scenes; do
        for number in $counts; do
            # No times, so few steps: cuts take three, and what goes on need not turn.
            case $scene in *,1,21) fro=4 ;; *) fro=0 ;; esac
            run "$file" "$number" "${scene%,*},$fro" || return
        done
    done
    [ "${1:-}" = more ] && return
    rm -f "$into/rates.csv"
    run "$into/rates.csv" "$steady_ranks" "$steady"
}

time_few() {
    local file=$into/times.csv scene
    rm -f "$file"
    { echo "link,value" && ranks 2 "$top_builddir/bench/model/ranks" link; } >"$into/link.csv" || return
    run "$file" 1 "$sheet" && run "$file" 2 "$sheet" || return
    for scene in $scenes; do
        run "$file" 1 "$scene" && run "$file" 2 "$scene" alone && run "$file" 2 "$scene" || return
    done
    rm -f "$into/choices.csv"
    run "$into/choices.csv" 2 "$steady"
}

# Of a rank of two, and of four: MB at most, on the average; triangles.
measure_memory() {
    local number name
    echo "ranks,bytes,triangles"
    for number in 2 4; do
        name=$([ "$number" -eq 2 ] && echo few || echo many)
        ranks "$number" "$top_builddir/tests/mpi/large" "$large" 4 | awk -v ranks="$number" -v name="$name" '
            /^rank/ { sum += $(NF - 1) }
            / triangles,/ { triangles = $3 }
            END { if (!triangles) exit 1
                  printf "%s,%.0f,%d\n", name, sum / ranks * 1048576, triangles / ranks }' || return
    done
}

# What threads of one process would give; it knows nothing of ranks.
model_threads() {
    mkdir -p "$into/threads" &&
        "$top_builddir/bench/model/model" "$@" --wide --into="$into/threads" >"$into/log" &&
        cp "$into/threads/model.csv" "$into/threads.csv"
}

time_all() {
    time_few && measure_memory >"$into/memory.csv" && model_threads "$@"
}

# replay STEPS: of the way between two frames, again and again, each time by its ends.
replay() {
    local recording=$into/replayed turn number begin
    "$top_builddir/pccdctl" record -o "$recording" -- "$top_builddir/pccdctl" check --url direct: \
        --threads 1 --repeat $(($1 - 1)) "$PCCD_DATA/${ball}92.ply" "$PCCD_DATA/${ball}93.ply" >"$into/log"
    [ $? -eq 1 ] || return # something meets
    for ((turn = 0; turn < turns; turn++)); do
        for number in 1 2; do
            begin=$(date +%s%N)
            ranks "$number" "$top_builddir/pccd-mpi" replay --threads 1 "$recording" >"$into/log" || return
            echo "$1,$number,$(($(date +%s%N) - begin))" >>"$into/replays.csv"
        done
    done
    rm -f "$recording"
}

replay_all() {
    local steps
    [ -e "${PCCD_DATA:-}/${ball}92.ply" ] || { echo "ranks.sh: skipped, not in \$PCCD_DATA: $ball" >&2; return 0; }
    echo steps,ranks,ns >"$into/replays.csv"
    for steps in $lengths; do
        replay "$steps" || return
    done
    sed 1d "$into/replays.csv" | sort -t, -n -k1,1 -k2,2 -k3,3 | awk -F, -v turns="$turns" '
        NR % turns == int(turns / 2) + (turns == 1 ? 0 : 1) { seconds[$1, $2] = $3 / 1e9 }
        NR % (2 * turns) == 0 {
            printf "%d steps: %.2f s by one rank, %.2f s by two: each does %.3f of what one does\n",
                $1, seconds[$1, 1], seconds[$1, 2], seconds[$1, 1] / seconds[$1, 2] / 2
        }'
}

model() {
    (cd "$into" && awk -F, -v scene="$modelled" -f "$here/ranks.awk" threads.csv memory.csv link.csv \
        counts.csv rates.csv choices.csv times.csv)
}

shift
for what in "${@:-all}"; do
    case $what in
        all) count && time_all cloth-ball && model ;;
        count) count ;;
        large)
            counts='4 16'
            scenes='layers=792,5,2,1'
            count more
            ;;
        time) time_all cloth-ball ;;
        replay) replay_all ;;
        model) model ;;
        smoke)
            ranks_rest=yes
            counts='1 4'
            scenes='layers=12,5,21,3'
            steady=layers=12,5,61,0
            sheet=sheet=12,5,1,3
            large=100
            lengths=2
            turns=1
            count && time_all --smoke && model && replay_all
            ;;
        *) echo "ranks.sh: unknown: $what" >&2 && false ;;
    esac || exit 1
done
