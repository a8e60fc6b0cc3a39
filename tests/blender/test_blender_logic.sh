#!/bin/bash
# test_blender_logic.sh - what the add-on for Blender computes, without Blender (TAP).
#
# Room:     tests/blender.
# Does:     run check_logic.py with the first Python that has numpy and msgpack; without one,
#           skip it by name.
# Needs:    PCCD_DAEMON, PCCDCTL, top_srcdir and top_builddir, set by `make check`.
set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCDCTL:?}" "${PCCD_DAEMON:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
# shellcheck source=tests/python/find.sh
. "$top_srcdir/tests/python/find.sh"

if [ -z "$python" ]; then
    tap_skip check_logic "$no_python"
    tap_end
    exit
fi
work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
ln -s "$top_srcdir/client/blender/addon" "$work/pccd_blender"
PYTHONPATH=$work:$PYTHONPATH:$top_srcdir/tests/blender \
    timeout 120 "$python" "$top_srcdir/tests/python/tap.py" check_logic
