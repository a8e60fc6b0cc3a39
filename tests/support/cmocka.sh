#!/bin/bash
# tests/support/cmocka.sh - run a cmocka program and correct its TAP where it skips.
#
# Of a case that was skipped, cmocka 1.1 says "not ok 3 # SKIP name", which TAP counts as a
# failure, or "ok 3 # SKIP name", and cmocka 2 "ok 3 - name # SKIP". TAP's own form is the last one
# with a reason, which test_skip() has printed before in the line "# skipped: reason". The exit
# status is the program's.

set -o pipefail
"$@" | awk '
    sub(/^# skipped: /, "") { reason = $0; next }
    sub(/^not ok [0-9]+ # SKIP /, "&") { sub(/^not /, "") }
    match($0, /^ok [0-9]+ # SKIP /) {
        number = $2
        $0 = "ok " number " - " substr($0, RLENGTH + 1) " # SKIP"
    }
    /^ok .* # SKIP$/ { $0 = $0 " " reason }
    { print; fflush() }
    /^(not )?ok / { reason = "" }'
