#!/bin/bash
# test_style_rooms.sh - a folder is a layer, and includes point only downwards.
#
# Reads every include of every source file. A quoted include must stand in the file's own
# folder or in one that the tables below let it see; an angled one must be of the C library
# or of a library that the room may use. A header and its source are one node of the graph
# of includes, which may have no circle. Then each header is compiled alone, with only the
# folders that it may see on its path.

set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
cd "$top_srcdir" || exit 99

# Folder, then the folders whose headers it may include. "client/lib+" is the public header
# alone, with the types that it includes; "daemon/engine+" is engine.h alone, "client/mpi+"
# pccd_mpi.h; a name that ends in ".h" is that header alone. Every room may
# include those of proto/common/; the examples are the users', who have only what is
# installed.
rooms='
proto/common
proto
proto/text          proto
client/oracle
daemon/engine
daemon/service      proto proto/text daemon/engine+
daemon/direct       proto daemon/engine+ daemon/service
daemon/server       proto proto/text daemon/engine+ daemon/service
client/record       client/lib+
client/registry
client/lib          proto client/record client/registry
client/tool         proto/text
client/ctl          client/lib+ client/record client/registry client/oracle client/tool proto/text
client/load         client/lib+ client/tool proto/text
client/cpp          client/lib+
client/ipc          client/lib+
client/planner      client/lib+
client/mpi          client/lib+ client/lib/mpi_hooks.h
client/mpi/program  client/ctl client/record client/registry client/lib+ client/mpi+ client/tool proto/text
client/examples     client/lib+
client/mpi/example  client/lib+ client/mpi+ client/examples
bench/scenes        tests/support
bench               proto proto/text daemon/engine client/lib+ tests/support bench/scenes
bench/model         bench proto/text daemon/engine bench/scenes client/lib+ client/mpi+
bench/growth        bench proto/text daemon/engine bench/scenes
bench/paper         bench daemon/engine bench/scenes
bench/peers         bench proto/text daemon/engine bench/scenes client/oracle client/lib+ tests/support
bench/redis         bench proto proto/text client/lib+
bench/run           bench daemon/engine client/lib+ bench/scenes proto/text
tests/proto         proto tests/support
tests/abi           proto client/lib+ tests/support/cases.h
tests/cpp           client/lib+
tests/ipc           client/lib+ client/oracle tests/support
tests/planner       client/lib+
tests/support       proto client/lib+ client/oracle
tests/integration   proto client/record client/lib+ client/lib/mpi_hooks.h tests/support client/oracle
tests/unit          proto daemon/engine bench/wide_sweep.h daemon/service daemon/server client/record client/registry client/lib client/ctl client/load client/mpi/moving_boxes.h client/mpi/rank_sort.h client/tool proto/text tests/support client/oracle
tests/files         client/ctl
tests/fuzz          proto daemon/engine daemon/service daemon/server client/record client/registry client/ctl tests/support client/oracle tests/fault
tests/fault         proto client/lib+ tests/support client/oracle
tests/zoo           proto client/lib+ tests/support client/oracle
tests/mpi           client/lib+ client/mpi+ tests/support
tests/determinism   daemon/engine tests/support client/oracle tests/unit
tests/property      proto daemon/engine client/lib+ tests/support client/oracle tests/unit
tests/truth         proto daemon/engine client/lib+ tests/support client/oracle tests/unit tests/fuzz
'

# A room of several folders has a line for each of them, from the bottom layer to the top:
# the room, the folder ("." is what lies in the room's own), and the folders of the room,
# from lines above it, whose headers it may include. What it may include of other rooms, the
# table above says. In such a room every name is given once.
layers='
daemon/engine base
daemon/engine kernel      base
daemon/engine elementary  base kernel
daemon/engine result      base
daemon/engine team        base kernel elementary result
daemon/engine scene       base kernel elementary team
daemon/engine narrow      base kernel elementary team scene
daemon/engine turning     base kernel elementary result team scene narrow
daemon/engine near        base kernel elementary team scene
daemon/engine paper       base kernel elementary team scene narrow
daemon/engine wide        base kernel elementary team scene narrow
daemon/engine .           base kernel elementary result team scene turning narrow near paper wide
daemon/service base
daemon/service queue      base
daemon/service memory     base queue
daemon/service sessions   base queue memory
daemon/service scenes     base queue memory sessions
daemon/service requests   base queue memory sessions scenes
daemon/service .          base sessions requests
client/ctl .
client/ctl mesh           .
client/ctl scene          . mesh
client/ctl sweep          . mesh scene
client/ctl check          . mesh scene
client/ctl near           . mesh scene check
client/ctl observe        . check
client/ctl judge          . mesh scene check
client/ctl record         . mesh scene check
client/ctl export         . record
client/ctl inspect        . check record export
client/ctl picture        . record export
client/ctl mcp            . mesh scene check record
client/ctl commands       . mesh scene sweep check near observe judge record export inspect picture mcp
'

