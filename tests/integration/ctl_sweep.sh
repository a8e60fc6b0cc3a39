#!/bin/bash
# tests/integration/ctl_sweep.sh - pccdctl sweep: mechanisms from URDF, SRDF and scene files.

set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/ctl.sh
. "$top_srcdir/tests/support/ctl.sh"

if ! ctl sweep /dev/null && grep -q 'built without expat' err; then
    tap_skip "pccdctl sweep reads URDF" "built without expat"
        exit 0
fi

# urdf SHAPE JOINT [MORE]: r.urdf, a base, and an arm of this shape on a joint of this type and
# members, "revolute <limit .../>". Line 2 is the base, 3 the arm, 4 the joint, 5 what comes then.
urdf() {
    cat >r.urdf <<EOF
<robot name="r">
<link name="base"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
<link name="arm">$1</link>
<joint name="elbow" type="${2%% *}"><parent link="base"/><child link="arm"/>${2#* }</joint>
${3-}
</robot>
EOF
}
solid() { echo "<collision><origin xyz=\"3 0 0\"/><geometry>$1</geometry></collision>"; }
box=$(solid '<box size="1 1 1"/>')
limit='<limit lower="-1" upper="1"/>'

# refused WHAT SHAPE JOINT [MORE]: the file is refused with the line and these words.
refused() {
    local what=$1
    shift
    urdf "$@"
    fails 4 "r.urdf:$what" sweep r.urdf
}

# Otherwise a robot would be proved free whose arm was left out: liburdfdom leaves out such a shape,
# and all that come after it, and says that the file is right.
refused '3: link "arm": scale="2" of <mesh> has 1 of 3 numbers' \
    "$(solid '<mesh filename="a.obj" scale="2"/>')" "revolute $limit" &&
    refused '3: link "arm": filename="" of <mesh> names no file' \
        "$(solid '<mesh filename=""/>')" "revolute $limit" &&
    refused '3: link "arm": size="1 2" of <box> has 2 of 3 numbers' \
        "$(solid '<box size="1 2"/>')" "revolute $limit" &&
    refused '3: link "arm": rpy="0 1" of <origin> has 2 of 3 numbers' \
        "<collision><origin rpy=\"0 1\"/><geometry><box size=\"1 1 1\"/></geometry></collision>" \
        "revolute $limit" &&
    refused '3: link "arm": a <collision> without geometry' "$box<collision/>" "revolute $limit" &&
    refused '3: link "arm": <cone> is no shape that is known' "$(solid '<cone/>')" \
        "revolute $limit" &&
    refused '3: link "arm": a <geometry> of more than one shape' \
        "$(solid '<sphere radius="1"/><sphere radius="2"/>')" "revolute $limit" &&
    refused '3: link "arm": <cylinder> has no length' "$(solid '<cylinder radius="1"/>')" \
        "revolute $limit" &&
    refused '3: link "arm": radius="0" of <sphere> leaves nothing of it' \
        "$(solid '<sphere radius="0"/>')" "revolute $limit" &&
    refused '3: link "arm": radius="1e30" of <sphere> is larger than 1e18' \
        "$(solid '<sphere radius="1e30"/>')" "revolute $limit"
report "a shape that is not understood is refused with its link"

# Otherwise a number that is none would be another one, or the model would be gone without a word
# of where.
refused '4: joint "elbow": lower="inf" of <limit>: "inf" is no finite number' "$box" \
    'revolute <limit lower="inf" upper="1"/>' &&
    refused '4: joint "elbow": upper="1e400" of <limit>: "1e400" is no finite number' "$box" \
        'revolute <limit lower="0" upper="1e400"/>' &&
    refused '4: joint "elbow": upper="0x1" of <limit>: "0x1" is no finite number' "$box" \
        'revolute <limit lower="0" upper="0x1"/>' &&
    refused '4: joint "elbow": upper="1,5" of <limit>: "1,5" is no finite number' "$box" \
        'revolute <limit lower="0" upper="1,5"/>' &&
    urdf "$box" "revolute <limit lower=\"-1\" upper=\"1.5 \"/><axis xyz=\"0	0 1\"/>" &&
    ctl sweep --json r.urdf && grep -q '^ *1.5$' out
report "a number that is none is refused with its line; blanks and tabs are none"

# Otherwise a loop would be swept as a tree, or a ring of links would not be there at all.
other='<joint name="b" type="fixed"><parent link="arm"/><child link="hand"/></joint>'
refused '5: joint "c": its link "hand" hangs on joint "b", too: loops are not swept' "$box" \
    "revolute $limit" "<link name=\"hand\"/>$other${other/\"b\"/\"c\"}" &&
    refused '5: joint "a": it hangs on itself, in a ring of joints' "$box" "revolute $limit" \
        '<link name="x"/><link name="y"/><joint name="a" type="fixed"><parent link="x"/>
        <child link="y"/></joint><joint name="c" type="fixed"><parent link="y"/>
        <child link="x"/></joint>' &&
    refused '1: no joint joins link "hand" to the others' "$box" "revolute $limit" \
        '<link name="hand"/>' &&
    refused '5: link "arm": line 3 has another one of this name' "$box" "revolute $limit" \
        '<link name="arm"/>' &&
    refused '5: joint "b": its child is a link "hand", and there is none' "$box" \
        "revolute $limit" "$other"
report "loops, rings, a second root and unknown links are refused"

# Otherwise a finger would stand still because the joint that it follows is not there.
mimic() { echo "<joint name=\"$1\" type=\"prismatic\"><parent link=\"arm\"/>
    <child link=\"$1\"/>$limit<mimic joint=\"$2\"/></joint><link name=\"$1\"/>"; }
refused '5: joint "a": it follows a joint "wrist", and there is none' "$box" "revolute $limit" \
    "$(mimic a wrist)" &&
    refused '5: joint "a": it follows itself, in a ring of joints' "$box" "revolute $limit" \
        "$(mimic a b)$(mimic b a)"
report "a joint that follows nothing, or itself, is refused"

# Otherwise a joint would have a range that nobody has said, or an axis that is none.
refused '4: joint "elbow": revolute, and no <limit>' "$box" 'revolute ' &&
    refused '4: joint "elbow": its axis 0 0 0 has the length 0' "$box" \
        "revolute $limit<axis xyz=\"0 0 0\"/>" &&
    refused '4: joint "elbow": its range ends at -1, before its begin 1' "$box" \
        'revolute <limit lower="1" upper="-1"/>' &&
    refused '4: joint "elbow": no joint is of the type "hinge"' "$box" 'hinge ' &&
    refused '5: <xacro:arm>: have xacro make URDF of it first' "$box" "revolute $limit" \
        '<xacro:arm/>' &&
    urdf "$box" 'revolute <limit lower="0" upper="9e6"/>' &&
    ends 4 'r.urdf: joint "elbow", at 0 to 9e+06: its angle is beyond 2^20 turns' sweep r.urdf
report "a joint without a range, or with a wrong one, is refused"

# Otherwise a broken file would be read as far as it goes.
printf '<!DOCTYPE robot [<!ENTITY a "b">]>\n<robot/>\n' >d.urdf
printf '<robot>\n<link>\n</robot>\n' >e.urdf
printf '<sdf/>\n' >s.urdf
fails 4 'd.urdf:1: a DOCTYPE' sweep d.urdf && fails 4 'e.urdf:3: mismatched tag' sweep e.urdf &&
    fails 4 's.urdf:1: URDF begins with <robot>, not <sdf>' sweep s.urdf &&
    fails 4 'none.urdf' sweep none.urdf && printf '<robot/>' >n.urdf &&
    fails 4 'n.urdf: nothing has a shape' sweep n.urdf
report "a file that is no URDF is refused"

# Otherwise the arm would be gone with its mesh.
urdf "$(solid '<mesh filename="package://my_arm/meshes/arm.obj" scale="1 -1 2"/>')" \
    "revolute $limit"
fails 4 'r.urdf:3: "arm": the mesh package://my_arm/meshes/arm.obj is not there' sweep r.urdf &&
    fails 4 '--meshes nodir: no such folder' sweep --meshes nodir r.urdf &&
    printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >arm.obj && ctl sweep --meshes . r.urdf &&
    mkdir -p my_arm/meshes my_arm/urdf && mv arm.obj my_arm/meshes && ctl sweep r.urdf &&
    mv r.urdf my_arm/urdf && ctl sweep my_arm/urdf/r.urdf &&
    printf 'v 0 0 zero\n' >my_arm/meshes/arm.obj &&
    fails 4 'my_arm/urdf/../meshes/arm.obj:1' sweep my_arm/urdf/r.urdf
report "meshes are found beside the file, in their package and in --meshes; a missing one is named"

# Otherwise a range that nobody sees would be called free, or a joint that cannot be swept.
urdf "$box" 'revolute <limit effort="1"/>' \
    '<link name="a"/><joint name="float" type="floating"><parent link="arm"/><child link="a"/></joint>'
ends 4 'r.urdf: no joint has a range to move over' sweep r.urdf &&
    says '^joint +elbow: 0, does not move$' '^joint +float: floating, held' &&
    fails 4 '--joint float: the joint does not move' sweep --joint float r.urdf &&
    ends 2 '--fix elbow=x: the value is no number' sweep --fix elbow=x r.urdf &&
    ends 2 '--fix elbow=1: --joint elbow=0:1 names this joint, too' sweep --fix elbow=1 \
        --joint elbow=0:1 r.urdf &&
    ends 2 '--joint elbow: --joint elbow names' sweep --joint elbow --joint elbow r.urdf &&
    ends 2 '--joint elbow=1: not NAME=LO:HI' sweep --joint elbow=1 r.urdf &&
    ends 2 'elbow=1:0: the high end is below the low end' sweep --joint elbow=1:0 r.urdf &&
    ends 2 'elbow=10:9deg: the high end is below' sweep --joint elbow=10:9deg r.urdf &&
    ends 2 'elbow=nan:1: the low end is no finite' sweep --joint elbow=nan:1 r.urdf &&
    ends 2 'elbow=0:1rad: the high end has another unit' sweep --joint elbow=0:1rad r.urdf &&
    ends 2 'elbow=1deg:2: the high end has no unit' sweep --joint elbow=1deg:2 r.urdf &&
    fails 4 '--joint knee: r.urdf has no such joint' sweep --joint knee r.urdf &&
    fails 4 '--allow: "a,b" does not name two parts' sweep --allow a,b r.urdf &&
    ends 2 'at most 3' sweep --joint a --joint b --joint c --joint d r.urdf
report "what does not move is said to; wrong names are refused"

# Otherwise the pairs that touch by design would be jams in every robot.
echo '<robot><disable_collisions link1="base" link2="arm"/><group_state name="up" group="g">
<joint name="elbow" value="0.5"/></group_state></robot>' >r.srdf
echo '<robot><disable_collisions link1="base" link2="leg"/></robot>' >bad.srdf
urdf "$box" "revolute $limit"
ends 4 'no two shapes may meet' sweep --srdf r.srdf --state up r.urdf &&
    ends 4 'no two shapes may meet' sweep --allow base,arm r.urdf &&
    says 'may meet 0$' && fails 4 'r.urdf:1: no SRDF: it has links' sweep --srdf r.urdf r.urdf &&
    fails 4 'bad.srdf:1: the URDF has no link "leg"' sweep --srdf bad.srdf r.urdf &&
    fails 4 'r.srdf:1: there is no group_state "down"' sweep --srdf r.srdf --state down r.urdf &&
    echo '<robot name="s"/>' >s.srdf &&
    fails 4 's.srdf:1: it is of the robot "s", and the URDF of another' sweep --srdf s.srdf r.urdf &&
urdf "<visual/>" "revolute $limit" "<link name=\"hand\">$box</link><joint name=\"j\" type=\"fixed\">
    <parent link=\"arm\"/><child link=\"hand\"/></joint>" &&
    ctl sweep --joint elbow=-1.5:0 r.urdf &&
    says '^note +link arm has a <visual> and no' 'note +elbow at -1.5 to 0 rad .* goes beyond its limits, -1 to 1' &&
    ctl sweep --json --joint elbow=-1.5:0 r.urdf && grep -A1 '"beyond_limits"' out | grep -q elbow &&
    grep -A1 '"without_collision"' out | grep -q arm && sed -i 's/3 0 0/0 0 0/' r.urdf &&
    echo '<robot><group_state name="up" group="g"/></robot>' >up.srdf &&
    { ctl sweep --srdf up.srdf r.urdf; [ $? -eq 1 ]; } && says '--state, one of up$' \
        'all that meet at the begin: base,hand$'
report "SRDF leaves pairs out and has states; what is not compared is named"

# Otherwise a scene file would be swept without its joints, or checked as if it had none.
printf 'v 3 0 0\nv 4 0 0\nv 3 1 0\nf 1 2 3\n' >part.obj
scene() { cat >s.json <<EOF
{"pccd_scene": 1,
 "joints": [{"name": "pin", "type": "revolute", "axis": [0, 0, 1]$1}],
 "objects": [{"name": "post", "files": "part.obj"},
             {"name": "door", "files": "part.obj", "joint": "pin"}]}
EOF
}
scene ', "range": [2, 3]'
ctl sweep s.json && says '^joint +pin 2 to 3 rad' 'may meet 1$' &&
    fails 4 's.json:2: joints are moved by pccdctl sweep alone' check s.json &&
    ctl scene schema && grep -q '"multiplier"' out && scene '' &&
    fails 4 's.json:2: joint "pin": revolute, and no "range"' sweep s.json &&
    scene ', "range": [1, 2, 3]' && fails 4 's.json:2: "range" is no list of 2' sweep s.json &&
    scene ', "range": [1, 2], "parent": "wall"' &&
    fails 4 's.json:2: no joint has the name "wall"' sweep s.json &&
    scene ', "range": [1, 2], "parent": "pin"' &&
    fails 4 's.json:2: joint "pin": it hangs on itself' sweep s.json
report "a scene file can have joints"

# ---- what meets --------------------------------------------------------------------------------

# A leaf whose upper face turns about the origin, from the x axis, and a stop whose corner is at
# (cos 30 deg, sin 30 deg).
cat >hinge.urdf <<'EOF'
<robot name="hinge">
  <link name="post"><collision><origin xyz="0.7660254037844387 0.6 0"/>
    <geometry><box size="0.2 0.2 0.3"/></geometry></collision></link>
  <link name="leaf"><collision><origin xyz="1 -0.1 0"/>
    <geometry><box size="1 0.2 0.1"/></geometry></collision></link>
  <joint name="pin" type="revolute"><parent link="post"/><child link="leaf"/>
    <axis xyz="0 0 2"/><limit lower="0" upper="1.5"/></joint>
</robot>
EOF
# numbers KEY NAME: the interval of joint NAME below the first KEY.
numbers() {
    awk -v key="\"$1\":" -v name="\"$2\":" 'index($0, key) { on = 1 }
        on && index($0, name) { getline low; getline high; print low + 0, high + 0; exit }' \
        CONVFMT=%.17g OFMT=%.17g out
}
# holds KEY NAME VALUE WIDTH: that interval has the value, and is no wider.
holds() {
    numbers "$1" "$2" >got
    awk -v x="$3" -v w="$4" '{ ok = $1 <= x && x <= $2 && $2 - $1 <= w } END { exit !ok }' got ||
        { cat got >>err; return 1; }
}
jams() { ctl sweep "$@"; [ $? -eq 1 ]; }

# Otherwise the jam would not be where it is, or would not be proved to be there.
jams --json hinge.urdf && holds jams pin 0.52359877559829887 1e-6 && grep -q '"begin"' out &&
    cp out hinge.json && jams --url direct: --threads 1 --json hinge.urdf &&
    cmp out hinge.json >>err && jams --bracket 1e-9 --json hinge.urdf &&
    holds jams pin 0.52359877559829887 1e-9
report "a hinge jams at its stop, in a bracket as narrow as is asked for"

# Otherwise what is free would not be, or what people read would be something else.
ctl sweep --joint pin=0:30deg hinge.urdf
[ $? -ne 0 ] && ctl sweep --joint pin=0.1:29.9deg hinge.urdf &&
    says '^joint +pin 0.001745 to 0.5219 rad .0.1 to 29.9 deg.: free$' '^answer +free$' &&
    jams hinge.urdf && says 'jams +at 0.5236 rad .30 deg.: post and leaf, from the begin$' \
    'jams.*from the end' '^answer +jams$' && printf 'v 0 0 -9\nv 1 0 -9\nv 0 1 -9\nf 1 2 3\n' >low.obj &&
    ctl sweep --allow post,leaf --with low.obj hinge.urdf
report "a hinge is free before its stop, and where its parts may meet"

# Otherwise a distance would be another one. The corner is sin(30 deg - q) from the face.
jams --clearance 0.1 --json hinge.urdf && holds jams pin 0.42343135397717 1e-6 &&
    grep -q '"within_bracket": true' out && jams --bracket 1e-15 --json hinge.urdf &&
    grep -q '"within_bracket": false' out && jams --bracket 1e-15 hinge.urdf &&
    says '^ +[0-9.e-]+ wide: it could not be narrowed to 1e-15$' &&
    ctl sweep --least 1e-6 --joint pin=0:0.4 --json hinge.urdf &&
    awk '/least_distance/ { getline a; getline b; ok = a + 0 <= 0.12328430974 && b + 0 >= 0.12328430974 &&
        b - a < 1e-5 } END { exit !ok }' out
