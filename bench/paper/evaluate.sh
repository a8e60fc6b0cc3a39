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

# Table 1, Figures 1 and 6, what of 7, 8 and 9 can be measured here.
sequence() {
    bench/paper/sequence "${smoke[@]}" --threads "$threads" --csv "$into/sequence.csv.new" \
        >"$into/sequence.txt.new"
    mv "$into/sequence.csv.new" "$into/sequence.csv"
    mv "$into/sequence.txt.new" "$into/sequence.txt"
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
    bench/peers/peers "${smoke[@]}" --json --threads "$threads" >"$into/peers.jsonl"
    keep peers.md awk -f "$scripts/peers.awk" "$into/peers.jsonl"
    rm "$into/peers.jsonl"
}

# Of one scene that is there everywhere.
kernels() {
    keep kernels.txt bench/roofline "${smoke[@]}" breaking
}

# The recorded frames against what is asked of them; none without PCCD_DATA.
steps() {
    keep steps.txt bench/wide "${smoke[@]}"
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
    for figure in cores rates speedup shares components; do
        gnuplot -e "folder='$into'; kind='png'; scripts='$scripts'" "$scripts/$figure.gp"
    done
}

for part in $parts; do
    say "$part"
    "$part"
done
say "done: $into"
