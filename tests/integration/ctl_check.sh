#!/bin/bash
# tests/integration/ctl_check.sh - pccdctl against real daemons.

set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/ctl.sh
. "$top_srcdir/tests/support/ctl.sh"

# meets ARGUMENT...: a check that says that something meets, which is no mistake of it.
meets() {
    ctl check "$@"
    [ $? -eq 1 ]
}

# ---- files --------------------------------------------------------------------------

# A triangle in the plane z = 0 and one above it that moves down by 2; its lowest corner,
# vertex 3, passes the first triangle at t = 1/2, the others stay above.
ply_frame() { # DROP
    cat <<PLY
ply
format ascii 1.0
element vertex 6
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0.25 0.25 $((1 - $1))
0.25 0.25 $((4 - $1))
0.375 0.25 $((4 - $1))
3 0 1 2
3 3 4 5
PLY
}
obj_frame() { # DROP
    printf 'v %s\n' '0 0 0' '1 0 0' '0 1 0' "0.25 0.25 $((1 - $1))" \
        "0.25 0.25 $((4 - $1))" "0.375 0.25 $((4 - $1))"
    printf 'f 1 2 3\nf -3 -2 -1\n'
}
ply_frame 0 >t0.ply
ply_frame 2 >t1.ply
obj_frame 0 >t0.obj
obj_frame 2 >t1.obj

# A stack of 40 sheets and 40 needles that pass all of them: at least 1600 contacts.
stack_frame() { # DROP
    awk -v drop="$1" 'BEGIN {
        n = 40
        print "ply\nformat ascii 1.0\nelement vertex " 6 * n
        print "property double x\nproperty double y\nproperty double z"
        print "element face " 2 * n "\nproperty list uchar int vertex_indices\nend_header"
        for (i = 0; i < n; i++) {
            z = -i / 64
            print 0, 0, z; print 4, 0, z; print 0, 4, z
        }
        for (i = 0; i < n; i++) {
            x = 0.25 + i / 64; y = 0.25 + i % 7 / 8
            print x, y, 1 - drop; print x, y, 5 - drop; print x + 1 / 128, y, 5 - drop
        }
        for (i = 0; i < 2 * n; i++)
            print 3, 3 * i, 3 * i + 1, 3 * i + 2
    }'
}
stack_frame 0 >s0.ply
stack_frame 3 >s1.ply

# ---- check --------------------------------------------------------------------------

meets t0.ply t1.ply &&
    says '^mesh +6 vertices, 6 edges, 2 triangles$' '^contacts +1: 1 vertex-face, 0 edge-edge$' \
        '1 proved, 0 possible; 0 touch at the start' '^first at +t = 0\.5: ' '^safe step +0\.4999$' \
        '^answer +complete$' '^hash +2:[0-9a-f]{32}$' 'median of 1 after one to warm up' \
        '^  build ' '^  ingest ' '^  refit ' '^  traversal ' '^  tests ' '^  merge ' '^  step '
report "check prints the summary"

# The vertex, then the triangle's three; the time within the tolerance around 1/2; the place.
known_contact() { # FILE
    awk -F, 'NR == 1 { good = $0 == "kind,i0,i1,i2,i3,toi,toi_hi,proved,x,y,z" }
        NR == 2 { good = good && $1 == "vf" && $2 == 3 && $3 == 0 && $4 == 1 && $5 == 2 &&
                  $6 <= 0.5 && $7 >= 0.5 && $7 - $6 <= 1e-6 && $8 == 1 &&
                  $9 == 0.25 && $10 == 0.25 && $11 == 0 }
        END { exit !(good && NR == 2) }' "$1"
}
meets --contacts contacts.csv t0.ply t1.ply && known_contact contacts.csv
report "check --contacts writes the known contact"

meets --contacts - t0.ply t1.ply && known_contact out &&
    grep -qE '^contacts +1: 1 vertex-face' err
report "check --contacts - keeps the report off the standard output"

meets --json --repeat 3 t0.ply t1.ply &&
    [ "$(json_value vertices)" = 6 ] && [ "$(json_value edges)" = 6 ] &&
    [ "$(json_value triangles)" = 2 ] && [ "$(json_value contacts)" = 1 ] &&
    [ "$(json_value vf)" = 1 ] && [ "$(json_value ee)" = 0 ] &&
    [ "$(json_value possible)" = 0 ] && [ "$(json_value complete)" = true ] &&
    [ "$(json_value repeat)" = 3 ] && [ "$(json_value allocs)" = 0 ] &&
    [ "$(json_value builds)" = 0 ] &&
    says '"toi_first": 0\.(5|4999)' '"hash": "2:[0-9a-f]{32}"' '"build": [0-9]' \
        '"ingest": [0-9]' '"refit": [0-9]' '"traversal": [0-9]' '"tests": [0-9]' \
        '"merge": [0-9]' '"step": [0-9]'
report "check --json has the promised keys, and a warm step builds and allocates nothing"

