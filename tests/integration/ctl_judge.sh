#!/bin/bash
# tests/integration/ctl_judge.sh - pccdctl check of whole sequences: verdicts, results, jobs,
# certificates (TAP).

set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/ctl.sh
. "$top_srcdir/tests/support/ctl.sh"

# A floor and three spikes that pass through it, or stand above it: each crosses the floor with two
# of its edges, or with none. spikes A B C: how high their tips are.
spikes() {
    echo 'v -30 -30 0'; echo 'v 30 -30 0'; echo 'v 0 30 0'; echo 'f 1 2 3'
    local i=0 tip
    for tip; do
        echo "v $((3 * i)) 0 $tip"; echo "v $((3 * i + 1)) 0 9"; echo "v $((3 * i)) 1 9"
        echo "f $((3 * i + 4)) $((3 * i + 5)) $((3 * i + 6))"
        i=$((i + 1))
    done
}
# The first stands crossed until it leaves, and comes back; the second comes and goes; the third
# never touches.
spikes -2 1 1 >seq0.obj
spikes -2 1 2 >seq1.obj
spikes -2 -1 2 >seq2.obj
spikes 1 -1 2 >seq3.obj
spikes -1 -1 2 >seq4.obj
spikes -1 1 2 >seq5.obj
spikes -1 -1 2 >seq6.obj
steps() { sed -n 's/.*"step":\([0-9]*\),.*"begins_crossed":\([0-9]*\),"ends_crossed":\([0-9]*\),"standing":\([0-9]*\),"new":\([0-9]*\),"gone":\([0-9]*\),.*/\1 \2 \3 \4 \5 \6/p' "$1"; }

# If it failed, what stood crossed in the first frame would be told again and again, or what is new
# would be lost among it.
cat >expected <<'END'
1 2 2 2 0 0
2 2 4 2 2 0
3 4 2 0 0 2
4 2 4 2 0 0
5 4 2 2 0 2
6 2 4 2 2 0
END
check 1 --results r.jsonl seq%d.obj && steps r.jsonl | diff - expected >>"$log" &&
    says '^standing +2 crossings in the first frame' \
        '^ +ends crossed 4 times: 2 new, 2 of the first frame.s; 0 gone$' \
        '^verdict +meets first in step 2, at t = 0\.5, between vertex 6 and face 0; in 5 of 6 steps; standing 2 crossings, in the last frame 2; new 4 crossings, the first at the end of step 2$' \
        '^ +frames are samples: between them each vertex is taken to go straight$' &&
    tail -n 1 r.jsonl | grep -q '^{"verdict":"meets","steps":6,"meeting":5,"first_step":2,' &&
    [ "$(grep -c '"fails":true' r.jsonl)" -eq 5 ]
report judge__tells_what_stands_and_what_is_new

# If it failed, what crosses would depend on who finds it: of mode all the records tell where an
# edge may have come through a face, of mode first all faces are compared. Faces and rods that share
# corners, points that lie on others, and enough that nearly every step has all of it.
mkdir soup && awk 'BEGIN {
    srand(5)
    for (frame = 0; frame < 10; frame++) {
        file = "soup/s" frame ".obj"
        for (v = 0; v < 90; v++) {
            for (k = 0; k < 3; k++) x[v, k] = frame > 0 && rand() < 0.7 ? x[v, k] : int(rand() * (v < 60 ? 1e6 : 5)) / (v < 60 ? 2e5 : 1)
            print "v " x[v, 0] " " x[v, 1] " " x[v, 2] >file
        }
        for (f = 0; f < 30; f++) print "f " 1 + 3 * f " " 2 + 3 * f " " (f % 3 ? 3 + 3 * f : 1 + (3 * f + 7) % 90) >file
        for (e = 0; e < 15; e++) print "l " 1 + 6 * e " " 1 + (6 * e + 40) % 90 >file
    }
}' </dev/null && check 1 --weld off --results all.jsonl soup/s%d.obj && check 1 --weld off --mode first --results first.jsonl soup/s%d.obj &&
    [ "$(steps all.jsonl | awk '$3 > 20 && $5 > 5 && $6 > 5' | wc -l)" -gt 6 ] && diff <(steps all.jsonl) <(steps first.jsonl) >>"$log"
