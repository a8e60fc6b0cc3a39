#!/bin/bash
# tests/dist/cross_check.sh - what a build for another processor makes by its own programs.
#
# Room:  client/ctl/local.mk, Makefile.am, configure.ac, from outside.
# Does:  have make run pccdctl by an emulator that fails; ask what check-emulated would make.

set -u
. "${top_srcdir:?}/tests/support/tap.sh"
: "${top_builddir:?}"

log=$(mktemp "${TMPDIR:-/tmp}/pccd-cross-XXXXXX") || exit 1
trap 'rm -f "$log"' EXIT
script=client/ctl/completion/pccdctl

# If it failed, three empty files would be installed as the completion of the shells.
name="completion__is_not_there_where_pccdctl_cannot_run"
if [ ! -s "$top_builddir/$script" ]; then
    tap_skip "$name" "this build has no completion"
else
    # Nothing is built: pccdctl is taken for new, and nothing for older than what it is made of.
    ! MAKEFLAGS='' make -C "$top_builddir" -o pccdctl -W pccdctl EMULATOR=false "$script" >"$log" 2>&1 &&
        [ -s "$top_builddir/$script" ]
    tap_result $? "$name" "$log"
    rm -f "$top_builddir/$script.tmp"
fi

# If it failed, the name of a test would begin a line of the shell, and be no test of make's.
name="check_emulated__runs_the_tests_of_the_engine"
MAKEFLAGS='' make -C "$top_builddir" -n check-emulated EMULATOR=false TESTS="tests/unit/test_codec \
    tests/unit/test_eng_range tests/unit/test_eng_parts tests/unit/test_eng_neon.sh" >"$log" 2>&1 &&
    grep -q "='tests/unit/test_eng_range.log tests/unit/test_eng_parts.log';" "$log" &&
    ! grep -q '^tests/unit/' "$log"
tap_result $? "$name" "$log"
tap_end
