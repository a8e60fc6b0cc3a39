#!/bin/bash
# size.sh - counts what somebody new to the tree has to learn: a name and a number a line.
#
#   size.sh            the figures of the tree in $top_srcdir
#   size.sh BASELINE   the same beside those of a file of lines `name figure slack`; fails if a
#                      figure is more than the slack above its baseline
#   size.sh --write BASELINE   write them there; the slacks stay
set -u
: "${top_srcdir:=.}"
cd "$top_srcdir" || exit 99

files() { # FOLDERS... -- FIND-TESTS...
    local folders=()
    while [ "$1" != -- ]; do folders+=("$1"); shift; done
    shift
    find "${folders[@]}" -type f \( "$@" \) ! -path '*/corpus/*' ! -path '*/results/*' \
        ! -path '*/node_modules/*' ! -name package-lock.json ! -name '*.dist.*' | LC_ALL=C sort
}
code=(-name '*.[ch]' -o -name '*.hpp' -o -name '*.cc' -o -name '*.py' -o -name '*.js' -o -name '*.mjs'
    -o -name '*.css' -o -name '*.html' -o -name '*.sh' -o -name '*.mk' -o -name '*.def' -o -name '*.am'
    -o -name '*.ac' -o -name '*.awk' -o -name '*.inl' -o -name '*.sym' -o -name '*.map' -o -name '*.pml')
product=(daemon client proto bench debian configure.ac Makefile.am bootstrap)
c_files=(-name '*.[ch]' -o -name '*.cc' -o -name '*.hpp')

lines() { xargs -r cat | wc -l; }

# Lines of prose: no tables, headings, code, links, pictures, synopses or examples.
prose() {
    files README.md CONTRIBUTING.md daemon client proto bench tests -- -name '*.md' -o -name '*.scd' |
        xargs awk '
            FNR == 1 { is_code = is_examples = 0 }
            /^# / { is_examples = /^# EXAMPLES/ }
            is_examples && /^\t/ { next }
            /^ *```/ { is_code = !is_code }
            !is_code && !/^ *\|/ && !/^\t*[|[]/ && !/^(    |#|!)/ && !/https?:|\+\+$/ { print }'
}

figures() {
    echo "product_lines $(files "${product[@]}" -- "${code[@]}" -o -name bootstrap -o -path bench/compare | lines)"
    echo "product_files $(files "${product[@]}" -- "${code[@]}" -o -name bootstrap -o -path bench/compare | wc -l)"
    echo "small_files $(files "${product[@]}" -- "${c_files[@]}" | xargs wc -l | awk '$2 != "total" && $1 < 60' | wc -l)"
    echo "engine_lines $(files daemon/engine -- "${code[@]}" | lines)"
    echo "engine_headers $(files daemon/engine -- -name '*.h' | wc -l)"
    echo "test_lines $(files tests -- "${code[@]}" | lines)"
    echo "test_files $(files tests -- "${code[@]}" | wc -l)"
    # Structs that several files may share.
    echo "header_structs $(files "${product[@]}" -- -name '*.h' -o -name '*.hpp' |
        xargs grep -hE '^(typedef )?(struct|union)( [a-z_0-9]+)? \{' | wc -l)"
    # Definitions of functions with 7 parameters and more.
    echo "wide_functions $(files "${product[@]}" -- -name '*.[ch]' | xargs awk '
        /^[a-z].*\(/ && !/[;=]$/ { head = ""; is_head = 1 }
        is_head { head = head $0 }
        is_head && (/[;=]$/ || /^}/) { is_head = 0 }
        /^[{]$/ && is_head {
            is_head = depth = commas = most = 0
            for (i = 1; i <= length(head); i++) {
                c = substr(head, i, 1)
                if (c == "(" && depth++ == 0) commas = 0
                if (c == ")" && --depth == 0 && commas > most) most = commas
                if (c == "," && depth == 1) commas++
            }
            wide += most >= 6
        }
        END { print wide + 0 }')"
    echo "page_lines $(files README.md CONTRIBUTING.md daemon client proto bench tests -- -name '*.md' -o -name '*.scd' | lines)"
    echo "readme_lines $(lines <<<README.md)"
    echo "prose_columns $(prose | LC_ALL=C.UTF-8 wc -L)"
    echo "glossary_rows $(awk '/^## /{ is_on = $0 == "## Words" } is_on && /^\| / && !/^\| Word/' CONTRIBUTING.md | wc -l)"
}

if [ $# -eq 0 ]; then
    figures
    exit
fi
if [ "$1" = --write ]; then
    figures | awk '
        FNR == NR && /^#/ { print }
        FNR == NR { slack[$1] = $3; next }
        { print $1, $2, slack[$1] + 0 }' "$2" - >"$2.new" && mv "$2.new" "$2"
    exit
fi
figures | awk '
    FNR == NR { if (!/^#/) { baseline[$1] = $2; slack[$1] = $3 } next }
    {
        is_grown = !($1 in baseline) || $2 > baseline[$1] + slack[$1]
        printf "%-18s %7d  baseline %7d%s\n", $1, $2, baseline[$1], is_grown ? "  GROWN" : ""
        grown += is_grown
    }
    END { exit grown > 0 }' "$1" -
