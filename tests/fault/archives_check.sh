#!/bin/bash
# tests/fault/archives_check.sh - which libraries' calls can fail on order.

set -u
. "${top_srcdir:?}/tests/support/tap.sh"
: "${top_builddir:?}" "${CC:?}"

log=$(mktemp "${TMPDIR:-/tmp}/pccd-archives-XXXXXX") || exit 1
trap 'rm -f "$log"' EXIT

# If it failed, no call of the library would ever fail in these tests, and nobody would know.
for library in libuv libmsgpack; do
    name="${library}__is_linked_in_where_it_is_an_archive"
    # shellcheck disable=SC2086 # CC may have words
    folder=$(dirname "$($CC -print-file-name=libuv.so)")
    if ! ls "$folder/$library"*.a >"$log" 2>&1; then
        tap_skip "$name" "no archive of it beside libuv.so"
        continue
    fi
    readelf -d "$top_builddir/tests/fault/pccdd-faulty" >"$log" 2>&1 &&
        ! grep -q "NEEDED.*$library" "$log"
    tap_result $? "$name" "$log"
done
tap_end