# The vertex begins 1 above the face and comes down by 2. Its distance is 2 R = 0.5 at a
# quarter, and half of what it began with there, too.
meets --thickness 0.25 t0.ply t1.ply && says '^safe step +0\.2(5|499)' &&
    meets --json --thickness 0.25 t0.ply t1.ply &&
    says '"toi_first": 0\.2(5|4999)' '"safe_step": 0\.2(5|4999)' &&
    [ "$(json_value inside)" = 0 ] && [ "$(json_value crowded)" = false ] &&
    meets --json --separation 0.5 t0.ply t1.ply && says '"safe_step": 0\.2(5|4999)' &&
    meets --json --thickness 2 t0.ply t1.ply && says '"safe_step": 0\.0,' &&
    [ "$(json_value crowded)" = true ] &&
    meets --thickness 2 t0.ply t1.ply && says '^warning .*thickness' &&
    meets --json --thickness 2.5 --approach 0.5 t0.ply t1.ply &&
    says '"safe_step": 0\.2(5|4999)' && [ "$(json_value inside)" -gt 0 ] &&
    meets --json --thickness 0.25 --rings 2 --rest-exclusion 2 t0.ply t1.ply &&
    says '"toi_first": 0\.(5|4999)' &&
    fails 2 thickness check --thickness nan t0.ply t1.ply &&
    fails 2 approach check --approach 1 t0.ply t1.ply &&
    fails 2 rings check --rings 9 t0.ply t1.ply
report "check has thickness, separation, approach and what rest excludes"

# If it failed, a report would say when something meets first, and nobody would know where: in
# text, a line a step, and JSON; with names where there are names; of an edge its vertices.
bar() { # Z: that of an edge which crosses another one in (0.5, 0, 0) when it is 0
    printf 'o bar\nv -1 0 0\nv 3 0 0\nv 1 -9 -9\nf 1 2 3\no rail\nv 0.5 -1 %s\nv 0.5 1 %s\nv 9 9 %s\nf 4 5 6\n' \
        "$1" "$1" $(($1 + 9))
}
bar 1 >bar0.obj
bar -1 >bar1.obj
meets t0.ply t1.ply &&
    says '^first at +t = 0\.[0-9]+: vertex 3 meets face 0 at \(0\.25, 0\.25, 0\)$' &&
    meets t0.ply t1.ply t0.ply &&
    says '^ +2  .*, first at 0\.5: vertex 3 meets face 0 at \(0\.25, 0\.25, 0\), begins crossed' &&
    meets bar0.obj bar1.obj &&
    says '^first at .*: edge 0-1 of "bar" meets edge 3-4 of "rail" at \(0\.5, 0, [-0-9.e]+\)$' &&
    meets --json bar0.obj bar1.obj && tr -d ' \n' <out | grep -qE \
    '"first":\{"a":\{"object":"bar","edge":\[0,1\]\},"b":\{"object":"rail","edge":\[3,4\]\},"at":\[0\.5,0\.0,'
report "check says where something meets first, in text and JSON"

# Where vertex 3 has come to at toi, in the doubles of its record, and where it touches the face; to
# the last bit. If it failed, whoever draws contacts would have to guess which rule we use.
meets --contacts plain.csv t0.ply t1.ply t0.ply &&
    meets --geometry --contacts places.csv t0.ply t1.ply t0.ply && python3 - <<'PYTHON'
import csv
plain, places = (list(csv.reader(open(name))) for name in ("plain.csv", "places.csv"))
assert [row[:9] for row in places] == [row[:9] for row in plain], places
assert [row[9:] for row in plain] == ["x y z".split()] + [row[14:17] for row in places[1:]], plain
assert places[0][9:] == "object_a object_b ax ay az bx by bz nx ny nz".split()
first, second = ([float(value) for value in row[11:]] for row in places[1:])
toi = float(places[1][6])
assert first == [0.25, 0.25, 1 + toi * -2, 0.25, 0.25, 0, 0, 0, 1], first
toi = float(places[2][6])
assert second == [0.25, 0.25, -1 + toi * 2, 0.25, 0.25, 0, 0, 0, -1], second
assert places[1][9:11] == ["t0", "t0"]
PYTHON
[ $? -eq 0 ] && meets --geometry --contacts bars.csv bar0.obj bar1.obj && python3 - <<'PYTHON'
import csv
row = next(row for row in csv.DictReader(open("bars.csv"))
           if [row["i0"], row["i1"], row["i2"], row["i3"]] == ["0", "1", "3", "4"])
assert row["object_a"] == "bar" and row["object_b"] == "rail"
a, b, n = ([float(row[side + axis]) for axis in "xyz"] for side in "abn")
assert a == [0.5, 0, 0] and b == [0.5, 0, 1 + float(row["toi"]) * -2] and n == [0, 0, -1]
PYTHON
[ $? -eq 0 ] && meets --mode pairs --geometry --contacts - t0.ply t1.ply &&
    grep -qx 'vf,3,0,1,2,,,0,t0,t0,,,,,,,,,' out &&
    fails 2 'of the contacts that --contacts writes' check --geometry t0.ply t1.ply
