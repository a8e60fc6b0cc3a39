#!/bin/bash
# tests/integration/ctl_record.sh - pccdctl record, replay, verify, render, export (TAP).

set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/ctl.sh
. "$top_srcdir/tests/support/ctl.sh"

# A strip of triangles that goes through another one, standing across.
frame() { # HEIGHT
    printf 'ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n'
    printf 'property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n'
    printf '%s\n' '0 0 0' '1 0 0' '0 1 0' "0.25 0.25 $1" "0.75 0.25 $((3 + $1))" \
        "0.25 0.75 $((3 + $1))" '3 0 1 2' '3 3 4 5'
}
frame 1 >frame0.ply
frame -1 >frame1.ply

# If it failed, a session could not be recorded from outside, or its program's end would be lost.
start_daemon s && timeout 60 "$PCCDCTL" record -o session.rec --contacts -- \
    "$PCCDCTL" load --times 5 --socket "$work/s" frame0.ply frame1.ply >"$log" 2>&1 &&
    timeout 60 "$PCCDCTL" record -o other.rec -- bash -c 'exit 7' >>"$log" 2>&1
[ $? -eq 7 ] && [ -s session.rec ] && [ ! -e other.rec ]
report record__keeps_what_a_program_asks_and_its_exit_status

# If it failed, a script would take a session that was never recorded for one that was.
timeout 60 "$PCCDCTL" record -o other.rec -- true >"$log" 2>&1
[ $? -eq 4 ] && grep -q 'nothing was recorded: the program has not connected' "$log" &&
    [ ! -e other.rec ]
report record__fails_when_nothing_was_recorded

# If it failed, a ring of files would be larger than was asked for by what is registered, or
# nobody would know which bound has ended it.
{
    printf 'ply\nformat ascii 1.0\nelement vertex 500\nproperty float x\nproperty float y\n'
    printf 'property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n'
    seq 500 | awk '{ print $1, $1 % 7, 1 / $1 }'
    echo '3 0 1 2'
} >large.ply
timeout 60 "$PCCDCTL" record -o ring.rec --max-bytes 8192 --segments 2 --level 0 -- \
    "$PCCDCTL" load --times 5 --socket "$work/s" large.ply large.ply >"$log" 2>&1 &&
    grep -q 'a segment (--max-bytes / --segments, 4096 bytes) does not hold' "$log" &&
    [ "$(cat ring.rec* | wc -c)" -le 8192 ]
report record__says_what_a_ring_cannot_hold

# If it failed, files of an earlier run would pass for parts of a new one, a second client's
# would be told to nobody, or what is no recording would be removed with them.
twice() {
    # shellcheck disable=SC2016 # the inner shell expands it
    timeout 60 "$PCCDCTL" record -o two.rec -- bash -c '"$0" load --times 2 --socket "$1" \
        frame0.ply frame1.ply & "$0" load --times 2 --socket "$1" frame0.ply frame1.ply; wait' \
        "$PCCDCTL" "$work/s" >>"$log" 2>said
}
: >"$log"
twice && [ "$(grep -c '^pccdctl: two.rec.*2 steps, 2 answers' said)" -eq 2 ] && [ -s two.rec-2 ] &&
    cp two.rec two.rec.1 && cp two.rec two.rec-2.3 && cp two.rec two.rec-old &&
    echo mine >two.rec-9 && twice &&
    [ "$(echo two.rec*)" = "two.rec two.rec-2 two.rec-9 two.rec-old" ] &&
    [ "$(grep -c '^pccdctl: two.rec.*2 steps, 2 answers' said)" -eq 2 ] &&
    "$PCCDCTL" record -- "$PCCDCTL" load --times 1 --socket "$work/s" frame0.ply frame1.ply >>"$log" 2>said &&
    grep -q '^pccdctl: pccdctl.rec: ' said && [ -s pccdctl.rec ] && cp two.rec kept.rec &&
    ! "$PCCDCTL" record -o kept.rec -- true 2>>"$log" && cmp kept.rec two.rec && [ "$(echo kept*)" = kept.rec ] &&
    mkfifo pipe && ! "$PCCDCTL" record -o pipe -- true 2>said &&
    grep -q 'is not a file' said && [ -p pipe ]
report record__removes_what_belongs_to_it

# If it failed, the death of daemon and program together would cost more than the last event.
timeout 60 "$PCCDCTL" record -o killed.rec -- \
    "$PCCDCTL" load --times 1000000 --socket "$work/s" frame0.ply frame1.ply >"$log" 2>&1 &