report judge__finds_what_crosses_without_asking

# If it failed, a step that was begun before the last one's answer was seen would be lost, or be made
# from elsewhere: here an answer has more pages than one, and the next step is taken back.
awk 'BEGIN { for (i = 0; i < 6; i++) { f = "many" i ".obj"; z = (i < 3 || i == 4) - 0.5
    print "v -9 -9 0\nv 9999 -9 0\nv -9 9999 0\nf 1 2 3" >f
    for (k = 0; k < 1200; k++) { x = 2 * (k % 50); y = 2 * int(k / 50)
        print "v " x " " y " " z "\nv " x + 1 " " y " 9\nv " x " " y + 1 " 9\nf -3 -2 -1" >f } } }' </dev/null
check 1 --results pages.jsonl --result-bytes 65536 many%d.obj && check 1 --results whole.jsonl many%d.obj && cmp pages.jsonl whole.jsonl >>"$log" &&
    [ "$(grep -c '"contacts":1200,' whole.jsonl)" -eq 3 ] && ctl verify --url direct: whole.jsonl many%d.obj
report judge__takes_back_a_step_that_was_begun

# If it failed, results would have the hash of a file that was not what was judged. What reads the
# contacts waits in step 3 until the file has changed.
mkfifo hits.csv && { timeout 100 "$PCCDCTL" check --private --contacts hits.csv --results changed.jsonl many%d.obj >out 2>err & } && pid=$!
exec 7<hits.csv && touch -d @1 many5.obj && cat <&7 >/dev/null
exec 7<&-
wait $pid
[ $? -eq 4 ] && grep -qx 'pccdctl: many5.obj has changed since the check began: what was found is no result of it' err &&
    [ "$(wc -l <changed.jsonl)" -eq 7 ] && ! grep -q '"verdict"' changed.jsonl
report judge__of_files_that_change_has_no_verdict

# If it failed, a verdict would say more, or less, than the steps.
check 0 seq0.obj seq0.obj --no-self && says '^verdict +free: nothing meets, at frames or between them$' &&
    check 1 seq0.obj seq0.obj seq0.obj && says '^verdict +crossed, and nothing else meets; standing 2 crossings, in the last frame 2; no new crossings$' &&
    check 1 seq0.obj seq0.obj && says '^verdict +crossed, and nothing else meets$' &&
    spikes 1 1 1 >high.obj && spikes 2 2 2 >higher.obj &&
    check 0 --thickness 0.25 higher.obj high.obj higher.obj && says '^verdict +free: .*; thickness kept$' &&
    check 1 --thickness 0.75 higher.obj high.obj higher.obj &&
    says '^verdict +too near first in step 1, at t = .*; thickness not kept$' &&
    check 1 --mode any seq%d.obj && says '^verdict +meets first in step 2; in 5 of 6 steps' &&
    check 1 --mode any seq0.obj seq0.obj seq0.obj && says '^verdict +crossed, and nothing else meets'
report judge__has_a_verdict_for_each_outcome

# If it failed, who reads a pipe would wait for the last step to hear of the first; a box that
# nobody sees is not drawn there.
mkfifo late.obj
{ timeout 100 "$PCCDCTL" check --private --weld off seq0.obj seq1.obj late.obj >piped 2>err; } &
pid=$!
for _ in $(seq 200); do grep -q '^ *1  seq1.obj: 0 ' piped 2>/dev/null && break; sleep 0.1; done
grep -q '^ *1  seq1.obj: 0 ' piped && ! grep -q '^ *2 ' piped && cat seq2.obj >late.obj && wait $pid
[ $? -eq 1 ] && grep -q '^ *2  late.obj: ' piped
report judge__tells_each_step_when_it_is_known

