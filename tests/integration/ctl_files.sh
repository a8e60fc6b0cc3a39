#!/bin/bash
# tests/integration/ctl_files.sh - files that pccdctl and pccd-load read and write (TAP).

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}"
# shellcheck source=tests/support/ctl.sh
. "$top_srcdir/tests/support/ctl.sh"

load=$top_builddir/pccd-load
frame 1 >a.obj
frame -1 >b.obj
timeout 60 "$PCCDCTL" record -o some.rec --contacts -- \
    "$PCCDCTL" load --private --times 3 a.obj b.obj >"$log" 2>&1 || exit 99
has_page=yes
timeout 60 "$PCCDCTL" inspect -o page.html some.rec 2>&1 | grep -q 'built without' && has_page=

# If it failed, a scene that was exported could not be looked at by us again, or would be another.
"$PCCDCTL" export --steps 1 --time 0 -o 0.glb some.rec >"$log" 2>&1 &&
    "$PCCDCTL" export --steps 1 --time 1 -o 1.glb some.rec >>"$log" 2>&1 &&
    "$PCCDCTL" check --private --json 0.glb 1.glb >from_glb 2>>"$log"
"$PCCDCTL" check --private --json a.obj b.obj >from_obj 2>>"$log"
grep -h '"hash"' from_glb from_obj >>"$log"
grep -q '"contacts": 1,' from_glb && [ "$(grep '"hash"' from_glb)" = "$(grep '"hash"' from_obj)" ]
report files__an_export_is_read_again

# If one failed, who has two files would have to write a program that is recorded to see more
# than a list of contacts; or files would stay behind.
mkdir tmp
export TMPDIR=$work/tmp
for output in two.png two.glb ${has_page:+two.html}; do
    case $output in
    *.png) command="render --size 64x64" what='1 contact$' ;;
    *.glb) command=export what='1 contact$' ;;
    *.html) command=inspect what='1 step, 1 to 1, ' ;;
    esac
    # shellcheck disable=SC2086 # words
    timeout 60 "$PCCDCTL" $command -o $output a.obj b.obj >"$log" 2>&1 &&
        grep -q "$what" "$log" && [ -s $output ] && [ -z "$(ls tmp)" ]
    report "files__two_frames_become_$output"
done
timeout 60 "$PCCDCTL" render --size 64x64 -o one.png a.obj >"$log" 2>&1 &&
    grep -q '0 contacts$' "$log" && ! "$PCCDCTL" render -o no.png a.obj some.rec >>"$log" 2>&1 &&
    grep -q 'some.rec: neither PLY' "$log" && [ ! -e no.png ] && [ -z "$(ls tmp)" ]
report files__one_mesh_is_drawn_where_it_stands

# If it failed, who kills a command that shows frames would find their recording, which may
# be large, in a folder that nobody cleans.
many=
for _ in $(seq 1500); do
    many+="a.obj b.obj "
done
# shellcheck disable=SC2086 # words
"$PCCDCTL" render --size 64x64 -o killed.png $many >"$log" 2>&1 &
pid=$!
was_seen=1
for _ in $(seq 2000); do
    # shellcheck disable=SC2012 # names of ours
    ls -l "/proc/$pid/fd" 2>/dev/null | grep -q "$TMPDIR/.*(deleted)" && was_seen=0 && break
done
kill -KILL "$pid" 2>/dev/null
wait "$pid" 2>/dev/null
[ $was_seen = 0 ] && [ -z "$(ls tmp)" ] && [ ! -e killed.png ]
report files__a_killed_command_leaves_nothing
unset TMPDIR