report "check --geometry writes where contacts are, and leaves the other columns as they were"

# Surfaces that pass through each other from the first frame to the last have no contact:
# if that were all that is said, they would be taken for free. Nothing of a box inside a
# box passes through anything, and check says nothing of it (near --what depth does).
stands() { # FILE SPIKE_Z
    printf 'v %s\n' '-30 -30 0' '30 -30 0' '0 30 0' "0 0 $2" '1 0 6' '0 1 6' >"$1"
    printf 'f %s\n' '1 2 3' '4 5 6' >>"$1"
}
stands crossed0.obj -2
stands crossed1.obj -2
stands crossed2.obj -1.5
stands apart.obj 1
boxes() { # SIZE
    for low in 0 1; do
        awk -v low=$low 'BEGIN { high = 4 - low; for (i = 0; i < 8; i++)
            print "v", (i % 2 ? high : low), (int(i / 2) % 2 ? high : low), (i > 3 ? high : low) }'
    done
    for first in 1 9; do
        awk -v first=$first 'BEGIN { n = split("021132456576014415236637042246135357", c, "")
            for (i = 1; i <= n; i += 3) print "f", c[i] + first, c[i + 1] + first, c[i + 2] + first }'
    done
}
boxes >boxes.obj
meets crossed0.obj crossed1.obj && says '^begins +crossed 2 times: ' '^contacts +0: ' \
    '^first at +the start, where it is crossed$' '^safe step +0$' && ! grep -q never out &&
    meets --json crossed0.obj crossed1.obj && [ "$(json_value crossings)" = 2 ] &&
    [ "$(json_value start_inside)" = 0 ] && says '"safe_step": 0\.0,' '"toi_first": null' &&
    meets --mode any crossed0.obj crossed1.obj && says '^begins +crossed 2 ' '^contact +yes$' &&
    meets --mode any --json --url direct: --method paper crossed0.obj crossed1.obj &&
    says '"verdict": "yes"' && [ "$(json_value crossings)" = 2 ] &&
    meets crossed0.obj crossed1.obj crossed2.obj && says 'crossed1.obj: 0 .*, begins crossed 2 times' &&
    ctl check apart.obj apart.obj && says '^first at +never$' '^safe step +1$' && ! grep -q begins out &&
    meets --approach 0.5 --separation 100 apart.obj apart.obj && says '^begins +inside 15 times' \
        '^first at +the start, where it is inside' &&
    ctl check boxes.obj boxes.obj && ! grep -q begins out
report "check says how a step begins that is crossed or inside, and does not call it free"

# A box at height Z on a floor of four squares.
box_on_floor() { # Z
    printf 'v %s\n' '0 0 0' '2 0 0' '4 0 0' '0 2 0' '2 2 0' '4 2 0' '0 4 0' '2 4 0' '4 4 0'
    awk -v z="$1" 'BEGIN { for (i = 0; i < 8; i++)
        print "v", (i % 2 ? 3 : 1), (int(i / 2) % 2 ? 3 : 1), (i > 3 ? 2 : 0) + z }'
    printf 'f %s\n' '1 2 5 4' '2 3 6 5' '4 5 8 7' '5 6 9 8' '10 12 13 11' '14 15 17 16' \
        '10 11 15 14' '12 16 17 13' '10 14 16 12' '11 13 17 15'
}
for z in 0 1 -1; do
    box_on_floor $z >"box$z.obj"
done
meets box0.obj box1.obj && says '^contacts +36: ' '^safe step +0$' && ! grep -q '^touching' out &&
    meets --touching told box0.obj box1.obj && says '^contacts +36: ' '^safe step +0$' \
        '^touching +36 at t = 0: 0 enter, 0 slide, 36 leave$' &&
    meets --touching told --contacts box.csv box0.obj box1.obj &&
    head -1 box.csv | grep -q ',proved,x,y,z,touching$' && [ "$(grep -c ',leaves$' box.csv)" = 36 ] &&
    ctl check --touching left-out box0.obj box1.obj && says '^contacts +0: ' '^safe step +1$' &&
    ctl check --touching left-out --mode any --method paper box0.obj box1.obj &&
    ctl check --touching left-out --json --url direct: box0.obj box1.obj &&
    [ "$(json_value leaving)" = 36 ] && [ "$(json_value entering)" = 0 ] &&
    ctl check --touching left-out box0.obj box0.obj &&
    says '^touching +36 at t = 0: 0 enter, 36 slide, 0 leave$' &&
    meets --touching left-out box0.obj box-1.obj && says '^safe step +0$' &&
    meets --touching left-out box0.obj box0.obj box1.obj box-1.obj &&
    says 'box1.obj: 0 .*, 0 enter, 0 slide, 36 leave, ' &&
    ! ctl check --touching left box0.obj box1.obj &&
    ctl check --touching left-out --results box.certificate box0.obj box0.obj box1.obj &&
    says '^verdict +free: nothing enters what it touches, or meets, at frames or between them' &&
    ctl verify box.certificate box0.obj box0.obj box1.obj &&
    ctl record -o box.rec --contacts -- "$PCCDCTL" check --touching left-out box0.obj box1.obj &&
    ctl verify box.rec && ctl replay box.rec && says ' the same, 0 not$'