report "a clearance jams earlier; the least distance is found"

# Otherwise two parts would keep another clearance than their own, or none, or it would be
# added to the others'; or its words would mean something else.
jams --clearance 9 --clearance leaf,post=0.1 --json hinge.urdf &&
    holds jams pin 0.42343135397717 1e-6 && [ "$(grep -c '"clearance": 0.1' out)" = 1 ] &&
    jams --clearance 0.1 --clearance post,leaf=0 --json hinge.urdf &&
    holds jams pin 0.52359877559829887 1e-6 &&
    cat >hinge.json <<'EOF' && for part in leaf post; do
{"pccd_scene": 1, "objects": [{"name": "post", "files": ["post.obj"], "thickness": 5},
  {"name": "leaf", "files": ["leaf.obj"], "joint": "pin"}, {"name": "far", "files": ["far.obj"]}],
 "joints": [{"name": "pin", "type": "revolute", "axis": [0, 0, 1], "range": [0, 1.5]}],
 "ignore": [["far", "leaf"]], "clearance": [["leaf", "post", 0.1]]}
EOF
    [ $part = post ] && box="0.6660254037844387 0.8660254037844387 0.5 0.7 -0.15 0.15" ||
        box="0.5 1.5 -0.2 0 -0.05 0.05"
    echo "$box" | awk '{ for (i = 0; i < 8; i++)
            print "v", $(1 + i % 2), $(3 + int(i / 2) % 2), $(5 + int(i / 4))
        print "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4"
        print "f 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6" }' >$part.obj