# If it failed, what was done before a machine died would be done again, or a run that goes on would
# say something else than one that was never ended.
status=0
for bytes in 0 20 $(($(head -n 1 r.jsonl | wc -c) - 1)) $(head -n 1 r.jsonl | wc -c) \
    $(($(head -n 2 r.jsonl | wc -c) + 5)) $(head -n 4 r.jsonl | wc -c) $(($(wc -c <r.jsonl) - 3)); do
    head -c "$bytes" r.jsonl >again.jsonl
    check 1 --results again.jsonl seq%d.obj && cmp r.jsonl again.jsonl >>"$log" 2>&1 &&
        says '^verdict +meets first in step 2, .*new 4 crossings' || { status=1; break; }
done
[ $status -eq 0 ] && check 4 --results r.jsonl --thickness 1 seq%d.obj &&
    grep -q 'r.jsonl: it has results of other files' err && echo text >text &&
    check 4 --results text seq%d.obj && grep -q 'text: it is there, and is no file of results' err &&
    ctl check --private --results - seq%d.obj; cmp out r.jsonl >>"$log" 2>&1 && grep -q '^verdict ' err
report judge__goes_on_with_results_that_are_there

# If it failed, a verdict without the steps that it is of would be believed.
none='it is not the verdict of the lines before it'
{ head -n 1 r.jsonl; echo '{"verdict":"free"}'; } >w.jsonl && ends 4 "w.jsonl: line 2: $none" check --private --results w.jsonl seq%d.obj &&
    { head -n 1 r.jsonl; tail -n 1 r.jsonl; } >w.jsonl && ends 4 "w.jsonl: line 2: $none" check --private --results w.jsonl seq%d.obj &&
    { head -n 7 r.jsonl; tail -n 1 r.jsonl; } >w.jsonl && ends 4 "w.jsonl: line 8: $none" check --private --results w.jsonl seq%d.obj &&
    sed '$s/"meets"/"free"/' r.jsonl >w.jsonl && ends 4 "w.jsonl: line 9: $none" check --private --results w.jsonl seq%d.obj &&
    for line in 2 8 9; do
        { cat r.jsonl; sed -n ${line}p r.jsonl; } >w.jsonl
        ends 4 'w.jsonl: line 10: it is no result of this check' check --private --results w.jsonl seq%d.obj || echo "line $line"
    done >"$log" && [ ! -s "$log" ] && cp r.jsonl w.jsonl && check 1 --results w.jsonl seq%d.obj && cmp r.jsonl w.jsonl >>"$log" &&
    check 1 --part 1/2 --results w.jsonl seq%d.obj && head -n 1 w.jsonl.1-of-2 >w && tail -n 1 w.jsonl.1-of-2 >>w &&
    mv w w.jsonl.1-of-2 && rm w.jsonl && check 4 --jobs 2 --results w.jsonl seq%d.obj
report judge__believes_no_verdict_without_its_steps

# If it failed, several machines or processes would come to another verdict than one.
for i in 1 2 3; do
    check 1 --part $i/3 --results jobs.jsonl seq%d.obj || echo "part $i" >>"$log"
done
[ -s jobs.jsonl.3-of-3 ] && check 1 --jobs 3 --results jobs.jsonl seq%d.obj && cmp r.jsonl jobs.jsonl >>"$log" &&
    [ ! -e jobs.jsonl.1-of-3 ] && says '^ +6  seq6.obj: ' '^verdict +meets first in step 2, ' &&
    check 1 --jobs 2 seq%d.obj && says '^verdict +meets first in step 2, .*new 4 crossings' &&
    for n in 2 4 9; do
        rm -f jobs.jsonl
        check 1 --jobs $n --results jobs.jsonl seq%d.obj && cmp r.jsonl jobs.jsonl || echo "$n jobs"
    done >>"$log" 2>&1
[ ! -s "$log" ]
report judge__says_the_same_in_parts_and_jobs