recorder=$!
for _ in $(seq 100); do
    [ -s killed.rec ] && [ "$(wc -c <killed.rec)" -gt 8192 ] && break
    sleep 0.1
done
kill -9 "$daemon"
wait "$daemon" 2>/dev/null
for child in $(pgrep -P "$recorder"); do
    for program in $(pgrep -P "$child") $child; do
        kill -9 "$program" 2>/dev/null
    done
done
wait "$recorder" 2>/dev/null
timeout 60 "$PCCDCTL" replay --json killed.rec >said 2>>"$log" &&
    grep -q '"differ": 0' said && ! grep -q '"same": 0,' said
report replay__gets_the_same_hashes_from_another_daemon

# If it failed, a file that is cut anywhere would be of no use.
bytes=$(wc -c <session.rec)
status=0
for cut in $((bytes / 2)) $((bytes - 9)) $((bytes - 1)); do
    head -c "$cut" session.rec >cut.rec
    timeout 60 "$PCCDCTL" replay cut.rec >"$log" 2>&1 || status=1
done
[ $status -eq 0 ]
report replay__reads_a_file_that_is_cut

# If it failed, a script would take a recording of nothing for one whose answers are right.
: >"$log"
for cut in 16 17 100; do
    head -c "$cut" session.rec >cut.rec
    timeout 60 "$PCCDCTL" replay cut.rec >out 2>said
    [ $? -eq 4 ] && grep -q 'cut.rec: it holds no step' said || echo "$cut: $(cat out said)" >>"$log"
done
[ ! -s "$log" ]
report replay__of_no_step_is_no_success

# If it failed, a damaged file would be trusted, or nobody would know where it is damaged.
{ head -c $((bytes / 2)) session.rec; printf 'damage'; tail -c +$((bytes / 2 + 7)) session.rec; } >bad.rec
timeout 60 "$PCCDCTL" replay bad.rec >"$log" 2>&1
[ $? -eq 4 ] && grep -q 'at byte [0-9]*' "$log"
report replay__says_where_a_file_is_damaged

# If it failed, what is before the damage would be lost with it, or passed for everything.
timeout 60 "$PCCDCTL" record -o long.rec --contacts -- \
    "$PCCDCTL" load --times 50 --private frame0.ply frame1.ply >"$log" 2>&1
bytes=$(wc -c <long.rec)
{ head -c $((bytes / 2)) long.rec; printf 'damage'; tail -c +$((bytes / 2 + 7)) long.rec; } >bad.rec
for command in replay verify 'inspect -o a.html'; do
    # shellcheck disable=SC2086 # words
    timeout 60 "$PCCDCTL" $command bad.rec >said 2>&1
    [ $? -eq 4 ] || echo "$command takes it" >>"$log"
    [ "${command%% *}" = inspect ] && grep -q 'built without' said && continue
    before=$(grep -o -e '--steps \.\.[0-9]*' said) || { echo "$command: $(cat said)" >>"$log"; continue; }
    # shellcheck disable=SC2086 # words
    timeout 60 "$PCCDCTL" $command $before bad.rec >said 2>&1 && grep -q 'is damaged after' said ||
        { echo "$command $before: $(cat said)" >>"$log"; }
done
timeout 60 "$PCCDCTL" render -o a.png bad.rec >said 2>&1 && grep -q 'is damaged after' said ||
    echo "render: $(cat said)" >>"$log"
! grep -v -e '^pccdctl: long.rec: ' -e '^steps ' -e '^triangles ' -e '^contacts ' -e '^round trip ' "$log"
report replay__keeps_what_is_before_the_damage

# If it failed, a mistyped range would be called right, because nothing in it is wrong.
{ head -c 16 session.rec; } >empty.rec
status=0
for wrong in 'replay --steps 99' 'verify --steps 99..' 'replay --json --steps 6..7'; do
    # shellcheck disable=SC2086 # words
    timeout 60 "$PCCDCTL" $wrong session.rec >"$log" 2>&1
    [ $? -eq 4 ] && grep -q 'holds no such step' "$log" || { echo "$wrong" >>"$log"; status=1; break; }
done
[ $status -eq 0 ] && ! timeout 60 "$PCCDCTL" verify empty.rec >"$log" 2>&1 &&
    grep -q 'none of 0 steps' "$log" && ! grep -q PASS "$log"
report verify__passes_nothing_that_it_has_not_checked

# If it failed, right answers would not be called right, or by a daemon that is not there.
timeout 60 "$PCCDCTL" verify session.rec >"$log" 2>&1 && grep -q '^PASS: ' "$log"
report verify__passes_right_answers