done && sed 's/^v /v 9/' post.obj >far.obj && jams --json hinge.json &&
    holds jams pin 0.42343135397717 1e-6 &&
    ctl sweep --least 1e-6 --joint pin=0:0.4 --json hinge.json &&
    awk '/least_above_clearance/ { getline a; getline b
        ok = a + 0 <= 0.02328430974 && b + 0 >= 0.02328430974 } END { exit !ok }' out &&
    fails 4 '--clearance: "leaf,leaf=1" does not name two' sweep --clearance leaf,leaf=1 hinge.urdf &&
    ends 2 '"-1" is no number' sweep --clearance leaf,post=-1 hinge.urdf &&
    ends 2 'not two names' sweep --clearance leaf=1 hinge.urdf &&
    jams --between leaf,post --json hinge.json && holds jams pin 0.42343135397717 1e-6 &&
    ends 4 'no two shapes may meet' sweep --between far,post hinge.json &&
    ends 4 'no two shapes may meet' sweep --allow leaf,post --between leaf,post hinge.json &&
    fails 4 '"leaf,no" does not name two objects' sweep --between leaf,no hinge.json &&
    ends 2 '--between is of scene files' sweep --between leaf,post hinge.urdf &&
    sed '/"post", "files"/s/{"name": "post".*$//; s/, {"name": "far".*}//; /"ignore"/s/,$//; s/^ "ignore".*/ "ignore": []}/; s/\[$/[/' hinge.json >leaf.json &&
    jams --with post.obj --json leaf.json && holds jams pin 0.52359877559829887 1e-6 &&
    sed 's/"post", 0.1/"post"/' hinge.json >bad.json &&
    fails 4 'a pair of "clearance" is ["name", "name", distance]' sweep bad.json &&
    sed 's/"post", 0.1/"post", -1/' hinge.json >bad.json &&
    fails 4 'a clearance is a number from 0' sweep bad.json