report "check lets a box go that leaves its floor, and none that goes in"

# What is nearer than its thickness and goes away would never be free, or be called one that keeps
# it; what comes nearer still would be.
for z in 0.125 1 0.0625; do
    box_on_floor $z >"near$z.obj"
done
meets --thickness 0.25 near0.125.obj near1.obj && says '^safe step +0$' &&
    ctl check --thickness 0.25 --touching left-out near0.125.obj near1.obj && says '^contacts +0: ' '^safe step +1$' \
        '^touching +[1-9][0-9]* at t = 0: 0 enter, ' '; thickness not kept by what slides or leaves$' &&
    meets --thickness 0.25 --touching left-out near0.125.obj near0.0625.obj && says '^safe step +0$' &&
    for mode in all first any first-per-pair; do
        for to in near0.125 near1 near0.0625; do
            ctl record -o near.rec --contacts -- "$PCCDCTL" check --mode $mode --thickness 0.25 \
                --touching left-out near0.125.obj $to.obj
            ctl verify near.rec && ! grep -q 'not checked' out err || echo "$mode $to" >>wrong
        done
    done && [ ! -e wrong ]
report "check lets go what is nearer than its thickness and does not come nearer"

# A tip that slides over a side of what it touches is a contact there; if that were not checked, it
# could be told at any time.
printf 'v %s\n' '-4 -4 0' '4 -4 0' '0 4 0' '0 0 0' '0 1 2' '1 0 2' >slide0.obj
printf 'v %s\n' '-4 -4 0' '4 -4 0' '0 4 0' '6 0 0' '6 1 2' '7 0 2' >slide1.obj
printf 'f %s\n' '1 2 3' '4 5 6' | tee -a slide0.obj >>slide1.obj
for mode in all first any; do
    ctl record -o slide.rec --contacts -- "$PCCDCTL" check --mode $mode --touching left-out slide0.obj slide1.obj
    ctl verify slide.rec && ! grep -q 'not checked' out err || echo "slide $mode" >>wrong
done
meets --touching left-out slide0.obj slide1.obj && says '^contacts +3: ' '^first at +t = 0\.3333: vertex 3 meets face 0 ' '^touching +1 at t = 0: 0 enter, 1 slides' &&
    [ ! -e wrong ]
report "verify knows when what slides meets again"

# A body that crosses itself in each of its frames: not one step of it is free, also those
# that have no contact.
kick=${PCCD_DATA:-}/kick
title="check says of each step of a recorded body how often it begins crossed"
if [ -e "$kick/kick.pc2" ] && [ -e "$kick/kick.obj" ]; then
    ctl near --what crossings --json "$kick/kick.obj" && first=$(json_value crossings) &&
        meets "$kick/kick.obj" "$kick/kick.pc2" &&
        says "^ +1  .*, begins crossed $first times, " '^ +4  .*: 0 \(.*, begins crossed ' &&
        [ "$(grep -cE ', begins crossed 49[0-9] times, ' out)" = 24 ]
    report "$title"
else
    tap_skip "$title" "no kick in \$PCCD_DATA"
fi

# A cloud of three points comes down on a triangle, a rod and a point, at R each: VF at
# any distance, VE and VV where there is one.
rods='v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 10 0 0\nv 11 0 0\nl 4 5\nv 20 0 0\np 6\n'
cloud='v 0.25 0.25 Z\nv 10.5 0 Z\nv 20 0 Z\np 7 8 9\n'
printf "$rods${cloud//Z/1}" >rods0.obj
printf "$rods${cloud//Z/-1}" >rods1.obj
printf 'ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n%s' \
    $'property float z\nend_header\n0 0 0\n0 0 1\n' >cloud0.ply
sed 's/^0 0 1$/0 0 0.25/' cloud0.ply >cloud1.ply
meets --thickness 0.25 rods0.obj rods1.obj &&
    says '^free +1 edge, 4 points' \
        '^contacts +3: 1 vertex-face, 0 edge-edge, 1 vertex-edge, 1 vertex-vertex' &&
    meets --json --thickness 0.25 --method paper rods0.obj rods1.obj &&
    [ "$(json_value ve)" = 1 ] && [ "$(json_value vv)" = 1 ] &&
    [ "$(json_value free_edges)" = 1 ] && [ "$(json_value free_points)" = 4 ] &&
    meets rods0.obj rods1.obj && says '^contacts +1: 1 vertex-face, 0 edge-edge$' &&
    meets --json --thickness 0.25 cloud0.ply cloud1.ply &&
    [ "$(json_value vv)" = 1 ] && [ "$(json_value triangles)" = 0 ] &&
    ctl near --json --distance 1 rods0.obj && [ "$(json_value total)" = 3 ]