# If it failed, a picture could not be opened, or would have another size.
timeout 60 "$PCCDCTL" render session.rec --steps 1 --size 320x200 -o a.png >"$log" 2>&1 &&
    timeout 60 "$PCCDCTL" render session.rec --steps 1 --at contacts --up z --view 60,40 \
        --zoom 0.5 -o a.svg >>"$log" 2>&1 &&
    python3 - >>"$log" 2>&1 <<'EOF'
import base64, struct, xml.dom.minidom
png = open('a.png', 'rb').read()
assert png[:8] == b'\x89PNG\r\n\x1a\n' and struct.unpack('>II', png[16:24]) == (320, 200)
svg = xml.dom.minidom.parse('a.svg')
image = svg.getElementsByTagName('image')[0].getAttribute('xlink:href')
assert base64.b64decode(image.split(',')[1])[:4] == b'\x89PNG'
assert any('1 contact' in text.firstChild.data for text in svg.getElementsByTagName('text'))
assert len(svg.getElementsByTagName('circle')) > 0
EOF
report render__writes_png_and_svg

# If it failed, nobody could look at one contact: the moment would be another, something would be
# in front of it, or a number that there is not be drawn as one that there is.
{
    timeout 60 "$PCCDCTL" render session.rec --steps 1 --size 320x200 --at contact 1 -o c.svg &&
        timeout 60 "$PCCDCTL" render --at 'contact 1' --steps 1 --size 320x200 -o d.svg session.rec &&
        cmp c.svg d.svg &&
        timeout 60 "$PCCDCTL" render session.rec --steps 1 --at contact 1 --time 0.25 -o e.svg &&
        timeout 60 "$PCCDCTL" render session.rec --steps 1 --at all -o g.svg
} >said 2>"$log" && [ "$(grep -c '^[cd].svg: step 1 at t = 0\.5, 1 object, 1 contact$' said)" = 2 ] &&
    grep -q '^e.svg: step 1 at t = 0.25' said &&
    grep -q 'step 1 at t = 0.5, contact 1 of 1</text>' c.svg &&
    grep -q '<circle cx="160.00" cy="100.00" r="6.3[0-9]*" opacity="1"' c.svg &&
    ! grep -q 'r="6.3' g.svg && grep -q 'step 1, 1 contact</text>' g.svg &&
    ! timeout 60 "$PCCDCTL" render session.rec --steps 1 --at contact 2 -o f.svg >"$log" 2>&1 &&
    grep -q 'step 1 has 1 contact, and no contact 2' "$log" && [ ! -e f.svg ] &&
    ! timeout 60 "$PCCDCTL" render session.rec --at contact -o f.svg >"$log" 2>&1
report render__looks_at_one_contact

# If it failed, Blender would not open the file, or show another scene.
timeout 60 "$PCCDCTL" export session.rec --steps 1 --time 0.5 -o a.glb >"$log" 2>&1 &&
    python3 - >>"$log" 2>&1 <<'EOF'
import json, struct
data = open('a.glb', 'rb').read()
magic, version, length, text_bytes, kind = struct.unpack('<IIIII', data[:20])
assert (magic, version, length, kind) == (0x46546c67, 2, len(data), 0x4e4f534a)
doc = json.loads(data[20:20 + text_bytes])
binary = data[20 + text_bytes:]
bin_bytes, kind = struct.unpack('<II', binary[:8])
assert kind == 0x004e4942 and bin_bytes == len(binary) - 8 == doc['buffers'][0]['byteLength']
binary = binary[8:]
sizes = {'SCALAR': 1, 'VEC3': 3}
def read(index):
    accessor = doc['accessors'][index]
    view = doc['bufferViews'][accessor['bufferView']]
    words = accessor['count'] * sizes[accessor['type']]
    assert words * 4 == view['byteLength'] and view['byteOffset'] % 4 == 0
    assert view['byteOffset'] + view['byteLength'] <= bin_bytes
    form = {5126: 'f', 5125: 'I'}[accessor['componentType']]
    return struct.unpack_from('<%d%s' % (words, form), binary, view['byteOffset'])
