#!/bin/bash
# tests/integration/ctl_sequence.sh - frames of a mesh from several files, and from one (TAP).

set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/ctl.sh
. "$top_srcdir/tests/support/ctl.sh"

# The tip of a triangle above another, at this height.
frame() { # HEIGHT
    printf 'v %s\n' '0 0 0' '1 0 0' '0 1 0' "0.25 0.25 $1" '0.25 0.25 30' '0.375 0.25 30'
    printf 'f 1 2 3\nf 4 5 6\n'
}
# It stays above until frame 11, by the numbers; by the alphabet it goes through twice.
for i in {1..12}; do frame $((12 - i)) >"seq$i.obj"; done

# ---- names -----------------------------------------------------------------------------

# If it failed, whoever asks what is near in a bake would hear of its first frame alone, without a
# word; or the whole of a bake that stands crossed would be taken for free.
timeout 100 "$PCCDCTL" near --private --distance 1 seq%d.obj >out 2>err &&
    grep -qx 'pccdctl: warning: seq%d.obj has 12 frames, and the first is read' err &&
    for i in 0 1 2; do sed 's/ 30$/ -30/' seq1.obj >"crossed$i.obj"; done &&
    check 1 --json crossed%d.obj && grep -q '^  "crossings": 4' out && grep -q '^  "initial": 0' out
report sequence__whole_is_told

# If it failed, a bake would be checked in another order than it was made in, without a word.
check 1 seq1.obj seq10.obj seq12.obj seq2.obj && grep -q '^pccdctl: warning: seq2.obj comes after seq12.obj, ' err &&
    check 1 --json seq?.obj seq1?.obj && [ ! -s err ] && grep -qF '"warnings": []' out &&
    check 1 --json seq*.obj && grep -q '^    "seq2.obj comes after seq12.obj, as they were named' out &&
    [ "$(grep -c warning: err)" -eq 1 ]
report sequence__that_goes_down_is_told

# If it failed, who plays frames to and fro, or names files that are not numbered, would be warned.
cp seq1.obj b.obj && cp seq2.obj a.obj
check 0 seq1.obj seq2.obj seq1.obj && [ ! -s err ] && check 0 b.obj a.obj && [ ! -s err ] &&
    mkdir -p run1 run2 && cp seq9.obj run1/f9.obj && cp seq1.obj run2/f1.obj &&
    check 0 run1/f9.obj run2/f1.obj && [ ! -s err ] && check 0 run2/f1.obj run1/f9.obj &&
    grep -q 'run1/f9.obj comes after run2/f1.obj' err
report sequence__that_is_meant_is_not_told

# If it failed, the order would be the shell's; or a pattern would take what it does not name.
cp seq1.obj seq.obj && cp seq1.obj seq1b.obj
check 1 --json seq%d.obj && [ ! -s err ] && grep -o '"to": .*' out >named &&
    seq 2 12 | sed 's/.*/"to": "seq&.obj",/' | cmp - named >>"$log" &&
    mkdir -p many && cp seq9.obj many/f098.ply.obj && cp seq10.obj many/f099.ply.obj &&
    cp seq11.obj many/f100.ply.obj && check 0 "$work/many/f%03d.ply.obj" &&
    grep -q "^ *2  $work/many/f100.ply.obj: 0 " out
report sequence__pattern_takes_files_by_number

# If it failed, a frame that was lost would be stepped over.
rm seq7.obj seq8.obj
check 4 seq%d.obj && grep -qx 'pccdctl: seq%d.obj: number 7 is missing: there are 6 and 9' err &&
    check 4 none%d.obj && grep -qx 'pccdctl: none%d.obj: no file has such a name with a number' err &&
    mv many/f100.ply.obj . && check 4 many/f%d.ply.obj &&
    grep -q 'f09[89].ply.obj has other zeros: %0Nd' err && mv f100.ply.obj many &&
    cp many/f100.ply.obj many/f101.ply.obj && check 0 many/f%d.ply.obj &&
    grep -q 'warning: many/f%d.ply.obj leaves out f09[89].ply.obj' err &&
    check 4 nowhere/f%d.obj && grep -q 'nowhere/f%d.obj: cannot read the folder: No such' err
report sequence__gap_is_named

# If it failed, a file could not have a percent sign.
cp seq1.obj 5%d.obj && cp seq2.obj 100%.obj && check 0 5%d.obj 100%.obj &&
    check 4 %d%d.obj seq1.obj && grep -q '%d%d.obj: cannot open' err &&
    mkdir -p take%d && cp seq1.obj seq2.obj take%d && check 0 take%d/seq%d.obj
report sequence__file_may_be_named_so