report "check and near read rods and points, and count their kinds"

meets --json t0.ply t1.ply
hash=$(json_value hash)
meets --json t0.obj t1.obj && [ "$(json_value hash)" = "$hash" ] && [ -n "$hash" ]
report "OBJ in double gives the hash of PLY in float"

meets --json t0.ply t1.obj && [ "$(json_value hash)" = "$hash" ]
report "frames of different formats go together"

meets --json --threads 1 t0.ply t1.ply && [ "$(json_value threads)" = 1 ] &&
    [ "$(json_value hash)" = "$hash" ] &&
    meets --json --method paper t0.ply t1.ply && [ "$(json_value hash)" = "$hash" ] &&
    meets --json --method wide t0.ply t1.ply && [ "$(json_value hash)" = "$hash" ] &&
    [ "$(json_value method)" = '"wide"' ]
report "threads and method do not change the hash"

meets --json --threads 2 --tuning scheduler=paper,high-level=disjoint,refit=paper \
    s0.ply s1.ply && whole=$(json_value hash) &&
    meets --json --tuning scheduler=steal s0.ply s1.ply &&
    [ "$(json_value hash)" = "$whole" ] && [ -n "$whole" ] &&
    says '"tuning": ' '"low": [0-9]' '"high": [0-9]' '"rebuild": [0-9]' &&
    fails 4 'scheduler: "slow" is not steal or paper' \
        check --json --tuning scheduler=slow t0.ply t1.ply
report "tuning is chosen and told, and changes no hash"

meets --mode any t0.ply t1.ply && says '^contact +yes$' &&
    ctl check --mode any t0.ply t0.ply && says '^contact +no$'
report "mode any says yes or no"

# As grep: 0 and nothing on the way, 1 and something, in text and JSON, of one step or of the
# second of two.
cp t0.ply t0.again.ply
ctl check t0.ply t0.again.ply && ctl check --json t0.ply t0.again.ply t0.ply &&
    meets t0.ply t0.again.ply t1.ply && meets --json --mode first t0.ply t1.ply &&
    meets --mode pairs t0.ply t1.ply &&
    meets --contacts contacts.csv t0.ply t1.ply && known_contact contacts.csv
report "the exit status of check says whether something meets"

meets --mode first --contacts contacts.csv t0.ply t1.ply && known_contact contacts.csv
report "mode first gives the earliest contact"

meets --mode first-per-pair --contacts contacts.csv t0.ply t1.ply && known_contact contacts.csv
report "mode first-per-pair gives the first contact of two objects"

meets --mode pairs --contacts contacts.csv t0.ply t1.ply &&
    grep -qx 'vf,3,0,1,2,,,0,,,' contacts.csv && says '^pairs +[1-9]'
report "mode pairs gives candidates without times"

meets --tolerance 0.25 --contacts contacts.csv t0.ply t1.ply &&
    awk -F, 'NR == 2 { good = $6 <= 0.5 && $7 >= 0.5 && $7 - $6 <= 0.25 } END { exit !good }' \
        contacts.csv
report "a wide tolerance still holds the contact"

meets --json --contacts contacts.csv t0.ply t1.ply t0.ply t0.ply &&
    [ "$(json_value contacts)" = 2 ] && [ "$(grep -c '"hash"' out)" = 3 ] &&
    [ "$(head -n 1 contacts.csv)" = step,kind,i0,i1,i2,i3,toi,toi_hi,proved,x,y,z ] &&
    [ "$(grep -c '^1,vf,3,0,1,2,' contacts.csv)" = 1 ] &&
    [ "$(grep -c '^2,vf,3,0,1,2,' contacts.csv)" = 1 ] && [ "$(wc -l <contacts.csv)" = 3 ]
report "a sequence is checked step by step"

meets t0.ply t1.ply t0.ply && says '^ +1  t1\.ply: 1 \(1 vf' '^ +2  t0\.ply: 1 \(1 vf' &&
    [ ! -s err ]
report "a sequence prints a line a step, and no bar into a file"

meets --json --contacts whole.csv s0.ply s1.ply && whole=$(json_value hash) &&
    meets --json --result-bytes 65536 --contacts paged.csv s0.ply s1.ply &&
    [ "$(json_value hash)" = "$whole" ] && [ "$(json_value complete)" = true ] &&
    [ "$(wc -l <whole.csv)" -gt 1600 ] && cmp -s whole.csv paged.csv
report "an answer in pages is the same as in one piece"