# If it failed, a part would be taken for the whole, or a number of a part for one that there is.
check 1 --part 1/2 --results whole.jsonl seq%d.obj && says '^verdict +meets first in step 2, ' &&
    check 0 --thickness 0.25 --part 2/2 --results high.jsonl higher.obj high.obj higher.obj &&
    says '^verdict +free: nothing meets in steps 2 to 2 \(part 2 of 2\), at frames .*; thickness kept$' &&
    check 0 --no-self --part 1/4 --results high.jsonl higher.obj high.obj higher.obj &&
    says '^verdict +no step is in this part$' &&
    check 1 --part 1/2 --results crossed.jsonl seq0.obj seq0.obj seq0.obj &&
    says '^verdict +crossed, and nothing else meets in steps 1 to 1 \(part 1 of 2\); standing 2 ' &&
    ctl verify --private high.jsonl.1-of-4 higher.obj high.obj higher.obj &&
    says '^PASS +all 3 lines are the same; they are of no step \(part 1 of 4\)$' &&
    ctl verify --private high.jsonl.2-of-2 higher.obj high.obj higher.obj &&
    says '^PASS +all 4 lines are the same; they are of steps 2 to 2 \(part 2 of 2\)$' &&
    for part in '"part":7,"parts":1' '"part":0,"parts":1' '"part":1,"parts":0' '"part":1,"parts":1000001' \
        '"part":1' '"parts":2' '"part":"1","parts":1'; do
        sed "1s/\"part\":2,\"parts\":2/$part/" high.jsonl.2-of-2 >w.jsonl
        ends 4 'w.jsonl: its head is none' verify --private w.jsonl higher.obj high.obj higher.obj || echo "$part"
    done >"$log" && [ ! -s "$log" ]
report judge__of_a_part_says_which_steps_it_has

# If it failed, a bake that was cut off would be free, or meet something, or be no word.
cp seq0.obj cut0.obj && cp seq1.obj cut1.obj && head -n 7 seq2.obj >cut2.obj && cp seq3.obj cut3.obj
for options in '' '--jobs 2' '--results cut.jsonl'; do
    # shellcheck disable=SC2086 # words
    check 4 $options cut%d.obj && grep -qE 'cut2.obj' err && grep -q '^ *1  cut1.obj: 0 ' out &&
        ! grep -q '^verdict' out || { echo "$options:"; cat out err; } >>"$log"
done
says '^so far +' && [ "$(wc -l <cut.jsonl)" -eq 3 ] && [ ! -s "$log" ] && python3 - <<'END'
import struct
rows = [[float(x) for line in open(f"seq{i}.obj") if line[0] == "v" for x in line.split()[1:]] for i in range(4)]
head = struct.pack("<12siiffi", b"POINTCACHE2", 1, 12, 0, 1, 7)
with open("cut.pc2", "wb") as to:
    to.write(head + b"".join(struct.pack("<36f", *row) for row in rows)[:-20])
# As Blender writes it: the first frame is there twice, and the header counts it once.
head = struct.pack(">2i4f", 4, 12, 0, 1, 2, 3)
frames = [struct.pack(">36f", *row) for row in rows]
for name, cut in (("early", 160), ("late", 20)):
    with open(f"{name}.mdd", "wb") as to:
        to.write((head + frames[0] + b"".join(frames))[:-cut])
END
[ $? -eq 0 ] && check 4 seq0.obj cut.pc2 && says '^ *1  cut.pc2 frame 1: 0 ' '^ *2  cut.pc2 frame 2: 1 ' '^so far +meets' &&
    grep -qx 'pccdctl: cut.pc2: frame 3 is cut off: by its header, 7 frames of 12 vertices, it has 1040 bytes; it has 588' err &&
    ! ctl near --private seq0.obj cut.pc2 &&
    check 4 seq0.obj early.mdd && says '^ *1  early.mdd 1 s: 0 ' '^so far +crossed, ' && grep -q 'early.mdd: frame 2 is cut off: .* has 744 bytes; it has 584$' err &&
    check 4 seq0.obj late.mdd && says '^ *1  late.mdd 1 s: 0 ' '^ *2  late.mdd 2 s: 1 ' '^so far +meets' &&
    grep -q 'late.mdd: frame 3 is cut off: .* it has 744 bytes; it has 724$' err &&
    { head -c 28 cut.pc2; printf '\377\377\377\177'; tail -c +33 cut.pc2; } >huge.pc2 &&
    ends 4 'by its header, 2147483647 frames of 12 vertices' check --private seq0.obj huge.pc2