# If it failed, a browser would show the first picture alone, or none.
cat >film.py <<'END'
import struct, sys, zlib
data, at, sequence, pictures = open(sys.argv[1], "rb").read(), 8, 0, []
assert data[:8] == b"\x89PNG\r\n\x1a\n"
while at < len(data):
    count, kind = struct.unpack(">I4s", data[at:at + 8])
    body = data[at + 8:at + 8 + count]
    assert struct.unpack(">I", data[at + 8 + count:at + 12 + count])[0] == zlib.crc32(kind + body)
    at += 12 + count
    if kind == b"IHDR":
        width, height, depth, colour = struct.unpack(">IIBB", body[:10])
        assert (depth, colour) == (8, 2)
    elif kind == b"acTL":
        frames = struct.unpack(">II", body)[0]
    elif kind in (b"fcTL", b"fdAT"):
        assert struct.unpack(">I", body[:4])[0] == sequence
        sequence += 1
        if kind == b"fcTL":
            assert struct.unpack(">IIIIHH", body[4:24]) == (width, height, 0, 0, 1, 10)
            pictures.append(b"")
        else:
            pictures[-1] += body[4:]
    elif kind == b"IDAT":
        pictures[-1] += body
assert kind == b"IEND" and frames == len(pictures) == 3, (kind, frames, len(pictures))
pixels = [zlib.decompress(picture) for picture in pictures]
assert {len(p) for p in pixels} == {height * (1 + 3 * width)}
assert pixels[0] != pixels[1], "nothing moves"
END
timeout 60 "$PCCDCTL" render --size 64x64 --rate 10 -o film.apng a.obj b.obj a.obj b.obj >"$log" 2>&1 &&
    grep -qx 'film.apng: 3 steps' "$log" && [ -s film.apng ]
report files__frames_become_a_film
if command -v python3 >/dev/null; then
    python3 film.py film.apng >"$log" 2>&1
    report files__film_is_an_animated_png
else
    tap_skip files__film_is_an_animated_png "no python3"
fi
timeout 60 "$PCCDCTL" render --size 64x64 --every 2 -o film.apng a.obj b.obj a.obj b.obj >"$log" 2>&1 &&
    grep -qx 'film.apng: 2 steps' "$log" &&
    timeout 60 "$PCCDCTL" render --size 64x64 --first-tries -o film.apng a.obj a.obj a.obj b.obj a.obj >"$log" 2>&1 &&
    grep -qx 'film.apng: 2 steps' "$log"
# If it failed, a film of a program that tries each frame again and again would flicker.
report files__film_leaves_out_further_tries
for z in 9 0; do
    printf 'v 0 0 %s\nv 1 0 %s\nv 0 1 %s\nv 0 0 -5\nv 2 0 -5\nv 0 2 -5\nf 1 2 3\nf 4 5 6\n' $z $z $z >drop$z.obj
done
for up in '' '--up z' '--up y'; do
    # shellcheck disable=SC2086 # words
    for ending in png apng; do
        timeout 60 "$PCCDCTL" render --private --size 64x64 $up -o "up${up#--up }.$ending" drop9.obj drop0.obj
    done
done >"$log" 2>&1
cmp up.png upz.png >>"$log" && cmp up.apng upz.apng >>"$log" && ! cmp -s up.png upy.png && ! cmp -s up.apng upy.apng
# If it failed, what falls would lie on its side in a picture or a film, and stand on the page.
report files__up_is_where_things_fall_from
! "$PCCDCTL" render --at 'contact 1' -o no.apng some.rec 2>"$log" && grep -q 'a film is of steps' "$log" &&
    ! "$PCCDCTL" render --rate 3 -o no.png some.rec 2>"$log" && grep -q 'rate is of a film' "$log" &&
    ! "$PCCDCTL" render --every 3 -o no.png some.rec 2>"$log" && grep -q 'every is of a film' "$log" &&
    ! "$PCCDCTL" render --first-tries -o no.png some.rec 2>"$log" && grep -q 'first-tries is of a film' "$log" &&
    ! "$PCCDCTL" render --first-tries --time 1 -o no.apng some.rec 2>"$log" && grep -q 'no --time' "$log" &&
    [ ! -e no.apng ] && [ ! -e no.png ]
# If it failed, an option would be taken and do nothing.
report files__film_refuses_what_it_has_not