report "two parts have a clearance of their own, in the place of all others"

# Otherwise to look at the boxes of a step in which bodies turn, which has none, would end the
# daemon, and the answers behind it would be others than the recorded ones.
timeout 60 "$PCCDCTL" record --contacts -o t.rec -- "$PCCDCTL" sweep hinge.urdf >out 2>err
"$PCCDCTL" inspect -o t.html t.rec 2>&1 | grep -q 'built without' && has_page= || has_page=1
[ -s t.rec ] && ctl replay t.rec && says ' the same, 0 not$' &&
    { [ -z "$has_page" ] || { ctl inspect --json -o t.html t.rec &&
        [ "$(json_value differ)" = 0 ] && grep -q '"up":"z"' t.html &&
        PCCD_RECORD=u.rec PCCD_RECORD_OPTIONS=$(printf 'contacts=1,%.0s' {1..24})level=1 \
            ctl sweep --joint pin=0:0.1 hinge.urdf && ctl inspect -o u.html u.rec &&
        grep -q '"up":"z"' u.html; }; }
report "a recorded sweep is answered so again, also beside its boxes, with z up"

# Otherwise a finger would not follow the other one. The gap is 0.021 + 1.5 q.
cat >gripper.urdf <<'EOF'
<robot name="gripper"><link name="palm"/>
  <link name="a"><collision><origin xyz="0 0.02 0"/>
    <geometry><box size="0.02 0.02 0.02"/></geometry></collision></link>
  <link name="b"><collision><origin xyz="0 -0.015 0"/>
    <geometry><box size="0.01 0.01 0.01"/></geometry></collision></link>
  <joint name="ja" type="prismatic"><parent link="palm"/><child link="a"/><axis xyz="0 1 0"/>
    <limit lower="-0.02" upper="0.05"/></joint>
  <joint name="jb" type="prismatic"><parent link="palm"/><child link="b"/><axis xyz="0 -1 0"/>
    <limit lower="-1" upper="1"/><mimic joint="ja" multiplier="0.5" offset="0.001"/></joint>
