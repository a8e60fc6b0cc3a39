#!/bin/bash
# counted.sh - is there more work in a step than there was? By counting, not by the clock.
#
#   counted.sh            the small set against baseline.csv (TAP; a part of make check)
#   counted.sh quick      every scene, with times, and instructions under callgrind
#   counted.sh baseline   the same, and write baseline.csv
#
# Fixed steps of fixed scenes, by one thread. More than 3 % more of anything fails; contacts
# must be equal. Instructions depend on machine and compiler, so they are compared only where
# the baseline was made with the same.

set -u -o pipefail
: "${top_srcdir:?is set by make}" "${top_builddir:?is set by make}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

mode=${1-check}
baseline=$top_srcdir/bench/counted/baseline.csv
bench=$top_builddir/bench/pccd-bench
work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
export GOMP_SPINCOUNT=2000 # else pccd-bench starts itself anew, with it
worse=0

# Set, scene, steps. The first set takes seconds; the recorded scenes need $PCCD_DATA.
scenes='
check cloth-20k 60-63
check crumpled 0-3
check fast-sheet 0-3
check all-overlap 0-3
check nothing-moves 0-3
check teleport 0-3
quick cloth 150-153
quick breaking 240-243
quick bodies 280-283
quick exploding 40-43
quick cloth-ball 0-0
quick cloth-ball-fifth 0-4
quick cloth-funnel 0-0
quick n-body 0-0
quick n-body-fifth 0-4
'
methods='wide paper'

# ---- counting -------------------------------------------------------------------------

# Lines "scene,method,steps,counter,value" from a CSV of pccd-bench: sums over the steps, of
# what is resident the most. Subtrees that are made in the background, as far as time allows, are not
# counted, nor what depends on which they were.
totals() {
    awk -F, -v name="$2,$3,$4" '
        /^# (input|hash): / { split($0, item, ": "); print name "," substr(item[1], 3) "," item[2] }
        /^#/ { next }
        !columns { columns = NF; for (i = 1; i <= NF; i++) heading[i] = $i; next }
        { for (i = 1; i <= NF; i++)
            if (heading[i] == "scene_bytes") sum[i] = $i > sum[i] ? $i : sum[i]
            else sum[i] += $i }
        END {
            fixed = "^(box_tests|leaf_pairs|candidates|elementary_tests|survivors|" \
                "exact_queries|contacts|scene_bytes)$"
            for (i = 1; i <= columns; i++)
                if (heading[i] == "swaps")
                    has_swaps = sum[i] > 0
            for (i = 1; i <= columns; i++)
                if (heading[i] ~ fixed ||
                    heading[i] ~ /^(reconstructed_triangles|allocations)$/ && !has_swaps)
                    printf "%s,%s,%d\n", name, heading[i], sum[i]
        }' "$1"
}

# The median step in a CSV of pccd-bench.
median_ms() {
    grep -v '^#' "$1" | sed 1d | cut -d, -f3 | sort -g |
        awk '{ v[NR] = $1 } END { printf "%.4g", v[int(NR / 2) + 1] }'
}

# SCENE STEPS METHOD: 0, or 77 when its frames are not there.
count() {
    "$bench" --method "$3" --frames "$2" --format csv -o "$work/steps.csv" "$1" 2>"$work/log" ||
        return
    totals "$work/steps.csv" "$1" "$3" "$2" >"$work/now"
}

# ---- comparing ------------------------------------------------------------------------