# If it failed, the name of a file could clear the screen of who works with it, or answer a
# question for them. A name that is not UTF-8 would make JSON that is none.
evil=$'\e[2J\x9b\xff'
shown='\x1b[2J\x9b\xff'
cp some.rec "$evil.rec"
cp a.obj "$evil.obj"
: >"$log"
harmless() { # STATUS COMMAND...
    local status=$1
    shift
    timeout 60 "$@" >out 2>err
    [ $? -eq "$status" ] && cat out err | grep -qF "$shown" && ! cat out err | grep -q "$(printf '[\033\233]')" ||
        { echo "not so: $*"; cat -v out err; } >>"$log"
}
harmless 4 "$PCCDCTL" replay "no$evil"
harmless 4 "$PCCDCTL" check "no$evil" a.obj
harmless 4 "$PCCDCTL" check "$evil.rec" a.obj
harmless 1 "$PCCDCTL" check "$evil.obj" b.obj
harmless 0 "$PCCDCTL" render --size 64x64 -o "$evil.png" "$evil.rec"
harmless 0 "$PCCDCTL" export -o "$evil.glb" "$evil.rec"
harmless 4 "$PCCDCTL" replay --steps 99 "$evil.rec"
harmless 4 "$PCCDCTL" render -o "/nowhere/$evil.png" some.rec
harmless 2 "$PCCDCTL" render -o "$evil.jpg" some.rec
harmless 2 "$PCCDCTL" list "$evil"
harmless 2 "$PCCDCTL" "$evil"
harmless 3 "$PCCDCTL" ping --socket "$work/$evil"
mkdir "$evil"
harmless 4 "$PCCDCTL" record -o "$evil" -- true
[ -z "$has_page" ] || harmless 0 "$PCCDCTL" inspect -o "$evil.html" some.rec
harmless 4 "$load" --csv "/nowhere/$evil" --clients 1
harmless 2 "$load" --clients "$evil"
if command -v python3 >/dev/null; then
    for command in "render --size 64x64 -o x$evil.png" "export -o x$evil.glb"; do
        # shellcheck disable=SC2086 # words
        timeout 60 "$PCCDCTL" $command --json some.rec >out 2>err &&
            python3 -c 'import json; assert json.load(open("out"))["file"].startswith("x\\x1b")' ||
            cat -v out err >>"$log"
    done
fi
[ ! -s "$log" ]
report names__cannot_control_a_terminal

