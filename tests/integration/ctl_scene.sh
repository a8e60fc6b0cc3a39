#!/bin/bash
# tests/integration/ctl_scene.sh - several meshes from files as one scene (TAP).

set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/ctl.sh
. "$top_srcdir/tests/support/ctl.sh"

# cube SIDE X Y Z: a closed box with that corner.
cube() {
    local x y z
    for x in 0 1; do for y in 0 1; do for z in 0 1; do
        echo "v $(($2 + x * $1)) $(($3 + y * $1)) $(($4 + z * $1))"
    done; done; done
    printf 'f %s\n' '1 2 4 3' '5 7 8 6' '1 5 6 2' '3 4 8 7' '1 3 7 5' '2 6 8 4'
}
# A box of side 2 that falls by 4 a frame: it meets a floor whose top is 0 in its third step, half
# way, and goes through another box that falls along in no frame.
for i in 0 1 2 3; do
    cube 2 0 0 $((10 - 4 * i)) >"box$i.obj"
    cube 2 9 0 $((10 - 4 * i)) >"side$i.obj"
done
cube 100 -50 -50 -100 >floor.obj
cube 10000 -5000 -5000 -10000 >floor-cm.obj

scene() { cat >scene.json; }
# refuses LINE: pccdctl check says of scene.json, at status 4, a line that begins so.
refuses() {
    check 4 scene.json && grep -qF "pccdctl: scene.json:$1" err && [ "$(wc -l <err)" -eq 1 ] ||
        echo "$1: $(cat err)" >>"$log"
}

# If it failed, what stands in files of its own could not be hit, or a unit would be taken for
# another one: the same scene in centimetres has other bytes, and the same contacts.
scene <<'END'
{"pccd_scene": 1, "objects": [
  {"name": "box", "files": "box%d.obj"},
  {"name": "floor", "files": ["floor-cm.obj"], "unit": 0.01}]}
END
check 1 --json scene.json && cp out scene.out && grep -q '^  "vertices": 16,' out &&
    grep -A2 '"objects": \[$' out | grep -q '"a": "box"' && check 1 --json box%d.obj --with floor.obj &&
    diff <(grep '"hash"' scene.out) <(grep '"hash"' out) >>"$log" &&
    grep -qE '"toi_first": (0.5|0.4999999[0-9]*),' out && [ "$(grep -c '"contacts": 0,' out)" -eq 2 ] &&
    check 1 scene.json && grep -qx 'object 2   "floor", floor-cm.obj: 8 vertices, 18 edges, 12 triangles' out
report scene__has_objects_from_files

# If it failed, contacts would name vertices of another file, or no object.
check 1 --contacts c.csv scene.json && head -1 c.csv | grep -qx 'step,kind,i0,i1,i2,i3,toi,toi_hi,proved,object_a,object_b,x,y,z' &&
    [ "$(sed 1d c.csv | grep -cE '^3,(vf|ee),[0-7],[0-7],[0-7],[0-7],[01][.0-9]*,.*,(box,floor|floor,box)(,[^,]+){3}$')" -eq \
        "$(sed 1d c.csv | wc -l)" ] && [ "$(wc -l <c.csv)" -gt 4 ]
report scene__contacts_name_their_objects

# If it failed, what is told to pass through would be hit, or what is not would be missed.
box='{"name": "box", "files": "box%d.obj"' floor='{"name": "floor", "files": "floor.obj"'
two() { echo "{\"pccd_scene\": 1, \"objects\": [$box$1}, $floor$2}]${3-}}" | scene; }
two '' '' && check 1 scene.json &&
    two '' '' ', "ignore": [["floor", "box"]]' && check 0 scene.json &&
    two ', "groups": "a", "meets": ["a"]' ', "groups": ["b", "c"]' && check 0 scene.json &&
    two ', "groups": "a", "meets": "c"' ', "groups": ["b", "c"], "meets": ["a"]' && check 1 scene.json &&
    two ', "meets": ["a", "b"]' '' && check 0 scene.json && two ', "groups": "a"' '' && check 1 scene.json &&
    two ', "meets": "a", "self": false' ', "self": false' && check 0 --json scene.json &&
    grep -q '^    "no two objects may meet, nor one itself: nothing is compared"$' out &&
    grep -qx 'pccdctl: warning: no two objects may meet, nor one itself: nothing is compared' err &&
    ctl near --what nearest scene.json && grep -q 'warning: no two objects may meet' err &&
    two '' '' ', "frames": {"last": 2}' && check 0 scene.json &&
    two '' '' ', "frames": {"first": 2, "last": 3}' && check 1 scene.json &&
    two ', "thickness": 2' '' ', "frames": {"last": 2}' && check 1 scene.json
report scene__says_what_may_meet

# If it failed, an option would be taken and do nothing.
cp side0.obj both0.obj && cp side1.obj both1.obj
printf 'v %s\n' '0 0 0' '4 0 0' '0 4 0' '1 1 -1' '1 1 1' '2 1 1' >cross.obj
printf 'f 1 2 3\nf 4 5 6\n' >>cross.obj
check 1 box%d.obj --with side%d.obj --with floor.obj &&
    check 0 box%d.obj --with side%d.obj --with floor.obj --between box,side &&
    check 1 box%d.obj --with side%d.obj --with floor.obj --between box,side --between floor,side &&
    check 4 box%d.obj --with floor.obj --between box,flor &&
    grep -qx 'pccdctl: --between: "box,flor" does not name two objects' err &&
    cp floor.obj 'a,b.obj' && check 1 box%d.obj --with a,b.obj --between a,b,box &&
    check 2 box%d.obj --between box && check 1 cross.obj cross.obj &&
    check 0 cross.obj cross.obj --no-self && check 1 cross.obj cross.obj --between cross,cross &&
    check 0 cross.obj cross.obj --no-self --between cross,cross &&
    grep -q 'nothing is compared' err && check 4 box%d.obj --with box0.obj --with both%d.obj &&
    grep -q '2 frames, and "box" has 4' err