report judge__of_frames_that_are_cut_off_says_what_was_whole

# If it failed, a certificate would be believed whatever it says, or not be reproduced elsewhere.
verify() {
    local status=$1
    shift
    ctl verify --private "$@"
    [ $? -eq "$status" ]
}
cat >scene.json <<'END'
{"pccd_scene": 1, "objects": [
  {"name": "one", "files": "seq%d.obj", "thickness": 0.125},
  {"name": "two", "files": ["seq1.obj"], "unit": 0.5, "self": false}]}
END
check 1 --results s.jsonl --with high.obj --between one,high --between one,one --mode first --weld off scene.json &&
    verify 0 s.jsonl scene.json high.obj && says '^PASS +all 9 lines are the same$' &&
    verify 0 --method paper --threads 2 s.jsonl scene.json high.obj &&
    verify 0 r.jsonl seq%d.obj && mkdir -p other && cp seq?.obj other &&
    ctl verify --url direct: r.jsonl other/seq%d.obj && verify 0 r.jsonl other/seq?.obj &&
    cp higher.obj other/high.obj && verify 1 s.jsonl scene.json other/high.obj &&
    says '^different +high.obj: was high.obj with [0-9]+ bytes' '^FAIL ' &&
    sed '5s/"new":0/"new":1/; 6s/"toi":0/"toi":1/' r.jsonl >w.jsonl && verify 1 w.jsonl seq%d.obj &&
    says '^different +line 5, step 3$' '^ +new was 1, is 0$' '^ +first was ' '^FAIL +2 differences' &&
    sed '1s/"thickness":0.0/"thickness":2.0/' r.jsonl >w.jsonl && verify 1 w.jsonl seq%d.obj && says '^FAIL' &&
    cp seq6.obj was6.obj && spikes -1 -1 3 >seq6.obj && verify 1 r.jsonl seq%d.obj &&
    says '^different +seq6.obj: was seq6.obj with' && cp was6.obj seq6.obj &&
    head -n 5 r.jsonl >w.jsonl && verify 4 w.jsonl seq%d.obj && grep -q 'has no verdict at its end' err &&
    ends 4 'absent.jsonl, which has files behind it, is no certificate: No such file' verify absent.jsonl seq%d.obj &&
    verify 4 r.jsonl seq0.obj && verify 4 r.jsonl absent.obj && verify 4 s.jsonl &&
    grep -q 'name the files of s.jsonl behind it, those of --with last' err &&
    echo '{"pccd_check":1,"settings":3}' >w.jsonl && echo '{"verdict":"free"}' >>w.jsonl && verify 4 w.jsonl seq0.obj
report judge__certificate_is_verified_byte_for_byte

# If it failed, what no check has written would be passed over in a certificate.
cp r.jsonl w.jsonl && echo '{"verdict":"free"}' >>w.jsonl && verify 1 w.jsonl seq%d.obj &&
    says '^different +line 10, behind the verdict: none is expected$' '^FAIL +1 difference,' &&
    sed '1s/,"steps":6/,"steps":6,"approved":true/' r.jsonl >w.jsonl && verify 1 w.jsonl seq%d.obj &&
    says '^different +approved: no check has it$' '^FAIL +1 difference,' &&
    sed '1s/,"steps":6/,"steps":6,"steps":6/' r.jsonl >w.jsonl && verify 4 w.jsonl seq%d.obj
report judge__certificate_has_nothing_else

# If it failed, vertices that a .gltf file has in another one could change, and nothing would tell.
python3 - <<'END'
import json, struct
for i, height in enumerate((2, 1, 3)):
    points = [-9, -9, 0, 9, -9, 0, 0, 9, 0, 0, 0, height, 1, 0, height, 0, 1, height]
    with open(f"g {i}.bin", "wb") as to:
        to.write(struct.pack("<18f6H", *points, *range(6)))
    views = [{"buffer": 0, "byteLength": 72}, {"buffer": 0, "byteOffset": 72, "byteLength": 12}]
    accessors = [{"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3"},
                 {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}]
    with open(f"g{i}.gltf", "w") as to:
        json.dump({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                   "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
                   "buffers": [{"uri": f"g%20{i}.bin", "byteLength": 84}, {"uri": "data:;base64,AAAA", "byteLength": 3}],
                   "bufferViews": views, "accessors": accessors}, to)