</robot>
EOF
jams gripper.urdf && says '^joint +jb: follows ja, times 0.5 plus 0.001$' \
    'a and b, from the begin, where they meet already' &&
    ctl sweep --joint ja=-0.0139:0.05 gripper.urdf && jams --json gripper.urdf &&
    sed -n '/"initial": true/,$p' out >out2 && mv out2 out && holds at ja -0.014 1e-6
report "a joint that mimics another one follows it"

# Otherwise round shapes would be thinner or thicker. The ball's centre is at (cos q, sin q), and it
# meets the wall x >= 0.5 where cos q = 0.4, from within at 0.6; the cylinder is in a prism.
round() { # SHAPE RPY
    cat >round.urdf <<EOF
<robot name="round"><link name="wall"><collision><origin xyz="1.5 0 0"/>
    <geometry><box size="2 4 4"/></geometry></collision></link>
  <link name="ball"><collision><origin xyz="1 0 0" rpy="$2"/><geometry>$1</geometry></collision></link>
  <joint name="q" type="continuous"><parent link="wall"/><child link="ball"/><axis xyz="0 0 1"/></joint>
</robot>
EOF
}
round '<sphere radius="0.1"/>' '0 0 0'
jams --json --joint q=-90deg:0 round.urdf && holds jams q -1.1592794807274085 1e-6 &&
    round '<capsule radius="0.1" length="1"/>' '0 0 0' &&
    jams --json --joint q=-90deg:0 round.urdf && holds jams q -1.1592794807274085 1e-6 &&
    round '<cylinder radius="0.1" length="1"/>' '0 0 0' &&
    jams --json --joint q=-90deg:0 round.urdf && numbers jams q >got &&
    awk '{ exit !($1 < -1.1592795 && $1 > -1.1605) }' got &&
    round '<sphere radius="0.1"/>' '0 0 0' && sed -i 's/"1 0 0" rpy/"0 0 0" rpy/' round.urdf &&
    ctl sweep --clearance 0.3999 round.urdf && jams --clearance 0.4001 round.urdf
