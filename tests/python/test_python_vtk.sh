#!/bin/bash
# test_python_vtk.sh - the reader of recordings for VTK and ParaView (TAP).
set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCD_DAEMON:?}" "${PCCDCTL:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
# shellcheck source=tests/python/find.sh
. "$top_srcdir/tests/python/find.sh"

vtk=$(python_with 'numpy, vtkmodules.vtkIOXML')
if [ -z "$vtk" ]; then
    tap_skip check_vtk "no python3 with numpy and vtkmodules (Debian: python3-vtk9)"
    tap_end
    exit
fi
work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
XDG_RUNTIME_DIR=$work timeout 120 "$vtk" "$top_srcdir/tests/python/tap.py" check_vtk