mesh, _, lines = [m['primitives'][0] for m in doc['meshes']]
marks = doc['meshes'][1]['primitives']
x, motion = read(mesh['attributes']['POSITION']), read(mesh['targets'][0]['POSITION'])
assert x[9:12] == (0.25, 0.25, 1.0) and motion[9:12] == (0, 0, -2), (x, motion)
assert read(mesh['indices']) == (0, 1, 2, 3, 4, 5) and doc['meshes'][0]['weights'] == [0.5]
bounds = doc['accessors'][mesh['attributes']['POSITION']]
assert bounds['min'] == [0, 0, 0] and bounds['max'] == [1, 1, 4]
count = doc['extras']['contacts']
assert all(m['mode'] == 4 for m in marks) and lines['mode'] == 1 and count > 0
corners = read(marks[0]['attributes']['POSITION'])
assert len(corners) == 6 * 3 * count and sum(len(read(m['indices'])) for m in marks) == 24 * count
# Octahedra about where the lines begin; each side of one is seen from outside.
ends = read(lines['attributes']['POSITION'])
for i in range(count):
    for k in range(3):
        assert abs(sum(corners[18 * i + k:18 * i + 18:3]) / 6 - ends[6 * i + k]) < 1e-6
side = [corners[3 * v:3 * v + 3] for v in read(marks[0]['indices'])[:3]]
middle = [sum(corners[k:18:3]) / 6 for k in range(3)]
u, v = [[a - b for a, b in zip(side[n], side[0])] for n in (1, 2)]
n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
assert sum(a * (b - c) for a, b, c in zip(n, side[0], middle)) > 0
assert len(read(lines['attributes']['POSITION'])) == 6 * doc['extras']['contacts']
assert max(abs(v) for v in corners) <= 1.1
assert doc['animations'][0]['channels'][0]['target'] == {'node': 0, 'path': 'weights'}
for accessor in range(len(doc['accessors'])):
    read(accessor)
EOF
report export__writes_gltf

# If it failed, ParaView would not open the file, or show other numbers.
timeout 60 "$PCCDCTL" export session.rec --steps 1 -o a.vtp >"$log" 2>&1 &&
    python3 - >>"$log" 2>&1 <<'EOF'
