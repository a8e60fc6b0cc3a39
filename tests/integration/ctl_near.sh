#!/bin/bash
# tests/integration/ctl_near.sh - pccdctl near against a real daemon, and without one.

set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/ctl.sh
. "$top_srcdir/tests/support/ctl.sh"

# json KEY VALUE...: each key of the object in out has that value.
json() {
    while [ $# -gt 0 ]; do
        [ "$(json_value "$1")" = "$2" ] || { echo "$1 is not $2" >>err; return 1; }
        shift 2
    done
}
# same TEXT: the file rows is that.
same() { [ "$(cat rows)" = "$1" ] || { cat rows >>err; return 1; }; }

# A triangle in the plane z = 0, and needles whose first corner is above its inside, above
# its corner 0, and below it, through it.
needle() { # X Y Z
    printf 'v %s\n' "$1 $2 $3" "$1 $2 4" "0.375 $2 4"
    echo 'f 1 2 3'
}
printf 'v %s\n' '0 0 0' '1 0 0' '0 1 0' >floor.obj
echo 'f 1 2 3' >>floor.obj
needle 0.25 0.25 0.5 >above.obj
needle 0 0 0.5 >corner.obj
needle 0.25 0.25 -1 >through.obj
head_row=kind,type,a,b,i0,i1,i2,i3,i4,d_lo,d_hi,count,u,v,nx,ny,nz,x,y,z

# Otherwise a program that reads the report or the CSV would not find the pair that there
# is, or where.
ctl near --distance 0.5 --csv rows floor.obj above.obj &&
    grep -q '^near  *1 pair within 0.5: 1 vertex-face$' out &&
    grep -q '^distance  *0.5$' out && grep -q '^answer  *complete$' out &&
    says '^nearest +vertex 0 of "above" and face 0 of "floor" at \(0.25, 0.25, 0\)$' && same "$head_row
vf,vf,2,1,0,0,1,2,,0.5,0.5,1,0.25,0.25,0,0,1,0.25,0.25,0"
report "pairs: a distance of exactly D is within it"

# Otherwise objects would be taken for frames of one mesh, or D would be rounded up.
ctl near --distance 0.4999999999999999 --json floor.obj above.obj &&
    json total 0 vf 0 ee 0 distance_min null distance_max null complete true
report "pairs: nothing is within less"

# Otherwise numbers that programs read would be missing.
ctl near --distance 0.5 --json floor.obj above.obj &&
    json what '"pairs"' total 1 vf 1 ee 0 ve 0 vv 0 ef 0 distance_min 0.5 distance_max 0.5 \
        crossings 0 verdict '"none"' complete true repeat 1 &&
    grep -q '"hash": "2:[0-9a-f]\{32\}"' out && grep -q '"step": [0-9]' out
report "--json has the promised members"
hash=$(json_value hash)

# Otherwise the answer would depend on who computes, and how.
ctl near --url direct: --distance 0.5 --json floor.obj above.obj && json hash "$hash" &&
    ctl near --method paper --distance 0.5 --json floor.obj above.obj &&
    json hash "$hash" method '"paper"' && [ -n "$hash" ]
report "direct: and the other method give the same hash"

# Otherwise pairs around one corner would not be one entry with their number.
ctl near --distance 0.5 --what pairs --json floor.obj corner.obj && pairs=$(json_value total) &&
    ctl near --distance 0.5 --what features --csv rows floor.obj corner.obj &&
    [ "$pairs" -gt 1 ] && same "$head_row
vv,vv,1,2,0,0,,,,0.5,0.5,$pairs,0,0,0,0,-1,0,0,0.5"
report "features: pairs at one corner are merged, and counted"

# Otherwise a trust region would be taken from another vertex's bound.
ctl near --distance 1 --what vertices --csv - floor.obj above.obj && cp out rows && same \
"object,vertex,bound
1,0,0.5
1,1,0.5
1,2,0.5
2,0,0.5
2,1,$(awk -F, '$1 == 2 && $2 == 1 { print $3 }' rows)
2,2,$(awk -F, '$1 == 2 && $2 == 2 { print $3 }' rows)" && grep -q '^near  *6 vertices' err &&
    grep -q '^nearest  *vertex 0 of "floor" at (0, 0, 0)$' err
report "vertices: a bound for each, in the order of files; --csv - keeps the report off stdout"

# Otherwise a surface that is pierced would be called free of intersections.
ctl near --what crossings --csv rows floor.obj through.obj &&
    grep -q '^intersects yes$' out && grep -q '^crossings  *2$' out &&
    says '^where +edge 0-1 of "through" and face 0 of "floor" at \(0.25, 0.25, 1.49e-08\)$' &&
    awk -F, 'NR > 1 && ($18 - (NR == 2 ? 0.25 : 0.275)) ^ 2 + ($19 - 0.25) ^ 2 + $20 ^ 2 > 1e-14 { exit 1 }' rows &&
    sed -i '2,$s/\(,[^,]*\)\{3\}$//' rows && same "$head_row
ef,,2,1,0,1,0,1,2,0,0,1,0.200000003,0,0,0,0
ef,,2,1,0,2,0,1,2,0,0,1,0.200000003,0,0,0,0"
report "crossings: the two edges that pass through"

# Otherwise sheets that cut through each other edge on edge would intersect without a record: their
# corners, edges and faces touch, and no edge passes through the inside of a face. What touches is
# counted once more, in integers, and has nothing to do with a thickness.
python3 - <<'END'
def sheet(name, place):
    with open(name, 'w') as to:
        for i in range(9):
            print('v', *place(i % 3 - 1, i // 3 - 1), file=to)
        for v in (1, 2, 4, 5):
            print(f'f {v} {v + 1} {v + 3}\nf {v + 1} {v + 4} {v + 3}', file=to)
sheet('flat.obj', lambda a, b: (2 * a, 2 * b, 0))
sheet('upright.obj', lambda a, b: (2 * a, 0, 2 * b))
END
ctl near --what crossings --csv rows --thickness 0.2 flat.obj upright.obj && cp out text &&
    ctl near --what crossings --json flat.obj upright.obj && python3 - >>"$log" 2>&1 <<'END'
import csv, itertools, json, re
def read(name):
    words = [line.split() for line in open(name)]
    x = [tuple(map(int, w[1:])) for w in words if w[0] == 'v']
    faces = [tuple(int(i) - 1 for i in w[1:]) for w in words if w[0] == 'f']
    return x, faces, sorted({tuple(sorted(p)) for f in faces for p in itertools.combinations(f, 2)})
def sub(a, b): return [p - q for p, q in zip(a, b)]
def dot(a, b): return sum(p * q for p, q in zip(a, b))
def cross(a, b): return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
def is_in(p, a, b, c):
    n = cross(sub(b, a), sub(c, a))
    return dot(n, sub(p, a)) == 0 and all(dot(n, cross(sub(v, u), sub(p, u))) >= 0 for u, v in ((a, b), (b, c), (c, a)))
def is_on(p, a, b):
    return not any(cross(sub(b, a), sub(p, a))) and dot(sub(p, a), sub(p, b)) <= 0
def meet(a, b, c, d): # two segments that are not parallel, or touch in an end
    u, v, w = sub(b, a), sub(d, c), sub(c, a)
    n = cross(u, v)
    if not any(n):
        return is_on(a, c, d) or is_on(b, c, d) or is_on(c, a, b) or is_on(d, a, b)
    s, t = dot(cross(w, v), n), dot(cross(w, u), n)
    return dot(w, n) == 0 and 0 <= s <= dot(n, n) and 0 <= t <= dot(n, n)
(x, f, e), (y, g, h) = read('flat.obj'), read('upright.obj')
vf = sum(is_in(p, *(y[i] for i in t)) for p in x for t in g) + sum(is_in(p, *(x[i] for i in t)) for p in y for t in f)
ee = sum(meet(x[a], x[b], y[c], y[d]) for a, b in e for c, d in h)
told = json.load(open('out'))
assert told['crossings'] == 0 and told['verdict'] == 'yes', told
assert (told['touching']['vf'], told['touching']['ee']) == (vf, ee) and min(vf, ee) > 9, (told['touching'], vf, ee)
assert f'touching   {vf + ee} pairs at distance 0: {vf} vertex-face, {ee} edge-edge\n' in open('text').read()
rows = list(csv.DictReader(open('rows')))
assert [sum(row['kind'] == kind for row in rows) for kind in ('vf', 'ee')] == [vf, ee]
END
[ $? -eq 0 ] && ctl near --what crossings --json floor.obj above.obj && json touching null
report "crossings: what intersects has a record, also where edge cuts edge"

# Otherwise nobody could be sure of a state without intersections.
ctl near --what crossings --json floor.obj above.obj &&
    json verdict '"no"' total 0 crossings 0 complete true
report "crossings: none, and it says so"

# Otherwise two objects' nearest pair would be another one, or be sought too near.
ctl near --what nearest --csv rows floor.obj above.obj && same "$head_row
vf,vf,2,1,0,0,1,2,,0.5,0.5,1,0.25,0.25,0,0,1,0.25,0.25,0" && grep -q '^near  *1 nearest pair of two objects: 1 vertex-face$' out &&
    ctl near --what nearest --distance 0.25 --json floor.obj above.obj && json total 0 &&
    ctl near --what nearest --gap 0.125 --json floor.obj above.obj &&
    json total 1 gap 0.125 hash null
report "nearest: one pair of two objects, within a distance or a gap"

# Otherwise a spike through a floor would be as far away from it as their edges are, and
# nothing would be wrong beside pairs and bounds.
printf 'v %s\n' '-30 -30 0' '30 -30 0' '0 30 0' >wide.obj
echo 'f 1 2 3' >>wide.obj
printf 'v %s\n' '0 0 -2' '1 0 6' '0 1 6' >pierce.obj
echo 'f 1 2 3' >>pierce.obj
ctl near --what nearest --csv rows wide.obj pierce.obj && same "$head_row
ef,,2,1,0,1,0,1,2,0,0,1,0.25,0,0,0,0,0.25,0,0" && grep -q '^distance  *0$' out &&
    ctl near --what nearest --json wide.obj pierce.obj && json ef 1 crossings null &&
    ctl near --distance 1 wide.obj pierce.obj && grep -q '^near  *0 pairs' out &&
    grep -q '^crossings  *2$' out &&
    ctl near --distance 1 --what vertices --json wide.obj pierce.obj && json crossings 2 &&
    ctl near --distance 1 --what features --json wide.obj pierce.obj && json crossings 2 &&
    ctl near --distance 1 --json floor.obj above.obj && json crossings 0
report "what crosses is nearest, at 0, and counted beside pairs, features and vertices"

# Otherwise the pairs of a file with itself would hide those of two files.
{ cat above.obj; printf 'v %s\n' '0.25 0.25 4.25' '0.25 0.25 5' '0.375 0.25 5'; echo 'f 4 5 6'; } >two.obj
ctl near --distance 0.5 --json floor.obj two.obj && json total 1 vf 1 && one=$(json_value total) &&
    ctl near --distance 0.5 --json two.obj && own=$(json_value total) && [ "$own" -gt 0 ] &&
    ctl near --distance 0.5 --self --json floor.obj two.obj && json total $((one + own)) &&
    ctl near --distance 0.5 --what features --json floor.obj two.obj && json total 1 &&
    ctl near --distance 0.5 --what vertices --csv rows floor.obj two.obj &&
    grep -q '^2,3,0.25$' rows
report "pairs of several files leave out each file's own, unless --self is given"

# Otherwise what is inside would be taken for apart, or an open mesh for one with an inside.
tetrahedron() { # HEIGHT
    printf 'v %s\n' "0 0 $1" "4 0 $1" "0 4 $1" "0.5 0.5 $(($1 + 4))"
    printf 'f %s\n' '1 3 2' '1 2 4' '2 3 4' '3 1 4'
}
tetrahedron 0 >lower.obj
printf 'v %s\n' '1.5 1 0.5' '1.75 1 9' '1.5 1.25 9' '1.25 0.75 9' >spike.obj
printf 'f %s\n' '1 3 2' '1 2 4' '2 3 4' '3 1 4' >>spike.obj
ctl near --what depth --csv rows lower.obj spike.obj && grep -q '^near  *1 vertex inside' out &&
    grep -q '^depth  *0.5$' out && [ "$(wc -l <rows)" -eq 2 ] && grep -q '^vf,.*,2,1,0,' rows &&
    ctl near --what depth --json lower.obj spike.obj && json total 1 vf 1 &&
    [ "$(json_value crossings)" -gt 0 ] &&
    fails 4 'the mesh of floor.obj is not closed: 1 of its faces run along the edge' \
        near --what depth lower.obj floor.obj
report "depth: the vertex that is inside; of an open mesh the edge is named"

# Otherwise an answer longer than the shared memory would lose records.
awk 'BEGIN {
    for (i = 0; i < 60; i++) {
        x = i / 64; print "v", x, 0, 1 / 64; print "v", x + 1 / 1024, 0, 4; print "v", x, 1, 4
        printf "f %d %d %d\n", 3 * i + 1, 3 * i + 2, 3 * i + 3
    }
}' >needles.obj
ctl near --distance 2 --self --result-bytes 65536 --csv rows --json floor.obj needles.obj &&
    json complete true && total=$(json_value total) && [ "$total" -gt 1024 ] &&
    [ "$(wc -l <rows)" -eq $((total + 1)) ] && [ "$(sort -u rows | wc -l)" -eq $((total + 1)) ]
report "every page comes: more records than the shared memory holds"

# Otherwise what is near could not be repeated, checked or seen where it was recorded.
ctl record -o near.rec --contacts -- "$PCCDCTL" near --distance 1 floor.obj above.obj &&
    grep -q ': [0-9]* bytes, 0 steps, 2 questions about what is near, 2 answers$' err &&
    ctl replay near.rec && grep -q '^recording .* 2 questions about what is near by ' out && grep -q '2 answers.*2 the same, 0 not' out &&
    ctl verify near.rec && grep -q '2 questions about what is near with [1-9]' out &&
    fails 4 'near.rec: number 2 is a question about what is near, not a step; render --near' \
        render --steps 2 -o no.svg near.rec &&
    fails 4 'near.rec holds no such step; it has 2, the last 2' render --steps 9 -o no.svg near.rec &&
    fails 4 'near.rec holds no step, but 2 questions about what is near' \
        render -o no.svg near.rec && [ ! -e no.svg ] &&
    ctl render --near -o near.svg near.rec &&
    lines=$(sed -n 's/.*, \([0-9]*\) records*$/\1/p' out) && [ "$lines" -gt 1 ] &&
    [ "$(grep -c '<line x1' near.svg)" -eq "$lines" ] && grep -q '>distance<' near.svg &&
    ctl record -o cross.rec --contacts -- "$PCCDCTL" near --what crossings floor.obj through.obj &&
    ctl render --near --steps 1..2 -o cross.svg cross.rec &&
    [ "$(grep -c '<line x1' cross.svg)" -eq 2 ] && ! grep -q '>distance<' cross.svg
report "a recording of it is replayed, verified and drawn"

# Otherwise ParaView and Blender would show no line, or lines elsewhere.
has_python() { command -v python3 >/dev/null; }
if has_python; then
    ctl record -o one.rec --contacts -- "$PCCDCTL" near --what nearest floor.obj above.obj &&
        ctl export --near -o one.vtp one.rec && grep -q '1 record$' out &&
        ctl export --near -o one.glb one.rec &&
        fails 2 'no --time' export --near --time 0 -o x.glb one.rec &&
        python3 - >>out 2>&1 <<'EOF'
import base64, json, struct, xml.etree.ElementTree as tree
piece = tree.parse('one.vtp').getroot().find('PolyData/Piece')
def read(array): # as VTK does: length and values are one piece of base64
    data = base64.b64decode(array.text, validate=True)[8:]
    size, form = {'Float32': (4, 'f'), 'UInt32': (4, 'I'), 'Float64': (8, 'd')}[array.get('type')]
    return struct.unpack('<%d%s' % (len(data) // size, form), data)
points, lines, polys = [int(piece.get('NumberOf' + n)) for n in ('Points', 'Lines', 'Polys')]
assert lines == 1 and polys == 2 and points == 8
x = read(piece.find('Points/DataArray'))
cells = {a.get('Name'): read(a) for a in piece.find('CellData')}
assert len(cells['distance']) == len(cells['kind']) == 3 and cells['kind'][1:] == (8, 8)
length = sum((a - b) ** 2 for a, b in zip(x[18:21], x[21:24])) ** .5
assert length > 0 and abs(length - cells['distance'][0]) < 1e-6
assert read(piece.find('Lines/DataArray')) == (6, 7)
data = open('one.glb', 'rb').read()
size, = struct.unpack('<I', data[12:16])
gltf = json.loads(data[20:20 + size])
assert gltf['extras']['near'] == 1 and gltf['meshes'][-1]['primitives'][0]['mode'] == 1
at = gltf['accessors'][gltf['meshes'][-1]['primitives'][0]['attributes']['POSITION']]
view = gltf['bufferViews'][at['bufferView']]
begin = 28 + size + view['byteOffset']
assert struct.unpack('<6f', data[begin:begin + 24]) == x[18:24]
EOF
    report "an exported answer has its lines"
else
    tap_skip "an exported answer has its lines" "no python3"
fi

# Otherwise a recording of a daemon's threads would have a hole where it computed that.
start_daemon s
while [ ! -e enough ]; do
    "$PCCDCTL" near --socket "$work/s" --distance 1 floor.obj above.obj
done >asked 2>&1 &
asking=$!
ctl trace --seconds 1 -o trace.json --socket "$work/s"
touch enough
wait "$asking"
grep -q '"name":"receive scene.near"' trace.json && grep -q '"name":"answer scene.near"' trace.json
report "trace shows the question, from its arrival to its answer"

# Otherwise a mistake would be answered as something else.
fails 2 '--distance: "-1" is not a number from 0' near --distance -1 floor.obj &&
    fails 2 '--distance is missing' near floor.obj above.obj &&
    fails 2 '--what: "far"' near --what far floor.obj &&
    fails 2 '--gap is of --what nearest' near --distance 1 --gap 1 floor.obj &&
    fails 2 'crossings has no use' near --what crossings --distance 1 floor.obj &&
    fails 2 '--self: nearest is of two objects' near --what nearest --self floor.obj above.obj &&
    fails 4 '--between: nearest is of two objects, and "floor" is one' \
        near --what nearest --between floor,floor floor.obj above.obj &&
    ctl near --distance -0 floor.obj above.obj && grep -q '^near .* within 0' out &&
    fails 2 'one file at least' near --distance 1 &&
    fails 4 'missing.obj: cannot open' near --distance 1 missing.obj &&
    fails 3 '' near --distance 1 --socket "$work/nobody" floor.obj
report "what is wrong is named"

tap_end
