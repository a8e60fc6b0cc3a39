# tap.sh - results of a test script in the Test Anything Protocol; sourced by bash scripts.
#
#   tap_result STATUS NAME [LOG]   ok when STATUS is 0; else the log's first lines as comments
#   tap_skip NAME REASON
#   tap_end                        the plan; the script's exit status

tap_count=0
tap_failed=0

tap_result() {
    tap_count=$((tap_count + 1))
    if [ "$1" -eq 0 ]; then
        printf 'ok %d - %s\n' "$tap_count" "$2"
        return
    fi
    tap_failed=$((tap_failed + 1))
    printf 'not ok %d - %s\n' "$tap_count" "$2"
    [ -z "${3-}" ] || sed -n '1,40s/^/# /p' "$3"
}

tap_skip() {
    tap_count=$((tap_count + 1))
    printf 'ok %d - %s # SKIP %s\n' "$tap_count" "$1" "$2"
}

tap_end() {
    printf '1..%d\n' "$tap_count"
    [ "$tap_failed" -eq 0 ]
}
