#!/bin/bash
# mpi_check.sh - one scene over 1, 2, 3, 4 and 8 ranks: the same bytes as by one process.

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCDCTL:?}" "${PCCD_DATA?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
# shellcheck source=tests/mpi/ranks.sh
. "$top_srcdir/tests/mpi/ranks.sh"
ranks_rest=yes

all=${PCCD_MPI_ALL:-0}
counts='1 2 3 4 8'
mistakes='order totals mode settings two-owners no-owner two-triangles no-triangle index
    not-finite no-object near-distance near-kind near-negative near-gap near-far near-object
    near-open no-part no-handle no-settings no-answer no-motions no-share no-world
    absent'
ends='yes deadline cancel turns'
scenes='cloth-funnel cloth-ball n-body-simulation'
work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-mpi-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log

cases() { # the names of all
    printf 'plays_of_%s_ranks_are_those_of_one_process\n' $counts
    printf '%s_ends_a_call_on_all_ranks\n' $ends
    printf 'mistake_%s_is_told_to_all_ranks\n' $mistakes dies
    printf 'check_of_%s_says_what_pccdctl_says\n' files numbered_files seams objects motions \
        other_files missing_file usage $scenes
    printf 'work_of_%s_lies_evenly_on_many_ranks\n' $scenes
    printf '%s\n' rank_of_one_thread_starts_no_others threads_of_a_rank_change_no_byte \
        first_is_known_however_few_records_are_kept answers_do_not_show_how_ranks_round \
        triangles_lie_evenly_where_work_does_not yes_stops_no_rank_that_tells_how_a_step_begins \
        help_is_printed_once ghosts_last_while_things_move_steadily \
        completion_knows_commands_and_options near_of_files_says_what_pccdctl_says \
        near_refuses_a_scene_file example_prints_one_line_for_any_number_of_ranks
}

if [ "${PCCD_MPI:-no}" = no ]; then
    for name in $(cases); do
        tap_skip "mpi__$name" "no --with-mpi"
    done
    tap_end
    exit
fi

# ---- the library -----------------------------------------------------------------------

# If one failed, an answer would depend on the number of ranks, or on who was given what.
plays=12
[ "$all" = 0 ] || plays=150
for count in $counts; do
    # Eight ranks take their time on two processors: those of MPICH do not sleep while they wait.
    if [ "$count" -eq 8 ]; then
        [ "$all" = 0 ] && plays=6
        [ "$all$PCCD_MPI" = 1mpich ] && plays=15
    fi
    # Memory that nobody has written to has coordinates beyond 1e18. Play 8019 refuses a step, and
    # then has an object without leaves on some ranks.
    MALLOC_PERTURB_=128 ranks "$count" "$top_builddir/tests/mpi/same_as_one" $plays 60 \
        "$((1000 * count + 19))" >"$log" 2>&1
    tap_result $? "mpi__plays_of_${count}_ranks_are_those_of_one_process" "$log"
done

# If one failed, ranks would go on with what nobody needs any more; or a message of one call would
# end another one, or be waited for in vain.
turns=300
[ "$all" = 0 ] || turns=1500
for what in $ends; do
    ranks 3 "$top_builddir/tests/mpi/stop" "$what" $turns >"$log" 2>&1
    tap_result $? "mpi__${what}_ends_a_call_on_all_ranks" "$log"
done

# If it failed, ranks would keep each other from their processors, or one would end where the
# system starts no more threads.
ranks 4 "$top_builddir/tests/mpi/large" 200 1 >"$log" 2>&1
tap_result $? mpi__rank_of_one_thread_starts_no_others "$log"

# If it failed, positions or records of a rank would be lost between its threads, or two of these
# would have the same ones; or what leaves its box would not be seen. There are so many of each
# that a team is woken (client/mpi/team.h).
for run in '1 1' '1 3' '2 1' '2 3'; do # by itself a rank has the processors that it is bound to
    OMP_NUM_THREADS=3 ranks "${run% *}" "$top_builddir/tests/mpi/large" 200 3 16384 \
        "${run#* }" 2>&1
done >"$log"
grep -o '[0-9]* choices of ghosts, [0-9]* contacts, hash.*' "$log" | awk '{ print }
    { choices = $1; sub(/.* ghosts, /, ""); records[NR] = $0 }
    $1 <= 40000 || $0 != records[1] || choices != (NR > 2 ? 2 : 1) { wrong = 1 }
    END { exit wrong || NR != 4 }' >>"$log"
tap_result $? mpi__threads_of_a_rank_change_no_byte "$log"

# If it failed, ranks that keep few records would lose the earliest contact, or hide that they had.
for count in 1 3; do
    ranks "$count" "$top_builddir/tests/mpi/stop" crowd >"$log" 2>&1 || break
done
tap_result $? mpi__first_is_known_however_few_records_are_kept "$log"

# If one failed, a mistake of one rank would hang the others, or end a world that could go on.
for mistake in $mistakes; do
    ranks 3 "$top_builddir/tests/mpi/misuse" "$mistake" >"$log" 2>&1
    tap_result $? "mpi__mistake_${mistake}_is_told_to_all_ranks" "$log"
done

# If it failed, a simulator that rounds down, or a library in it that flushes subnormal numbers,
# would get other contacts from its ranks, or would compute otherwise after a call.
ranks 3 "$top_builddir/tests/mpi/rounding" >"$log" 2>&1
tap_result $? mpi__answers_do_not_show_how_ranks_round "$log"

# If it failed, a job would go on without one of its ranks, or seem to have ended well.
RANKS_SECONDS=30 ranks 3 "$top_builddir/tests/mpi/misuse" dies >"$log" 2>&1
status=$?
[ $status -ne 0 ] && [ $status -ne 124 ]
tap_result $? mpi__mistake_dies_is_told_to_all_ranks "$log"

# If it failed, a simulator in parts would go another way with each number of ranks.
for count in 1 3; do
    ranks "$count" "$top_builddir/client/mpi/example/cloth_mpi" 100 2>&1
done >"$log"
grep -q '^100 frames, [1-9][0-9]* contacts' "$log" && [ "$(sort -u "$log" | wc -l)" -eq 1 ]
tap_result $? mpi__example_prints_one_line_for_any_number_of_ranks "$log"

# ---- the program -----------------------------------------------------------------------

# A stack of sheets and needles that pass all of them, and a rod beside them.
frame() { # DROP
    awk -v drop="$1" 'BEGIN {
        n = 40
        print "ply\nformat ascii 1.0\nelement vertex " 6 * n + 3
        print "property double x\nproperty double y\nproperty double z"
        print "element face " 2 * n "\nproperty list uchar int vertex_indices"
        print "element edge 2\nproperty int vertex1\nproperty int vertex2\nend_header"
        for (i = 0; i < n; i++) {
            z = -i / 64
            print 0, 0, z; print 4, 0, z; print 0, 4, z
        }
        for (i = 0; i < n; i++) {
            x = 0.25 + i / 64; y = 0.25 + i % 7 / 8
            print x, y, 1 - drop; print x, y, 5 - drop; print x + 1 / 128, y, 5 - drop
        }
        print -1, 0.5, 1 - drop; print 1, 0.6, 1 - drop; print 3, 0.5, 1 - drop
        for (i = 0; i < 2 * n; i++)
            print 3, 3 * i, 3 * i + 1, 3 * i + 2
        print 6 * n, 6 * n + 1; print 6 * n + 1, 6 * n + 2
    }'
}
for i in 0 1 2 3; do
    frame "$i" >"$work/f$i.ply"
