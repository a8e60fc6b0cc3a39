#!/bin/bash
# test_make_page.sh - where the page of pccdctl inspect comes from in a build (TAP).
#
# Room:     tests/inspect.
# Does:     run client/inspect/make_page.sh in a folder of its own, with an npm in the path that
#           notes that it was run and fails, as one without a network does.
set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-page-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log
source=$top_srcdir
mkdir "$work/bin" "$work/build" && cd "$work/build" || exit 99
printf '#!/bin/sh\necho "$@" >>%s/asked\nexit 1\n' "$work" >"$work/bin/npm"
chmod +x "$work/bin/npm"
PATH=$work/bin:$PATH

# page MODE: status in $status, what it says in $log, the page in page.html.
page() {
    rm -f page.html
    sh "$source/client/inspect/make_page.sh" "$1" "$source" page.html >"$log" 2>&1
    status=$?
}
is_left_out() { [ $status -eq 0 ] && [ -e page.html ] && [ ! -s page.html ]; }

# An unpacked tarball brings the page; a clone does not.
mkdir -p "$work/clone/client" "$work/tarball/client"
cp -R "$top_srcdir/client/inspect" "$work/clone/client/"
rm -f "$work/clone/client/inspect/page.dist.html"
cp -R "$work/clone/client/inspect" "$work/tarball/client/"
echo '<html>' >"$work/tarball/client/inspect/page.dist.html"
source=$work/clone

page auto
is_left_out && [ "$(wc -l <"$log")" -eq 1 ] && grep -q 'left out: .* --with-inspect=fetch does' "$log" &&
    page no && is_left_out && [ ! -s "$log" ] && page yes && [ $status -ne 0 ] && [ ! -e page.html ] &&
    [ ! -e "$work/asked" ]
# If it failed, make would ask a network for something, or nobody would know what is missing.
tap_result $? page__make_fetches_nothing "$log"

page fetch
if command -v node >/dev/null; then
    [ $status -ne 0 ] && grep -q 'npm could not fetch .*npm.log' "$log" && grep -q '^ci ' "$work/asked"
else
    [ $status -ne 0 ] && grep -q 'no node (18 or later)' "$log"
fi
# If it failed, who asks for the page would get a build without it.
tap_result $? page__that_is_asked_for_is_fetched_or_an_error "$log"

source=$work/tarball
rm -f "$work/asked"
page auto
[ $status -eq 0 ] && cmp page.html "$source/client/inspect/page.dist.html" && [ ! -e "$work/asked" ]
# If it failed, a package would be built without the page that its tarball has.
tap_result $? page__of_a_tarball_is_taken "$log"

name=page__is_bundled_from_what_was_fetched
source=$work/clone
if ! cmp -s "$top_srcdir/client/inspect/package-lock.json" \
    "$top_builddir/client/inspect/npm/fetched.json"; then
    tap_skip $name "nothing was fetched for this build"
else
    rm -rf client/inspect/npm && cp -R "$top_builddir/client/inspect/npm" client/inspect/ &&
        page yes && [ $status -eq 0 ] && cmp page.html "$top_builddir/client/inspect/page.html" &&
        [ ! -e "$work/asked" ] && echo >>"$source/client/inspect/package-lock.json" && page auto &&
        is_left_out
    # If it failed, a page would be fetched again for each build, or made of something else than
    # package-lock.json names.
    tap_result $? $name "$log"
fi

tap_end
