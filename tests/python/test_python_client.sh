#!/bin/bash
# test_python_client.sh - the Python module against real daemons (TAP).
set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCDD:?}" "${PCCD_DAEMON:?}" "${PCCDCTL:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
# shellcheck source=tests/python/find.sh
. "$top_srcdir/tests/python/find.sh"

cases="check_abi check_raw check_client check_near check_batch check_thick check_turning check_arrays check_misuse check_scenes check_link check_points check_weld"
if [ -z "$python" ]; then
    for case in $cases; do
        tap_skip "$case" "$no_python"
    done
    tap_end
    exit
fi
# shellcheck disable=SC2086 # words on purpose
exec timeout 600 "$python" "$top_srcdir/tests/python/tap.py" $cases
