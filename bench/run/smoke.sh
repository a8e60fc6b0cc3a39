#!/bin/bash
# smoke.sh - pccd-bench measures the same by all ways, and writes what can be read (TAP).
#
# With a tiny scene; its times mean nothing here.

set -u -o pipefail
: "${top_srcdir:?is set by make check}" "${top_builddir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log

run() {
    "$top_builddir/bench/pccd-bench" --small "$@"
}

# The value of one setting in the head of a CSV.
item() {
    sed -n "s/^# $1: //p" "$2"
}

# If this failed, times of the engine and of a daemon would be of different work.
: >"$log"
for via in engine daemon direct; do
    for method in paper wide; do
        run --via $via --method $method --format csv -o "$work/$via.csv" cloth-20k 2>>"$log" &&
            [ "$(item via "$work/$via.csv")" = $via ] &&
            [ "$(item method "$work/$via.csv")" = $method ] &&
            item hash "$work/$via.csv" || echo "$via $method failed"
    done
done >"$work/hashes"
cat "$work/hashes" >>"$log"
[ "$(wc -l <"$work/hashes")" -eq 6 ] && [ "$(sort -u "$work/hashes" | grep -cE '^2:[0-9a-f]{32}$')" -eq 1 ] &&
    [ "$(sort -u "$work/hashes" | wc -l)" -eq 1 ]
tap_result $? pccd_bench__has_one_hash_by_all_ways "$log"

# If this failed, what breaks would not break in all ways at the same step, or a mesh that is
# replaced have another answer with a daemon; or frames would depend on how they were come by.
for via in engine daemon direct; do
    run --via $via --frames 18-23 --repeat 2 --format csv -o "$work/$via.csv" breaking 2>>"$log" &&
        item hash "$work/$via.csv" || echo "$via failed"