report "spheres, capsules and cylinders are as thick as they are"

within() { printf '%s' "<robot name=\"w\"><link name=\"wall\"><collision><geometry>$1</geometry>
    </collision></link><link name=\"bar\">$(solid "$2")</link><joint name=\"q\" type=\"continuous\">
    <parent link=\"wall\"/><child link=\"bar\"/></joint></robot>" >within.urdf; }

# Otherwise a clearance would take the place of the radius that is the shape, and what meets the
# ball would be called free. With 0.1 between them they jam where cos q = 0.3.
for shape in sphere 'capsule length="1"'; do
    round "<$shape radius=\"0.1\"/>" '0 0 0'
    jams --json --joint q=-90deg:0 --clearance wall,ball=0 round.urdf &&
        holds jams q -1.1592794807274085 1e-6 &&
        jams --json --joint q=-90deg:0 --clearance ball,wall=0.1 round.urdf &&
        holds jams q -1.2661036727794992 1e-6 || break
done && within '<sphere radius="9"/>' '<box size="1 1 1"/>' &&
    jams --clearance wall,bar=0 within.urdf
report "a clearance is beside the radius of a sphere or capsule, not in its place"

# Otherwise what passes through another part from the begin, or is wholly within it, would be free.
within '<box size="9 9 9"/>' '<box size="1 1 1"/>' && jams within.urdf &&
    says 'wall and bar, from the begin, where they meet already' &&
    within '<cylinder radius="8" length="9"/>' '<box size="1 1 1"/>' && jams within.urdf &&
    within '<box size="1 9 9"/>' '<box size="9 0.1 0.1"/>' && jams within.urdf &&
    says 'wall and bar, from the begin, where they meet already' &&
    within '<box size="9 9 9"/>' '<sphere radius="1"/>' && jams within.urdf &&
    printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >flat.obj &&
    within '<box size="9 9 9"/>' '<mesh filename="flat.obj"/>' && ctl sweep within.urdf &&
    says '^note +not all shapes are closed' && sed 's/^v /v 99/' flat.obj >away.obj &&
    within '<box size="9 9 9"/>' '<box size="1 1 1"/>' && jams --with away.obj within.urdf &&
    says 'wall and bar, from the begin, where they meet already' '^note +not all shapes' &&
    sed -i 's|</robot>|<link name="in"><collision><geometry><sphere radius="2"/></geometry></collision>\
    </link><joint name="p" type="continuous"><parent link="bar"/><child link="in"/></joint></robot>|' \
        within.urdf && jams --with away.obj within.urdf &&
    says '^ +what touches by design: --allow wall,bar --allow wall,in$'
