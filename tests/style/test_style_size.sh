#!/bin/bash
# test_style_size.sh - there is not more to learn than the baseline says (TAP).
set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
size=$top_srcdir/tests/style/size.sh

# If this failed, the tree would grow without anybody saying what that buys: raise the figure
# in size.txt in the commit that says it, or make something else smaller.
"$size" tests/style/size.txt >"$work/log" 2>&1
tap_result $? tree__has_the_size_of_the_baseline "$work/log"

# If this failed, the case above could not fail.
awk '$1 == "product_lines" { $2 = 0 } { print }' "$top_srcdir/tests/style/size.txt" >"$work/less"
"$size" "$work/less" >"$work/log" 2>&1
[ $? -eq 1 ] && grep -q '^product_lines .*GROWN$' "$work/log"
tap_result $? growth__is_found "$work/log"

tap_end
