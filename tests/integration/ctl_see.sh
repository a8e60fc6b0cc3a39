#!/bin/bash
# tests/integration/ctl_see.sh - thickness, rods and points in pictures and exports (TAP).

set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/ctl.sh
. "$top_srcdir/tests/support/ctl.sh"


if ! command -v python3 >/dev/null; then
    tap_skip pictures "no python3, which reads them"
    tap_end
    exit
fi
# A picture as rows of pixels; what is drawn is what differs from the background, a vertical run of
# colours, as the column at its left border has it. The legend is left out.
cat >picture.py <<'END'
import struct, zlib
def rows(path):
    data, at, packed = open(path, 'rb').read(), 8, b''
    while at < len(data):
        size, kind = struct.unpack('>I4s', data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b'IHDR':
            wide, high, bits, colours = struct.unpack('>IIBB', body[:10])
            assert (bits, colours) == (8, 2)
        packed += body if kind == b'IDAT' else b''
        at += size + 12
    flat, before, out = zlib.decompress(packed), bytes(3 * wide), []
    for y in range(high):
        how, line = flat[y * (3 * wide + 1)], bytearray(flat[y * (3 * wide + 1) + 1:][:3 * wide])
        for i in range(3 * wide if how else 0):
            left, up, corner = (line[i - 3], before[i], before[i - 3]) if i >= 3 else (0, before[i], 0)
            if how == 4:
                a, b, c = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
                guess = left if a <= b and a <= c else up if b <= c else corner
            else:
                guess = (0, left, up, (left + up) // 2)[how]
            line[i] = (line[i] + guess) & 255
        out.append([tuple(line[3 * x:3 * x + 3]) for x in range(wide)])
        before = bytes(line)
    return out
def drawn(path):
    return [[(x > 250 or y > 112) and max(abs(a - b) for a, b in zip(p, row[0])) > 6
             for x, p in enumerate(row)] for y, row in enumerate(rows(path))]
def runs(line): # [first, end) of what is drawn
    edges = [i for i in range(len(line) + 1)
             if (i < len(line) and line[i]) != (i > 0 and line[i - 1])]
    return list(zip(edges[::2], edges[1::2]))
END
export PYTHONPATH=$work PYTHONDONTWRITEBYTECODE=1
# record NAME RADIUS [FRAMES [OPTION...]]: from FRAMES0.obj to FRAMES1.obj, NAME if not given.
record() {
    ctl record --contacts -o "$1.rec" -- "$PCCDCTL" check --private --repeat 0 --thickness "$2" \
        "${@:4}" "${3:-$1}0.obj" "${3:-$1}1.obj" || [ $? -eq 1 ] # 1: something meets
}

# Two points come straight towards each other, to the distance 2.
printf 'v %s\n' '-2 0 0' '2 0 0' >points0.obj
printf 'v %s\n' '-1 0 0' '1 0 0' >points1.obj
for frame in 0 1; do printf 'p 1 2\n' >>points$frame.obj; done

# If it failed, clouds would not be seen, or with another thickness than they meet with: at their
# time of impact two would overlap, or have a gap between them.
record points 0.75 && record wide 1 points && record small 1e-9 points &&
    for name in points wide small; do
        ctl render --size 600x400 --view 90,0 --up z -o $name.png $name.rec || break
    done && python3 - >>"$log" 2>&1 <<'END'
from picture import drawn, runs
gap, touch, small = [runs(max(drawn(name + '.png'), key=sum)) for name in ('points', 'wide', 'small')]
assert len(gap) == 2 and len(touch) == 1 and len(small) == 2, (gap, touch, small)
(a, b), (c, d) = gap # seen from the front, both as large as the ratio of radius and distance
assert abs((c - b) / (b - a) - 0.5 / 1.5) < 0.03 and abs((b - a) - (d - c)) <= 2, gap
assert all(3 <= end - first <= 6 for first, end in small), small
END
report render__draws_points_as_thick_as_they_meet

# If it failed, rods would not be seen; or without their round ends.
printf 'v %s\n' '-2 0 0' '2 0 0' >rod0.obj
printf 'l 1 2\n' >>rod0.obj
cp rod0.obj rod1.obj
record rod 0.5 && ctl render --size 600x400 --view 90,0 --up z -o rod.png rod.rec &&
    python3 - >>"$log" 2>&1 <<'END'
from picture import drawn, runs
image = drawn('rod.png')
(first, end), = runs(max(image, key=sum))
high = sum(any(line) for line in image)
assert abs((end - first) / high - 5) < 0.4, (end - first, high) # 4 and two radii, by two radii
corner = min(y for y, line in enumerate(image) if any(line))
assert not image[corner][first + high // 8] and image[corner + 2][(first + end) // 2]
END
report render__draws_rods_with_round_ends

# What a new user draws first. A triangle falls through another one; a cloth sinks onto the tip of a
# pyramid, which hides the contact from one side, as the cloth does from another.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv .2 .2 1\nv .3 .2 4\nv .2 .3 4\nf 1 2 3\nf 4 5 6\n' >fall0.obj
sed 's/ 1$/ -1/; s/ 4$/ 2/' fall0.obj >fall1.obj
python3 - <<'END'
for frame, high in enumerate((0.32, 0.29)):
    with open(f'sink{frame}.obj', 'w') as to:
        for x, y in [(i % 12 / 11 - .5, i // 12 / 11 - .5) for i in range(144)]:
            print('v', x, y, high - (x * x + y * y) * (.3 + .05 * frame), file=to)
        print('v -.3 -.3 0\nv .3 -.3 0\nv 0 .4 0\nv 0 0 .3', file=to)
        for v in (12 * j + i + 1 for j in range(11) for i in range(11)):
            print(f'f {v} {v + 1} {v + 12}\nf {v + 1} {v + 13} {v + 12}', file=to)
        print('f 145 147 146\nf 145 146 148\nf 146 147 148\nf 147 145 148', file=to)
END
cat >seen.py <<'END'
from picture import rows
def below(path): # the legend
    return rows(path)[160:]
def marks(path): # pixels of contacts of the middle of a step, which are pink to orange
    return [(x, y) for y, row in enumerate(below(path)) for x, (r, g, b) in enumerate(row)
            if r > g + 60 and r > b + 30]
def wall(path): # the part of the picture that has the commonest colour
    flat = [tuple(c // 32 for c in p) for row in below(path) for p in row]
    return max(map(flat.count, set(flat))) / len(flat)
def light(pixel):
    linear = [c / 255 / 12.92 if c < 11 else ((c / 255 + 0.055) / 1.055) ** 2.4 for c in pixel]
    return sum(a * b for a, b in zip((0.2126, 0.7152, 0.0722), linear))
def contrast(path): # of words: the darkest against what is usual behind them (WCAG 2)
    lights = sorted(light(p) for row in rows(path)[22:70] for p in row[28:200])
    return (lights[len(lights) // 2] + 0.05) / (lights[0] + 0.05)
END

# If it failed, a picture of one contact would show none: it would be of a moment when it is over, or
# be hidden, or a speck.
ctl render --size 640x480 -o fall.png fall0.obj fall1.obj && grep -qx 'fall.png: step 1 at t = 0.5, 1 object, 1 contact' out &&
    ctl render --size 640x480 -o over.png --at all fall0.obj fall1.obj && grep -q 'over.png: step 1 at t = 1,' out &&
    ctl render -o half.png --time 0.25 fall0.obj fall1.obj && grep -q 'half.png: step 1 at t = 0.25,' out &&
    python3 - >>"$log" 2>&1 <<'END'
from seen import contrast, marks
assert len(marks('fall.png')) > 50 > 10 > len(marks('over.png')), [len(marks(n)) for n in ('fall.png', 'over.png')]
assert contrast('fall.png') > 4.5
END
report render__shows_one_contact_when_it_happens

# If it failed, contacts that are close to each other would be a wall that fills the picture; or the
# hidden ones would not be seen. Triangles of both sides are around them.
ctl render --size 640x480 -o where.png --at contacts --up z --view 30,-10 sink0.obj sink1.obj &&
    ctl render -o where.svg --up z --view 30,-10 sink0.obj sink1.obj && python3 - >>"$log" 2>&1 <<'END'
import xml.dom.minidom
from seen import marks, wall
assert wall('where.png') < 0.6, wall('where.png')
at = marks('where.png')
assert len(at) > 100, len(at)
middle = [sum(p[k] for p in at) / len(at) for k in (0, 1)]
assert all(5 < max(abs(p[k] - middle[k]) for p in at) < 14 for k in (0, 1)) # a ring
svg = xml.dom.minidom.parse('where.svg')
rings = [c for c in svg.getElementsByTagName('circle') if c.getAttribute('fill') == 'none']
assert rings and all(c.getAttribute('stroke-opacity') == '1' for c in rings), rings
END
report render__rings_hidden_contacts_between_triangles_of_both_sides

# If it failed, a contact would be seen in the dark, beside words that cannot be read, and without
# the names of what meets; or its cloth alone would be seen. No number has to be known for the first.
ctl render --size 640x480 -o one.png --up z --at 'contact 1' sink0.obj sink1.obj &&
    ctl render --size 640x480 -o dark.png --up z --at 'contact 1' --view 30,-40 sink0.obj sink1.obj &&
    ctl render -o first.svg --at first --with fall0.obj sink0.obj sink1.obj &&
    grep -Eq '<text [^>]*>(vertex|edge) [0-9-]+ of sink0 meets (face|edge) [0-9-]+ of (sink0|fall0) at \([-0-9., e]+\)</text>' \
        first.svg && ! ctl render -o no.png --at first fall0.obj fall0.obj &&
    grep -q 'step 1 has no contact, and so no first one' err && [ ! -e no.png ] &&
    ctl render --size 320x240 -o small.svg --at first --with fall0.obj sink0.obj sink1.obj &&
    [ "$(grep -o '<text [^>]*>[^<]*' small.svg | sed 's/.*>//' | tr '\n' ' ' | grep -c ' meets .* at (.*) time')" -eq 1 ] &&
    ! grep -E '<text [^>]*>[^<]{50}' small.svg >>"$log" &&
    python3 - >>"$log" 2>&1 <<'END'
from seen import below, contrast, marks, wall
flat = sorted(max(p) for row in below('dark.png') for p in row)
assert flat[len(flat) // 100] > 90 and flat[len(flat) // 2] > 100, flat[::len(flat) // 10] # of 255
assert contrast('dark.png') > 4.5 and contrast('one.png') > 4.5
assert len(marks('one.png')) > 50 and wall('one.png') < 0.7, (len(marks('one.png')), wall('one.png'))
END
report render__lights_one_contact_and_names_what_meets

# If it failed, surfaces would have no thickness where it was asked for, or one where it was not.
# Seen along its plane, a triangle without one is a line.
printf 'v %s\n' '-2 0 -2' '2 0 -2' '0 0 2' >face0.obj
printf 'f 1 2 3\n' >>face0.obj
cp face0.obj face1.obj
record face 0.5 && ctl render --size 600x400 --view 0,0 --up z -o plain.png face.rec &&
    ctl render --thick --size 600x400 --view 0,0 --up z -o thick.png face.rec &&
    python3 - >>"$log" 2>&1 <<'END'
from picture import drawn, runs
plain, thick = drawn('plain.png'), drawn('thick.png')
assert max(sum(line) for line in plain) <= 2, max(map(runs, plain))
lines = [runs(line) for line in thick]
high = sum(any(line) for line in thick)
wide = max(end - first for line in lines for first, end in line)
assert abs(high / wide - 5) < 0.6, (high, wide) # 4 and two radii, by two radii
assert all(len(line) <= 1 for line in lines)
END
report render__draws_surfaces_thick_where_it_is_asked_for

# If it failed, a picture without the thickness that was asked for would not say so.
record none 0 face && timeout 60 "$PCCDCTL" render --thick -o none.png none.rec 2>said >>"$log" &&
    grep -q 'nothing in step 1 has a thickness' said && cat said >>"$log"
report render__says_where_nothing_is_thick

# If it failed, a thickness far above the length of the edges, which is the usual mistake, would keep
# a processor busy for hours.
awk 'BEGIN { for (i = 0; i < 800; i++) { printf "v %d 0 0\np %d\n", i, i + 1 } }' >row0.obj
cp row0.obj row1.obj
record row 1e5 row --rest-exclusion 1e9 && ! ctl render --size 2000x2000 -o row.png row.rec &&
    [ ! -e row.png ] && grep -q 'row.png: too many features that are so thick' err &&
    ctl render --size 64x64 -o row.png row.rec
report render__refuses_what_would_take_hours

# If it failed, a contact at a distance would be drawn where nothing is: each is a line between the
# two nearest points at its time. The radius is 1/4: a point falls on a face, an edge and a point.
printf 'v %s\n' '0 0 0' '4 0 0' '0 4 0' '10 0 0' '14 0 0' '20 0 0' >under.obj
for height in 1 0; do
    printf 'v %s\n' "1 1 $height" "12 0 $height" "20 0 $height" | cat under.obj - >all$((1 - height)).obj
    printf '%s\n' 'f 1 2 3' 'l 4 5' 'p 6 7 8 9' >>all$((1 - height)).obj
done
record all 0.25 && ctl render --size 600x400 --time 0 -o all.svg all.rec &&
    ctl export --time 0.5 -o all.glb all.rec && ctl export --time 0.5 -o all.vtp all.rec &&
    python3 - >>"$log" 2>&1 <<'END'
import base64, json, struct, xml.dom.minidom, xml.etree.ElementTree as tree
svg = xml.dom.minidom.parse('all.svg')
assert len(svg.getElementsByTagName('line')) == len(svg.getElementsByTagName('circle')) == 3
data = open('all.glb', 'rb').read()
size, = struct.unpack('<I', data[12:16])
doc, binary = json.loads(data[20:20 + size]), data[28 + size:]
def read(index):
    accessor = doc['accessors'][index]
    words = accessor['count'] * {'SCALAR': 1, 'VEC3': 3}[accessor['type']]
    form = {5126: 'f', 5125: 'I'}[accessor['componentType']]
    return struct.unpack_from('<%d%s' % (words, form), binary,
                              doc['bufferViews'][accessor['bufferView']]['byteOffset'])
body, points, normals = [mesh['primitives'] for mesh in doc['meshes']]
assert {p['mode']: read(p['indices']) for p in body} == \
    {4: (0, 1, 2), 1: (3, 4), 0: (5, 6, 7, 8)}
assert all(read(p['attributes']['_RADIUS']) == (0.25,) * 9 for p in body)
assert all(len(read(p['targets'][0]['POSITION'])) == 27 for p in body)
ends = read(normals[0]['attributes']['POSITION'])
lines = sorted(ends[i:i + 6] for i in range(0, len(ends), 6)) # of two points the first has the lower index
true = [(1, 1, 0, 1, 1, .5), (12, 0, 0, 12, 0, .5), (20, 0, .5, 20, 0, 0)]
assert len(lines) == 3 and all(abs(a - b) < 1e-5 for line, right in zip(lines, true)
                               for a, b in zip(line, right))
piece = tree.parse('all.vtp').getroot().find('PolyData/Piece')
def vtk(array):
    data = base64.b64decode(array.text, validate=True)
    count, = struct.unpack('<Q', data[:8])
    assert len(data) == 8 + count
    return struct.unpack('<%d%s' % (count // 4, {'Float32': 'f', 'UInt32': 'I'}[array.get('type')]), data[8:])
counts = [int(piece.get('NumberOf' + name)) for name in ('Points', 'Verts', 'Lines', 'Polys')]
assert counts == [12, 3 + 4, 1, 1], counts
cells = {name: {a.get('Name'): vtk(a) for a in piece.find(name)} for name in ('Verts', 'Lines', 'Polys')}
assert cells['Verts']['connectivity'][3:] == (5, 6, 7, 8)
assert cells['Lines'] == {'connectivity': (3, 4), 'offsets': (2,)}
assert cells['Polys']['connectivity'] == (0, 1, 2)
numbers = {a.get('Name'): vtk(a) for a in piece.find('CellData')}
assert sorted(numbers['kind'][:3]) == [0, 2, 3] and numbers['kind'][3:] == (8,) * 6
assert all(len(words) == (9 * 3 if name == 'normal' else 9) for name, words in numbers.items())
assert numbers['feature_a'][3:] == (0, 1, 2, 3, 0, 0)
vertices = {a.get('Name'): vtk(a) for a in piece.find('PointData')}
assert vertices['radius'] == (0.25,) * 9 + (0,) * 3
END
report contacts__at_a_distance_are_lines_and_rods_and_points_are_exported

# If it failed, ParaView would show a series without its contacts, at other times, or no arrows. The
# cloud comes down to the triangle at t = 1, and leaves it in the second step.
ctl export -o 'a&b.pvd' all0.obj all1.obj all0.obj && grep -qx 'a&b.pvd: 2 steps' out &&
    ctl export --time 0.5 --json -o half.pvd --steps 2 all0.obj all1.obj all0.obj &&
    tr -d ' \n' <out | grep -qx '{"file":"half.pvd","steps":1}' &&
    [ "$(ls a\&b_*.vtp half_*.vtp | tr '\n' ' ')" = 'a&b_000001.vtp a&b_000002.vtp half_000002.vtp ' ] &&
    python3 - >>"$log" 2>&1 <<'END'
import xml.etree.ElementTree as tree
def sets(path):
    return [(float(a.get('timestep')), a.get('file')) for a in tree.parse(path).getroot().iter('DataSet')]
assert sets('a&b.pvd') == [(1, 'a&b_000001.vtp'), (2, 'a&b_000002.vtp')], sets('a&b.pvd')
assert sets('half.pvd') == [(1.5, 'half_000002.vtp')], sets('half.pvd')
END
[ $? -eq 0 ] && ! ctl export --near -o no.pvd all0.obj all1.obj && grep -q 'no --near' err &&
    ! ctl export --time 0.5 -o no.vtk all.rec && grep -q 'neither .glb, .vtp nor .pvd' err
report export__a_series_has_a_file_for_each_step
# If it failed, Blender would show objects whose names say nothing.
ctl export --with all1.obj all0.obj all1.obj && grep -q '^all0-step.glb: ' out && python3 - >>"$log" 2>&1 <<'END'
import json, struct
data = open('all0-step.glb', 'rb').read()
size, = struct.unpack('<I', data[12:16])
names = [node['name'] for node in json.loads(data[20:20 + size])['nodes']]
assert names[:2] == ['all0', 'all1'], names
END
report export__objects_of_files_keep_their_names
# If it failed, the parts of a jam would not be told apart in its picture, be where they do not meet,
# or lack the way that they went. A leaf turns about z, from the x axis, and meets the corner of a
# post that is up to the right; a wall stands aside.
box() { # LOW-X HIGH-X LOW-Y HIGH-Y LOW-Z HIGH-Z
    for x in "$1" "$2"; do for y in "$3" "$4"; do for z in "$5" "$6"; do echo "v $x $y $z"; done; done; done
    printf 'f %s\n' '1 2 4 3' '5 7 8 6' '1 5 6 2' '3 4 8 7' '1 3 7 5' '2 6 8 4'
}
box 0.67 0.87 0.5 0.7 -0.05 0.15 >post.obj
box 0.5 1.5 -0.2 0 -0.05 0.05 >leaf.obj
box -0.4 0.2 0.5 0.6 -0.05 0.15 >wall.obj
cat >hinge.json <<'END'
{"pccd_scene": 1,
 "joints": [{"name": "pin", "type": "revolute", "axis": [0, 0, 1], "range": [0, 1.5]}],
 "objects": [{"name": "wall", "files": "wall.obj"}, {"name": "post", "files": "post.obj"},
             {"name": "leaf", "files": "leaf.obj", "joint": "pin"}]}
END
{ ctl sweep -o jam.png hinge.json; [ $? -eq 1 ]; } && says '^picture +jam.png$' &&
    ctl sweep -o least.png --joint pin=0:0.4 hinge.json &&
    ctl sweep -o free.svg --least 0 --joint pin=0:0.4 hinge.json && grep -q '>free at pin = 0.2: ' free.svg &&
    cp jam.png kept.png && ends 2 'neither .png nor .svg' sweep -o jam.jpg hinge.json &&
    fails 4 'no such joint' sweep -o jam.png --joint knee hinge.json && cmp jam.png kept.png &&
    ends 2 'a picture is of a range' sweep -o jam.png --edges hinge.json hinge.json &&
    python3 - >>"$log" 2>&1 <<'END'
from picture import rows
def seen(path):
    places = {'post': [], 'leaf': [], 'mark': [], 'way': [], 'wall': []}
    for y, row in enumerate(rows(path)[112:], 112):
        for x, (r, g, b) in enumerate(row):
            name = 'post' if b > 2 * r else 'mark' if g > 3 * b and r > g - 20 and g > 180 else \
                'leaf' if r > 2.5 * b else 'way' if r > b + 10 else 'wall' if abs(r - b) < 6 and r < 180 else None
            if name:
                places[name].append((x, y))
    return places
jam, least = seen('jam.png'), seen('least.png')
assert all(len(at[name]) > 2500 for at in (jam, least) for name in ('post', 'leaf', 'way', 'wall'))
assert len(jam['way']) > 2 * len(jam['leaf']), [len(at) for at in jam.values()]
assert 40 < len(jam['mark']) < len(least['mark']), (len(jam['mark']), len(least['mark']))
middle = [sum(at[k] for at in jam['mark']) / len(jam['mark']) for k in (0, 1)]
for name in ('post', 'leaf'): # both are beside the mark
    assert min(max(abs(x - middle[0]), abs(y - middle[1])) for x, y in jam[name]) < 12, name
END
report sweep__draws_the_jam_and_the_way_to_it

# If it failed, a body that turns would be drawn on the chords of its arcs: after half of half a turn
# as a line, and its contacts where nothing is.
sed -i 's/1.5]/3.14159]/; s/"pin", "type"/"pin", "position": [0, 0, 0], "type"/' hinge.json
ctl record --contacts -o turn.rec -- "$PCCDCTL" sweep hinge.json
for time in 0 0.5; do
    ctl render --steps 1 --time $time --size 900x600 --view 0,90 --up z -o turn$time.png turn.rec || break
done && ctl render --steps 1 --at 'contact 1' --size 900x600 --view 0,90 --up z -o hit.png turn.rec &&
    ctl export --steps 1 --time 0.5 -o turn.vtp turn.rec && python3 - >>"$log" 2>&1 <<'END'
from picture import rows
def share(name): # of the leaf and the wall
    flat = [p for row in rows(name)[112:] for p in row]
    leaf = sum(g > 1.1 * r and g > 1.1 * b for r, g, b in flat)
    return leaf / sum(b > 1.3 * r for r, g, b in flat)
begin, middle = share('turn0.png'), share('turn0.5.png')
assert abs(middle / begin - 1) < 0.1, (begin, middle)
centre = [p for row in rows('hit.png')[270:330] for p in row[420:480]]
assert any(g > 1.1 * r and g > 1.1 * b for r, g, b in centre) and any(r > 1.15 * b for r, g, b in centre)
END
report render__poses_what_turns_by_its_joints

if /usr/bin/python3 -c 'import vtk' 2>/dev/null; then
    /usr/bin/python3 - >>"$log" 2>&1 <<'END'
import vtk
from vtk.util.numpy_support import vtk_to_numpy
for step, toi in ((1, 1), (2, 0)):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(f'a&b_{step:06}.vtp')
    reader.Update()
    data = reader.GetOutput()
    cells = {data.GetCellData().GetArrayName(i): vtk_to_numpy(data.GetCellData().GetArray(i))
             for i in range(data.GetCellData().GetNumberOfArrays())}
    points = {data.GetPointData().GetArrayName(i): vtk_to_numpy(data.GetPointData().GetArray(i))
              for i in range(data.GetPointData().GetNumberOfArrays())}
    assert data.GetNumberOfPoints() == 10, data.GetNumberOfPoints()
    assert max(abs(a - b) for a, b in zip(data.GetPoint(9), (1, 1, 0))) < 1e-6
    assert tuple(points['normal'][9]) == (0, 0, 1) and not points['normal'][:9].any()
    assert abs(points['toi'][9] - toi) < 1e-6 and (points['toi'][:9] == 2).all()
    assert cells['kind'][0] == 0 and (cells['kind'][1:] == 8).all()
    assert (cells['object_a'][0], cells['feature_a'][0], cells['feature_b'][0]) == (cells['object_b'][0], 6, 0)
    arrows, arrow = vtk.vtkGlyph3D(), vtk.vtkArrowSource()
    arrows.SetInputData(data)
    arrows.SetSourceConnection(arrow.GetOutputPort())
    arrows.SetInputArrayToProcess(1, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_POINTS, 'normal')
    arrows.SetVectorModeToUseVector()
    arrows.SetScaleModeToScaleByVector()
    arrows.Update()
    low_x, high_x, _, _, low_z, high_z = arrows.GetOutput().GetBounds()
    assert high_z - low_z >= 1, (low_z, high_z)
    field = data.GetFieldData()
    assert field.GetAbstractArray('object_names').GetValue(0) == 'all0'
    assert field.GetArray('object_handles').GetTuple1(0) == cells['object_b'][0]
END
    report export__vtk_reads_contacts_as_points_with_normals
else
    tap_skip export__vtk_reads_contacts_as_points_with_normals "no vtk for /usr/bin/python3"
fi

# If it failed, what was exported would come back without its rods and points, or with the marks of
# contacts as if they were some.
ctl check --repeat 0 all.glb all.glb && grep -q '^mesh  *9 vertices, 4 edges, 1 triangle$' out &&
    grep -q '^free  *1 edge, 4 points$' out
report export__is_read_back_with_rods_and_points
# If it failed, whoever exports glTF without -o would lose what was read.
cp all.glb kept.glb && ctl export all.glb all.glb && grep -q '^all-step.glb: ' out && cmp all.glb kept.glb
report export__spares_what_it_reads

tap_end