# is_trace FILE: one JSON object with slices of a step, the loop and a client.
is_trace() {
    head -c 1 "$1" | grep -q '{' && tail -n 1 "$1" | grep -qE '"lost_events":[0-9]+\}\}$' &&
        grep -qE '^\{"ph":"X".*"name":"step","args":\{"triangles":80,"threads":1\}\},$' "$1" &&
        grep -q '"name":"unit"' "$1" && grep -q '"name":"answer frame.submit"' "$1" &&
        grep -q '"name":"frame.submit"' "$1" && grep -q '"args":{"name":"team 0"}' "$1"
}
meets --repeat 0 --method paper --trace trace.json s0.ply s1.ply && is_trace trace.json &&
    [ "$(grep -c '"name":"unit"' trace.json)" = 158 ] && # 79 of these: how it begins
    says '^trace +trace\.json: [0-9]+ events$' &&
    meets --repeat 0 --method paper --trace trace.json --events 10 s0.ply s1.ply &&
    says 'older ones were lost' &&
    meets --json --repeat 0 --method paper --trace trace.json --min-us 1000000 s0.ply s1.ply &&
    ! grep -q '"name":"unit"' trace.json && [ "$(json_value complete)" = true ] &&
    printf '%s\n' 'v 0 0 0' 'v 3 0 0' 'v 0 3 0' 'v 1 1 0' 'v 1 1 2' 'v 1 2 2' 'f 1 2 3' 'f 4 5 6' \
        >rest.obj && meets --repeat 1 --trace trace.json rest.obj rest.obj &&
    grep -qE '"name":"merge","args":\{"kept_records":[1-9][0-9]*\}' trace.json
report "check --trace writes what its daemon did"

# ---- what is refused ----------------------------------------------------------------

sed 's/^0 1 0$/0 nan 0/' t0.ply >nan.ply
fails 4 'nan.ply:12: vertex 2: coordinate y is nan' check nan.ply t1.ply
report "a NaN is refused with file, line and vertex"

sed 's/^3 0 1 2$/3 0 1 6/' t0.ply >index.ply
fails 4 'index.ply:16: face 0: 6 is not a vertex number' check t0.ply index.ply
report "a bad index in the second frame is refused"

sed 's/^3 0 1 2$/3 0 2 1/' t0.ply >turned.ply
fails 4 'triangle 0 is (0 1 2) in t0.ply and (0 2 1) in turned.ply' check t0.ply turned.ply
report "frames of different meshes are refused"

head -n 16 t0.ply >cut.ply
fails 4 'cut.ply:16: face 1: the file ends here' check cut.ply t1.ply
report "a cut file is refused"

fails 4 'absent.ply: cannot open: No such file' check t0.ply absent.ply
report "an absent file is told"

fails 2 't0.ply is one frame: name the file after the step, too, or' check t0.ply &&
    fails 2 'which frames' check &&
    fails 2 '"wide-open" is none of default, paper, wide' check --method wide-open t0.ply t1.ply &&
    fails 2 'which --trace asks for' check --events 10 t0.ply t1.ply &&
    fails 2 '"nowhere" is neither unix:PATH nor direct:' check --url nowhere t0.ply t1.ply &&
    fails 2 '--private excludes --url and --socket' check --private --socket s t0.ply t1.ply &&
    fails 2 'is not a whole number' check --threads -1 t0.ply t1.ply &&
    fails 2 'mode any gives no contacts' check --mode any --contacts c.csv t0.ply t1.ply
report "wrong usage is an error with exit status 2"

"$PCCDCTL" check --contacts /dev/full t0.ply t1.ply >out 2>err
[ $? -eq 4 ] && grep -qF '/dev/full: cannot write' err
report "a full disk is told"

fails 4 '/nowhere/t.json: cannot write' check --json --trace /nowhere/t.json t0.ply t1.ply &&
    fails 2 'exclude each other' trace -o x --steps 1 --seconds 1
report "a recording that has nowhere to go is told"

fails 3 'no connection' check --daemon /nowhere/pccdd t0.ply t1.ply &&
    fails 3 'nobody listens at /nowhere: No such file or directory; pccdctl doctor tells' \
        check --socket /nowhere t0.ply t1.ply
report "a daemon that cannot be started is told"

# ---- a daemon that stays ------------------------------------------------------------

start_daemon s

ctl ping --socket "$work/s" -c 5 -i 0 && [ "$(grep -c "^daemon $daemon: seq" out)" = 5 ] &&
    says '^5 round trips: min [0-9.]+ us, median [0-9.]+ us, p99 [0-9.]+ us, max'
report "ping measures round trips through the daemon asked for"

meets --url "unix:$work/s" t0.ply t1.ply && ctl stats --socket "$work/s" &&
    says '^steps +2  .*' "^pid +$daemon  " '^exact_share +[0-9.e-]+  ' \
        '^cpu +(scalar|sse2|sse4|avx2|avx512|neon)  ' &&
    ctl stats --json --socket "$work/s" && [ "$(json_value steps)" = 2 ] &&
    [ "$(json_value candidates)" -gt 0 ] && [ -n "$(json_value cpu)" ] &&
    [ -n "$(json_value exact_share)" ]
report "stats counts the steps of check, as text and as JSON"

