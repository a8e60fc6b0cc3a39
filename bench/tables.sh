#!/bin/bash
# tables.sh - ways to take the same steps, side by side: rows for pccd-bench.
#
#   tables.sh [--smoke] [--json] [--threads N] [ROW|SCENE...]   (make bench-tables)

set -u -o pipefail
: "${top_builddir:?is set by make}"

threads=2 json='' smoke='' wanted=()
while [ $# -gt 0 ]; do
    case $1 in
    --smoke) smoke=1 ;;
    --json) json=1 ;;
    --threads) threads=${2:?--threads: how many?}; shift ;;
    -*) echo "tables.sh: $1 is not known" >&2; exit 2 ;;
    *) wanted+=("$1") ;;
    esac
    shift
done

recorded='cloth-ball cloth-ball-fifth n-body n-body-fifth cloth-funnel'
made='cloth-20k cloth crumpled fast-sheet all-overlap nothing-moves teleport'

# What moves of a scene, by turns: all of it, parts, nothing; and with all that stands found anew.
standing='bodies cloth cloth-ball'
moving='--frames=hard+19 --moving=all --beside= --beside=--tuning=still=anew'
for part in objects:0.33 objects:0.1 objects:0.01 patch:0.1 patch:0.01 none; do
    moving+=" --beside=--moving=$part --beside=--moving=${part}_--tuning=still=anew"
done
moving+=' --beside=--moving=vertices:0.01'

# Row | scenes | options. @ in an option is the number of threads.
rows="
modes   | $made $recorded | --method=paper --frames=hard+9 --beside= --beside=--fresh \
    --beside=--mode=first --beside=--mode=any --beside=--mode=pairs
wide    | $recorded | --method=wide --frames=hard+4 --repeat=5 --beside= --beside=--threads=@ \
    --beside=--cpu=avx2 --beside=--mode=first --beside=--method=paper
threads | $recorded breaking bodies | --method=paper --frames=hard+9 --beside= \
    --beside=--threads=@ --beside=--threads=@_--tuning=refit=paper \
    --beside=--threads=@_--tuning=scheduler=paper,refit=paper \
    --beside=--threads=@_--tuning=scheduler=paper,refit=paper,high-level=disjoint
small   | soup-16 soup-64 soup-256 soup-1024 soup-4096 | --frames=15 --repeat=10 \
    --beside=--threads=@_--team
rebuild | exploding breaking bodies cloth-ball-fifth n-body-fifth | --method=paper \
    --rebuild-ratio=-1 --beside=--rebuild-ratio=0.9 --beside=--fresh
standing         | $standing | --via=direct --sends=moved $moving
standing-all     | $standing | --via=direct $moving
standing-daemon  | $standing | --via=daemon --sends=moved $moving
standing-daemon-all | $standing | --via=daemon $moving
standing-threads | $standing | --via=direct --sends=moved --threads=@ $moving
standing-avx2    | $standing | --via=direct --sends=moved --cpu=avx2 $moving
standing-sse4    | $standing | --via=direct --sends=moved --cpu=sse4 $moving
standing-paper   | $standing | --via=direct --sends=moved --method=paper $moving
game    | game | --via=daemon --sends=moved --hz=60 --frames=60-299 --beside= --beside=--sends=all \
    --beside=--via=direct --beside=--threads=@ --beside=--method=paper
thickness | cloth-20k cloth-ball cloth-funnel n-body | --frames=hard --repeat=9 --beside= \
    --beside=--separation=0.001 --beside=--separation=0.01 \
    --beside=--separation=0.01_--approach=0.1 --beside=--separation=0.1
thin    | points points-self hair | --frames=hard --repeat=5 --beside= --beside=--method=paper
poses   | bodies | --via=direct --frames=280-299 --warm-up=150 --beside= --beside=--sends=poses \
    --beside=--method=paper --beside=--method=paper_--sends=poses
direct  | one-triangle cloth-20k cloth-ball-fifth | --frames=hard+4 --repeat=5 --via=daemon \
    --beside=--via=direct --beside=--via=engine
"

# is_wanted NAME SCENE
is_wanted() {
    local item
    [ ${#wanted[@]} -gt 0 ] || return 0
    for item in "${wanted[@]}"; do
        [ "$item" != "$1" ] && [ "$item" != "$2" ] || return 0
    done
    return 1
}

measure() {
    local name=$1 scene=$2 options=() option
    shift 2
    for option; do
        option=${option//@/$threads}
        options+=("${option//_/ }")
    done
    [ -z "$smoke" ] || options+=(--small --frames=hard+1 --repeat=1)
    if [ -n "$json" ]; then
        "$top_builddir/bench/pccd-bench" "${options[@]}" --format json "$scene"
    else
        printf '\n%s: %s\n' "$name" "$scene"
        "$top_builddir/bench/pccd-bench" "${options[@]}" "$scene" | sed -n '/^ms a step (p50)/,$p'
    fi
}

failed=0
while IFS='|' read -r name scenes options; do
    name=${name// /}
    for scene in $scenes; do
        [ -n "$name" ] && is_wanted "$name" "$scene" || continue
        # Recorded scenes have no small ones.
        [ -z "$smoke" ] || [[ " $recorded " != *" $scene "* ]] || continue
        # shellcheck disable=SC2086 # words
        measure "$name" "$scene" $options
        case $? in
        0) ;;
        77) ;; # said by pccd-bench: its frames are not there
        *) failed=1 ;;
        esac
    done
done <<<"${rows//\\$'\n'/}"
exit $failed
