#!/bin/bash
# tests/integration/ctl_objects.sh - objects of a file in what check says (TAP).

set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/ctl.sh
. "$top_srcdir/tests/support/ctl.sh"

# A floor; an object of two spikes and another of one, their tips above it; a rod that comes down
# across its side.
frame() { # HEIGHT
    cat <<END
o Floor
v -9 -9 0
v 9 -9 0
v 0 9 0
f 1 2 3
o Spike, "left"
v -1 0 $1
v -1 0 30
v -1 1 30
f 4 5 6
v -1.5 0 $1
v -1.5 0 30
v -1.5 1 30
f 7 8 9
o Spike
v 1 0 $1
v 1 0 30
v 1 1 30
f 10 11 12
o Rod
v -4 -12 $1
v 4 -6 $1
l 13 14
END
}
frame 1 >a.obj
frame -1 >b.obj

# If it failed, who has a scene would be told of features, and not of what they see in it.
check 1 a.obj b.obj && grep -qx 'between    3 pairs of objects' out &&
    grep -A3 '^between' out | tail -n 3 >told &&
    printf '           %s\n' '"Floor", "Spike, "left"": 2' '"Floor", "Rod": 2' \
        '"Floor", "Spike": 1' | cmp - told >>"$log" && [ "$(grep -c '^contacts  *5: 4 ' out)" -eq 1 ]
report objects__that_meet_are_told

# If it failed, a program would have to find them by numbers of features.
check 1 --json a.obj b.obj a.obj && [ "$(grep -c '"objects": \[$' out)" -eq 2 ] &&
    [ "$(tr -d ' \n' <out | grep -o '{"a":"Floor","b":"Spike,\\"left\\"","contacts":2}' | wc -l)" -eq 2 ] &&
    check 1 a.obj b.obj a.obj && [ "$(grep -cx '           "Floor", "Rod": 2' out)" -eq 2 ]
report objects__of_each_step_are_in_the_json

# If it failed, a table would lose its columns at a name, or have them without objects.
check 1 --contacts c.csv a.obj b.obj &&
    [ "$(head -n 1 c.csv)" = kind,i0,i1,i2,i3,toi,toi_hi,proved,object_a,object_b,x,y,z ] &&
    [ "$(grep -c '^vf,.*,1,"Spike, ""left""",Floor,' c.csv)" -eq 2 ] &&
    grep -q '^vf,9,0,1,2,.*,1,Spike,Floor,' c.csv && grep -Eq '^ee,.*,1,(Rod,Floor|Floor,Rod),' c.csv &&
    grep -v '^o ' a.obj >c.obj && grep -v '^o ' b.obj >d.obj && check 1 --contacts d.csv c.obj d.obj &&
    diff <(cut -d, -f1-8 c.csv) <(cut -d, -f1-8 d.csv) >>"$log" && ! grep -q '^between' out
report objects__have_columns_of_their_own

# If it failed, a heap of objects would fill the screen; or what was counted in one page of several
# would be lost.
heap() { # HEIGHT
    printf 'o Floor\nv -9 -9 0\nv 999 -9 0\nv 0 999 0\nf 1 2 3\n'
    for i in {1..40}; do
        printf 'o Needle%d\n' "$i"
        for ((k = 0; k <= i; k++)); do
            printf 'v %d %d %s\nv %d %d 30\nv %d.25 %d 30\nf -3 -2 -1\n' "$i" "$k" "$1" "$i" "$k" "$i" "$k"
        done
    done
}
heap 1 >heap0.obj && heap -1 >heap1.obj
check 1 --result-bytes 65536 heap0.obj heap1.obj && grep -qx 'between    40 pairs of objects' out &&
    grep -A1 '^between' out | grep -qx '           "Floor", "Needle40": 41' &&
    grep -qx '           "Floor", "Needle31": 32' out && ! grep -q 'Needle30' out &&
    grep -qx '           and 30 more pairs of objects' out &&
    check 1 --json heap0.obj heap1.obj && [ "$(grep -c '"b": "Needle' out)" -eq 40 ]
report objects__of_a_heap_are_told_in_part

# If it failed, of what the daemon keeps where there is more, the first page alone would be told.
start_daemon few --contacts-max 3000
ctl check --url "unix:$work/few" --result-bytes 65536 --thickness 0.6 --contacts few.csv heap0.obj heap1.obj
grep -q 'INCOMPLETE: .*keeps' out && [ "$(wc -l <few.csv)" -eq 3001 ]
report contacts__that_are_kept_are_told_to_the_last
kill "$daemon"

# If it failed, two bodies that touch corner to corner would be taken for free, without a word; or
# two names be one.
cat >touch.obj <<'END'
o Leg#1 # the left one
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
o Leg#2
v 0 0 0
v -1 0 0
v 0 -1 0
v 0 0 -1
f 5 7 6
f 5 6 8
f 5 8 7
f 6 7 8
END
check 0 touch.obj touch.obj &&
    grep -qx '           of these 1 joins two objects, which touch there and do not meet: see --weld off' out &&
    check 0 --json touch.obj touch.obj && grep -q '^  "welded_between": 1,' out &&
    check 1 --weld off touch.obj touch.obj && grep -qx '           "Leg#1", "Leg#2": 15' out &&
    check 0 a.obj a.obj && ! grep -q 'joins two objects' out
report objects__that_are_joined_are_told
tap_end