done

# What a report has that is not time or work, and not the place of what is near, which no rank
# knows: one "key: value" a line.
without_place() { # FILE
    sed '/^  "place": {/,/^  }/d; /^    "place": {/,/^    }/d; /"place": null/d' "$1"
}
told() { # FILE
    without_place "$1" | sed '/"counters": {/,/}/d; /"ms": {/,/}/d; /"threads"/d; /"tuning"/d'
}
# What people read of each step, and of all.
read_aloud() { # FILE
    sed -nE 's/, [0-9.]+ ms$//; /^( *[0-9]+  |verdict|standing|           )/p' "$1"
}
# same_report NAME RANKS ARGUMENT...
same_report() {
    local name=$1 count=$2
    shift 2
    "$PCCDCTL" check --url direct: --json --repeat 1 --contacts "$work/one.csv" "$@" \
        >"$work/one.json" 2>"$log"
    local met=$?
    [ $met -le 1 ] && ranks "$count" "$top_builddir/pccd-mpi" check --json --repeat 1 \
        --contacts "$work/ranks.csv" "$@" >"$work/ranks.json" 2>>"$log"
    [ $? -eq $met ] && sed -i -E "s/,x,y,z$//; 2,\$s/(,[^,]*){3}$//" "$work/one.csv" &&
        cmp "$work/one.csv" "$work/ranks.csv" >>"$log" 2>&1 &&
        [ "$(wc -l <"$work/one.csv")" -gt 1 ] &&
        diff <(told "$work/one.json") <(told "$work/ranks.json") >>"$log" 2>&1 &&
        # The keys are the same, also of what may differ.
        diff <(grep -o '^ *"[a-z_]*":' "$work/one.json") \
            <(grep -o '^ *"[a-z_]*":' "$work/ranks.json") >>"$log" 2>&1
    local status=$?
    [ $status -eq 0 ] || echo "$name, $count ranks: $*" >>"$log"
    return $status
}