report "what begins within another part is seen, or that it would not be"

# Otherwise a box of joint values would be called free with a jam in it.
cat >two.urdf <<'EOF'
<robot name="two">
  <link name="base"><collision><origin xyz="1.5 1.2 0"/>
    <geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <link name="upper"/>
  <link name="lower"><collision><origin xyz="0.5 0 0"/>
    <geometry><box size="1 0.05 0.05"/></geometry></collision></link>
  <joint name="a" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3"/></joint>
  <joint name="b" type="revolute"><parent link="upper"/><child link="lower"/>
    <origin xyz="1 0 0"/><axis xyz="0 0 1"/><limit lower="-3" upper="3"/></joint>
</robot>
EOF
ctl sweep --joint a=-1:0 --joint b=-1:0.3 two.urdf && says 'a -1 to 0 rad.*, b .*: free' &&
    jams --joint a=0:1.5 --joint b=-1:1 --json two.urdf && grep -q '"lower"' out &&
    { ctl sweep --joint a=0:0.55 --joint b=-1:0.4 --motions 1 two.urdf; [ $? -eq 5 ]; } &&
    says 'undecided +[0-9.e-]* of the range$'
report "two joints at once are free, jam, or stay undecided where motions end"

# Otherwise the least distance would be that of some values alone. It is where a = 0, b = 0.3: the
# corner at 1.55, 1.15 is 1.15 cos b - 0.55 sin b - 0.025 from the upper face.
ctl sweep --least 0.01 --joint a=-1:0 --joint b=-1:0.3 --json two.urdf &&
    awk '/least_distance/ { getline a; getline b; ok = a + 0 <= 0.9111008488307 &&
        b + 0 >= 0.9111008488307 && b - a < 0.03 } END { exit !ok }' out &&
    ctl sweep --least 0.01 --motions 1 --joint a=-1:-0.5 --joint b=-1:-0.9 two.urdf
report "the least distance of two joints at once is found"

# Otherwise a planner's edge would be called free that is not, or another one would be asked.
edge() { echo "$1" >e.jsonl; }
edge '{"from": [0], "to": [0.5]}

{"from": {"pin": 0.4}, "to": {"pin": 1.4}}'
jams --edges e.jsonl hinge.urdf && says '^edge +line 1: free$' \
    '^edge +line 3: jams, t 0.1236: post and leaf$' &&
    jams --edges e.jsonl --json hinge.urdf && grep -q '"line": 3' out &&
    edge '{"from": [0], "to": [-0.5]}' && ctl sweep --edges e.jsonl hinge.urdf &&
    says '^ +note +pin at -0.5 to 0 rad .* goes beyond its limits, 0 to 1.5 rad' &&
    ctl sweep --json --edges e.jsonl hinge.urdf && grep -A1 '"beyond_limits"' out | grep -q pin &&
    edge '{"from": [0], "to": [0.5]}' && ctl sweep --edges e.jsonl hinge.urdf &&
    printf 'v 0 0.1 -1\nv 1.5 0.1 -1\nv 1.5 0.1 1\nf 1 2 3\n' >wall.obj &&
    jams --edges e.jsonl --with wall.obj hinge.urdf && says 'leaf and wall.obj$' &&
    edge '{"from": [0]}' && ends 4 'e.jsonl:1: an edge is {' sweep --edges e.jsonl hinge.urdf &&
    edge '{"from": [0], "to": [1, 2]}' &&
    ends 4 'e.jsonl:1: "to" has 2 values' sweep --edges e.jsonl hinge.urdf &&
    edge '{"from": [0], "to": {"knee": 2}}' &&
    ends 4 'e.jsonl:1: "to" names "knee", which is no joint' sweep --edges e.jsonl hinge.urdf &&
    : >e.jsonl && ends 4 'e.jsonl: no edge is in it' sweep --edges e.jsonl hinge.urdf &&
    edge '{"from": [0], "to": ["a"]}' &&
    ends 4 'e.jsonl:1: "to" has no number for joint "pin"' sweep --edges e.jsonl hinge.urdf &&
    edge '[' && ends 4 'e.jsonl:1: ' sweep --edges e.jsonl hinge.urdf