[ "$(cat "/proc/$daemon/comm")" = pccdd ]
report "the daemon is found by its name"

meets --url "unix:$work/s" --threads 2 --repeat 0 s0.ply s1.ply &&
    ctl stats --threads --socket "$work/s" && says '^step [0-9]+ by 1 thread$' \
        '^  ingest +[0-9.]+ ms$' '^  step +[0-9.]+ ms$' '^thread +task_units +pairs' \
        '^thread +refit +low +high +tests +rebuild +wait +merge$' '^     0 .*[0-9] ms$' &&
    ctl stats --threads --json --socket "$work/s" && [ "$(json_value threads)" = 1 ] &&
    [ "$(json_value task_units)" -gt 0 ] && [ "$(json_value ns_step)" -gt 0 ] &&
    [ "$(json_value tuning)" = null ]
report "stats --threads tells what the threads of the last step did"

# Triangles beside each other that move, so many that a team is worth while whatever else
# the processors do.
awk 'BEGIN { for (i = 0; i < 40000; i++) printf "v %d 0 0\nv %d 1 0\nv %d 0 1\n", i, i, i
    for (i = 0; i < 40000; i++) printf "f %d %d %d\n", 3 * i + 1, 3 * i + 2, 3 * i + 3 }' \
    >many.obj
sed 's/^v [0-9]*/&.25/' many.obj >more.obj
if [ "$(nproc)" -gt 1 ]; then
    ctl check --url "unix:$work/s" --threads 2 --repeat 3 --method paper \
        --tuning refit=paper,scheduler=paper,high-level=disjoint many.obj more.obj &&
        ctl stats --threads --json --socket "$work/s" && [ "$(json_value threads)" = 2 ] &&
        [ "$(json_value tuning)" = '"scheduler=paper,high-level=disjoint,refit=paper"' ]
    report "stats --threads --json tells the tuning that was chosen"
else
    number=$((number + 1))
    echo "ok $number - stats --threads --json tells the tuning # SKIP one processor"
fi

{ sleep 0.3; "$PCCDCTL" check --url "unix:$work/s" --repeat 0 s0.ply s1.ply >/dev/null; } &
ctl trace --socket "$work/s" --steps 1 -o trace.json && { wait $! || [ $? -eq 1 ]; } && is_trace trace.json &&
    says '^trace +trace\.json: [0-9]+ events$' &&
    ctl trace --socket "$work/s" --seconds 0.05 -o - && head -n 1 out | grep -q '^{' && says 'lost_events'
report "trace records what a daemon does for others"

PCCD_URL="unix:$work/s" "$PCCDCTL" version >out 2>err &&
    says '^tool +pccdctl [0-9.]+$' '^library +libpccd [0-9.]+$' \
        "^daemon +.*$daemon, (scalar|sse2|sse4|avx2|avx512|neon)$"
report "version names the daemon's process and instruction set"

kill "$daemon" && wait "$daemon"
fails 3 'no connection' ping --socket "$work/s"
report "ping fails when nobody listens"

PCCD_URL="unix:$work/s" "$PCCDCTL" version >out 2>err && says '^daemon +does not answer'
report "version works without a daemon"

ctl version --socket "$work/s"
[ $? -eq 3 ] && says '^daemon +does not answer' && grep -q 'no connection' err
report "version fails where the daemon that an option names does not answer"

PCCD_CPU=scalar start_daemon s
ctl version --socket "$work/s" && says "$daemon, scalar\$" &&
    meets --json --url "unix:$work/s" t0.ply t1.ply && [ "$(json_value hash)" = "$hash" ]
report "PCCD_CPU chooses the daemon's instruction set, which does not change the hash"

kill "$daemon" && wait "$daemon"
PCCD_CPU=mmx "$PCCD_DAEMON" --socket "$work/s" >out 2>err
[ $? -eq 1 ] && grep -q 'PCCD_CPU=mmx: there is no such .*, but scalar' err
report "an instruction set that is not there is refused by name"

# ---- floats -------------------------------------------------------------------------

# As -ffast-math does it, where a library is linked with that by gcc 12: the thread that loads it
# takes subnormal numbers for zeros.
cat >flush.c <<'C'
__attribute__((constructor)) static void flush(void)
{
#if defined(__x86_64__)
    __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | 0x8040);
#elif defined(__aarch64__)
    __builtin_aarch64_set_fpcr(__builtin_aarch64_get_fpcr() | 1 << 24);
#endif
}
C
small() { printf 'v %se-310 %se-310 %se-310\n' 0 0 0 1 0 0 0 1 0 .2 .2 "$1" .3 .2 4 .2 .3 5; }
small 1 >small0.obj
small -1 >small1.obj
printf 'f 1 2 3\nf 4 5 6\n' | tee -a small0.obj >>small1.obj
if "${CC:-cc}" -shared -fPIC -o flush.so flush.c 2>err; then
    meets --private --json small0.obj small1.obj && [ "$(json_value contacts)" -eq 1 ] &&
        hash=$(json_value hash) &&
        ASAN_OPTIONS=${ASAN_OPTIONS-}:verify_asan_link_order=0 LD_PRELOAD=$work/flush.so \
            meets --private --json small0.obj small1.obj && [ "$(json_value hash)" = "$hash" ]
    report "a library that flushes subnormal numbers does not change the hash"