# If it failed, a user of pccd-mpi check would read something else than one of pccdctl check.
status=0
for count in $counts; do
    same_report files "$count" "$work"/f[01].ply || { status=1; break; }
done
if [ $status -eq 0 ]; then
    same_report sequence 3 "$work"/f?.ply &&
        same_report pairs 3 --mode pairs "$work"/f[01].ply &&
        same_report first 2 --mode first "$work"/f[01].ply &&
        same_report thick 3 --thickness 0.05 --rings 1 --separation 0.01 --approach 0.5 \
            "$work"/f[01].ply
    status=$?
fi
tap_result $status mpi__check_of_files_says_what_pccdctl_says "$log"

# If it failed, a pattern would be a file that is not there.
mkdir "$work/many" && cp "$work/f0.ply" "$work/many/s9.ply" && cp "$work/f1.ply" "$work/many/s10.ply" &&
    cp "$work/f2.ply" "$work/many/s11.ply" &&
    same_report pattern 2 "$work/many/s%d.ply" && grep -q 's9.ply' "$work/ranks.json" &&
    same_report shell_order 3 "$work"/many/s*.ply && grep -q '^pccd-mpi: warning: .*s9.ply comes after' "$log" &&
    [ "$(grep -c 'warning:' "$log")" -eq 2 ] && rm "$work"/many/s1?.ply &&
    { ranks 2 "$top_builddir/pccd-mpi" check "$work/many/s%d.ply" >"$work/out" 2>"$log"; [ $? -eq 4 ]; } &&
    grep -q 's9.ply is one frame: a step has two' "$log"
tap_result $? mpi__check_of_numbered_files_says_what_pccdctl_says "$log"

# A cube of which each face has its own corners, as an exporter of normals writes it.
awk 'BEGIN {
    print "ply\nformat ascii 1.0\nelement vertex 24"
    print "property float x\nproperty float y\nproperty float z"
    print "element face 6\nproperty list uchar int vertex_indices\nend_header"
    for (face = 0; face < 6; face++)
        for (i = 0; i < 4; i++) {
            axis = face % 3
            x[axis] = face < 3 ? -1 : 1
            x[(axis + 1) % 3] = i == 1 || i == 2 ? 1 : -1
            x[(axis + 2) % 3] = i > 1 ? 1 : -1
            print x[0], x[1], x[2]
        }
    for (face = 0; face < 6; face++)
        print 4, 4 * face, 4 * face + 1, 4 * face + 2, 4 * face + 3
}' >"$work/cube.ply"
# A sheet of two strips, each with its own vertices where they are sewn, and needles above it.
# There the seam opens at two of six vertices, and the strips are nearly at one place at another.
sewn() { # DROP OPENING
    awk -v drop="$1" -v opening="$2" 'BEGIN {
        n = 6
        print "ply\nformat ascii 1.0\nelement vertex " 4 * n + 9
        print "property double x\nproperty double y\nproperty double z"
        print "element face " 2 * (n - 1) + 3 "\nproperty list uchar int vertex_indices\nend_header"
        for (row = 0; row < 4; row++)
            for (i = 0; i < n; i++)
                printf "%.17g %d %g\n", i + (row == 2 && i == 5 ? 2 ^ -42 : 0), int((row + 1) / 2),
                    row == 2 && i < 2 ? opening : 0
        for (i = 0; i < 3; i++) {
            print i + 0.5, 1, 1 - drop; print i + 0.5, 1, 5 - drop; print i + 0.75, 1, 5 - drop
        }
        for (strip = 0; strip < 2; strip++)
            for (i = 0; i + 1 < n; i++) {
                v = 2 * n * strip + i
                print 4, v, v + 1, v + n + 1, v + n
            }
        for (i = 0; i < 3; i++)
            print 3, 4 * n + 3 * i, 4 * n + 3 * i + 1, 4 * n + 3 * i + 2
    }'
}
sewn 0 0 >"$work/w0.ply"
sewn 2 0 >"$work/w1.ply"
sewn 2 0.25 >"$work/w2.ply"
told_welded() { # FILE: what of its members says what became of seams
    sed -n 's/^ *"weld[a-z_]*": \([0-9]*\),*$/\1/p' "$1" | tr '\n' ' '
}