# On a disk that holds 16 KiB: nothing is left of a file that does not fit, what was there before
# stays, and the program says why. Run as root of a mount namespace of our own.
cat >full.sh <<'EOF'
mount -t tmpfs -o size=16k none full || exit 77
attempt() { # FILE COMMAND...
    file=$1
    shift
    for old in '' good; do
        [ -z "$old" ] || printf good >"full/$file"
        timeout 60 "$@" >out 2>err
        status=$?
        [ $status -eq 4 ] && grep -q 'No space left on device' err &&
            [ "$(cat full/* 2>/dev/null)" = "$old" ] ||
            { echo "$*: $status"; cat err; ls -l full; }
        rm -f full/*
    done
}
attempt a.png "$PCCDCTL" render --size 2400x1800 -o full/a.png some.rec
attempt a.svg "$PCCDCTL" render -o full/a.svg large.rec
attempt a.glb "$PCCDCTL" export -o full/a.glb large.rec
attempt a.vtp "$PCCDCTL" export -o full/a.vtp large.rec
attempt a.png "$PCCDCTL" demo --steps 1 -o full/a.png
[ -z "$has_page" ] || attempt a.html "$PCCDCTL" inspect -o full/a.html some.rec
attempt a.csv "$PCCDCTL" check --contacts full/a.csv large0.obj large1.obj
attempt a.json "$PCCDCTL" check --repeat 50 --trace full/a.json large0.obj large1.obj
EOF
# 2000 strips that meet a floor of one triangle each.
for height in 1 -1; do
    seq 2000 | awk -v h="$height" '{ x = 3 * $1
        print "v", x, 0, 0; print "v", x + 1, 0, 0; print "v", x, 1, 0
        print "v", x + .25, .25, h; print "v", x + .75, .25, 3 + h; print "v", x + .25, .75, 3 + h
        f = f "f " 6 * $1 - 5 " " 6 * $1 - 4 " " 6 * $1 - 3 "\nf " 6 * $1 - 2 " " 6 * $1 - 1 " " 6 * $1 "\n" }
        END { printf "%s", f }' >"large$((height < 0)).obj"
done
timeout 60 "$PCCDCTL" record -o large.rec --contacts -- \
    "$PCCDCTL" load --private --times 1 large0.obj large1.obj >"$log" 2>&1
mkdir full
export PCCDCTL has_page
if unshare --mount true 2>/dev/null; then
    as_root=''
else
    as_root=--map-root-user
fi
# shellcheck disable=SC2086 # nothing or a word
timeout 300 unshare $as_root --mount bash full.sh >"$log" 2>&1
status=$?
if grep -q '^mount: \|^unshare: ' "$log" || [ $status -eq 77 ]; then
    tap_skip files__appear_whole_or_not_at_all "no disk can be mounted here"
else
    [ $status -eq 0 ] && [ ! -s "$log" ]
    # If it failed, half a picture would be taken for one, or a good file be lost.
    report files__appear_whole_or_not_at_all
fi

# On disks of two to sixteen pages, whether a page ends with a chunk or within one.
cat >full_record.sh <<'EOF'
for pages in 2 3 4 8 16; do
    for level in 0 1; do
        mount -t tmpfs -o size=$((4 * pages))k none full || exit 77
        timeout 60 "$PCCDCTL" record -o full/a.rec --contacts --level $level -- \
            "$PCCDCTL" load --private --times 600 a.obj b.obj >out 2>err
        [ $? -eq 4 ] && grep -q 'a.rec could not be written to its end' err ||
            { echo "$pages pages, level $level:"; cat err; ls -l full; }
        timeout 60 "$PCCDCTL" verify full/a.rec >out 2>err && grep -q '^PASS' out &&
            grep -q 'a.rec ends because it could not be written' err ||
            { echo "$pages pages, level $level, verify:"; cat out err; }
        umount full
    done
done
EOF
# shellcheck disable=SC2086 # nothing or a word
timeout 300 unshare $as_root --mount bash full_record.sh >"$log" 2>&1
status=$?
if grep -q '^mount: \|^unshare: ' "$log" || [ $status -eq 77 ]; then
    tap_skip files__a_recording_on_a_full_disk_is_a_failure "no disk can be mounted here"
else
    [ $status -eq 0 ] && [ ! -s "$log" ]
    # If it failed, a script would take half a recording for all of it.
    report files__a_recording_on_a_full_disk_is_a_failure
fi

# If it failed, somebody would wait for minutes, and for all of the memory, to be told what the
# first lines of a file show.
: >"$log"
printf 'ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n' >large.ply
printf 'v 0 0 0\n' >holes.obj
cp some.rec holes.rec
head -c 100 some.rec >short.rec
for file in large.ply holes.obj holes.rec short.rec; do
    truncate -s 8G $file || { tap_skip files__are_judged_by_their_beginning "no sparse files"; tap_end; exit; }
done
too_large() { # STATUS TEXT COMMAND...
    local status=$1 text=$2
    shift 2
    timeout 10 "$@" >out 2>err
    [ $? -eq "$status" ] && grep -q "$text" err || { echo "not so: $*"; cat out err; } >>"$log"
}
too_large 4 'rows of element "vertex" take 12000000000 bytes or more, and 85899344[0-9]* of the file are left' \
    "$PCCDCTL" check large.ply large.ply
too_large 4 'holes.obj: byte 8 is zero' "$PCCDCTL" load holes.obj
too_large 0 'holes.rec is cut off after byte' "$PCCDCTL" replay holes.rec
too_large 4 'none of 0 steps\|damaged\|at byte' "$PCCDCTL" verify short.rec
[ ! -s "$log" ]
report files__are_judged_by_their_beginning

# If it failed, a command would wait for ever, without a word, for who writes into a pipe.
: >"$log"
mkfifo pipe.rec
for command in replay verify render 'render --near' export 'export --list' ${has_page:+inspect}; do
    case $command in
    replay | verify | *--list) output= ;;
    render*) output='-o no.png' ;;
    export) output='-o no.glb' ;;
    inspect) output='-o no.html' ;;
    esac
    # shellcheck disable=SC2086 # words
    too_large 4 'pipe.rec: not a file' "$PCCDCTL" $command $output pipe.rec
done
[ ! -s "$log" ]
report files__a_recording_is_no_pipe

# If it failed, a device that never ends would be read for ever, or a mesh could not come out
# of another program.
: >"$log"
for file in /dev/zero /dev/urandom; do
    too_large 4 "$file: a device, neither file nor pipe" "$PCCDCTL" check $file $file
done
endless() { "$PCCDCTL" check /dev/stdin a.obj </dev/zero; }
piped() { cat /dev/zero | "$PCCDCTL" check /dev/stdin a.obj; }
export -f endless piped
too_large 4 'stdin: a device' bash -c endless
too_large 4 'stdin: neither PLY' bash -c piped
mkfifo a.pipe.obj
cat a.obj >a.pipe.obj &
timeout 10 "$PCCDCTL" check --private a.pipe.obj b.obj >out 2>&1
[ $? -eq 1 ] && grep -q '^contacts  *1' out || cat out >>"$log"
# The corners of STL are looked at before its frame is.
printf 'solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n' >one.stl
mkfifo pipe.stl
cat one.stl >pipe.stl &
timeout 10 "$PCCDCTL" check --private one.stl pipe.stl >out 2>&1 || cat out >>"$log"
[ ! -s "$log" ]
report files__a_mesh_is_a_file_or_a_pipe

# If it failed, OBJ and STL would be read from files alone whose names say so, not from a pipe of
# the shell or a file of a temporary name.
: >"$log"
{ printf '# of a program\n\n'; cat a.obj; } >nameless_obj
cp one.stl nameless_stl
first() { "$PCCDCTL" check --private "$1" "$2" 2>&1 | sed -n 's/^\(mesh\|contacts\) //p'; }
for kind in obj stl; do
    cp nameless_$kind nameless.$kind
    want=$(first nameless.$kind nameless.$kind)
    [ -n "$want" ] && [ "$(first nameless_$kind nameless_$kind)" = "$want" ] &&
        [ "$(first <(cat nameless_$kind) <(cat nameless_$kind))" = "$want" ] || echo "$kind: $want" >>"$log"
done
echo "hello, world" >letter
# Of a pipe nobody sees a name: an opening brace is that of glTF's JSON.
printf '{"asset": {"version": "3.0"}}' >nameless_gltf
"$PCCDCTL" check --private nameless_gltf nameless_gltf >out 2>&1
grep -q 'glTF of version 3.0' out || cat out >>"$log"
# The header of a binary STL file may begin with the word of another format.
{ printf 'ply of a converter%62s' ''; printf '\1\0\0\0'; head -c 12 /dev/zero; printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0\0\0'; } >word.stl
"$PCCDCTL" check --private word.stl word.stl >out 2>&1
grep -q '^mesh  *3 vertices, 3 edges, 1 triangle' out || cat out >>"$log"
"$PCCDCTL" check --private letter letter >out 2>&1
[ $? -eq 4 ] && grep -q 'letter: neither .* nor what begins as OBJ or STL' out || cat out >>"$log"
[ ! -s "$log" ]
report files__are_known_by_how_they_begin

# ply NAME ELEMENTS ROW...: a file of four vertices, with these lines of the header behind them.
ply() {
    local name=$1 elements=$2
    shift 2
    printf 'ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n' >"$name.ply"
    printf "${elements}end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n" >>"$name.ply"
    printf '%s\n' "$@" >>"$name.ply"
}
# reads NAME WHAT: what is said of a file that stands still.
reads() {
    timeout 20 "$PCCDCTL" check --private "$1" "$1" >out 2>&1
    grep -q -- "$2" out || { echo "$1: no \"$2\"" && cat out; } >>"$log"
}
# If it failed, faces would be taken from another list than theirs, or left out without a word, or
# groups and solids be taken for faces.
: >"$log"
list='property list uchar int'
ply two_lists "element face 1\n$list indices\n$list vertex_indices\n" '3 0 0 0 3 0 1 2'
reads two_lists.ply ' 3 edges, 1 triangle'
ply group "element face 1\n$list vertex_indices\nelement group 1\n$list vertices\n" '3 0 1 2' '3 0 1 3'
reads group.ply ' 1 triangle'
ply solid "element face 1\n$list vertex_indices\nelement voxel 1\n$list vertex_indices\n" '3 0 1 2' '4 0 1 2 3'
reads solid.ply 'element "voxel" has "vertex_indices", and is none that is read'
ply quad "element face 1\n$list vertex_indices\nelement quad 1\n$list corners\n" '3 0 1 2' '4 0 1 2 3'
reads quad.ply 'element "quad" has no list "vertex_indices"'
ply scalars 'element triangle 1\nproperty int vertex1\nproperty int vertex2\nproperty int vertex3\n' '0 1 2'
reads scalars.ply 'element "triangle" has no list "vertex_indices"'
ply edges "element face 1\n$list vertex_indices\nelement edges 1\nproperty int vertex1\nproperty int vertex2\n" '3 0 1 2' '0 3'
reads edges.ply 'element "edges" has "vertex1", and is none that is read'
ply no_faces 'element face 0\n' && sed -i '$d' no_faces.ply
reads no_faces.ply ' 4 points'
facet='facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0'
printf "solid\n$facet\nendloop\nendfacet $facet endloop endfacet\nendsolid\n" >surplus.stl
reads surplus.stl 'surplus.stl:8: "facet" is too much on the line'
printf "solid\n$facet 7\nendloop\nendfacet\nendsolid\n" >fourth.stl
reads fourth.stl 'fourth.stl:6: "7" is too much on the line'
printf "solid of one\n$facet\nend loop\nend facet\nend solid of one\n" >apart.stl
reads apart.stl ' 1 triangle'
[ ! -s "$log" ]
report files__have_no_faces_that_are_not_read

# If it failed, a scene that moves by itself would be one frame, or a pipe be waited for twice.
cat >fall.gltf <<'END'
{"asset": {"version": "2.0"}, "buffers": [{"byteLength": 100, "uri": "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AAAAAAAAAD4AAAA+AACAPwAAAD4AAAA+AACAvw=="}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 8},
  {"buffer": 0, "byteOffset": 44, "byteLength": 32}, {"buffer": 0, "byteOffset": 76, "byteLength": 24}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}, {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR"},
  {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC4"}, {"bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC3"}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}, {"mesh": 0}],
 "animations": [{"samplers": [{"input": 1, "output": 2}, {"input": 1, "output": 3}], "channels": [
  {"sampler": 0, "target": {"node": 1, "path": "rotation"}}, {"sampler": 1, "target": {"node": 1, "path": "translation"}}]}]}
END
: >"$log"
timeout 20 "$PCCDCTL" check --private fall.gltf >out 2>&1
[ $? -eq 1 ] && grep -q 'first at  *t = 0[.]\(5\|4999\)' out && grep -q 'up to 180 degrees' out || cat out >>"$log"
timeout 20 "$PCCDCTL" check --private --rate 4 --animation 0 fall.gltf >out 2>&1
[ $? -eq 1 ] && grep -q '0.75 s: ' out && grep -q 'up to 45 degrees' out || cat out >>"$log"
too_large 4 'no animation has the name or number "walk"' "$PCCDCTL" check --animation walk fall.gltf
mkfifo a.pipe.glb
cat 0.glb >a.pipe.glb &
timeout 10 "$PCCDCTL" check --private a.pipe.glb 1.glb >out 2>&1
[ $? -eq 1 ] && grep -q '^contacts  *1' out || cat out >>"$log"
mkfifo b.pipe.gltf
cat fall.gltf >b.pipe.gltf &
too_large 4 'has 2 frames, and a pipe is one' "$PCCDCTL" check b.pipe.gltf fall.gltf
too_large 0 'warning: fall.gltf has 2 frames, and the first is read' "$PCCDCTL" near --private --distance 2 fall.gltf
[ ! -s "$log" ]
report files__an_animated_scene_is_all_its_frames

tap_end
