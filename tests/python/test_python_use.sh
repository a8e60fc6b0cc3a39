#!/bin/bash
# test_python_use.sh - what a user of the Python module sees (TAP).
set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCD_DAEMON:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
# shellcheck source=tests/python/find.sh
. "$top_srcdir/tests/python/find.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
mkdir "$work/runtime"
export XDG_RUNTIME_DIR=$work/runtime

# run NAME PROGRAM...: ok when it exits with 0; its output goes into $work/log.
run() {
    local name=$1
    shift
    if [ -z "$python" ]; then
        tap_skip "$name" "$no_python"
        return
    fi
    timeout 400 "$@" >"$work/log" 2>&1
    tap_result $? "$name" "$work/log"
}

# If this failed, the first program that anybody tries would be wrong: it checks that no
# vertex of the cloth gets into the sphere.
run example__cloth_stays_outside "$python" "$top_srcdir/client/python/example_cloth.py"
# If this failed, bounds of vertices would be of no use from Python, or not hold: it asks
# after each move whether anything crosses or touches.
run example__cloth_moves_by_bounds "$python" \
    "$top_srcdir/client/python/example_cloth_near.py"
# If this failed, thickness would be of no use from Python, or not hold: it asks after
# each frame whether anything is nearer than it allows.
run example__cloth_keeps_its_thickness "$python" \
    "$top_srcdir/client/python/example_cloth_thick.py"
# If this failed, what meets could not be answered body by body from Python.
run example__balls_stay_in_a_cloth "$python" \
    "$top_srcdir/client/python/example_game_balls.py"
run example__three_clients_share_a_scene "$python" "$top_srcdir/client/python/example_shared.py"

# If this failed, the program of README.md would not do what it says without a daemon
# (tests/docs/docs_commands.sh runs it with one).
awk '/^```python$/ { on = 1; next } /^```$/ { on = 0 } on' "$top_srcdir/README.md" >"$work/readme.py"
run readme__works_as_written env PCCD_URL=direct: "$python" "$work/readme.py"
if [ -n "$python" ]; then
    [ "$(wc -l <"$work/readme.py")" -ge 5 ] && grep -qx 'vertex 3 hits face 0 at t = 0.500' "$work/log"
    tap_result $? readme__finds_contacts "$work/log"
else
    tap_skip readme__finds_contacts "$no_python"
fi
awk '/^```python$/ { on = 1; next } /^```$/ { on = 0 } on' "$top_srcdir/client/README.md" >"$work/guide.py"
run guide__works_as_written "$python" "$work/guide.py"

# If this failed, the installed module would lack a part, or not find what it needs.
cat >"$work/installed.sh" <<'SH'
make -C "$top_builddir" install-dist_python_moduleDATA install-nodist_python_moduleDATA \
    pythondir="$1/python" python_moduledir="$1/python/pccd" || exit 1
cd / || exit 1
PYTHONPATH=$1/python PCCD_LIBRARY=$top_builddir/.libs/libpccd.so.0 "$2" -c '
import sys, pccd
assert pccd.__file__.startswith(sys.argv[1]), pccd.__file__
with pccd.connect(private=True, result_bytes=1 << 16) as client:
    assert client.ping() > 0' "$1"
SH
run installation__is_whole "$BASH" "$work/installed.sh" "$work" "$python"

# If this failed, the type hints would promise what the code does not keep.
for tool in mypy pyflakes; do
    name=types__are_what_the_hints_say
    [ $tool = mypy ] || name=names__are_all_used
    if [ -n "$python" ] && ! "$python" -m $tool --version >/dev/null 2>&1; then
        tap_skip $name "no $tool (Debian: python3-mypy, pyflakes3)"
    elif [ $tool = mypy ]; then
        run $name "$python" -m mypy --strict --cache-dir="$work/mypy" \
            "$top_builddir/python/pccd"
    else
        # panel.py declares properties as Blender wants it, which pyflakes takes for types.
        mapfile -t addon < <(find "$top_srcdir/client/blender/addon" -name '*.py' ! -name panel.py)
        run $name "$python" -m pyflakes "$top_srcdir"/{client,tests}/python \
            "$top_srcdir/tests/blender" "${addon[@]}"
    fi
done

# If this failed, a client would leave a daemon or its folder behind.
ls -A "$work/runtime" >"$work/log"
[ ! -s "$work/log" ]
tap_result $? runtime_folder__is_empty "$work/log"

tap_end
