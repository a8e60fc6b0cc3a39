#!/bin/bash
# site_pictures.sh - make the pictures of the recipes anew, by the commands of their pages.
#
# make site-pictures, after a change of what pccdctl draws.
set -u
: "${top_srcdir:?}" "${top_builddir:?}"
# shellcheck source=tests/python/find.sh
. "$top_srcdir/tests/python/find.sh"
# shellcheck source=tests/docs/recipe.sh
. "$top_srcdir/tests/docs/recipe.sh"

work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
export PCCD_DAEMON=$top_builddir/pccdd
[ -n "$python" ] || { echo "site_pictures: $no_python" >&2; exit 2; }
for page in "$top_srcdir"/client/man/site/*.md; do
    recipe=$(basename "$page" .md)
    [ -n "$(pictures "$recipe")" ] || continue
    if ! run_recipe "$recipe" "$work/$recipe" >"$work/log"; then
        tail "$work/log" >&2
        echo "site_pictures: $recipe: failed" >&2
        exit 1
    fi
    for picture in $(pictures "$recipe"); do
        cp "$work/$recipe/$picture" "$top_srcdir/client/man/site/"
    done
done