# If it failed, what stands still would touch itself at each seam, or a seam that opens would stay.
status=0
for count in 1 2 3 4; do
    ranks "$count" "$top_builddir/pccd-mpi" check "$work/cube.ply" "$work/cube.ply" >"$work/out" 2>"$log" &&
        grep -qx 'welded     16 vertices to others at the same place in every frame' "$work/out" &&
        grep -q '^contacts   0:' "$work/out" &&
        same_report seams "$count" "$work"/w[012].ply &&
        [ "$(told_welded "$work/ranks.json")" = '3 0 2 0 1 ' ] || { status=1; break; }
done
[ $status -eq 0 ] && same_report sewn 3 --weld 0.001 "$work"/w[01].ply &&
    [ "$(told_welded "$work/ranks.json")" = '6 0 0 0 0 ' ] &&
    same_report off 2 --weld off "$work"/w[012].ply &&
    same_report flat 4 --weld 1.0625 "$work"/w[01].ply &&
    told_welded "$work/ranks.json" | grep -q '^[1-9][0-9]* 0 0 [1-9]'
tap_result $? mpi__check_of_seams_says_what_pccdctl_says "$log"

# A floor, two spikes that are one object and touch at a seam, and a rod.
objects() { # HEIGHT
    cat <<END
o Floor
v -9 -9 0
v 9 -9 0
v 0 9 0
f 1 2 3
o Spikes
v -1 0 $1
v -1 0 30
v -1 1 30
f 4 5 6
v 1 0 $1
v -1 0 30
v -1 1 30
f 7 8 9
o Rod
v -4 -12 $1
v -1 1 30
l 10 11
END
}
mkdir "$work/objects" && objects 1 >"$work/objects/a9.obj" && objects -1 >"$work/objects/a10.obj"
# If it failed, who has a scene would be told of features over ranks, and not of what they see in it.
status=0
for count in 1 4; do
    same_report objects "$count" "$work/objects/a%d.obj" &&
        grep -A3 '"objects": \[' "$work/ranks.json" | grep -q '"b": "Spikes"' || { status=1; break; }
done
sed '/^o Spikes/d; /^o Rod/d' "$work/objects/a9.obj" >"$work/one9.obj"
sed '/^o Spikes/d; /^o Rod/d' "$work/objects/a10.obj" >"$work/one10.obj"
[ $status -eq 0 ] && [ "$(told_welded "$work/ranks.json")" = '3 1 0 0 0 ' ] &&
    same_report one_object 3 "$work/one%d.obj" && same_report pairs 3 --mode pairs "$work/objects/a%d.obj" &&
    # Without the CSV, for which the first rank reads all.
    { ranks 3 "$top_builddir/pccd-mpi" check "$work/objects/a%d.obj" "$work/objects/a9.obj" >"$work/out" 2>"$log"; [ $? -eq 1 ]; } &&
    grep -qx '           "Floor", "Spikes": [0-9]*' "$work/out" && grep -q '^verdict  *meets first in step 1, at t = .* of "Spikes"' "$work/out" &&
    grep -q ' ends crossed .* new' "$work/out" && grep -q ', first at .*: .* of "[A-Z].* meets .* at (' "$work/out" &&
    { "$PCCDCTL" check --url direct: "$work/objects/a%d.obj" "$work/objects/a9.obj" >"$work/one"; [ $? -eq 1 ]; } &&
    diff <(read_aloud "$work/one") <(read_aloud "$work/out") >>"$log" &&
    { ranks 3 "$top_builddir/pccd-mpi" check --mode any "$work/objects/a%d.obj" >"$work/out" 2>"$log"; [ $? -eq 1 ]; }
tap_result $? mpi__check_of_objects_says_what_pccdctl_says "$log"

# A spike that comes down on a floor, as a cache of points and as an animation of glTF.
low='\0\0\200\277' zero='\0\0\0\0' one='\0\0\200\077' two='\0\0\0\100'
floor=$low$low$zero$two$low$zero$low$two$zero
cat >"$work/spike.obj" <<'END'
v -1 -1 0
v 2 -1 0
v -1 2 0
v 0 0 1
v 0 0 2
v 1 0 2
f 1 2 3
f 4 5 6
END
{
    printf 'POINTCACHE2\0\1\0\0\0\6\0\0\0'
    # shellcheck disable=SC2059 # the bytes are in the format
    printf "$zero$one\\3\\0\\0\\0"
    for tip in "$one" "$zero" "$low"; do
        # shellcheck disable=SC2059
        printf "$floor$zero$zero$tip$zero$zero$two$one$zero$two"
    done
} >"$work/spike.pc2"
bytes=$(# shellcheck disable=SC2059
    printf "$floor$zero$zero$one$zero$zero$two$one$zero$two$zero$one$zero$zero$zero$zero$zero$low$low" | base64 -w 0)
