#!/bin/bash
# test_blender_addon.sh - the add-on for Blender, as its users have it (TAP).
#
# Room:     tests/blender.
# Does:     make the zip, install it by Blender's own means for a user of its own, run
#           check_addon.py in Blender, then the headless check of the files that this has
#           made, as a program with an exit status. Without Blender all is skipped by name.
# Needs:    PCCDCTL, top_srcdir and top_builddir, set by `make check`; blender, patchelf.
#           $PCCD_PICTURES: a folder for what was rendered.
set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCDCTL:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

cases="command__checks_polygons_that_turn_over
    command__knows_thickness_and_rest_exclusion command__says_what_it_cannot_check
    command__takes_the_modifiers_and_the_world command__tells_a_topology_that_changes
    command__tells_what_is_nowhere json__is_that_of_pccdctl markers__render_at_their_frames
    operator__is_cancelled operator__lists_and_jumps zip__brings_its_own_library"
own="zip__is_made bake__that_crosses_ends_with_1 bake__counts_are_those_of_pccdctl
    bake__that_is_clean_ends_with_0 bake__without_the_addon_ends_with_4
    bake__that_is_interrupted_ends_with_4"
why=
blender=$(command -v blender) || why="no blender"
command -v patchelf >/dev/null || why="no patchelf"
! nm -D "$top_builddir/.libs/libpccd.so.0" | grep -qE '__(a|ub|t)san_' ||
    why="the build has a sanitiser in it"
if [ -n "$why" ]; then
    for name in $cases $own; do
        tap_skip "$name" "$why"
    done
    tap_end
    exit
fi

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log
unset PCCD_URL PCCD_DAEMON PCCD_DIRECT PCCD_LIBRARY PYTHONPATH PYTHONHOME
export BLENDER_USER_SCRIPTS=$work/scripts BLENDER_USER_CONFIG=$work/config
# Blender's Python takes for its own what belongs to another one that is first in $PATH.
blender="env PATH=/usr/bin:/bin $blender"
mkdir "$work/scripts" "$work/config" "$work/bakes"

"$BASH" "$top_srcdir/client/blender/make_addon.sh" "$top_srcdir" "$top_builddir" \
    "$work/pccd_blender.zip" >"$log" 2>&1
# If it failed, there would be nothing to install.
tap_result $? zip__is_made "$log"

# shellcheck disable=SC2086 # $blender is words on purpose
# In Blender, all in one process: it takes most of a second to start. It says of each case
# what would be wrong if that failed.
timeout 100 $blender -b --factory-startup --python-exit-code 4 \
    -P "$top_srcdir/tests/blender/check_addon.py" -- "$work/pccd_blender.zip" "$work/bakes" \
    >"$work/cases" 2>&1
for name in $cases; do
    grep -qE "^ok [0-9]+ - $name\$" "$work/cases"
    status=$?
    awk -v name="$name" '/^(not )?ok / { on = index($0, " - " name) } on && /^(not ok|#)/' \
        "$work/cases" >"$log"
    [ -s "$log" ] || tail -20 "$work/cases" >"$log"
    tap_result $status "$name" "$log"
done

bake_check() { # FILE ARGUMENT...: its exit status in $status
    local file=$1
    shift
    timeout 60 $blender -b "$work/bakes/$file.blend" --python-exit-code 4 \
        --python-expr "import pccd_blender; pccd_blender.bake_check()" -- "$@" >"$log" 2>&1
    status=$?
}

bake_check through --json
# If it failed, a farm would take a bake for a good one.
[ $status -eq 1 ]
tap_result $? bake__that_crosses_ends_with_1 "$log"

grep '^{' "$log" >"$work/mine.json"
"$PCCDCTL" check --json "$work"/bakes/?.obj >"$work/theirs.json" 2>"$log"
[ $? -eq 1 ] &&
    python3 - "$work/mine.json" "$work/theirs.json" >>"$log" 2>&1 <<'END'
import json
import sys

mine, theirs = (json.load(open(path)) for path in sys.argv[1:])
assert theirs["contacts"] > 100
for key in "vertices", "edges", "triangles", "contacts", "vf", "ee", "possible", "complete":
    assert mine[key] == theirs[key], (key, mine[key], theirs[key])
for key in "contacts", "vf", "ee", "initial", "toi_first", "safe_step", "mode":
    assert [s[key] for s in mine["steps"]] == [s[key] for s in theirs["steps"]], key
END
# If it failed, Blender would be shown something else than the command line.
tap_result $? bake__counts_are_those_of_pccdctl "$log"

bake_check clean
# If it failed, nobody could let a program wait for a good bake.
[ $status -eq 0 ] && grep -q '^9 frames looked at: nothing crosses or meets$' "$log"
tap_result $? bake__that_is_clean_ends_with_0 "$log"

BLENDER_USER_SCRIPTS=$work/nowhere bake_check clean
# If it failed, a machine where the add-on is not installed would find all bakes clean.
[ $status -eq 4 ]
tap_result $? bake__without_the_addon_ends_with_4 "$log"

# Long enough to be interrupted; not before the library is there, and with it the handler.
# A shell starts what runs beside it with SIGINT ignored, unless it has job control.
set -m
$blender -b "$work/bakes/through.blend" --python-exit-code 4 --python-expr \
    "import pccd_blender; pccd_blender.bake_check()" -- --frames 1:1000000 --json \
    -o "$work/cut.json" >"$log" 2>&1 &
pid=$!
for _ in $(seq 400); do
    grep -q libpccd-direct "/proc/$pid/maps" 2>/dev/null && break
    sleep 0.05
done
kill -INT "$pid"
wait "$pid"
status=$?
[ $status -eq 4 ] && grep -q '"cancelled": true, "complete": false' "$work/cut.json" 2>>"$log"
# If it failed, Ctrl-C would lose what was found, or tell that all was looked at.
tap_result $? bake__that_is_interrupted_ends_with_4 "$log"
tap_end
