#!/bin/bash
# test_style_files.sh - every source file keeps the house rules of CONTRIBUTING.md.

set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
cd "$top_srcdir" || exit 99
mapfile -t sources < <(find proto daemon client bench tests \( -name '*.[ch]' -o -name '*.cc' \) |
    LC_ALL=C sort)
mapfile -t scripts < <(find client bench tests -name '*.py' -o -path bench/compare | LC_ALL=C sort)
mapfile -t texts < <(find proto daemon client bench tests \
    \( -name '*.[ch]' -o -name '*.cc' -o -name '*.def' -o -name '*.mk' -o -name '*.sh' -o -name '*.md' \
    -o -name '*.map' -o -name '*.py' \) | LC_ALL=C sort)
[ ${#sources[@]} -gt 0 ] && [ ${#scripts[@]} -gt 0 ] || exit 99

# Files that may ask for the time of day, each with its reason. Nobody waits by it.
day_times='
daemon/service/base/log.c          a line of the log begins with it
client/lib/recorder_snapshot.c     a recording says when it was made
'

# The log is what breaks the rule; an empty one passes. A tool that could not read the files
# has said so in the errors.
check() {
    cat "$work/errors" >>"$work/log"
    [ ! -s "$work/log" ]
    tap_result $? "$1" "$work/log"
}
exec 2>"$work/errors"

# If this failed, a source would lie there that nothing compiles. A program of one file is named
# without the ".c". (Headers need no list: the tarball has what git tracks.)
mapfile -t lists < <(find proto daemon client bench tests -name local.mk)
LC_ALL=C comm -23 <(printf '%s\n' "${sources[@]}" | sed -n 's/[.]c$//p') \
    <(grep -ohE '(proto|daemon|client|bench|tests)/[a-z0-9_/]+' "${lists[@]}" | LC_ALL=C sort -u) |
    sed 's/^/no list names /' >"$work/log"
check sources__are_in_a_list

# If this failed, the guard of a header would be a name that it had before, and sooner or later
# that of another. The file's own name is its end.
for header in "${sources[@]}"; do
    name=${header##*/}
    name=${name%.h}
    [ "$name.h" != "${header##*/}" ] ||
        grep -qE "^#ifndef ([A-Z0-9]+_)*${name^^}_H$" "$header" ||
        echo "$header: no guard ${name^^}_H"
done >"$work/log"
check headers__have_a_guard_of_their_name

# If this failed, a function would not fit on a screen. One that needs more says why in the
# comment before it, after the words "More than 70 lines:".
awk 'FNR == 1 { start = 0; excused = 0 }
    /More than 70 lines:/ { excused = 1 }
    /^[{]/ { start = FNR }
    /^[}]/ {
        if (start && FNR - start + 1 > 70 && !excused)
            print FILENAME ":" start ": " FNR - start + 1 " lines"
        start = 0
        excused = 0
    }' "${sources[@]}" >"$work/log"
check functions__have_at_most_70_lines

# If this failed, the same of a function in Python: one ends where something begins that is
# not indented more.
awk 'function ends(at) {
        while (depth > 0 && at <= indent[depth]) {
            if (last - start[depth] + 1 > 70)
                print file ":" start[depth] ": " last - start[depth] + 1 " lines"
            depth--
        }
    }
    FNR == 1 { ends(0); file = FILENAME }
    /^ *$/ { next }
    {
        match($0, /^ */)
        if ($0 !~ /^ *[])}]/)
            ends(RLENGTH)
        last = FNR
    }
    /^ *def / { indent[++depth] = RLENGTH; start[depth] = FNR }
    END { ends(0) }' "${scripts[@]}" >"$work/log"
check python_functions__have_at_most_70_lines

# If this failed, two files side by side would not fit on a screen.
LC_ALL=C.UTF-8 grep -nE '^.{91,}' "${sources[@]}" "${scripts[@]}" | cut -c1-100 >"$work/log"
check lines__have_at_most_90_columns

# If this failed, the same file would look different in another editor.
grep -n "$(printf '\t')" "${sources[@]}" "${scripts[@]}" >"$work/log"
check files__have_no_tabs

# If this failed, a diff would show changes that nobody sees.
{
    grep -nE '[[:space:]]+$' "${texts[@]}"
    for file in "${texts[@]}"; do
        [ -z "$(tail -c 1 "$file")" ] || echo "$file: no newline at the end"
    done
} >"$work/log"
check files__have_no_trailing_blanks