cat >"$work/spike.gltf" <<END
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
"nodes": [{"name": "Floor", "mesh": 0}, {"name": "Spike", "mesh": 1}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}, {"primitives": [{"attributes": {"POSITION": 1}}]}],
"animations": [{"name": "fall", "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
    "samplers": [{"input": 2, "output": 3}]}],
"buffers": [{"byteLength": 108, "uri": "data:application/octet-stream;base64,$bytes"}],
"bufferViews": [{"buffer": 0, "byteLength": 108}],
"accessors": [
    {"bufferView": 0, "byteOffset": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0], "max": [2, 2, 0]},
    {"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 1], "max": [1, 0, 2]},
    {"bufferView": 0, "byteOffset": 72, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
    {"bufferView": 0, "byteOffset": 80, "componentType": 5126, "count": 2, "type": "VEC3"}]}
END
# If it failed, one frame of a file that moves would be read, or none.
status=0
for count in 1 3; do
    same_report cache "$count" "$work/spike.obj" "$work/spike.pc2" &&
        [ "$(grep -c '"from":' "$work/ranks.json")" -eq 2 ] &&
        same_report animation "$count" "$work/spike.gltf" &&
        same_report rate "$count" --rate 4 --animation fall "$work/spike.gltf" || { status=1; break; }
done
[ $status -eq 0 ] && [ "$(grep -c '"b": "Spike"' "$work/ranks.json")" -gt 0 ] &&
    same_report faces_of_another 2 --weld 0.5 "$work/spike.obj" "$work/spike.pc2" &&
    { ranks 2 "$top_builddir/pccd-mpi" check "$work/spike.pc2" >"$work/out" 2>"$log"; [ $? -eq 4 ]; } &&
    grep -q 'spike.pc2 has positions alone' "$log" &&
    { ranks 2 "$top_builddir/pccd-mpi" check --animation 1 "$work/spike.gltf" >"$work/out" 2>"$log"; [ $? -eq 4 ]; } &&
    grep -q 'no animation has the name or number "1"' "$log"
tap_result $? mpi__check_of_motions_says_what_pccdctl_says "$log"

# A box whose corners are at LOW and HIGH along each axis.
box() { # LOW HIGH
    awk -v low="$1" -v high="$2" 'BEGIN {
        print "ply\nformat ascii 1.0\nelement vertex 8"
        print "property double x\nproperty double y\nproperty double z"
        print "element face 12\nproperty list uchar int vertex_indices\nend_header"
        for (i = 0; i < 8; i++)
            print (i % 2 ? high : low), (int(i / 2) % 2 ? high : low), (i >= 4 ? high : low)
        split("0 2 1 1 2 3 4 5 6 5 7 6 0 1 4 1 5 4 2 6 3 3 6 7 0 4 2 2 4 6 1 3 5 3 7 5", v)
        for (i = 1; i <= 36; i += 3)
            print 3, v[i], v[i + 1], v[i + 2]
    }'
}
box 0 2 >"$work/b0.ply"
box 1.5 3 >"$work/b1.ply"
box 1.25 1.75 >"$work/b2.ply"
box 4 5 >"$work/b3.ply"

# same_near RANKS ARGUMENT...
same_near() {
    local count=$1
    shift
    "$PCCDCTL" near --url direct: --json --csv "$work/one.csv" "$@" >"$work/one.json" 2>"$log" &&
        ranks "$count" "$top_builddir/pccd-mpi" near --json --csv "$work/ranks.csv" "$@" \
            >"$work/ranks.json" 2>>"$log" &&
        diff <(cut -d, -f1-17 "$work/one.csv") "$work/ranks.csv" >>"$log" 2>&1 && # no x,y,z
        [ "$(wc -l <"$work/one.csv")" -gt 1 ] &&
        diff <(told "$work/one.json") <(told "$work/ranks.json") >>"$log" 2>&1 &&
        diff <(without_place "$work/one.json" | grep -o '^ *"[a-z_]*":') \
            <(without_place "$work/ranks.json" | grep -o '^ *"[a-z_]*":') >>"$log" 2>&1
    local status=$?
    [ $status -eq 0 ] || echo "near, $count ranks: $*" >>"$log"
    return $status
}

