#!/bin/bash
# test_style_words.sh - names have the words of the glossary, and each has one meaning (TAP).
#
# Room:     tests/style.
# Does:     look for the words of words.txt in identifiers and names of files. Comments and
#           strings may have them.

set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
cd "$top_srcdir" || exit 99

# The names of the C files below the folders given, without the words allowed: one a line.
find daemon client proto bench tests -name '*.[ch]' -not -path '*/node_modules/*' |
    LC_ALL=C sort >"$work/files"

cat >"$work/look.awk" <<'END'
FILENAME == words {
    if (/^[^#]/) {
        instead = $0
        sub(/^[^ ]+ [^ ]+ /, "", instead)
        use[$2, $1] = instead
        listed[$2] = 1
    }
    next
}
function complain(name, word, folder) {
    folder = FILENAME
    while (sub(/\/[^\/]*$/, "", folder)) {
        if ((word, folder) in use) {
            print FILENAME ":" FNR ": " name " (" word "); use: " use[word, folder]
            return
        }
    }
}
function look(text, names, parts, i, j, n) {
    n = split(text, names, /[^A-Za-z0-9_]+/)
    for (i = 1; i <= n; i++) {
        if (names[i] == "") continue
        parts_count = split(names[i], parts, /_+/)
        for (j = 1; j <= parts_count; j++)
            if (parts[j] in listed) complain(names[i], parts[j])
    }
}
FNR == 1 {
    inside = 0
    base = FILENAME
    sub(/.*\//, "", base)
    sub(/\.[ch]$/, "", base)
    look(base)
}
{
    line = ""
    while ($0 != "") {
        if (inside) {
            if (!(end = index($0, "*/"))) break
            $0 = substr($0, end + 2)
            inside = 0
        } else if (match($0, /\/\*|\/\/|"([^"\\]|\\.)*"/)) {
            line = line substr($0, 1, RSTART - 1) " "
            what = substr($0, RSTART, 2)
            $0 = substr($0, RSTART + RLENGTH)
            if (what == "/*") inside = 1
            else if (what == "//") break
        } else {
            line = line $0
            break
        }
    }
    look(tolower(line))
}
END
look() { xargs awk -v words="$1" -f "$work/look.awk" "$1"; }

# If this failed, a reader would have to guess which of two meanings a name has.
look tests/style/words.txt <"$work/files" >"$work/log" 2>&1
[ ! -s "$work/log" ]
tap_result $? names__have_the_words_of_the_glossary "$work/log"

# If this failed, the case above would pass whatever names say.
mkdir -p "$work/room/below"
printf 'int srv_desk_of; /* desk */ const char *said = "desk"; // desk\n' >"$work/room/below/a.c"
printf '%s desk workspace\n' "$work/room" >"$work/words"
echo "$work/room/below/a.c" | look "$work/words" >"$work/log" 2>&1
[ "$(wc -l <"$work/log")" = 1 ] && grep -q 'srv_desk_of (desk); use: workspace' "$work/log"
tap_result $? names__with_another_word_are_found "$work/log"

tap_end
