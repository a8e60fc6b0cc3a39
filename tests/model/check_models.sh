#!/bin/bash
# check_models.sh - the protocols as models: sound as they are, found out when mutated (TAP).
#
# Needs spin and a C compiler; skipped by name without spin.

set -u -o pipefail
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

folder=$(mktemp -d) || exit 99
trap 'rm -rf "$folder"' EXIT
models=$(cd "$top_srcdir/tests/model" && pwd) || exit 99

# Search all executions of model $1 as mutant $2; the number of errors found, or nothing.
errors_of() {
    (cd "$folder" && rm -f pan* && spin -DMUTANT="$2" -a "$models/$1.pml" >log 2>&1 &&
        ${CC:-cc} -w -O1 -DSAFETY -DMEMLIM=512 -o pan pan.c >>log 2>&1 &&
        timeout 120 ./pan -m100000 >>log 2>&1 && ! grep -q 'search depth too small' log &&
        sed -n 's/.*errors: \([0-9]*\)$/\1/p' log)
}

check() { # MODEL MUTANTS
    local mutant errors
    if ! command -v spin >/dev/null; then
        tap_skip "$1__holds_in_all_executions" "spin is not installed"
        return
    fi
    # If this failed, the protocol itself would be wrong, whatever the code does.
    errors=$(errors_of "$1" 0)
    [ "$errors" = 0 ]
    tap_result $? "$1__holds_in_all_executions" "$folder/log"
    # If this failed, the model could not tell a wrong protocol from a right one.
    for ((mutant = 1; mutant <= $2; mutant++)); do
        errors=$(errors_of "$1" "$mutant")
        [ -n "$errors" ] && [ "$errors" -gt 0 ]
        tap_result $? "$1__mutant_${mutant}_is_found_out" "$folder/log"
    done
}

check wakeup 3
check resume 6
tap_end