# If it failed, somebody with one file would not know what is missing.
check 2 seq1.obj && grep -q 'seq1.obj is one frame: name the file after the step' err &&
    cp seq1.obj only3.obj &&
    check 4 only%d.obj && grep -q 'only3.obj is one frame: a step has two' err &&
    echo x | tee a.pvd >a.fbx && check 4 a.pvd && grep -q 'a.pvd: neither .*python3 -m pccd check reads' err &&
    check 4 seq1.obj a.fbx && grep -q 'a.fbx: neither .*of FBX Blender makes glTF' err
report sequence__of_one_frame_is_named

# ---- point caches ----------------------------------------------------------------------

if ! command -v python3 >/dev/null; then
    for name in cache__frames_have_the_faces_of_the_mesh cache__is_named_where_it_does_not_fit \
        cache__of_a_recorded_body_answers_as_its_files; do
        tap_skip $name "no python3"
    done
    tap_end
    exit
fi
cat >caches.py <<'END'
import struct
import sys

def read_obj(path):
    with open(path) as lines:
        rows = [line.split() for line in lines if line.startswith("v ")]
    return [float(word) for row in rows for word in row[1:]]

def write_pc2(path, frames):
    with open(path, "wb") as to:
        to.write(struct.pack("<12siiffi", b"POINTCACHE2", 1, len(frames[0]) // 3, 5, 1, len(frames)))
        for frame in frames:
            to.write(struct.pack(f"<{len(frame)}f", *frame))

def write_mdd(path, frames):
    with open(path, "wb") as to:
        to.write(struct.pack(">ii", len(frames), len(frames[0]) // 3))
        to.write(struct.pack(f">{len(frames)}f", *(i / 4 for i in range(len(frames)))))
        for frame in frames:
            to.write(struct.pack(f">{len(frame)}f", *frame))

if __name__ == "__main__":
    frames = [read_obj(path) for path in sys.argv[1:]]
    write_pc2("made.pc2", frames)
    write_mdd("made.mdd", frames)
END
told() { # FILE: what a report has that is not time, work, or a name
    sed '/"counters": {/,/}/d; /"ms": {/,/}/d; /"sources": \[$/,/\]/d; /"sources": \[\]/d; /"from"/d; /"to"/d' "$1"
}

# If it failed, a cache would be played with other faces or positions, or the mesh's own place would
# be taken for a frame.
for i in 1 2 3; do frame $((2 - i)) >"f$i.obj"; done
python3 caches.py f1.obj f2.obj f3.obj 2>"$log" && check 1 --json f1.obj f2.obj f3.obj && told out >due &&
    for kind in pc2 mdd; do
        check 1 --json seq1.obj made.$kind && told out | cmp - due >>"$log" &&
            grep -q '"frames": 3,' out && grep -q '"faces": "seq1.obj"' out || break
    done && check 1 seq1.obj made.pc2 &&
    grep -qx 'frames     3 of made.pc2: frame 5 to frame 7; faces of seq1.obj' out &&
    grep -q '^ *1  made.pc2 frame 6: ' out && check 1 seq1.obj made.mdd &&
    grep -qx 'frames     3 of made.mdd: 0 s to 0.5 s; faces of seq1.obj' out &&
    timeout 60 "$PCCDCTL" load --private --times 1 seq1.obj made.pc2 >>"$log" 2>&1
report cache__frames_have_the_faces_of_the_mesh

# If it failed, a cache would be played on a mesh that is not its own.
printf 'v 9 9 9\n' | cat - seq1.obj >seven.obj
check 4 seven.obj made.pc2 &&
    grep -qx 'pccdctl: seven.obj has 7 vertices and made.pc2 has 6: not two frames of one mesh' err &&
    check 4 made.pc2 && grep -q 'made.pc2 has positions alone: name the mesh file' err &&
    check 4 made.pc2 seq1.obj && grep -q 'made.pc2 has positions alone: name the mesh file' err &&
    head -c 100 made.mdd >cut.mdd && check 4 seq1.obj cut.mdd &&
    grep -qx 'pccdctl: cut.mdd: by its header, 3 frames of 6 vertices, it has 236 bytes; it has 100' err &&
    printf 'v %s\n' '0 0 0' '1 0 0' '1 1 0' '0 1 0' >square.obj && echo 'f 1 2 3 4' >>square.obj &&
    python3 -c '
import struct, sys
crossed = 0, 0, 0, 1, 1, 0, 1, 0, 0, 0, 1, 0
sys.stdout.buffer.write(struct.pack("<12siiffi12f", b"POINTCACHE2", 1, 4, 0, 1, 1, *crossed))
' >bow.pc2 && check 4 square.obj bow.pc2 &&
    grep -qx 'pccdctl: square.obj:5: .* crosses itself.*, as bow.pc2 places it' err
report cache__is_named_where_it_does_not_fit

# ---- vertices at one place -------------------------------------------------------------

# Two triangles whose common side each has for itself; of split3 one end of it has torn.
for i in 1 2 3; do
    printf 'v %s\n' '0 0 0' '1 0 0' "0 1 $((i / 3))" '1 0 0' '0 1 0' '1 1 0' >split$i.obj
    printf 'f 1 2 3\nf 4 6 5\n' >>split$i.obj
done

# If it failed, the report would tell of one place where a distance was asked for; or near of
# frames that it does not read.
check 1 --weld 0.25 split%d.obj && grep -qx 'welded     1 vertex to one within 0.25 in every frame' out &&
    grep -qx '           1 vertex is kept, as it moves farther away than 0.25' out &&
    check 1 split1.obj split3.obj && grep -qx 'welded     1 vertex to one at the same place in every frame' out &&
    grep -qx '           1 vertex is kept, as it moves away from the same place' out &&
    timeout 100 "$PCCDCTL" near --private --distance 0 split%d.obj >out 2>>"$log" &&
    grep -qx 'welded     2 vertices to others at the same place' out && ! grep -q kept out
report weld__tells_of_what_was_looked_at

# If it failed, a surface that is split would have contacts, and nobody would say why.
check 1 --weld off split1.obj split1.obj && grep -q '^warning    most contacts touch in vertices' out &&
    check 1 --weld off --json split1.obj split1.obj && python3 - out <<'END' && check 0 split1.obj split1.obj
import json, sys
step = json.load(open(sys.argv[1]))
sys.exit(not (step["crowded"] and step["coincident"] == step["contacts"] > 0))
END
report split__is_said_to_be_the_cause

# If it failed, verify would pass a false count of these contacts, or refuse a true one.
timeout 100 "$PCCDCTL" record -o split.rec -- "$PCCDCTL" check --private --weld off split1.obj split1.obj >out 2>>"$log"
timeout 100 "$PCCDCTL" verify --private split.rec >out 2>>"$log"
report split__is_verified

# If it failed, of a large file all would be read, pictures too, or other bytes than are meant: behind
# the picture, in another chunk, in a file beside it.
python3 - <<'END'
import json, struct
corners = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<9f", .2, .2, 1, .3, .2, -1, .2, .3, -1)
faces = struct.pack("<6H", 0, 1, 2, 3, 4, 5)
for name, picture in (("small", b"png!"), ("large", bytes(range(256)) * 16384)):
    data = picture + corners + faces
    views = [(0, len(picture)), (len(picture), len(corners)), (len(picture) + len(corners), len(faces))]
    scene = {"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(data)}],
             "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": n} for at, n in views],
             "images": [{"bufferView": 0, "mimeType": "image/png"}], "nodes": [{"mesh": 0}],
             "accessors": [{"bufferView": 1, "componentType": 5126, "count": 6, "type": "VEC3"},
                           {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
             "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]}
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    chunks = b"".join(struct.pack("<I4s", len(chunk), kind) + chunk
                      for kind, chunk in ((b"JSON", text), (b"more", b"behind"), (b"BIN\0", data)))
    open(name + ".glb", "wb").write(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    scene["buffers"][0]["uri"] = name + ".bin"
    open(name + ".bin", "wb").write(data)
    json.dump(scene, open(name + ".gltf", "w"))
END
said() { check "$1" --json "$2" "$2" && sed 's/"file": "[^"]*"//; /"ms"/,$d; /small\|large/d; /threads\|_ns/d' out; }
said 1 small.glb | grep -v '_ms' >small.said
: >wrong
for file in large.glb small.gltf large.gltf; do
    said 1 $file | grep -v '_ms' | cmp -s - small.said || { echo "$file" && cat err; } >>wrong
done
grep -q '"crossings": [1-9]' small.said || cat small.said >>wrong
timeout 100 "$PCCDCTL" check --private large.glb <(cat large.glb) >out 2>&1 && cat out >>wrong
grep -q '^mesh  *6 vertices' out || cat out >>wrong
truncate -s 2M large.bin
check 4 large.gltf large.gltf && grep -q 'buffer 0: has 2097152 bytes, not 4194388' err || cat err >>wrong
[ ! -s wrong ]
tap_result $? gltf__is_read_where_its_vertices_are wrong

# asks NAME ARGUMENT...: what the command says of these arguments, to `out` and `err`.
asks() {
    local name=$1
    shift
    case $name in
    render) set -- -o drawn.png "$@" ;;
    export) set -- -o drawn.vtp "$@" ;;
    inspect) set -- -o drawn.html "$@" ;;
    near) set -- --distance 0 "$@" ;;
    esac
    timeout 100 "$PCCDCTL" "$name" --private "$@" >out 2>err
}
"$PCCDCTL" inspect --private -o no.html split1.obj >out 2>&1 && has_page=inspect || has_page=

# If it failed, a picture, a page or a question would be of another mesh than the check of the same
# files, or of another animation.
cat >moves.gltf <<'END'
{"asset": {"version": "2.0"}, "buffers": [{"byteLength": 68, "uri": "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAAAAAAAAAAAAgD8="}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 8},
  {"buffer": 0, "byteOffset": 44, "byteLength": 24}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}, {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR"},
  {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}],
 "animations": [{"name": "rise", "samplers": [{"input": 1, "output": 2}], "channels": [
  {"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]}
END
: >"$log"
for command in check near load render export $has_page; do
    frames="split1.obj split2.obj"
    [ $command != near ] || frames=split1.obj
    for weld in off auto; do # check says by its status that what was split meets itself
        # shellcheck disable=SC2086 # two names
        asks $command --weld $weld $frames || [ $command$weld = checkoff ] || cat err >>"$log"
        cp out $weld
    done
    [ $command = inspect ] || ! cmp -s off auto || echo "$command: --weld" >>"$log"
    ! asks $command --animation walk moves.gltf &&
        grep -q '^pccdctl: moves.gltf: no animation has the name or number "walk"' err || cat out err >>"$log"
    asks $command --animation rise --rate 4 moves.gltf || cat err >>"$log"
    case $command in
    check) grep -q '^ *4  *moves.gltf 1 s: ' out ;;
    near) grep -q 'has 5 frames' err ;;
    load) grep -q '^steps  *4 ' out ;;
    inspect) grep -q '1 to 4' out ;;
    *) grep -q ': step 4 at' out ;;
    esac || { echo "$command: --rate" && cat out err; } >>"$log"
done
[ ! -s "$log" ]
report frames__are_read_alike_by_all_commands

# If it failed, an option of frames would be dropped where a recording is played, or a film of an
# animated file be sampled at another rate than it is played at.
"$PCCDCTL" record -o some.rec -- "$PCCDCTL" load --private split1.obj split2.obj >out 2>&1
: >"$log"
for command in export render; do
    ! asks $command --weld off some.rec && grep -q 'some.rec is a recording' err || cat out err >>"$log"
done
timeout 100 "$PCCDCTL" render --private --size 64x64 -o film.apng --rate 4 moves.gltf >out 2>&1 &&
    grep -qx 'film.apng: 4 steps' out || cat out >>"$log"
timeout 100 "$PCCDCTL" render --private --size 64x64 -o film.apng --rate 4 some.rec >out 2>&1 &&
    grep -qx 'film.apng: 1 step' out || cat out >>"$log"
! asks render --rate 4 some.rec && grep -q 'rate is of a film' err || cat out err >>"$log"
! timeout 100 "$PCCDCTL" render --private -o film.apng --rate 4.5 moves.gltf >out 2>&1 &&
    grep -q 'of a film a whole number' out || cat out >>"$log"
[ ! -s "$log" ]
report frames__options_are_of_frames

# If it failed, the answers of a bake would depend on the kind of file that it comes in.
kick=${PCCD_DATA:-}/kick
if [ -e "$kick/kick.pc2" ] && [ -e "$kick/kick.obj" ]; then
    python3 - "$kick" >"$log" 2>&1 <<'END'
import array
import sys

with open(f"{sys.argv[1]}/kick.pc2", "rb") as cache:
    header = cache.read(32)
    points, count = (int.from_bytes(header[i:i + 4], "little") for i in (16, 28))
    frames = [array.array("f", cache.read(12 * points)) for _ in range(count)]
with open(f"{sys.argv[1]}/kick.obj") as lines:
    faces = [line for line in lines if line.startswith("f ")]
for number, x in enumerate(frames):
    with open(f"kick{number}.obj", "w") as to:
        to.writelines("v %.17g %.17g %.17g\n" % tuple(x[i:i + 3]) for i in range(0, len(x), 3))
        to.writelines(faces)
END
    check 1 --json --contacts cache.csv "$kick/kick.obj" "$kick/kick.pc2" && told out >cache &&
        [ "$(grep -c '"hash"' cache)" -eq 24 ] &&
        check 1 --json --contacts files.csv kick%d.obj && told out | diff - cache >>"$log" &&
        cmp cache.csv files.csv >>"$log" 2>&1 && [ "$(wc -l <cache.csv)" -gt 50 ]
    report cache__of_a_recorded_body_answers_as_its_files
else
    tap_skip cache__of_a_recorded_body_answers_as_its_files "no kick in \$PCCD_DATA"
fi
tap_end
