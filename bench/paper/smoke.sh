#!/bin/bash
# smoke.sh - the paper's evaluation runs from the first step to the last figure (TAP).
#
# With tiny scenes; its times mean nothing here.

set -u -o pipefail
: "${top_srcdir:?is set by make check}" "${top_builddir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log
source=$(cd "$top_srcdir" && pwd)
cd "$top_builddir" || exit 99

evaluate() {
    top_srcdir=$source BENCH_SMOKE=1 BENCH_THREADS=2 \
        "$source/bench/paper/evaluate.sh" "$work/results" "$@" >"$log" 2>&1
}

# If this failed, two ways of a step would have different answers, or none.
evaluate sequence
tap_result $? evaluation__takes_the_sequences "$log"

# If this failed, a speed-up would be to something else than one thread, or a way missing.
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; columns = NF; next }
    { ways[$at["scheduler"] " " $at["p"]]++; bad += NF != columns || $at["ms"] <= 0 }
    $at["p"] == 1 && $at["speedup"] != "1.000" { print; bad++ }
    END { for (way in ways) { kinds++; print way, ways[way]; bad += ways[way] != 3 }
          exit bad > 0 || kinds != 4 }' "$work/results/measured.csv" >"$log"
tap_result $? evaluation__has_every_scene_in_every_way "$log"

# If this failed, Table 1 would lack a scene.
awk -F'|' 'NR > 2 && NF == 11 { rows++ } { print } END { exit rows != 3 }' \
    "$work/results/table1.md" >"$log"
tap_result $? evaluation__writes_table_1 "$log"

# If this failed, nobody could tell how a step compares with the fastest library's.
if [ -x bench/peers/peers ]; then
    evaluate peers && awk -F'|' 'NR > 2 && ($7 <= 0 || $10 <= 0 || NF != 11) { print; bad = 1 }
        END { exit bad || NR < 4 }' "$work/results/peers.md" >>"$log"
    tap_result $? evaluation__compares_steps_with_the_fastest_library "$log"
else
    tap_skip evaluation__compares_steps_with_the_fastest_library "no other library"
fi

# If this failed, nobody could look at the result.
if command -v gnuplot >/dev/null; then
    figures() {
        evaluate model && evaluate figures && (cd "$work/results" &&
            [ "$(find . -name '*.svg' -size +4k | wc -l)" -eq 6 ]) && ! grep -i warning "$log"
    }
    figures
    tap_result $? evaluation__draws_its_figures "$log"
else
    tap_skip evaluation__draws_its_figures "no gnuplot"
fi

tap_end