done >"$work/hashes"
cat "$work/hashes" >>"$log"
contacts=$(awk -F, '/^#/ { next }
    !at { for (at = 1; $at != "contacts"; at++); next }
    { sum += $at } END { print sum }' "$work/engine.csv")
echo "$contacts contacts" >>"$log"
[ "$(wc -l <"$work/hashes")" -eq 3 ] && [ "$(sort -u "$work/hashes" | grep -cE '^2:[0-9a-f]{32}$')" -eq 1 ] &&
    [ "$(sort -u "$work/hashes" | wc -l)" -eq 1 ] && [ "$contacts" -gt 0 ]
tap_result $? pccd_bench__replaces_a_mesh_by_all_ways "$log"

# If this failed, a scene would be other steps when it is played again, from the first one on.
: >"$log"
for scene in cloth bodies exploding crumpled; do
    run --repeat 2 --frames 14 --format csv -o "$work/again.csv" "$scene" 2>>"$log" || echo "$scene"
done >"$work/different"
cat "$work/different" >>"$log"
[ ! -s "$work/different" ]
tap_result $? pccd_bench__has_the_same_frames_when_repeated "$log"

# If this failed, steps of which a part moves would be others by another way, or where only what
# moves is handed over; or what stands would move.
: >"$log"
for moving in none objects:0.5 patch:0.05 vertices:0.02 all; do
    for via in engine daemon direct; do
        run --via $via --moving $moving --frames hard+3 --format csv -o "$work/$via.csv" bodies 2>>"$log" &&
            item hash "$work/$via.csv" || echo "$via $moving failed"
        [ $via = engine ] ||
            run --via $via --moving $moving --sends moved --frames hard+3 --format csv \
                -o "$work/$via.csv" bodies 2>>"$log" && item hash "$work/$via.csv" || echo "$via moved failed"
    done | sort -u
done >"$work/hashes"
cat "$work/hashes" >>"$log"
[ "$(wc -l <"$work/hashes")" -eq 5 ] && [ "$(sort -u "$work/hashes" | grep -cE '^2:[0-9a-f]{32}$')" -eq 5 ]
tap_result $? pccd_bench__moves_the_same_part_by_all_ways "$log"

# If this failed, bodies that are handed over as poses would be elsewhere than by positions, or be
# tested against themselves all the same.
run --via engine --frames 100-107 --format csv -o "$work/engine.csv" bodies 2>"$log" &&
    run --via direct --sends poses --frames 100-107 --warm-up 20 --format csv -o "$work/poses.csv" \
        bodies 2>>"$log" &&
    [ "$(item hash "$work/engine.csv")" = "$(item hash "$work/poses.csv")" ] &&
    awk -F, '/^#/ { next }
        !at { for (at = 1; $at != "rigid_objects"; at++); next }
        { rigid += $at } END { exit rigid == 0 }' "$work/poses.csv"
tap_result $? pccd_bench__moves_bodies_by_poses "$log"

# If this failed, a separation would be another length, or another step, by another way.
: >"$log"
for via in engine daemon direct; do
    run --via $via --separation 0.5 --approach 0.1 --frames hard+3 --format csv -o "$work/$via.csv" \
        cloth-20k 2>>"$log" && item hash "$work/$via.csv" || echo "$via failed"
done >"$work/hashes"
run --frames hard+3 --format csv -o "$work/thin.csv" cloth-20k 2>>"$log"
item hash "$work/thin.csv" >>"$work/hashes"
cat "$work/hashes" >>"$log"
[ "$(wc -l <"$work/hashes")" -eq 4 ] && [ "$(sort "$work/hashes" | uniq -c | awk '{ print $1 }' | sort | paste -sd,)" = 1,3 ]
tap_result $? pccd_bench__keeps_features_apart_by_all_ways "$log"

# If this failed, steps would be missing from a figure, or stand under another heading.
run --frames 3-7 --format csv cloth-20k >"$work/steps.csv" 2>"$log" &&
    awk -F, '/^#/ { next }
        !columns { columns = NF; heading = $1 "," $NF; next }
        { rows++; bad += NF != columns || $1 != rows + 2 || $NF !~ /^2:[0-9a-f]+$/ }
        END { exit heading != "frame,hash" || rows != 5 || bad }' "$work/steps.csv"
tap_result $? pccd_bench__writes_a_line_for_each_step "$work/steps.csv"

# If this failed, two ways would not be compared over the same steps, or one would be left out.
run --frames hard+2 --small --format csv --beside '--threads 2 --team' --beside=--fresh \
    --beside=--mode=first bodies >"$work/sides.csv" 2>"$log" &&
    awk -F, '/^#/ { next }
        !columns { columns = NF; heading = $1 "," $2 "," $3; next }
        { rows[$2]++; threads[$2] = $3; hash[$2 == "--mode=first", $1, $NF]; bad += NF != columns }
        END { for (side in rows) { sides++; bad += rows[side] != 3 }
              for (answer in hash) answers++
              exit heading != "frame,side,threads" || sides != 4 || bad || answers != 6 ||
                  threads["--threads 2 --team"] != 2 || threads["--fresh"] != 1 }' "$work/sides.csv"
tap_result $? pccd_bench__takes_each_step_by_all_sides "$work/sides.csv"

# If this failed, a script could not read the result, or warming up and repeating would change
# which steps it is of.
if command -v python3 >/dev/null; then
    run --frames 3-7 --warm-up 0 --repeat 2 --format json -o "$work/steps.json" cloth-20k \
        2>"$log" && python3 - "$work/steps.json" "$(item hash "$work/steps.csv")" \
        "$(item input "$work/steps.csv")" >>"$log" 2>&1 <<'END'
import json, sys
result = json.load(open(sys.argv[1]))
settings, frames = result["settings"], result["frames"]
assert settings["hash"] == sys.argv[2] and settings["input"] == sys.argv[3], settings
assert [frame["frame"] for frame in frames] == [3, 4, 5, 6, 7], frames
counts = result["summary"]["counts"]
assert counts["contacts"]["all"] == sum(frame["counts"]["contacts"] for frame in frames) > 0
assert result["summary"]["ms"]["step"]["max"] == max(frame["ms"]["step"] for frame in frames)
for name in "commit", "compiler", "flags", "cpu", "simd", "method":
    assert settings[name], name
END
    tap_result $? pccd_bench__writes_json_that_adds_up "$log"
else
    tap_skip pccd_bench__writes_json_that_adds_up "no python3"
fi

# If this failed, who mistypes an option would be measuring something else, or not be told which.
: >"$log"
while read -r name options; do
    # shellcheck disable=SC2086 # words
    run $options >"$work/out" 2>"$work/error"
    status=$?
    [ $status -eq 2 ] && grep -q -- "$name" "$work/error" && [ ! -s "$work/out" ] || {
        echo "$options: status $status"
        cat "$work/error"
    } >>"$log"
done <<'END'
--threads --threads 0 cloth-20k
--threads --beside=--threads=0 cloth-20k
--team --via=daemon --team cloth-20k
--rebuild-ratio --rebuild-ratio=2 cloth-20k
--separation --separation=2 cloth-20k
--approach --approach=-1 cloth-20k
--via --via=direct hair
--frames --frames 5-3 cloth-20k
--frames --frames 0-99 cloth-20k
--warm-up --warm-up -1 cloth-20k
--repeat --repeat 0 cloth-20k
--cpu --cpu neon512 cloth-20k
--via --via network cloth-20k
--mode --mode none cloth-20k
--method --method narrow cloth-20k
--tuning --tuning=scheduler=serial cloth-20k
--format --format xml cloth-20k
--moving --moving=some cloth-20k
--moving --moving=objects cloth-20k
--moving --moving=patch:2 cloth-20k
--moving --moving=none:0.1 cloth-20k
--sends --sends=moved cloth-20k
--sends --via=daemon --sends=nothing cloth-20k
--hz --hz=0 cloth-20k
--output --output /nowhere/file cloth-20k
cloth-21k cloth-21k
--list
END
[ ! -s "$log" ]
tap_result $? pccd_bench__names_the_option_that_is_wrong "$log"

tap_end
