#!/bin/bash
# tests/support/cmocka.sh - run a cmocka program and correct one word of its TAP.
#
# cmocka 1.1 says "not ok 3 # SKIP name" of a case that was skipped, which TAP counts as a
# failure; TAP's own form is "ok 3 # SKIP name". The exit status is the program's.

set -o pipefail
"$@" | sed -u 's/^not ok \([0-9][0-9]* # SKIP \)/ok \1/'
