#!/bin/bash
# test_files_programs.sh - what is said of files that real programs wrote is right (TAP).
set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCDCTL:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
# shellcheck source=tests/python/find.sh
. "$top_srcdir/tests/python/find.sh"
export PCCD_PYTHON=$python # without one, what it reads is not judged

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
files=${PCCD_FILES:-$work/files}
[ -n "${PCCD_FILES:-}" ] || "$top_srcdir/tests/files/make_files.sh" "$files" >"$work/made" 2>&1

for program in admesh assimp blender gltf-pipeline gltf-transform gmsh meshio meshlab obj2gltf openscad three \
    trimesh vtk; do
    name=files__of_${program//-/_}_are_read_right
    folders=$(compgen -G "$files/$program-[0-9]*") || {
        tap_skip "$name" "no $program, or nothing that it wrote"
        continue
    }
    # shellcheck disable=SC2086 # $folders is words on purpose
    # If it failed, what this program writes would be read as something else, or not at all.
    python3 "$top_srcdir/tests/files/judge_files.py" "$files/scenes/scenes.json" $folders \
        >"$work/log" 2>&1
    status=$?
    if grep -q '^nothing was judged: none can be' "$work/log"; then
        tap_skip "$name" "$(tail -1 "$work/log")"
        continue
    fi
    tap_result $status "$name" "$work/log"
done

# If this failed, nobody could measure the readers: the table has a row for each format, with
# times of this build.
if [ -n "$python" ]; then
    "$python" "$top_srcdir/tests/files/read_table.py" --triangles 2000 --turns 1 "$work" \
        "$top_builddir/tests/files/read_mesh" >"$work/log" 2>&1 &&
        [ "$(grep -cE '^(ascii|binary|sheet)[.][a-z]+\s[0-9]+\s[0-9.]+ \([01][.]00\)' "$work/log")" -eq 6 ]
    tap_result $? table__has_a_time_of_every_format "$work/log"
else
    tap_skip table__has_a_time_of_every_format "$no_python"
fi
tap_end