# Folder prefix, then the libraries beside the C library.
libraries='
proto               msgpack.h
client/oracle       gmp.h
daemon/engine       emmintrin.h gmp.h omp.h xxhash.h
daemon/server       uv.h seccomp.h
client/record       xxhash.h zstd.h
client/cpp          array cstdio pccd.hpp vector
client/ipc          Eigen/SparseCholesky algorithm chrono cmath cstdio cstdlib cstring map
client/ipc          memory optional pccd.hpp pccd_ipc.hpp tbb/global_control.h vector
client/ipc          ipc/barrier/barrier.hpp ipc/broad_phase/lbvh.hpp ipc/candidates/candidates.hpp
client/ipc          ipc/ccd/additive_ccd.hpp ipc/utils/logger.hpp
client/ipc          ipc/collisions/normal/normal_collisions.hpp
client/planner      arm.hpp pccd_motion.hpp cstdio cstdlib cstring ompl/base/spaces/RealVectorStateSpace.h
client/planner      ompl/geometric/SimpleSetup.h ompl/geometric/planners/rrt/RRTConnect.h
client/planner      ompl/util/RandomNumbers.h
client/ctl          expat.h jansson.h microhttpd.h png.h xxhash.h zlib.h
client/mpi          malloc.h mpi.h xxhash.h
client/mpi/program  jansson.h malloc.h mpi.h
client/mpi/example  mpi.h
bench               omp.h
bench/model         mpi.h omp.h
bench/peers         omp.h embree3/rtcore.h BulletCollision/BroadphaseCollision/btDbvt.h
bench/peers         fcl/broadphase/broadphase_dynamic_AABB_tree_array.h fcl/config.h
bench/peers         fcl/geometry/shape/sphere.h fcl/narrowphase/collision_object.h
bench/peers         CGAL/Box_intersection_d/Box_d.h CGAL/box_intersection_d.h CGAL/version.h
bench/peers         ipc/broad_phase/lbvh.hpp ipc/candidates/candidates.hpp
bench/peers         ipc/ccd/additive_ccd.hpp ipc/ccd/tight_inclusion_ccd.hpp
bench/peers         ipc/collision_mesh.hpp ipc/collisions/normal/normal_collisions.hpp
bench/peers         ipc/distance/distance_type.hpp ipc/utils/logger.hpp tbb/global_control.h
bench/peers         fcl/geometry/bvh/BVH_model.h fcl/narrowphase/collision.h jansson.h
bench/peers         fcl/narrowphase/detail/traversal/collision/intersect.h
bench/peers         algorithm array atomic chrono cmath cstdio cstdlib cstring fstream map memory
bench/peers         random set sstream string vector
bench/redis         seccomp.h
bench/run           jansson.h xxhash.h
tests               cmocka.h gmp.h jansson.h msgpack.h omp.h png.h seccomp.h xxhash.h
tests               array cmath cstring limits pccd.hpp span
tests               arm.hpp cstdio cstdlib cstring map pccd_ipc.hpp random set string tuple ipc/broad_phase/brute_force.hpp
tests               ipc/ccd/additive_ccd.hpp ipc/collisions/normal/normal_collisions.hpp
tests               ipc/utils/logger.hpp ompl/base/spaces/SO2StateSpace.h ompl/util/RandomNumbers.h pccd_motion.hpp
'