report "edges are free or jam at a time; wrong ones are refused with their line"

# block X0 X1: a block of an OBJ file between these, 2 wide and high around the x axis.
block() {
    printf 'v %s -1 -1\nv %s 1 -1\nv %s 1 1\nv %s -1 1\n' "$2" "$2" "$2" "$2" "$1" "$1" "$1" "$1"
    printf 'f 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n'
}
block 1 2 >body.obj
block -2 -1.5 >wall.obj
block 11 12 >body2.obj
block 8 8.5 >wall2.obj
screw() { ctl check --motion screw --json "$@"; }
# The side y = -1 of the body comes to the edge of the wall at (-1.5, -1), at pi - 2 atan(2 / 3).
meets() { screw "$@"; [ $? -eq 1 ] && holds jams screw 1.9655874464946581 1e-6; }

# Otherwise a body of two files would turn about another axis, in the other direction, or straight.
meets --axis 0,0,1 --angle -200deg --pitch 0.5 body.obj wall.obj &&
    meets --axis 0,0,-2 --angle 3 body.obj wall.obj &&
    meets --axis 0,0,1 --through 10,0,5 --angle -3 body2.obj wall2.obj &&
    meets --axis 0,0,1 --angle -3 --with wall2.obj body.obj wall.obj &&
    screw --axis 0,0,1 --angle 1.965 body.obj wall.obj &&
    screw --axis 0,0,1 --angle 3 --pitch 20 body.obj wall.obj &&
    ! screw --axis 0,0,1 --angle 3 --pitch 20 --separation 2 body.obj wall.obj &&
    ! ctl check --motion screw --axis 0,0,1 --angle 3 body.obj wall.obj &&
    says '^joint +screw 0 to 3 rad .*: jams$' 'body and wall, from the begin$'
report "a screw of two files jams where it does"

# Otherwise what is asked of frames would be left out in silence, or a screw be none.
turn="--motion screw --axis 0,0,1 --angle 1"
for option in --mode=any --tolerance=1e-3 --contacts=c.csv --results=r.jsonl --jobs=2 --deadline=9 \
    --trace=t.json --page=p.html --rings=2 --repeat=3; do
    ends 2 "${option%%=*}: not with --motion screw" check $turn "$option" body.obj wall.obj || break
done && ends 2 'two files' check $turn seq%d.obj &&
    ends 2 '--motion screw: --axis X,Y,Z' check --motion screw --angle 1 body.obj wall.obj &&
    ends 2 'are of --motion screw' check --pitch 1 body.obj wall.obj &&
    ends 2 'not an angle' check $turn --angle 7e6 body.obj wall.obj &&
    ends 2 'not X,Y,Z' check $turn --through 1,2 body.obj wall.obj &&
    echo '{}' >s.json && ends 4 's.json' check $turn s.json wall.obj
report "a screw that makes no sense is refused by name"

# Otherwise nobody could hold against it what it has said.
timeout 60 "$PCCDCTL" record --contacts -o s.rec -- "$PCCDCTL" check $turn --angle=-3 body.obj \
    wall.obj >out 2>err
[ -s s.rec ] && ctl replay s.rec && says ' the same, 0 not$' && ctl verify --sample 30 s.rec
report "a recorded screw is answered so again, and verified"

# Otherwise the robot that many have would be another one, or its meshes not be found.
panda=${PCCD_DATA-}/panda
if [ -e "$panda/panda.urdf" ]; then
    ctl sweep --meshes "$panda" --srdf "$panda/panda.srdf" --state ready "$panda/panda.urdf"
    [ $? -le 1 ] && says 'joints 12, parts 13, shapes 11, pairs of shapes that may meet 21' \
        '^joint +panda_joint7 -2.967 to 2.967 rad'
    report "Panda: each joint is swept"
    # Otherwise edges of seven joints would stay undecided, or take minutes.
    sed 's/.*"start":\(\[[^]]*\]\),"goal":\(\[[^]]*\]\).*/{"from":\1,"to":\2}/' \
        "$panda/problems.jsonl" >edges.jsonl
    ctl sweep --meshes "$panda" --srdf "$panda/panda.srdf" --edges edges.jsonl "$panda/panda.urdf"
    [ $? -le 1 ] && [ "$(grep -cE '^edge .*: (free$|jams, )' out)" -eq 140 ]
    report "Panda: 140 edges of seven joints are decided"
else
    tap_skip "Panda: each joint is swept" "there is no panda in PCCD_DATA"
fi
tap_end