# If it failed, a user of pccd-mpi near would read something else than one of pccdctl near.
same_near 3 --distance 0.5 "$work"/f[01].ply &&
    same_near 2 --what features --distance 0.5 --thickness 0.1 "$work"/f[01].ply &&
    same_near 3 --what vertices --distance 0.5 "$work"/b[0-3].ply &&
    same_near 3 --what nearest "$work"/b[0-3].ply &&
    same_near 2 --what crossings "$work"/b[0-3].ply "$work/f2.ply" &&
    same_near 3 --what depth "$work"/b[0-3].ply &&
    # Files with seams; an animation, of which a warning tells that one frame is read.
    same_near 3 --what features --distance 0.5 --self "$work/cube.ply" "$work/w0.ply" "$work/spike.gltf" &&
    [ "$(grep -c 'warning: .*spike.gltf has 2 frames' "$log")" -eq 2 ] &&
    grep -q '"welded": 16' "$work/ranks.json" &&
    same_near 2 --what vertices --distance 0.5 --weld 0.001 "$work/w0.ply" "$work/objects/a9.obj" &&
    # A text as pccdctl's, with the file.
    ! ranks 2 "$top_builddir/pccd-mpi" near --what depth "$work"/[bf]0.ply >"$work/out" 2>"$log" &&
    grep -q '^pccd-mpi: .*the mesh of .*/f0.ply has free edges or points' "$log"
tap_result $? mpi__near_of_files_says_what_pccdctl_says "$log"

# If it failed, ranks would end by a signal where a file names several objects.
echo '{"pccd_scene": 1, "objects": [{"name": "a", "files": "f0.ply"}, {"name": "b", "files": "f1.ply"}]}' \
    >"$work/scene.json"
! ranks 2 "$top_builddir/pccd-mpi" near --distance 0.5 "$work/scene.json" >"$work/out" 2>"$log" &&
    grep -q '^pccd-mpi: .*/scene.json is a scene file, which pccdctl near reads' "$log"
tap_result $? mpi__near_refuses_a_scene_file "$log"

# If it failed, a file that one rank cannot read would hang the others, or be read without it.
# Each rank has a folder of its own here, and the last one lacks a file.
cat >"$work/rank.sh" <<'END'
#!/bin/bash
rank=${OMPI_COMM_WORLD_RANK:-${PMI_RANK:?}}
mkdir -p "$1/of$rank" && cp "$1"/f[012].ply "$1/of$rank" || exit 1
[ "$rank" -ne 2 ] || rm "$1/of$rank/f2.ply"
cd "$1/of$rank" || exit 1
shift
exec "$@"
END
RANKS_SECONDS=60 ranks 3 bash "$work/rank.sh" "$work" "$top_builddir/pccd-mpi" check f0.ply f1.ply \
    f2.ply >"$work/out" 2>"$log"
status=$?
[ $status -ne 0 ] && [ $status -ne 124 ] &&
    grep -q '^pccd-mpi: rank 2: .*f2.ply.*step 1 was the last one' "$log" &&
    # The same while it is looked for vertices at one place.
    sed -i 's/f\[012\]/w[012]/; s/f2.ply/w2.ply/' "$work/rank.sh" &&
    { RANKS_SECONDS=60 ranks 3 bash "$work/rank.sh" "$work" "$top_builddir/pccd-mpi" check w0.ply w1.ply \
        w2.ply >"$work/out" 2>"$log"; [ $? -eq 4 ]; } && grep -q '^pccd-mpi: rank 2: w2.ply: cannot open' "$log"
tap_result $? mpi__check_of_missing_file_says_what_pccdctl_says "$log"

# If one failed, a rank with another file would hang the others; or of a pipe each would read a
# part, for which there are no words but these.
status=0
mkfifo "$work/pipe.ply"
for what in 'cp "$1/f0.ply"' 'cp "$1/b0.ply"' 'cp "$1/spike.pc2"' 'cp "$1/objects/a9.obj"'; do
    sed "s|^\[ \"\$rank\" -ne 2 \].*|[ \"\$rank\" -ne 2 ] \|\| $what \"\$1/of\$rank/w0.ply\"|" "$work/rank.sh" >"$work/other.sh"
    { RANKS_SECONDS=60 ranks 3 bash "$work/other.sh" "$work" "$top_builddir/pccd-mpi" check w0.ply w0.ply \
        >"$work/out" 2>"$log"; [ $? -eq 4 ]; } && grep -Eq '^pccd-mpi: rank 2: w0.ply( and what follows: other files than on rank 0|:)' "$log" ||
        { echo "$what" >>"$log" && status=1 && break; }
done
[ $status -eq 0 ] && { RANKS_SECONDS=60 ranks 3 "$top_builddir/pccd-mpi" check "$work/pipe.ply" "$work/f0.ply" \
    >"$work/out" 2>"$log"; [ $? -eq 4 ]; } && grep -q 'pipe.ply is a pipe, which can be read once' "$log"