report scene__from_a_command_line

# If it failed, another command would know no scenes, or another one.
two '' '' ''
timeout 100 "$PCCDCTL" near --private --json --what nearest scene.json >out 2>err &&
    grep -q '"distance_min": 10.0,' out && grep -q '"name": "floor",' out &&
    timeout 100 "$PCCDCTL" record -o r.rec scene.json >out 2>err &&
    grep -qE '^contacts +[1-9]' out && timeout 100 "$PCCDCTL" replay --private r.rec >out 2>err &&
    grep -q '3 the same, 0 not' out && timeout 100 "$PCCDCTL" render --private -o p.png scene.json >out 2>err &&
    grep -q '2 objects, [1-9][0-9]* contacts' out &&
    timeout 100 "$PCCDCTL" export --private -o p.glb scene.json >out 2>err && [ -s p.glb ] &&
    { timeout 100 "$PCCDCTL" inspect --private -o p.html scene.json >out 2>err && [ -s p.html ] ||
        grep -q 'built without the page' err; } &&
    timeout 100 "$PCCDCTL" record -o between.rec scene.json --between box,box >out 2>err &&
    grep -qE '^contacts +0' out &&
    ! timeout 100 "$PCCDCTL" render --private -o q.png --no-self r.rec >out 2>err &&
    grep -q 'r.rec is a recording' err
report scene__is_taken_by_all_commands

# If it failed, a slip of a pen would be read as another scene, or its place be looked for long.
mkdir -p sub && cp box?.obj floor.obj sub
two '' ', "thicknes": 1' && refuses '1: "thicknes" is no member of an object, which has name '
scene <<'END' && refuses '4: "unit" is no number from 1e-18 to 1e+18'
{"pccd_scene": 1, "objects": [
  {"name": "box", "files": "box%d.obj",
   "self": true, "groups": ["{", "]\"", "\\"],
   "unit": 0}]}
END
scene <<'END' && refuses '3: another object, of line 2, has the name "box"'
{"pccd_scene": 1, "objects": [
  {"name": "box", "files": "box%d.obj"},
  {"name": "box", "files": "floor.obj"}]}
END
scene <<'END' && refuses '3: object "floor": flor.obj: cannot open'
{"pccd_scene": 1, "objects": [
  {"name": "box", "files": "box%d.obj"},
  {"name": "floor", "files": "flor.obj"}]}
END
scene <<'END' && refuses "2: '}' expected"
{"pccd_scene": 1, "objects": [{"name": "box"
  {}]}
END
two '' '' ', "pccd_scene": 1' && refuses '1: '
two ', "rings": 1.5' '' && refuses '1: "rings" is no whole number'
two ', "self": 1' '' && refuses '1: "self" is neither true nor false'
two ', "weld": "yes"' '' && refuses '1: "weld" is not auto, off or a length'
two '' '' ', "ignore": [["box", "flor"]]' && refuses '1: "ignore": no object has the name "flor"'
two '' '' ', "frames": {"first": 3, "last": 2}' && refuses '1: the first frame, 3, is behind the last'
two '' '' ', "frames": {"first": 4}' && refuses '1: object "box": the first frame is 4, and there are 4'
echo '[]' | scene && refuses '1: a scene is { ... }'
echo '{"objects": []}' | scene && refuses '1: no "pccd_scene": 1, which says what the file is'
echo '{"pccd_scene": 2, "objects": []}' | scene && refuses '1: "pccd_scene" is no number from 1 to 1'
two '' '' && mv scene.json sub/ok.json && rm box3.obj && check 1 sub/ok.json && cp sub/box3.obj . ||
    echo 'files are not beside the scene file' >>"$log"
two '' '' && printf '\xef\xbb\xbf' | cat - scene.json >bom.json && check 1 bom.json ||
    echo 'a byte order mark is not passed over' >>"$log"
[ ! -s "$log" ]
report scene__that_is_wrong_is_refused_by_its_line

# If it failed, a mechanism would be checked as if it had no joints.
printf '%s\n' '{"pccd_scene": 1, "objects": [{"name": "a", "files": "floor.obj"}],' \
    ' "joints": [{"name": "pin", "type": "fixed"}]}' >joints.json
check 4 joints.json
grep -q 'joints.json:2: joints are moved by pccdctl sweep alone$' err >"$log"
report scene__with_joints_is_not_checked

# If it failed, a new scene would have to be written by hand, or its format be guessed, or it would
# name another file where JSON has no word for the name.
! timeout 100 "$PCCDCTL" scene new $'\xff.obj' >out 2>err &&
    grep -q 'the name is not UTF-8, which JSON cannot say' err && [ ! -s out ] &&
    timeout 100 "$PCCDCTL" scene new -o new.json box%d.obj floor.obj sub/floor.obj 2>err &&
    grep -q '"name": "floor-2"' new.json && check 1 new.json &&
    timeout 100 "$PCCDCTL" scene schema >schema.json 2>err &&
    grep -q '"additionalProperties": false' schema.json &&
    for key in $(grep -oE '^ +"[a-z_]+": \{$' schema.json | grep -oE '[a-z_]+' |
        grep -vxE 'properties|items'); do
        grep -qE "^[*a-z_, ]*\*$key\*" "$top_srcdir/client/man/pccdctl.1.scd" || echo "$key is not in pccdctl(1)"
    done >"$log"
[ ! -s "$log" ]
report scene__new_and_its_format

tap_end
