#!/bin/bash
# smoke.sh - the scaling model runs and agrees with itself (TAP).
#
# With a tiny scene; the program itself checks that all work is done once by any number of
# threads, that phases add up, and that no prediction is shorter than its work or its
# longest chain allows. Its times mean nothing here.

set -u -o pipefail
: "${top_srcdir:?is set by make check}" "${top_builddir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT

# If this failed, the replay would lose work or add some.
"$top_builddir/bench/model/model" --smoke --into="$work" >"$work/log" 2>&1
tap_result $? model__agrees_with_itself "$work/log"

# If this failed, a method, a scheduler or a number of threads would be missing from the figures.
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; columns = NF; next }
    { rows[$at["scheduler"] " " $at["high_level"]]++; bad += NF != columns }
    $at["p"] == 1 && $at["speedup"] != "1.000" { print; bad++ }
    END { for (way in rows) { print way, rows[way]; kinds++; bad += rows[way] != 7 }
          exit bad > 0 || kinds != 3 }' "$work/model.csv" >"$work/log"
tap_result $? model__writes_a_row_for_each_way_and_number "$work/log"

# If this failed, what ranks do would not add up, or the model of ranks could not be made anew.
if [ "${PCCD_MPI:-no}" = no ]; then
    tap_skip model__counts_and_models_ranks "no --with-mpi"
else
    bash "$top_srcdir/bench/model/ranks.sh" "$work/ranks" smoke >"$work/log" 2>&1 &&
        awk '/^. 10.9 / { rows++ } END { exit rows < 9 }' "$work/log"
    tap_result $? model__counts_and_models_ranks "$work/log"
fi

tap_end
