#!/bin/bash
# test_inspect_page.sh - the page of pccdctl inspect, and its options (TAP).
#
# Room:     tests/inspect.
# Does:     run the cases of check_*.py, those of check_page.py in a Chromium if there is one; skip
#           by name what needs a page that was not built.
# Needs:    PCCDCTL, PCCD_DAEMON and top_srcdir, set by `make check`.
set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCDCTL:?}" "${PCCD_DAEMON:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

unset PCCD_URL PCCD_RECORD PCCD_RECORD_OPTIONS PYTHONHOME PYTHONSTARTUP
export PYTHONPATH=$top_srcdir/tests/inspect PYTHONDONTWRITEBYTECODE=1

if [ ! -s "$top_builddir/client/inspect/page.html" ]; then
    work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-inspect-XXXXXX") || exit 99
    trap 'rm -rf "$work"' EXIT
    "$PCCDCTL" inspect x.rec -o "$work/x.html" >"$work/log" 2>&1
    [ $? -eq 4 ] && grep -q -- '--with-inspect=fetch' "$work/log" && [ ! -e "$work/x.html" ]
    # If it failed, nobody would know how to get the page.
    tap_result $? inspect__says_how_to_get_it "$work/log"
    tap_skip check_options "built without the page"
    tap_skip check_page "built without the page"
    tap_skip check_failing "built without the page"
    tap_end
    exit
fi
exec timeout 600 python3 "$top_srcdir/tests/python/tap.py" check_options check_page check_failing