import base64, struct, xml.etree.ElementTree as tree
root = tree.parse('a.vtp').getroot()
assert root.get('type') == 'PolyData' and root.get('header_type') == 'UInt64'
piece = root.find('PolyData/Piece')
forms = {'Float32': 'f', 'UInt32': 'I'}
def read(array): # as VTK does: length and values are one piece of base64
    data = base64.b64decode(array.text, validate=True)
    count, = struct.unpack('<Q', data[:8])
    data = data[8:]
    assert len(data) == count
    return struct.unpack('<%d%s' % (count // 4, forms[array.get('type')]), data)
points, verts, polys = [int(piece.get('NumberOf' + n)) for n in ('Points', 'Verts', 'Polys')]
assert polys == 2 and verts > 0 and points == 6 + verts
x = read(piece.find('Points/DataArray'))
assert len(x) == 3 * points and x[9:12] == (0.25, 0.25, -1.0)
cells = {a.get('Name'): read(a) for a in piece.find('CellData')}
assert all(len(v) == (verts + polys) * (3 if n == 'normal' else 1) for n, v in cells.items())
assert all(0 <= t <= 1 for t in cells['toi'][:verts]) and cells['toi'][verts:] == (2, 2)
assert set(cells['kind'][:verts]) <= {0, 1} and cells['kind'][verts:] == (8, 8)
for cell, each, count in (('Verts', 1, verts), ('Polys', 3, polys)):
    of = {a.get('Name'): read(a) for a in piece.find(cell)}
    assert len(of['connectivity']) == each * count and max(of['connectivity']) < points
    assert of['offsets'] == tuple(each * (i + 1) for i in range(count))
owner = {a.get('Name'): read(a) for a in piece.find('PointData')}['object']
assert owner[:6] == cells['object_a'][verts:verts + 1] * 6 and set(owner[6:]) == {0}
EOF
report export__writes_vtk

# If it failed, a reader of many steps would have to guess which there are, or be told other
# numbers than those of the recording.
timeout 60 "$PCCDCTL" export --list --json session.rec >list.json 2>"$log" &&
    timeout 60 "$PCCDCTL" export --list --steps 1 session.rec >list.txt 2>>"$log" &&
    grep -qE '^step 1: [1-9][0-9]* records?, first at t = 0[.]' list.txt &&
    [ "$(wc -l <list.txt)" -eq 1 ] && python3 - >>"$log" 2>&1 <<'EOF'
import json, subprocess, os
steps = json.load(open('list.json'))
assert [one['step'] for one in steps] == list(range(1, len(steps) + 1)) and len(steps) > 1
for one in steps[:2]:
    told = json.loads(subprocess.run(
        [os.environ['PCCDCTL'], 'export', '--json', '-o', 'one.vtp', '--steps', str(one['step']), 'session.rec'],
        check=True, capture_output=True).stdout)
    assert told['contacts'] == one['contacts'] and (one['toi_first'] is None) == (one['contacts'] == 0)
EOF
[ $? -eq 0 ] && ! "$PCCDCTL" export --list -o a.vtp session.rec 2>>"$log" &&
    ! "$PCCDCTL" export --list list.json 2>>"$log"
report export__lists_steps

# If it failed, a scene in micrometres, of a galaxy, or far from where it is counted from would be
# drawn dark, as nothing, or in steps. Powers of two, so that the pictures must be the same.
python3 - <<'EOF'
strip = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (.25, .25, 1), (.75, .25, 2), (.25, .75, 2)]
for name, scale, shift in (('here', 1, 0), ('small', 2.**-60, 0), ('large', 2.**58, 0), ('far', 1, 2.**40)):
    for frame in range(2):
        with open('%s%d.obj' % (name, frame), 'w') as to:
            for x in strip:
                print('v', *(repr(scale * c + shift) for c in (x[0], x[1], x[2] + frame / 4)), file=to)
            print('f 1 2 3', 'f 4 5 6', sep='\n', file=to)
EOF
: >"$log"
for scene in here small large far; do
    timeout 60 "$PCCDCTL" record -o $scene.rec --contacts -- "$PCCDCTL" load --private --times 1 \
        ${scene}0.obj ${scene}1.obj >>"$log" 2>&1 &&
        timeout 60 "$PCCDCTL" render -o $scene.png --size 200x150 $scene.rec >>"$log" 2>&1 &&
        cmp $scene.png here.png >>"$log" 2>&1 || echo "not ok: $scene" >>"$log"
done
timeout 60 "$PCCDCTL" export -o far.glb far.rec >>"$log" 2>&1 &&
    timeout 60 "$PCCDCTL" export -o far.vtp far.rec >>"$log" 2>&1 && python3 - >>"$log" 2>&1 <<'EOF' || echo 'not ok: export' >>"$log"
import base64, json, struct, xml.etree.ElementTree as tree
true = [(c[0] + 2.**40, c[1] + 2.**40, c[2] + .25 + 2.**40) for c in
        ((0, 0, 0), (1, 0, 0), (0, 1, 0), (.25, .25, 1), (.75, .25, 2), (.25, .75, 2))]
data = base64.b64decode(tree.parse('far.vtp').find('.//Points/DataArray').text, validate=True)
assert [tuple(x) for x in struct.iter_unpack('<3d', data[8:])] == true
glb = open('far.glb', 'rb').read()
length = struct.unpack('<I', glb[12:16])[0]
document = json.loads(glb[20:20 + length])
start, = (document['bufferViews'][a['bufferView']]['byteOffset'] for a in document['accessors'][:1])
x0 = [struct.unpack_from('<3f', glb, 28 + length + start + 12 * i) for i in range(6)]
off = document['nodes'][0]['translation']
assert all(abs(a + o - (b - .25 * (k == 2))) < 1e-6 for x, y in zip(x0, true)
           for k, (a, o, b) in enumerate(zip(x, off, y)))
EOF
! grep -q 'not ok' "$log"
report stills__are_the_same_at_every_scale_and_place

# If it failed, a program could not tell what was drawn or written.
for command in 'render --size 320x200 -o a.png' 'export -o a.glb'; do
    # shellcheck disable=SC2086 # words
    timeout 60 "$PCCDCTL" $command --json --steps 1 session.rec >out 2>"$log" &&
        grep -q '^  "step": 1,$' out && grep -q '^  "objects": 1,$' out &&
        grep -q '^  "contacts": 1$' out && grep -q "^  \"file\": \"${command##* }\",\$" out ||
        { echo "$command" && cat out; } >>"$log"
done
[ ! -s "$log" ]
report stills__speak_json

# If it failed, a wrong use would end in something else than a sentence.
status=0
for wrong in "replay" "replay a b" "replay --steps 3..2 session.rec" "replay --steps 0 session.rec" \
    "replay --pace slow session.rec" "render session.rec -o a.jpg" \
    "render session.rec -o a.png --size 10x10" "export session.rec -o a.obj" "record -o x" \
    "verify --sample x session.rec"; do
    # shellcheck disable=SC2086 # words
    "$PCCDCTL" $wrong >"$log" 2>&1
    [ $? -eq 2 ] && [ -s "$log" ] || { echo "$wrong" >>"$log"; status=1; break; }
done
[ $status -eq 0 ]
report options__are_refused_when_they_are_wrong

tap_end