c_library='argp.h assert.h ctype.h dirent.h dlfcn.h endian.h errno.h execinfo.h fcntl.h fenv.h float.h getopt.h
    arm_neon.h glob.h grp.h immintrin.h inttypes.h limits.h linux/filter.h linux/futex.h
    linux/openat2.h linux/seccomp.h locale.h malloc.h math.h netinet/in.h
    poll.h pthread.h pwd.h sched.h semaphore.h setjmp.h signal.h smmintrin.h spawn.h stdarg.h stdatomic.h stdbool.h stddef.h
    stdint.h stdio.h stdlib.h string.h strings.h sys/epoll.h sys/eventfd.h sys/file.h sys/inotify.h
    sys/ioctl.h sys/mman.h sys/pidfd.h sys/prctl.h sys/ptrace.h sys/random.h sys/resource.h sys/signalfd.h sys/socket.h sys/stat.h sys/syscall.h
    sys/time.h sys/timerfd.h
    sys/types.h sys/uio.h sys/un.h sys/user.h sys/wait.h termios.h time.h unistd.h'

# Not for the engine: it computes, and talks to nobody.
engine_not='dirent.h fcntl.h grp.h netinet/in.h poll.h pwd.h sys/epoll.h sys/eventfd.h sys/inotify.h sys/socket.h sys/un.h
    sys/wait.h spawn.h glob.h'
# Nor for the service, but for what it makes and reads itself.
service_not='dirent.h fcntl.h grp.h netinet/in.h pwd.h sys/epoll.h sys/eventfd.h sys/inotify.h sys/socket.h
    sys/un.h sys/wait.h spawn.h glob.h'

find proto daemon client bench tests -name '*.[ch]' -o -name '*.cc' | LC_ALL=C sort >"$work/paths"
# The room that a folder belongs to, for awk scripts that are given the layers.
room_of='
    function read_layers(layers,   lines, word, count, words, i, w, folder) {
        count = split(layers, lines, "\n")
        for (i = 1; i <= count; i++) {
            words = split(lines[i], word, " ")
            if (words == 0)
                continue
            is_layered[word[1]] = 1
            folder = word[2] == "." ? word[1] : word[1] "/" word[2]
            line_of[folder] = i
            for (w = 3; w <= words; w++)
                below[folder] = below[folder] " " \
                    (word[w] == "." ? word[1] : word[1] "/" word[w])
        }
    }
    function folder_of(path) { sub(/\/[^\/]*$/, "", path); return path }
    function room_of(folder,   above) {
        above = folder_of(folder)
        return above in is_layered ? above : folder
    }'
# Paths as if a room was one folder.
awk -v layers="$layers" "$room_of"'
    BEGIN { read_layers(layers) }
    {
        name = $1
        sub(/.*\//, "", name)
        print room_of(folder_of($1)) "/" name
    }' "$work/paths" | LC_ALL=C sort >"$work/files"
# Of every include: the room of the file, what it includes, the file.
xargs grep -HoE '^ *# *include *[<"][^>"]*[>"]' <"$work/paths" |
    sed 's|^\([^:]*\)/\([^/:]*\): *# *include *|\1 \1/\2 |' | awk '{ print $1, $3, $2 }' | awk -v layers="$layers" "$room_of"'
    BEGIN { read_layers(layers) }
    { print room_of($1), $2, $3 }' >"$work/includes"
[ -s "$work/files" ] && [ -s "$work/includes" ] || exit 99

awk '{ print $1 }' "$work/includes" | sort -u >"$work/folders"
printf '%s' "$rooms" | awk 'NF { print $1 }' | sort >"$work/known"
comm -23 "$work/folders" "$work/known" | sed 's/^/no rule for /' >"$work/log"
uniq -d "$work/files" | sed 's/^/given twice: /' >>"$work/log"
awk -v layers="$layers" "$room_of"'
    BEGIN { read_layers(layers) }
    {
        folder = folder_of($1)
        if (room_of(folder) in is_layered && !(folder in line_of) && !(folder in told)) {
            print "no line among the layers for " folder
            told[folder] = 1
        }
    }' "$work/paths" >>"$work/log"
[ ! -s "$work/log" ]
# If this failed, a new folder could include anything, or a header's name could mean two.
tap_result $? rooms__have_a_rule_each "$work/log"

# If this failed, a layer would depend on one above it or beside it.
awk -v rooms="$rooms" '
    function public(name) { return name == "pccd.h" || name ~ /^pccd_(daemon|trace|types)[.]h$/ }
    BEGIN {
        count = split(rooms, lines, "\n")
        for (i = 1; i <= count; i++) {
            words = split(lines[i], word, " ")
            for (w = 2; w <= words; w++)
                sees[word[1]] = sees[word[1]] " " word[w]
        }
    }
    NR == FNR { has[$1] = 1; next }
    $2 ~ /^"/ {
        name = substr($2, 2, length($2) - 2)
        if (has[$1 "/" name] || name == "messages.def" && $1 == "proto" ||
            has["proto/common/" name] && $1 != "client/examples")
            next
        count = split(sees[$1], folder, " ")
        for (i = 1; i <= count; i++) {
            if (folder[i] == "client/lib+") {
                if (public(name))
                    next
            } else if (folder[i] == "daemon/engine+") {
                if (name == "engine.h")
                    next
            } else if (folder[i] ~ /[.]h$/) {
                if (folder[i] ~ "/" name "$")
                    next
            } else if (folder[i] == "client/mpi+") {
                if (name == "pccd_mpi.h")
                    next
            } else if (has[folder[i] "/" name] || public(name) && folder[i] == "client/lib")
                next
        }
        print $3 " includes " $2
    }' "$work/files" "$work/includes" >"$work/log" && [ ! -s "$work/log" ]