tap_result $? mpi__check_of_other_files_says_what_pccdctl_says "$log"

# If it failed, a script could not tell wrong usage, or help would be printed by each rank.
ranks 2 "$top_builddir/pccd-mpi" check "$work/f0.ply" >"$work/out" 2>"$log"
[ $? -eq 2 ] && grep -q 'f0.ply is one frame' "$log" && [ ! -s "$work/out" ] &&
    ranks 2 "$top_builddir/pccd-mpi" check --help >"$work/out" 2>"$log" &&
    [ "$(grep -c '^Usage:' "$work/out")" -eq 1 ]
tap_result $? mpi__check_of_usage_says_what_pccdctl_says "$log"

# If one failed, each rank would explain the same.
status=0
for line in help 'help check' 'help completion' 'completion --help' 'near --help' --version; do
    # shellcheck disable=SC2086 # words
    if ! { "$top_builddir/pccd-mpi" $line >"$work/one" 2>>"$log" &&
        ranks 2 "$top_builddir/pccd-mpi" $line >"$work/out" 2>>"$log" && [ -s "$work/out" ] &&
        diff "$work/one" "$work/out" >>"$log" 2>&1; }; then
        echo "$line" >>"$log"
        status=1
    fi
done
ranks 2 "$top_builddir/pccd-mpi" completion nonsense >"$work/out" 2>"$work/err"
[ $? -eq 2 ] && [ "$(grep -c nonsense "$work/err")" -eq 1 ] || status=1
tap_result $status mpi__help_is_printed_once "$log"

# If it failed, a shell would complete nothing, or make would need MPI to run.
words() { # WORD...: what completes the last one
    COMP_WORDS=(pccd-mpi "$@")
    COMP_CWORD=$#
    _pccd-mpi
    printf '%s\n' "${COMPREPLY[@]}"
}
"$top_builddir/pccd-mpi" completion bash >"$work/words" 2>"$log" &&
    # shellcheck source=/dev/null
    . "$work/words" && [ "$(words rep)" = replay ] && [ "$(words verify --sa)" = --sample ] &&
    [ "$(words check --method pa)" = paper ]
tap_result $? mpi__completion_knows_commands_and_options "$log"

