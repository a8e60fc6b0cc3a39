#!/bin/bash
# test_fuzz_corpus.sh - every input that a fuzzer has found worth keeping, once more.

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT

# If one of these failed, an input that was found to be hard would be one that hurts.
for folder in "$top_srcdir"/tests/fuzz/corpus/*/; do
    target=$(basename "$folder")
    timeout 300 "$top_builddir/tests/fuzz/replay" "$target" "$folder" >"$work/out" 2>"$work/log"
    tap_result $? "corpus__of_${target}_does_no_harm" "$work/log"
done

tap_end
