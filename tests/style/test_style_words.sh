#!/bin/bash
# test_style_words.sh - names have the words of the glossary, and each has one meaning (TAP).
#
# Room:     tests/style.
# Does:     look for the words of words.txt in identifiers and names of files, in which
#           comments and strings may have them; compare words.txt with the glossary of
#           CONTRIBUTING.md; look how comments of declarations begin.

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
    if (/^=/) {
        only[$2] = " "
        for (i = 3; i <= NF; i++) only[$2] = only[$2] $i " "
        listed[$2] = 1
    } else if (/^[^#]/) {
        instead = $0
        sub(/^[^ ]+ [^ ]+ /, "", instead)
        use[$2, $1] = instead
        listed[$2] = 1
    }
    next
}
function complain(name, word, is_owned, folder) {
    folder = FILENAME
    is_owned = !(word in only) || FILENAME !~ core
    while (sub(/\/[^\/]*$/, "", folder)) {
        if ((word, folder) in use) {
            print FILENAME ":" FNR ": " name " (" word "); use: " use[word, folder]
            return
        }
        if (!is_owned) is_owned = index(only[word], " " folder " ")
    }
    if (!is_owned) print FILENAME ":" FNR ": " name " (" word "): a second meaning?"
}
function singular(word) {
    if (word in listed) return word
    if (sub(/ies$/, "y", word) || sub(/s$/, "", word)) return word
    return word
}
function look(text, names, parts, i, j, n) {
    n = split(text, names, /[^A-Za-z0-9_]+/)
    for (i = 1; i <= n; i++) {
        if (names[i] == "" || names[i] ~ /^omp_/) continue # OpenMP's own
        parts_count = split(names[i], parts, /_+/)
        for (j = 1; j <= parts_count; j++)
            if ((word = singular(parts[j])) in listed) complain(names[i], word)
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
core='^(daemon|proto|client/lib)/'
look() { xargs awk -v words="$1" -v core="$core" -f "$work/look.awk" "$1"; }

# If this failed, a reader would have to guess which of two meanings a name has.
look tests/style/words.txt <"$work/files" >"$work/log" 2>&1
[ ! -s "$work/log" ]
tap_result $? names__have_the_words_of_the_glossary "$work/log"

# If this failed, the case above would pass whatever names say.
mkdir -p "$work/room/below"
printf 'int srv_desk_of; /* desk */ const char *said = "desk"; // desk\nint diaries;\n' \
    >"$work/room/below/a.c"
printf 'int ghosts; /* of ghosts */\n' >"$work/room/ghost.h"
printf '%s desk workspace\n%s diary journal\n= ghost %s\n' "$work/room" "$work/room" \
    "$work/room/below" >"$work/words"
core=^$work/
printf '%s\n' "$work/room/below/a.c" "$work/room/ghost.h" |
    look "$work/words" >"$work/log" 2>&1
[ "$(wc -l <"$work/log")" = 4 ] && grep -q 'srv_desk_of (desk); use: workspace' "$work/log" &&
    grep -q 'diaries (diary); use: journal' "$work/log" &&
    grep -q 'ghosts (ghost): a second meaning' "$work/log"
tap_result $? names__with_another_word_or_meaning_are_found "$work/log"

# The words of a page's glossary that have two rows or a row with two meanings, and those
# of the list that have none: one a line.
judge_glossary() { # PAGE LIST
    awk '
        FILENAME == ARGV[1] && /^## / { is_on = $0 == "## Words" }
        FILENAME == ARGV[1] && is_on && /^\| [^ ]/ && !/^\| Word/ {
            split($0, cell, " *\\| *")
            if (cell[2] in rows) print cell[2] ": two rows"
            rows[cell[2]] = 1
            if (cell[3] ~ /[Ee]lsewhere|[Oo]therwise|[.;:] [Ii]n `|[.;] [Oo]f [a-z ]+: /)
                print cell[2] ": two meanings"
            known = known " " cell[2] " " cell[3] " "
        }
        FILENAME == ARGV[2] && /^= / && known !~ "[ *]" $2 "[ *s]" { print $2 ": no row" }
    ' "$1" "$2"
}

# If this failed, a word would have another meaning in the next room.
judge_glossary CONTRIBUTING.md tests/style/words.txt >"$work/log"
[ ! -s "$work/log" ] && grep -q '^| seat |' CONTRIBUTING.md
tap_result $? words__have_one_row_with_one_meaning "$work/log"

# If this failed, the case above could not fail.
printf '%s\n' '## Words' '| a | one |' '| a | two |' '| b | one. In `x/`: another |' >"$work/page"
printf '= c daemon\n' >"$work/words"
judge_glossary "$work/page" "$work/words" >"$work/log"
[ "$(tr '\n' , <"$work/log")" = 'a: two rows,b: two meanings,c: no row,' ]
tap_result $? words__with_two_meanings_are_found "$work/log"

# Comments of declarations that begin as a question or with "Of", those of functions in
# headers that begin with no word of verbs.txt (behind "Collective."), and any line that
# says "likewise" in the place of what is meant: one a line.
cat >"$work/comments.awk" <<'END'
BEGIN { while ((getline line <verbs) > 0) is_verb[line] = 1 }
FNR == 1 { inside = is_pending = 0 }
function lacks_verb(text, word) {
    sub(/^ *(Collective\. )?/, "", text)
    match(text, /^[A-Za-z]*/)
    return !(substr(text, 1, RLENGTH) in is_verb)
}
is_pending && first > 1 && FILENAME ~ /^(client|daemon|proto)\/.*\.h$/ && /\(/ && lacks_verb(text) &&
    /^(static|ENG_INLINE|const|struct|enum|unsigned|bool|int|void|u?int[0-9]+_t|char|double|float|size_t|json_t|FILE|eng_[a-z]+|mpz_t) / {
    print FILENAME ":" first ": no verb: " substr(text, 1, 50)
}
function asks(text) {
    return text ~ /^(Of|What|Whether|How) / || text ~ /\?$/ ||
        text ~ /^(Are|Can|Do|Does|Has|Have|Is|May|Need|Should|Where|Which) [^.]*\? /
}
is_pending && /^[A-Za-z_#]/ && asks(text) {
    print FILENAME ":" first ": " substr(text, 1, 60)
}
{ is_pending = 0 }
tolower($0) ~ /likewise/ { print FILENAME ":" FNR ": likewise" }
!inside && /^\/\*/ { inside = 1; text = ""; first = FNR }
inside {
    line = $0
    sub(/^ *\/?\*+ ?/, "", line)
    if (sub(/ *\*\/.*/, "", line)) { inside = 0; is_pending = 1 }
    text = text (text == "" ? "" : " ") line
    if (!inside) sub(/( *\[[a-z, ]+\])+$/, "", text)
}
END

# If this failed, a reader would have to turn a question into what the function does, or
# to look up what is meant.
{ cat "$work/files" && find bench client daemon proto tests ./*.md -name '*.md' -o \
    -name '*.scd' -o -name '*.def'; } | grep -v -e BOUNDS -e CHANGELOG |
    xargs awk -v verbs=tests/style/verbs.txt -f "$work/comments.awk" >"$work/log"
[ ! -s "$work/log" ]
tap_result $? comments__begin_with_a_verb "$work/log"

# If this failed, the case above could not fail.
printf '/* Is it\n * so? [any] */\nint a;\n/* Of b. */\nint b;\n/* Return d. */\nint d; /* likewise */\n/* Is it? So. */\nint e;\n' \
    >"$work/c.c"
mkdir "$work/proto" && printf '/* c */\n/* Return it. */\nint f(void);\n/* It is. */\nint g(void);\n' \
    >"$work/proto/c.h"
verbs=$PWD/tests/style/verbs.txt
(cd "$work" && awk -v verbs="$verbs" -f comments.awk c.c proto/c.h) >"$work/log"
[ "$(cut -d: -f2 "$work/log" | tr '\n' ,)" = 1,4,7,8,4, ]
tap_result $? comments__that_ask_are_found "$work/log"

tap_end