# Prints what differs between the rows of $work/now and the baseline; fails when there is more
# work, or another answer. With other positions than the baseline's, which another C library's
# sines make, the answer may be another, but not by 3 %.
compare() {
    awk -F, '
        { key = $1 " " $2 " " $3 " " $4 }
        NR == FNR { if (!/^#/) { before[key] = $5; known[$1 " " $2 " " $3] = 1 }; next }
        { now[++rows] = $4; value[$4] = $5; name = $1 " " $2 " " $3 }
        END {
            if (!known[name]) {
                print name ": not in the baseline: make bench-baseline"
                exit 1
            }
            same = value["input"] == before[name " input"]
            if (value["input"] != "" && !same)
                print name ": made of other positions than the baseline"
            for (i = 1; i <= rows; i++) {
                counter = now[i]
                old = before[name " " counter]
                new = value[counter]
                if (counter == "input" || new == old)
                    continue
                if (!((name " " counter) in before)) {
                    print name ": " counter " " new ", not in the baseline"
                    continue
                }
                if (counter == "hash") {
                    if (same) { print name ": another answer: hash " old ", now " new; bad = 1 }
                    continue
                }
                change = old > 0 ? 100 * (new - old) / old : 100
                text = sprintf("%s: %s %d, now %d (%+.1f %%)", name, counter, old, new, change)
                if (counter == "contacts" && (same || change > 3 || change < -3) || change > 3) {
                    print text ": worse"
                    bad = 1
                } else if (change < -3)
                    print text ": better: commit the new baseline with make bench-baseline"
                else
                    print text
            }
            exit bad
        }' "$baseline" "$work/now"
}

# NAME: a line of the table, or of TAP. Status: of the comparison.
tell() {
    if [ "$mode" = check ]; then
        tap_result "$1" "counted_${2// /_}__does_no_more_work" "$work/differences"
        [ "$1" -ne 0 ] || sed 's/^/# /' "$work/differences"
        return
    fi
    printf '%-28s %10s  %s\n' "$2" "$3" \
        "$([ -s "$work/differences" ] || echo 'as the baseline')"
    sed 's/^/    /' "$work/differences"
    [ "$1" -eq 0 ] || worse=$((worse + 1))
}

skip() {
    if [ "$mode" = check ]; then
        tap_skip "counted_${1// /_}__does_no_more_work" "$2"
    else
        printf '%-28s %10s  skipped: %s\n' "$1" - "$2"
    fi
}

one_scene() {
    count "$1" "$2" "$3"
    case $? in
    0) ;;
    77)
        skip "$1 $3" "$(sed 's/^[^"]*//' "$work/log")"
        return
        ;;
    *)
        cp "$work/log" "$work/differences"
        tell 1 "$1 $3" -
        return
        ;;
    esac
    if [ "$mode" = baseline ]; then
        cat "$work/now" >>"$work/baseline"
    else
        compare >"$work/differences"
        tell $? "$1 $3" "$(median_ms "$work/steps.csv") ms"
    fi
}

# ---- instructions ---------------------------------------------------------------------

# What the number of instructions depends on, but for the sources.
toolchain() {
    sed -n 's/^# compiler: //p; s/^# flags: //p' "$work/steps.csv" |
        sed 's/-W[^ ]*//g; s/  */ /g; s/^ //; s/ $//' | paste -sd '|'
}

# METHOD: of the steps of a small scene, with what they copy in. valgrind knows no AVX-512.
instructions() {
    local cpu=sse4
    ! grep -qw avx2 /proc/cpuinfo || cpu=avx2
    "$top_builddir/libtool" --mode=execute valgrind --tool=callgrind \
        --toggle-collect=bench_world_step --callgrind-out-file=/dev/null \
        "$bench" --small --cpu $cpu --method "$1" --frames 22-25 --format csv \
        -o "$work/steps.csv" breaking >"$work/log" 2>&1 || return
    sed -n "s/.*Collected *: *\([0-9]*\).*/breaking-small,$1-$cpu,22-25,instructions,\1/p" \
        "$work/log" >"$work/now"
    [ -s "$work/now" ]
}

one_count_of_instructions() {
    if ! command -v valgrind >/dev/null; then
        skip "instructions $1" "valgrind is not installed"
    elif ! instructions "$1"; then
        cp "$work/log" "$work/differences"
        tell 1 "instructions $1" -
    elif [ "$mode" = baseline ]; then
        echo "# instructions: $(toolchain)" >>"$work/baseline"
        cat "$work/now" >>"$work/baseline"
    elif ! grep -qxF "# instructions: $(toolchain)" "$baseline"; then
        skip "instructions $1" "the baseline's are of another compiler or other flags"
    elif ! grep -q "^$(cut -d, -f1-3 "$work/now")," "$baseline"; then
        skip "instructions $1" "the baseline's are of another instruction set"
    else
        compare >"$work/differences"
        tell $? "instructions $1" -
    fi
}

# ---- all of it ------------------------------------------------------------------------

# Recorded scenes that are not here keep their rows.
write_baseline() {
    {
        echo '# baseline.csv - counted work of one thread; make bench-baseline writes it.'
        echo 'scene,method,steps,counter,value'
        cat "$work/baseline"
        while read -r _ scene _; do
            grep -q "^$scene," "$work/baseline" || grep "^$scene," "$baseline"
        done <<<"${scenes:1}"
    } 2>/dev/null >"$work/new"
    mv "$work/new" "$baseline" && echo "$baseline: $(grep -c , "$baseline") rows"
}

while read -r set scene steps; do
    [ "$mode" != check ] || [ "$set" = check ] || continue
    for method in $methods; do
        one_scene "$scene" "$steps" "$method"
    done
done < <(printf '%s' "$scenes" | sed '/^$/d')
if [ "$mode" = check ]; then
    tap_end
    exit
fi
for method in $methods; do
    one_count_of_instructions "$method"
done
if [ "$mode" = baseline ]; then
    write_baseline
elif [ "$worse" -gt 0 ]; then
    echo "more work than the baseline's: $worse"
    exit 1
fi