tap_result $? rooms__include_only_what_stands_below "$work/log"

# If this failed, a folder of a room would depend on one above it, or the table of layers
# would let it.
awk -v layers="$layers" "$room_of"'
    BEGIN {
        read_layers(layers)
        for (folder in line_of) {
            count = split(below[folder], seen, " ")
            for (i = 1; i <= count; i++) {
                may[folder " " seen[i]] = 1
                if (!(seen[i] in line_of))
                    print "the line of " folder " names " seen[i] ", which is not there"
                else if (line_of[seen[i]] >= line_of[folder])
                    print "the line of " folder " names " seen[i] ", which is not below it"
            }
        }
    }
    NR == FNR {
        name = folder = $1
        sub(/.*\//, "", name)
        folder = folder_of(folder)
        where[room_of(folder) " " name] = folder
        next
    }
    $2 ~ /^"/ {
        name = substr($2, 2, length($2) - 2)
        from = folder_of($3)
        to = where[$1 " " name]
        if (to != "" && to != from && $1 in is_layered && !((from " " to) in may))
            print $3 " includes " $2 " of " to
    }' "$work/paths" "$work/includes" | LC_ALL=C sort >"$work/log"
[ ! -s "$work/log" ]
tap_result $? folders__include_only_what_stands_below "$work/log"

# Of a tree: what each pair of a header and its source includes of it. tsort tells circles.
pairs_of() {
    awk -v tree="$1/" '
        function folder_of(path) { sub(/\/[^\/]*$/, "", path); return path }
        function pair_of(path) { sub(/[.][a-z]*$/, "", path); return path }
        index($1, tree) == 1 && NF == 1 {
            name = $1
            sub(/.*\//, "", name)
            is_file[$1] = 1
            any[name] = $1
        }
        NF == 3 && $2 ~ /^"/ && $3 in is_file {
            name = substr($2, 2, length($2) - 2)
            to = folder_of($3) "/" name
            if (!(to in is_file))
                to = any[name]
            if (to != "" && pair_of(to) != pair_of($3))
                print pair_of($3), pair_of(to)
        }' "$work/paths" "$work/includes" | LC_ALL=C sort -u
}

# If this failed, neither of two files could be read, tested or changed without the other.
for tree in proto/common proto daemon/engine daemon/service daemon/direct daemon/server client/record \
    client/registry client/lib client/tool client/ctl client/load client/mpi client/mpi/program bench; do
    pairs_of "$tree" | tsort 2>&1 >/dev/null | sed "s|^tsort: -|$tree|"
done >"$work/log"
[ ! -s "$work/log" ]
tap_result $? files__include_nothing_that_includes_them "$work/log"