# If one failed, a real scene would have another answer over ranks.
for scene in $scenes; do
    name=mpi__check_of_${scene}_says_what_pccdctl_says
    frames=("$PCCD_DATA/$scene"/frames/*.ply)
    if [ ! -e "${frames[0]}" ]; then
        tap_skip "$name" "no frames in \$PCCD_DATA"
        continue
    fi
    status=0
    for count in $([ "$all" = 0 ] && echo 3 || echo "$counts"); do
        same_report "$scene" "$count" "${frames[@]}" || { status=1; break; }
    done
    tap_result $status "$name" "$log"
done

# Thirty steps. Each cut asks for one choice of ghosts; if vertices leave their boxes, it takes
# another one, which takes as long as some steps. If it failed, ranks would mostly do that.
for i in {10..40}; do
    frame "0.$i" >"$work/steady$i.ply"
done
ranks 2 "$top_builddir/pccd-mpi" check --repeat 0 --shares "$work"/steady*.ply >"$work/out" 2>"$log" &&
    [ "$(grep -c '^rank ' "$log")" -eq 2 ] &&
    sed -n 's/^rank .* cuts \([0-9]*\), searches \([0-9]*\)$/\1 \2/p' "$log" |
    awk '$2 - $1 > 3 { bad = 1 } END { exit bad || NR != 2 }'
tap_result $? mpi__ghosts_last_while_things_move_steadily "$log"

# Most triangles lie apart and have nothing to do, a heap of others cross each other. If it failed,
# one rank would keep nearly all that lies apart, because it is so little work, and would need the
# memory of one process nearly: 2.8 times the mean instead of twice.
heap() { # BY: how far the heap moves
    awk -v by="$1" 'function triangle(x, y, z, size) {
            printf "v %.17g %.17g %.17g\nv %.17g %.17g %.17g\nv %.17g %.17g %.17g\n", x, y, z,
                x + size, y, z + size / 3, x, y + size, z + size / 2
            text = text sprintf("f %d %d %d\n", n + 1, n + 2, n + 3)
            n += 3
        }
        BEGIN {
            for (i = 0; i < 3600; i++) triangle(i % 60, int(i / 60), 0, 0.5)
            for (i = 0; i < 300; i++)
                triangle(55 + i % 7 / 7, 55 + int(i / 7) % 7 / 7, 20 + i / 300 + by * (i % 2), 2)
            printf "%s", text
        }'
}
heap 0 >"$work/heap0.obj"
heap 0.01 >"$work/heap1.obj"
ranks 4 "$top_builddir/pccd-mpi" check --repeat 1 --shares "$work"/heap?.obj >"$work/out" 2>"$log"
met=$?
"$PCCDCTL" check --url direct: "$work"/heap?.obj >"$work/one" 2>>"$log"
[ $? -eq $met ] && [ "$(grep '^hash' "$work/out")" = "$(grep '^hash' "$work/one")" ] &&
    sed -n 's/^rank .* own \([0-9]*\), ghosts.* imbalance \([0-9.]*\), .*/\1 \2/p' "$log" |
    awk '{ sum += $1; most = $1 > most ? $1 : most; if ($2 > 1.2) bad = 1 }
        END { exit bad || sum != 3900 || most > 2.1 * sum / 4 }'
tap_result $? mpi__triangles_lie_evenly_where_work_does_not "$log"

# Few triangles that cross, which a rank has looked through soon, and far from them a heap that keeps
# the others long. If it failed, the first rank with a yes would stop others that have to tell how
# the step begins.
crossed() { # HOW FAR IT HAS COME
    awk -v by="$1" 'function triangle(x, y, z, size, rise) {
            z += by
            printf "v %.4f %.4f %.4f\nv %.4f %.4f %.4f\nv %.4f %.4f %.4f\n", \
                x, y, z, x + size, y, z, x, y + size, z + size / rise
            faces = faces sprintf("f %d %d %d\n", n + 1, n + 2, n + 3)
            n += 3
        }
        BEGIN {
            for (i = 0; i < 8000; i++)
                triangle(i % 100 * 2, int(i / 100) * 2, i % 2 * 0.05, 1.9, 3 + i % 2)
            for (i = 0; i < 4000; i++)
                triangle(400 + i % 60 / 60, int(i / 60) / 60, i * 7 / 4000 % 1, 1.5, 3 + i % 7)
            printf "%s", faces
        }'
}
crossed 0 >"$work/crossed0.obj"
crossed 0.001 >"$work/crossed1.obj"
"$PCCDCTL" check --url direct: --mode any "$work"/crossed?.obj >"$work/one" 2>"$log"
[ $? -eq 1 ] && grep '^begins' "$work/one" >"$work/told" && [ -s "$work/told" ] &&
    { ranks 3 "$top_builddir/pccd-mpi" check --mode any "$work"/crossed?.obj >"$work/out" 2>"$log"; [ $? -eq 1 ]; } &&
    grep '^begins' "$work/out" | diff "$work/told" - >>"$log" && grep -qx 'answer     complete' "$work/out"
tap_result $? mpi__yes_stops_no_rank_that_tells_how_a_step_begins "$log"

# Work of all ranks beside that of one process, and the largest beside the mean, in the first step,
# which cuts by weights. If it failed, ranks would wait for one of them, or look for what others
# find.
work_of() { # OUTPUT: of the first step
    awk '/^work / { gsub(",", ""); print $2 + 8 * $11 }' "$1"
}
lies_evenly() { # RANKS FRAME...
    local count=$1 met one all
    shift
    ranks "$count" "$top_builddir/pccd-mpi" check --repeat 0 --shares "$@" >"$work/out" 2>>"$log"
    met=$?
    "$PCCDCTL" check --url direct: --repeat 0 "$@" >"$work/one" 2>>"$log"
    [ $? -eq $met ] && [ $met -le 1 ] || return
    one=$(work_of "$work/one") all=$(work_of "$work/out")
    echo "$count ranks: work $all, of one process $one" >>"$log"
    awk -v one="$one" -v all="$all" -v most="$((100 + 15 * count / 4))" \
        'BEGIN { exit !(one > 0 && all > 0 && 100 * all < most * one) }' &&
        tail -n "$((count + 1))" "$log" | awk '/^rank / { sub(/.*imbalance /, ""); ranks++
                if ($1 + 0 < 1 || $1 + 0 > 1.05) bad = 1 }
            END { exit bad || !ranks }'
}
for scene in $scenes; do
    name=mpi__work_of_${scene}_lies_evenly_on_many_ranks
    frames=("$PCCD_DATA/$scene"/frames/*.ply)
    if [ ! -e "${frames[0]}" ]; then
        tap_skip "$name" "no frames in \$PCCD_DATA"
        continue
    fi
    : >"$log"
    lies_evenly 4 "${frames[@]}" && lies_evenly 8 "${frames[@]}"
    tap_result $? "$name" "$log"
done

tap_end
