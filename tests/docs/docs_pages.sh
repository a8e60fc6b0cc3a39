#!/bin/bash
# docs_pages.sh - the manual pages name every option and function, and scdoc takes them (TAP).
#
# Room:     tests/docs.
# Does:     compare what programs print with --help, and what pccd.h declares, with the pages.

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log
man=$top_srcdir/client/man

# The options that a help text has, one a line.
options() { grep -oE -- '(^|[ ,])--[a-z][a-z0-9-]*' | grep -oE -- '--.*' | sort -u; }
# missing PAGE: options of stdin that the page does not have in bold.
missing() {
    while read -r option; do
        grep -qF -- "*$option*" "$man/$1" || echo "$1 lacks $option"
    done
}

"$top_builddir/pccdctl" --help | sed -n 's/^  \([a-z]*\) .*/\1/p' >"$work/commands"
while read -r command; do
    grep -q "^\*$command\*\$" "$man/pccdctl.1.scd" || echo "pccdctl.1 lacks $command"
    grep -q "^\*pccdctl $command\*" "$man/pccdctl.1.scd" || echo "no synopsis of $command"
    "$top_builddir/pccdctl" "$command" --help | options | missing pccdctl.1.scd
done <"$work/commands" >"$log"
[ -s "$work/commands" ] && [ ! -s "$log" ]
# If it failed, a command or an option of pccdctl would be described nowhere.
tap_result $? pages__pccdctl_has_every_command_and_option "$log"

while read -r command; do
    "$top_builddir/pccdctl" "$command" --help >"$work/help"
    sed -n '/^Examples:/,$s/^  *pccdctl //p' "$work/help" >"$work/examples"
    [ "$(grep -c "^$command" "$work/examples")" -eq 2 ] || echo "$command: not two examples"
    options <"$work/examples" | while read -r option; do
        grep -qE -- "^ .*$option([ =]|\$)" "$work/help" || echo "$command: no $option"
    done
done <"$work/commands" >"$log"
[ ! -s "$log" ]
# If it failed, help would show no use of a command, or one that is refused.
tap_result $? help__shows_two_examples_of_each_command "$log"

for page in client/README.md CONTRIBUTING.md proto/PROTOCOL.md client/man/pccd.7.scd; do
    lists=$(head -n 30 "$top_srcdir/$page" | grep -cE '^([1-5]\. |\. [A-Z])')
    [ "$lists" -eq 5 ] || echo "$page begins with $lists things to read, not 5"
done >"$log"
for line in './bootstrap demo ' './bootstrap check '; do
    head -n 20 "$top_srcdir/README.md" | grep -qF "    $line" || echo "README.md lacks $line"
done >>"$log"
awk 'length > 100 { print "README.md: " $0 } END { if (NR != 90) print "README.md has " NR " lines" }' \
    "$top_srcdir/README.md" >>"$log"
[ ! -s "$log" ]
# If it failed, whoever opens a page would not know where to begin.
tap_result $? pages__begin_with_what_to_read_first "$log"

"$top_builddir/pccdd" --help | options | grep -vE -- '--(help|usage|version)' |
    missing pccdd.8.scd >"$log"
[ ! -s "$log" ]
# If it failed, an option of the daemon would be described nowhere.
tap_result $? pages__pccdd_has_every_option "$log"

"$top_builddir/pccd-load" --help | options | grep -vE -- '--(help|usage|version)' |
    missing pccd-load.1.scd >"$log"
[ ! -s "$log" ]
# If it failed, an option of pccd-load would be described nowhere.
tap_result $? pages__pccd_load_has_every_option "$log"

if [ "${PCCD_MPI:-no}" = no ]; then
    tap_skip pages__pccd_mpi_has_every_option "no --with-mpi"
else
    # One rank needs no mpirun.
    for command in check near replay verify completion; do
        "$top_builddir/pccd-mpi" $command --help 2>/dev/null | options
    done | missing pccd-mpi.1.scd >"$log"
    [ ! -s "$log" ]
    # If it failed, an option of pccd-mpi would be described nowhere.
    tap_result $? pages__pccd_mpi_has_every_option "$log"
fi

grep -oE '\*pccd_[a-z0-9_]+\*\(\)' "$man/libpccd-mpi.3.scd" | tr -d '*()' | sort -u |
    while read -r name; do
        grep -q "^int $name(\|^void $name(\|^const char \*$name(" \
            "$top_srcdir/client/mpi/pccd_mpi.h" || echo "no such function: $name"
    done >"$log"
grep -oE '^(int|void|const char \*) ?pccd_mpi_[a-z_]+\(' "$top_srcdir/client/mpi/pccd_mpi.h" |
    grep -oE 'pccd_mpi_[a-z_]+' | while read -r name; do
        grep -qF "*$name*()" "$man/libpccd-mpi.3.scd" || echo "libpccd-mpi.3 lacks $name"
    done >>"$log"
[ ! -s "$log" ]
# If it failed, the page would lead to functions that are not there, or hide one that is.
tap_result $? pages__libpccd_mpi_names_all_functions "$log"

grep -oE '\*pccd_[a-z0-9_]+\*\(\)' "$man/libpccd.3.scd" | tr -d '*()' | sort -u |
    while read -r name; do
        grep -q "^ *$name;\$" "$top_srcdir/client/lib/libpccd.map" || echo "no such function: $name"
    done >"$log"
[ ! -s "$log" ]
# If it failed, the page would lead to functions that are not there.
tap_result $? pages__libpccd_names_functions_that_are "$log"

grep -ohE 'getenv\("[A-Z_]+"\)' "$top_srcdir"/client/lib/*.c | grep -oE '[A-Z_]{2,}' | sort -u |
    grep -vx PATH | while read -r name; do
        grep -qE "^\*(.*, \*)?$name\*" "$man/libpccd.3.scd" || echo "libpccd.3.scd: no $name"
    done >"$log"
[ ! -s "$log" ]
# If it failed, a variable would change what a program does, and no page would say so.
tap_result $? pages__libpccd_has_every_variable "$log"

sed -n '/^# SYNOPSIS/,/^# DESCRIPTION/{/^\*/p}' "$man/pccdctl.1.scd" >"$work/synopsis"
"$top_builddir/pccdctl" completion synopsis | diff "$work/synopsis" - >"$log" &&
    [ -s "$work/synopsis" ]
# If it failed, the synopsis would hide an option or a word that a command takes; make
# synopsis-doc writes it anew.
tap_result $? pages__pccdctl_has_a_whole_synopsis "$log"

for page in "$man"/*.scd; do
    name=${page##*/}
    head -n 1 "$page" | grep -qE "^${name%.*.scd}\\([1-8]\\)\$" || echo "$name: its first line"
    grep -q '^# NAME$' "$page" && grep -q '^# SEE ALSO$' "$page" || echo "$name: a heading is missing"
    grep -oE '\*[a-z-]+\*\([1-8]\)' "$page" | tr -d '*()' | sed 's/\(.\)$/.\1/' |
        while read -r other; do
            [ -e "$man/$other.scd" ] || echo "$name: see also $other, which is not there"
        done
    if command -v scdoc >/dev/null; then
        scdoc <"$page" >/dev/null || echo "$name: scdoc does not take it"
    fi
done >"$log" 2>&1
[ ! -s "$log" ]
# If it failed, a page would not be built, or would lead nowhere.
tap_result $? pages__are_well_formed "$log"

tap_end
