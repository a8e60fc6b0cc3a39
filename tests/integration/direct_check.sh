#!/bin/bash
# direct_check.sh - the tests of steps once more, without a daemon: PCCD_TEST_URL=direct:
#
# Not those whose subject is the daemon: its sockets and users, its quotas and options, its
# death and return, other clients of it while a step is computed.

set -u
: "${top_builddir:?is set by make check}"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
export PCCD_TEST_URL=direct:
count=0
failed=0

for program in step flow choice deadline watch replace slot; do
    timeout 600 "$top_builddir/tests/integration/test_int_$program" >"$work/out" 2>"$work/err"
    status=$?
    # cmocka says "not ok 3 # SKIP name" of a case that was skipped.
    sed -i 's/^not ok \([0-9][0-9]* # SKIP \)/ok \1/' "$work/out"
    while IFS= read -r line; do
        case $line in
        'ok '* | 'not ok '*)
            count=$((count + 1))
            printf '%s\n' "$line" | sed "s/^\(not \)\{0,1\}ok [0-9]*/\1ok $count/"
            ;;
        1..*) ;;
        *) printf '%s\n' "$line" ;;
        esac
    done <"$work/out"
    # If this failed, a program would have ended before its last test.
    count=$((count + 1))
    if [ "$status" -eq 0 ] && grep -q '^ok ' "$work/out"; then
        printf 'ok %d - direct: test_int_%s ends well\n' "$count" "$program"
    else
        failed=1
        printf 'not ok %d - direct: test_int_%s ends well\n' "$count" "$program"
        sed -n '1,40s/^/# /p' "$work/err"
    fi
done
printf '1..%d\n' "$count"
[ "$failed" -eq 0 ]
