#!/bin/bash
# test_proto_document.sh - PROTOCOL.md and the frozen messages agree with the manifest.

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
gendoc=$top_builddir/proto/gendoc
document=$top_srcdir/proto/PROTOCOL.md
frozen=$top_srcdir/tests/abi/manifest.txt

# If this failed, the document would describe other messages than the code speaks; run
# `make protocol-doc`.
"$gendoc" <"$document" >"$work/new" 2>"$work/log" &&
    diff -u "$document" "$work/new" >"$work/log" 2>&1
tap_result $? document__has_the_tables_of_the_manifest "$work/log"

# If this failed, the manual page would name other methods or statuses; run the same.
"$gendoc" manual <"$top_srcdir/client/man/pccd-protocol.7.scd" >"$work/new" 2>"$work/log" &&
    diff -u "$top_srcdir/client/man/pccd-protocol.7.scd" "$work/new" >"$work/log" 2>&1
tap_result $? document__manual_page_has_the_methods_of_the_manifest "$work/log"

"$gendoc" manifest >"$work/manifest"
for name in $(awk '$2 == "since" { print $1 }' "$work/manifest"); do
    grep -Fqx "### \`$name\`" "$document" || echo "no section for $name"
done >"$work/log"
[ -s "$work/manifest" ] && [ ! -s "$work/log" ]
# If this failed, a message would be documented nowhere.
tap_result $? document__has_a_section_for_each_message "$work/log"

# If this failed, who writes a client by the document would not know what a number means.
headers="$top_srcdir/proto/common/pccd_types.h $top_srcdir/proto/common/pccd_trace.h $top_srcdir/proto/common/pccd_daemon.h"
# shellcheck disable=SC2086 # several files
sed -n 's/^ *\(PCCD_[A-Z0-9_]*\) = \([0-9]*\)u\{0,1\}[, ].*/\1 \2/p; s/^ *\(PCCD_[A-Z0-9_]*\) = \([0-9]*\)$/\1 \2/p
    s/^ *X(\([A-Z0-9_]*\), \([0-9]*\), [a-z].*/PCCD_\1 \2/p' $headers |
    grep -v '_COUNT ' >"$work/values"
while read -r name value; do
    grep -Fq "| $value | \`$name\` |" "$document" || echo "$name = $value is not there"
done <"$work/values" >"$work/log"
for name in $(grep -o 'enum pccd_[a-z_]*' "$document" | grep -v 'pccd_status' | cut -d' ' -f2 | LC_ALL=C sort -u); do
    grep -Fqx "\`enum $name\`" "$document" || echo "no table of enum $name"
done >>"$work/log"
[ "$(wc -l <"$work/values")" -gt 50 ] && [ ! -s "$work/log" ]
tap_result $? document__has_every_value_of_every_enum "$work/log"

# If this failed, the daemon would answer a status that the document says never comes.
sentence=$(tr '\n' ' ' <"$document" | grep -o 'Codes [^.]*do not go over the wire')
for name in $(printf '%s' "$sentence" | grep -o 'E_[A-Z]*'); do
    find "$top_srcdir/daemon" -name '*.c' -exec cat {} + | tr '\n' ' ' |
        grep -o "proto_error_set([^;\"]*PCCD_$name[^;]*"
done >"$work/log"
[ -n "$sentence" ] && [ ! -s "$work/log" ]
tap_result $? document__says_which_statuses_do_not_come "$work/log"

LC_ALL=C sort "$frozen" >"$work/frozen"
LC_ALL=C sort "$work/manifest" >"$work/now"
LC_ALL=C comm -23 "$work/frozen" "$work/now" >"$work/log"
[ ! -s "$work/log" ]
# If this failed, an old peer would miss a message or a field, or read it as another type.
tap_result $? manifest__keeps_what_was_published "$work/log"

LC_ALL=C comm -13 "$work/frozen" "$work/now" >"$work/log"
[ ! -s "$work/log" ]
# If this failed, something new could be changed again unnoticed: add it to manifest.txt.
tap_result $? manifest__is_frozen_as_a_whole "$work/log"

awk 'NR == FNR { old[$1 " " $2] = 1; known[$0] = 1; next }
    $2 == "request" && $5 == "REQ" && old[$1 " " $2] && !known[$0]' \
    "$work/frozen" "$work/now" >"$work/log"
[ ! -s "$work/log" ]
# If this failed, an old client could not make a request that a new daemon understands.
tap_result $? manifest__adds_only_optional_params "$work/log"

tap_end