END
check 0 --results g.jsonl g%d.gltf && grep -q '"file":"g0.gltf",[^}]*},{"file":"g 0.bin","bytes":84,' g.jsonl &&
    [ "$(head -n 1 g.jsonl | grep -o '"file"' | wc -l)" -eq 6 ] && verify 0 g.jsonl g%d.gltf &&
    check 0 --results g.jsonl g%d.gltf && cp 'g 2.bin' was.bin && cp 'g 1.bin' 'g 2.bin' &&
    ends 4 'g.jsonl: it has results of other files' check --private --results g.jsonl g%d.gltf &&
    verify 1 g.jsonl g%d.gltf && says '^different +g 2.bin: was g 2.bin with 84 bytes' && cp was.bin 'g 2.bin' &&
    rm 'g 2.bin' && ends 4 'g 2.bin: cannot open' check --private --results absent.jsonl g%d.gltf
report judge__hashes_the_buffers_of_gltf

# If it failed, what leaves its floor would never be free, or a certificate of that would be none.
spikes 0 1 1 >leave0.obj
spikes 1 1 1 >leave1.obj
spikes 2 1 1 >leave2.obj
check 1 leave%d.obj && says '^verdict +meets first in step 1, at t = 0, ' &&
    check 0 --touching left-out --results l.jsonl leave%d.obj &&
    says '^verdict +free: nothing enters what it touches, or meets, ' &&
    grep -q '"step":1,.*"entering":0,"sliding":0,"leaving":1,' l.jsonl && verify 0 l.jsonl leave%d.obj
report judge__leaves_out_what_leaves

# If it failed, two frames would be judged by less than a sequence of them.
sed 's/^v 1 0 9$/v 1 0 -9/' leave0.obj >enter.obj
check 1 --touching left-out leave0.obj enter.obj && says '; new 1 crossing, the first at the end of step 1$'
report judge__looks_at_the_end_of_the_one_step

# If it failed, a page of steps that were made before would say that none of them fails.
cp r.jsonl w.jsonl
ctl check --private --page p.html seq0.obj seq1.obj
has_page=$(grep -q 'built without' err || echo yes)
for option in '--contacts w.csv' ${has_page:+'--page w.html'} '--film w.apng'; do
    head -n 4 r.jsonl >w.jsonl
    # shellcheck disable=SC2086 # words
    ends 4 "w.jsonl has steps already, whose contacts ${option% *} would leave out" \
        check --private --results w.jsonl $option seq%d.obj && cp r.jsonl w.jsonl &&
        ends 4 "w.jsonl has steps already" check --private --results w.jsonl $option seq%d.obj || echo "$option"
done >"$log" && [ ! -s "$log" ] && [ ! -e w.html ] && [ ! -e w.apng ] &&
    ends 4 'not with direct:' check --url direct: --film w.apng seq0.obj seq1.obj
report judge__shows_no_steps_of_before

# If it failed, options would be taken and not do what they say.
ends 2 '--part wants a file of --results' check --part 1/2 seq%d.obj &&
    ends 2 '"3/2" is not I/N' check --results r --part 3/2 seq%d.obj &&
    ends 2 '"1/2x" is not I/N' check --results r --part 1/2x seq%d.obj &&
    ends 2 'not with --json; lines of --results are JSON' check --results r --json seq%d.obj &&
    ends 2 'not with --deadline' check --jobs 2 --deadline 10 seq%d.obj &&
    ends 2 '--jobs: not with --contacts' check --jobs 2 --contacts c seq%d.obj && mkfifo pipe.obj &&
    { timeout 5 cat seq1.obj >pipe.obj & ends 4 'pipe.obj is no regular file' check --private --results r seq0.obj pipe.obj; }
report judge__refuses_what_does_not_go_together

tap_end
