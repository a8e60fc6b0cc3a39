#!/bin/bash
# smoke.sh - growth is measured, fitted and drawn (TAP).
#
# With tiny scenes; the times mean nothing here.

set -u -o pipefail
: "${top_srcdir:?is set by make check}" "${top_builddir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT

# If this failed, the growth figures could not be made anew.
bash "$top_srcdir/bench/growth/growth.sh" --smoke "$work/out" >"$work/log" 2>&1
tap_result $? growth__is_measured_and_fitted "$work/log"

# If this failed, a size would be missing, or scenes of different sizes would not be alike.
awk -F, 'NR > 1 && $1 == "wide" { rows++; least = !least || $3 < least ? $3 : least
        if (!($4 / $3 > 0.05 && $4 / $3 < 0.5)) { print "contacts a triangle", $4 / $3; bad = 1 } }
    END { if (rows != 3 || least > 1100) { print rows, least; bad = 1 } exit bad }' \
    "$work/out/size.csv" >"$work/log"
tap_result $? growth__has_alike_scenes_of_each_size "$work/log"

# If this failed, answers about what is near would not be measured, or be empty.
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
    { rows++; if (!($at["near_ms"] > 0 && $at["near_features"] > 0.01 * $at["triangles"] &&
            $at["near_bytes"] > 0)) { print; bad = 1 } }
    END { exit bad || rows == 0 }' "$work/out/size.csv" >"$work/log"
tap_result $? growth__asks_what_is_near "$work/log"

# If this failed, an exponent would not be that of the points.
{
    echo "way,x,y"
    for x in 0 1 10 100 1000 10000; do
        awk -v x=$x 'BEGIN { printf "a,%d,%.6f\nb,%d,9\n", x, 5 + 3 * x ^ 1.5, x }'
    done
} >"$work/known.csv"
got=$(awk -F, -f "$top_srcdir/bench/growth/fit.awk" x=x y=y only=a minus=1 "$work/known.csv")
[ "$got" = "y,x,1.500,3,3" ]
tap_result $? growth__fits_a_known_exponent <(echo "got $got")

tap_end