# If this failed, something would wait by a clock that can be set: for an hour, if somebody sets
# it back by one. A condition waits by it too, unless it was made for another clock.
{
    grep -nE 'CLOCK_(REALTIME|TAI)|\<(gettimeofday|timespec_get) *\(|\<time *\((NULL|0|&)|\<system_clock\>' \
        "${sources[@]}" | while IFS= read -r line; do
        printf '%s' "$day_times" | grep -q "^${line%%:*} " || echo "$line"
    done
    grep -nE '\<(pthread_timedjoin_np|pthread_(mutex|rwlock)_timed[a-z]*lock|sem_timedwait) *\(' \
        "${sources[@]}"
    grep -nE '\<(mtx_timedlock|cnd_timedwait|mq_timed[a-z]*) *\(' "${sources[@]}"
    grep -lE '\<pthread_cond_timedwait *\(' "${sources[@]}" |
        xargs -r grep -LE 'pthread_condattr_setclock\([^,]*, CLOCK_MONOTONIC\)' |
        sed 's/$/: the condition of pthread_cond_timedwait has no CLOCK_MONOTONIC/'
    grep -nE '\<(time\.time|datetime\.now|datetime\.utcnow)\(' "${scripts[@]}"
} >"$work/log"
check waits__are_by_a_clock_that_nobody_sets

# If this failed, the engine would compute with the registers of the x87, or of some processors
# alone: another machine would give other bytes.
{
    grep -nE '\<long double\>|\<__float(80|128)\>|\<_Float[0-9]+x?\>' \
        $(printf '%s\n' "${sources[@]}" | grep '^daemon/')
    grep -nE -e '-mfpmath|-m32|-ffast-math|-Ofast|-march=' configure.ac Makefile.am "${lists[@]}"
} >"$work/log"
check numbers__are_those_of_every_processor

# If this failed, work that is left to do would be known to nobody.
grep -nEw 'TODO|FIXME|XXX|HACK' "${texts[@]}" |
    grep -vE 'TODO\(#[0-9]+\)|^tests/style/' >"$work/log"
check todos__name_an_issue

# If this failed, a newcomer would not know what a file is for.
for file in "${sources[@]}"; do
    awk -v name="${file##*/}" '
        index($0, "/* " name " - ") != 1 && index($0, "/* " FILENAME " - ") != 1 {
            print FILENAME ": does not begin with \"/* " name " - \"" }
        { exit }' "$file"
done >"$work/log"
for file in "${scripts[@]}"; do
    awk -v name="${file##*/}" '
        NR == 1 && /^#!/ { next }
        !begun { begun = 1; good = index($0, "\"\"\"" name " - ") == 1; next }
        NR <= 20 && /^Room:     / { room = 1 }
        NR <= 20 && /^Does:     / { does = 1 }
        /^"""$/ { exit }
        END { if (!(good && room && does))
            print FILENAME ": the docstring has no name, no \"Room:\" or no \"Does:\"" }' "$file"
done >>"$work/log"
check files__begin_with_what_they_are

# If this failed, a test would say nothing about why it is there.
for file in "${sources[@]}"; do
    case $file in tests/*/test_*.c) ;; *) continue ;; esac
    awk '/^(static void [a-z0-9_]+__[a-z0-9_]+\(void \*\*state\)|CASE(_[A-Z]+)?\()/ && !commented {
            print FILENAME ":" FNR ": no comment before the test" }
        { commented = /\*\/$/ }' "$file"
done >"$work/log"
awk '/^ *def test_[a-z0-9_]+__[a-z0-9_]+\(/ && !commented {
        print FILENAME ":" FNR ": no comment before the test" }
    /^ *def test_/ && !/^ *def test_[a-z0-9_]+__[a-z0-9_]+\(/ {
        print FILENAME ":" FNR ": the name has not the form noun__behaviour" }
    { commented = /^ *# / }' "${scripts[@]}" >>"$work/log"
check tests__say_what_would_be_wrong

# If this failed, who reads what was skipped would not learn what it takes.
grep -nE '\<skip\(\)' "${sources[@]}" | grep -v '^tests/support/cases.h:' >"$work/log"
check tests__say_why_they_are_skipped

tap_end