# If this failed, a layer would need a library that it has no business with.
awk -v libraries="$libraries" -v c_library="$c_library" -v engine_not="$engine_not" -v service_not="$service_not" '
    BEGIN {
        count = split(c_library, word, " ")
        for (i = 1; i <= count; i++)
            plain["<" word[i] ">"] = 1
        count = split(engine_not, word, " ")
        for (i = 1; i <= count; i++)
            barred["daemon/engine <" word[i] ">"] = 1
        count = split(service_not, word, " ")
        for (i = 1; i <= count; i++)
            barred["daemon/service <" word[i] ">"] = 1
        count = split(libraries, lines, "\n")
        for (i = 1; i <= count; i++) {
            words = split(lines[i], word, " ")
            for (w = 2; w <= words; w++)
                may[word[1] " <" word[w] ">"] = 1
        }
    }
    $2 ~ /^</ {
        room = $1
        sub(/^tests\/.*/, "tests", room)
        if (!(plain[$2] || may[room " " $2]) || barred[room " " $2])
            print $3 " includes " $2
    }' "$work/includes" >"$work/log" && [ ! -s "$work/log" ]
tap_result $? rooms__use_only_their_libraries "$work/log"

# If this failed, a test could pass because of what two rooms know of each other. (The server
# may see the engine, so its tests may too.)
awk '
    NR == FNR {
        name = place = $1
        sub(/.*\//, "", name)
        sub(/\/[^\/]*$/, "", place)
        if (place ~ /^(daemon|client)\// && name !~ /^pccd/)
            where[name] = where[name] " " place
        next
    }
    $1 ~ /^tests\// && $2 ~ /^"/ {
        name = substr($2, 2, length($2) - 2)
        count = split(where[name], folder, " ")
        if (count == 1)
            seen[$3 " " folder[1]] = 1
    }
    END {
        for (entry in seen) {
            split(entry, part, " ")
            if (part[2] == "daemon/engine" && ((part[1] " daemon/server") in seen ||
                                               (part[1] " daemon/service") in seen))
                continue
            if (part[2] == "daemon/service" && (part[1] " daemon/server") in seen)
                continue
            rooms[part[1]]++
            list[part[1]] = list[part[1]] " " part[2]
        }
        for (file in rooms)
            if (rooms[file] > 1)
                print file " sees" list[file]
    }' "$work/files" "$work/includes" >"$work/log" && [ ! -s "$work/log" ]
tap_result $? tests__see_one_room_at_a_time "$work/log"

# Headers that a source of their folder includes first, which every build compiles: each has been
# compiled alone there.
awk 'NR == FNR { is_file[$1] = 1; next }
    !($3 in first) {
        first[$3] = 1
        folder = $3
        sub(/[^\/]*$/, "", folder)
        name = folder substr($2, 2, length($2) - 2)
        if ($2 ~ /^"/ && name in is_file && $3 ~ /[.]c$/ && $3 !~ /^bench\/peers\//)
            print name
    }' "$work/paths" "$work/includes" | sort -u >"$work/compiled"

# If this failed, a header would work only after another one.
flags_of() {
    local sees=$1 flags="-iquote proto/common" folder inner
    for folder in $sees; do
        case $folder in
        client/lib | client/lib+) flags="$flags -iquote client/lib" ;;
        *)
            folder=${folder%+}
            flags="$flags -iquote $folder"
            for inner in $(inner_folders "$folder"); do
                flags="$flags -iquote $inner"
            done
            ;;
        esac
    done
    printf '%s' "$flags"
}
inner_folders() {
    printf '%s' "$layers" | awk -v room="$1" '$1 == room && $2 != "." { print room "/" $2 }'
}
printf '%s' "$rooms" | while read -r room sees; do
    [ -n "$room" ] || continue
    inside='[^/]*'
    if [ -n "$(inner_folders "$room")" ]; then
        inside='.*'
        sees="$room $sees"
    fi
    flags=$(flags_of "$sees")
    case $room in
    client/mpi* | tests/mpi)
        # Where no MPI was named, its header is not known.
        [ -n "${MPI_CPPFLAGS-}" ] || continue
        flags="$flags $MPI_CPPFLAGS -iquote client/mpi"
        ;;
    esac
    for header in $(grep "^$room/$inside\.h\$" "$work/paths" | grep -vxF -f "$work/compiled"); do
        # shellcheck disable=SC2086 # flags are words
        ${CC-cc} -std=c11 -D_GNU_SOURCE -fopenmp -fsyntax-only -x c $flags "$header" \
            >"$work/error" 2>&1 ||
            { echo "$header:"; sed -n 1,3p "$work/error"; }
    done
done >"$work/log"
[ ! -s "$work/log" ]
tap_result $? headers__compile_alone "$work/log"

tap_end
