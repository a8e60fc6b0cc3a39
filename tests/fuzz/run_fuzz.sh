#!/bin/bash
# run_fuzz.sh SECONDS BUILD CORPUS - each target in turn for that long; a line for each.
#
# New inputs go to BUILD/fuzz-found/TARGET, findings to BUILD/fuzz-found/TARGET-crash-*.
# Ends with 1 when there was a finding.

set -u
seconds=$1
build=$2
corpus=$3
found=$build/fuzz-found
only=${FUZZ_TARGETS:-decoder reader record query mesh travel slot dispatch}
failed=0

mkdir -p "$found"
for target in $only; do
    mkdir -p "$found/$target"
    FUZZ_TARGET=$target nice -n 19 "$build/tests/fuzz/fuzz" -max_total_time="$seconds" -timeout=300 \
        -rss_limit_mb=4096 -detect_leaks=0 -max_len=4096 -print_final_stats=1 -verbosity=1 \
        -artifact_prefix="$found/$target-" "$found/$target" "$corpus/$target" \
        >"$found/$target.log" 2>&1
    status=$?
    executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$found/$target.log")
    edges=$(grep -o 'cov: [0-9]*' "$found/$target.log" | tail -1)
    printf '%-9s %12s executions, %s, %s\n' "$target" "${executions:-?}" "${edges:-no cov}" \
        "$([ $status -eq 0 ] && echo 'no finding' || echo "FINDING, see $found/$target.log")"
    [ $status -eq 0 ] || failed=1
done
exit $failed
