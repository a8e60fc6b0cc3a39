#!/bin/bash
# test_python_files.sh - python3 -m pccd check of files that meshio reads (TAP).
set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCD_DAEMON:?}" "${PCCDCTL:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
# shellcheck source=tests/python/find.sh
. "$top_srcdir/tests/python/find.sh"

meshio=$(python_with 'numpy, meshio')
if [ -z "$meshio" ]; then
    tap_skip check_files "no python3 with numpy and meshio (Debian: python3-meshio)"
    tap_end
    exit
fi
work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
XDG_RUNTIME_DIR=$work timeout 300 "$meshio" "$top_srcdir/tests/python/tap.py" check_files
