#!/bin/bash
# evaluate.sh - the paper's evaluation (section 7) on this machine, into a folder.
#
# usage: evaluate.sh FOLDER [PART...]
#
# Parts: setup sequence model peers kernels steps growth figures; all unless some are
# named, so that one can be repeated alone. Runs in the build's top folder, with top_srcdir
# set (make bench does it). A part that fails ends it: what was there before stays.

set -eu -o pipefail
: "${top_srcdir:?is set by make bench}"
into=${1:?usage: evaluate.sh FOLDER [PART...]}
shift
parts=${*:-setup sequence model peers kernels steps growth figures}
scripts=$top_srcdir/bench/paper
threads=${BENCH_THREADS:-$(nproc)}
smoke=(${BENCH_SMOKE:+--smoke})
mkdir -p "$into"

# say WHAT: on stderr, with the time since the beginning.
say() {
    printf '%4d s  %s\n' "$SECONDS" "$*" >&2
}

# keep FILE COMMAND...: its standard output into the folder, once it has ended well.
keep() {
    local file=$into/$1
    shift
    "$@" >"$file.new"
    mv "$file.new" "$file"
}

# Commit, compiler, flags, processor and settings.
setup() {
    keep setup.json bench/pccd-bench --format json --frames 0-0 one-triangle
}

# Table 1, Figures 1 and 6, what of 7, 8 and 9 can be measured here: the method paper with
# the paper's scheduler and refit, and the method wide, by 1, 2, 4, .. threads, by turns.
sequence() {
    local scene p sides=() smaller=(${BENCH_SMOKE:+--small --frames=4})
    for ((p = 1; p <= threads; p *= 2)); do
        [ "$p" -eq 1 ] || sides+=("--beside=--threads=$p")
        sides+=("--beside=--method=wide --tuning= --threads=$p")
    done
    {
        echo "scene,triangles,step,method,threads,step_ms,ingest_ms,refit_ms,low_ms,high_ms,"\
"merge_ms,refit_work_ms,low_work_ms,high_work_ms,merge_work_ms,wait_ms,rebuild_ms,"\
"box_tests,candidates,contacts,rebuilds,swaps"
        for scene in cloth breaking bodies; do # in the order of Table 1
            bench/pccd-bench --method=paper --tuning=scheduler=paper,refit=paper --warm-up=3 \
                --format=csv "${sides[@]}" "${smaller[@]}" "$scene" |
                awk -F, -v scene="$scene" -f "$scripts/sequence.awk"
        done
    } >"$into/sequence.csv.new"
    mv "$into/sequence.csv.new" "$into/sequence.csv"
    keep measured.csv awk -F, -f "$scripts/measured.awk" "$into/sequence.csv"
    keep table1.md awk -F, -f "$scripts/table.awk" "$into/measured.csv"
}

# Figures 7 to 9 for up to 64 threads.
model() {
    bench/model/model "${smoke[@]:---sequences}" --into="$into" >"$into/model.txt"
}

peers() {
    if [ ! -x bench/peers/peers ]; then
        say "  left out: configure has found none of Embree, Bullet, FCL, CGAL"
        return 0
    fi
    local set files=()
    for set in avx2 avx512 best; do # of ours; others choose theirs
        case $set in
        avx2) grep -qw avx2 /proc/cpuinfo || continue ;;
        avx512) grep -qw avx512bw /proc/cpuinfo || continue ;;
        best) [ ${#files[@]} -eq 0 ] || continue ;; # where there is neither
        esac
        PCCD_CPU=${set#best} bench/peers/peers "${smoke[@]}" --json --threads "$threads" \
            >"$into/$set.jsonl"
        files+=("$into/$set.jsonl")
    done
    keep peers.md awk -v csv="$into/peers.csv" -f "$scripts/peers.awk" "${files[@]}"
    rm "${files[@]}"
}

# Of one scene that is there everywhere.
kernels() {
    keep kernels.txt bench/pccd-bench kernel roofline "${smoke[@]}" breaking
}

# The recorded steps by the method wide in several ways; none without PCCD_DATA.
steps() {
    keep steps.txt env top_builddir=. bash "$top_srcdir/bench/tables.sh" "${smoke[@]}" \
        --threads "$threads" wide
}

growth() {
    bash "$top_srcdir/bench/growth/growth.sh" "$into" "${smoke[@]}" >"$into/growth.txt"
}

figures() {
    local figure
    if ! command -v gnuplot >/dev/null; then
        say "  left out: no gnuplot (apt-get install gnuplot-nox)"
        return 0
    fi
    for figure in cores rates speedup shares components peers speed; do
        # README's chart is of recorded steps alone.
        [ "$figure" != speed ] || grep -q '^wide: n-body' "$into/steps.txt" 2>/dev/null || continue
        gnuplot -e "folder='$into'; kind='svg'; scripts='$scripts'" "$scripts/$figure.gp"
    done
}

for part in $parts; do
    say "$part"
    "$part"
done
say "done: $into"
