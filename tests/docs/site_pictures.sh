#!/bin/bash
# site_pictures.sh - make the pictures of the recipes anew, by the commands of their pages; the
# film of README by those of client/README.md.
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

ln -s "$top_builddir" "$work/build"
sed -nE 's/^    (build\/pccdctl (record -o demo\.rec|render -o cloth\.apng) .*)/\1/p' \
    "$top_srcdir/client/README.md" >"$work/film"
if ! (cd "$work" && bash -e film) >"$work/log" 2>&1; then
    tail "$work/log" >&2
    echo "site_pictures: the film of README: failed" >&2
    exit 1
fi
cp "$work/cloth.apng" "$top_srcdir/client/ctl/picture/"