else
    number=$((number + 1))
    echo "ok $number - a library that flushes subnormal numbers does not change the hash # SKIP no cc"
fi

# ---- demo and help ------------------------------------------------------------------

is_png() { [ "$(head -c 8 "$1" | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a ]; }
ctl demo --steps 40 && is_png pccd-demo.png && says '^picture +\./pccd-demo\.png$' \
    '^steps +40 taken, [0-9]+ asked for' '^triangles +14642' '^contacts +[1-9]' '^left +0 contacts' '^per step +p50 .* p99 ' '^  ingest ' \
    '^  refit ' '^  traversal ' '^  tests ' '^  merge ' && [ ! -s err ]
report "demo holds its cloth, prints its table and writes a picture"

first=$(grep '^hash' out)
ctl demo --steps 40 -o other.png && is_png other.png &&
    [ "$(grep '^hash' out)" = "$first" ] && cmp -s pccd-demo.png other.png
report "demo gives the same hash and picture again"

fails 4 '/nowhere/demo.png: cannot write' demo --output /nowhere/demo.png
report "demo tells at once that the picture cannot be written"

fails 3 'no connection' demo --daemon /nowhere/pccdd --output none.png && [ ! -e none.png ]
report "demo leaves no empty picture behind"

ctl --help && says '^  ping ' '^  stats ' '^  trace ' '^  check ' '^  demo ' '^  version ' '^  status ' '^  top ' &&
    ctl check --help && says '--contacts=FILE' '--repeat=N' && ctl --version &&
    says '^pccdctl [0-9]+\.[0-9]+\.[0-9]+$' && fails 2 'no command "chekc"' chekc
report "help lists every command"

# If it failed, who begins would look for what to try among commands for operators, or would have no
# line to copy.
ctl --help && [ "$(sed -n 's/^  \([a-z]*\) .*/\1/p' out | head -n 5 | tr '\n' ' ')" = \
    'demo check near render inspect ' ] && says '^To begin with:$' '^A daemon:$' &&
    [ "$(grep -c '^[A-Z].*[a-z]:$' out)" -ge 4 ] && ! grep -E '^.{81}' out &&
    for command in $(sed -n 's/^  \([a-z]*\) .*/\1/p' out); do
        [ "$("$PCCDCTL" "$command" --help | grep -c "^  pccdctl $command")" -ge 2 ] || break
    done
report "help begins with what to try, and has examples"

# If it failed, a picture would want a name that nobody cares about, or would not say its own; or one
# would take the place of what it was made of.
mkdir -p named && (cd named && ctl render ../t0.ply ../t1.ply && grep -q '^t0\.png: step 1 ' out &&
    is_png t0.png && ctl render ../t0.ply ../t1.ply && cp ../t0.ply s0.ply && cp ../t1.ply s1.ply &&
    ctl render 's%d.ply' && grep -q '^s\.png: step 1 ' out && [ "$(echo ./*)" = './err ./out ./s.png ./s0.ply ./s1.ply ./t0.png' ])
report "a picture has a name without -o"

# If it failed, a line of the help would run out of a terminal, or say something of another option.
"$PCCDCTL" --help | sed -n 's/^  \([a-z]*\) .*/\1/p' >commands && [ "$(wc -l <commands)" -gt 20 ] &&
    while read -r command; do
        "$PCCDCTL" "$command" --help >out
        sed '/^  -V, /q' out | grep -vE '^$|^[^ ]|^ [A-Z]|^ {6}--[a-z]|^  -., --|^ {29}[^ ]|^  or:  '
        grep -E '^.{80}' out
        cat -s out | cmp out -
    done <commands >help.log && [ ! -s help.log ]
tap_result $? "help keeps to its columns" help.log

fails 2 'no command "chekc"; check?' chekc &&
    fails 2 'pccdctl check: --treads: no such option; --threads?' check --treads 2 &&
    fails 2 'unrecognized option' check --nothing-like-it && fails 2 'see pccdctl --help' nothing-like-it &&
    ! grep -q '[?]$' err && fails 4 'a.none: cannot open' check --thread 1 a.none b.none &&
    ctl demo --steps 1 --output --jsno && [ -e ./--jsno ]
report "what is misspelt gets the word that may be meant"

# If it failed, what every command knows would be taken for another word that is misspelt.
while read -r command; do
    for option in --help --usage --version --vers --usag; do
        ctl "$command" "$option" || echo "$command $option: $(cat err)"
    done
done <commands >help.log && [ ! -s help.log ]
tap_result $? "every command has help, usage and version" help.log

tap_end
