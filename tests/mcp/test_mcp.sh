#!/bin/bash
# test_mcp.sh - pccdctl mcp by pipes, and by the client library of the protocol (TAP).
#
# Room:     tests/mcp.
# Does:     run the cases of check_*.py; run check_sdk.mjs if $NODE_MODULES has what package.json
#           names, and otherwise skip it by name.
# Needs:    PCCDCTL, PCCD_DAEMON and top_srcdir, set by `make check`.
set -u
: "${top_srcdir:?is set by make check}" "${PCCDCTL:?}" "${PCCD_DAEMON:?}"

unset PCCD_URL PCCD_RECORD PCCD_RECORD_OPTIONS PYTHONHOME PYTHONSTARTUP
export PYTHONPATH=$top_srcdir/tests/mcp PYTHONDONTWRITEBYTECODE=1
exec timeout 900 python3 "$top_srcdir/tests/python/tap.py" check_mcp check_questions check_sdk
