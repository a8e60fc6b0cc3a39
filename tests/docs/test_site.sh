#!/bin/bash
# test_site.sh - the site that make site builds (TAP).
#
# Room:     tests/docs.
# Does:     build it, as make does, and look at it with check_site.py: links, what it asks of a
#           network, how wide it is on a phone; a link that leads nowhere ends make site; run the
#           programs and commands of each recipe as written.
# Needs:    PCCDCTL, PCCD_DAEMON, top_srcdir and top_builddir, set by `make check`.
set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCDCTL:?}" "${PCCD_DAEMON:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
# shellcheck source=tests/python/find.sh
. "$top_srcdir/tests/python/find.sh"
# shellcheck source=tests/docs/recipe.sh
. "$top_srcdir/tests/docs/recipe.sh"

work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-site-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log
site=$top_srcdir/client/man/site
PYTHONPATH=$PYTHONPATH:$top_srcdir/tests/docs:$top_srcdir/tests/inspect

# ---- the recipes ------------------------------------------------------------------------

for recipe in index cloth game edge robot jam bake replay share; do
    # If it failed, a reader would type it and be let down, or see a picture that it does not make.
    name=site__recipe_${recipe}_works_as_written
    if [ -z "$python" ]; then
        tap_skip "$name" "$no_python"
        continue
    fi
    mkdir "$work/$recipe"
    run_recipe "$recipe" "$work/$recipe" >"$work/$recipe/log" && [ -n "$(pictures "$recipe")" ]
    tap_result $? "$name" "$work/$recipe/log"
done
# says RECIPE LINE: it printed a line like this.
says() { grep -q -- "$2" "$work/$1/log" || { echo "$1 does not say: $2" && return 1; }; }
# film_begins RECIPE RECORDING: its film, all of which some viewers show is the first picture, begins
# with a step in which something meets.
film_begins() {
    local step
    step=$(sed -nE 's/.* --steps ([0-9]+)\.\. .*\.apng .*/\1/p' "$site/$1.md")
    "$PCCDCTL" export --list "$work/$1/$2" | grep "^step $step: [1-9]" || { echo "$1: step $step?" && return 1; }
}
# If it failed, the text of a recipe would promise what its reader does not see.
if [ -n "$python" ]; then
    {
        says index '^vf,3,0,1,2,0[.]\(5\|49\)' &&
            says game '^[1-9][0-9]* hits on the ground, [1-9][0-9]* of two rocks$' &&
            says robot '^edge *line 1: jams' && says robot '^edge *line 2: free$' &&
            says cloth '^100 frames, nothing intersects$' && film_begins cloth cloth.rec && film_begins game bounce.rec &&
            says edge '^free: the whole turn$' && says edge '^free to 84[.]5766 degrees$' &&
            says edge '^.0[.] 0[.]. .-2[.]  1[.]. free$' && says edge 'free to 0[.]1284 of the way$' &&
            says jam ' jams *at 1[.]462 rad' && says jam ' hinge 0 to 1[.]39[0-9]* rad .*: free' &&
            awk '/ bake_.* [1-9][0-9]* \(/ { print $2; exit }' "$work/bake/log" | grep -x 'bake_007.obj:' &&
            says replay '^frame 70 has [0-9]* contacts: what is wrong?$' &&
            says replay '100 the same, 0 not$' && says replay '^PASS: 1 step' &&
            [ "$(grep -c '^plate: step [0-9]* contacts: 0$' "$work/share/log")" -eq 9 ] &&
            says share '^plate: step 7 contacts: 1$' && says share '^needle: step 7 contacts: 1$'
    } >"$log" 2>&1
    tap_result $? site__recipes_find_what_they_say "$log"
else
    tap_skip site__recipes_find_what_they_say "$no_python"
fi

# ---- the site ---------------------------------------------------------------------------

maker=
for candidate in "${PYTHON-}" python3 /usr/bin/python3; do
    if [ -n "$candidate" ] && "$candidate" -c 'import markdown' 2>/dev/null; then
        maker=$candidate
        break
    fi
done
if [ -z "$maker" ] || ! command -v mandoc >/dev/null || [ ! -s "$top_builddir/client/man/pccd.7" ]; then
    for name in leads_somewhere asks_nobody has_every_document has_every_function \
        finds_what_is_searched fits_a_phone refuses_a_lost_link; do
        tap_skip "site__$name" "needs python3-markdown, mandoc and scdoc"
    done
    tap_end
    exit
fi
"$maker" "$site/make_site.py" "$top_srcdir" "$top_builddir" "$work/site" >"$log" 2>&1 ||
    tap_result 1 site__is_built "$log"
SITE=$work/site "$maker" "$top_srcdir/tests/python/tap.py" check_site >"$work/tap" 2>&1
sed -n 's/^/# /p' "$work/tap" >"$log"
while read -r good name; do
    tap_result "$good" "$name" "$log"
done < <(sed -n 's/^ok [0-9]* - \([^ ]*\)$/0 \1/p; s/^not ok [0-9]* - \([^ ]*\).*/1 \1/p' "$work/tap")
while read -r name why; do
    tap_skip "$name" "$why"
done < <(sed -n 's/^ok [0-9]* - \([^ ]*\) # SKIP */\1 /p' "$work/tap")

# If it failed, a page would be renamed, and readers of the others be led to nothing.
mkdir -p "$work/source" && cp -r "$top_srcdir"/{client,proto,bench,tests,README.md} "$work/source" &&
    sed -i 's/(edge.md)/(hedge.md)/; s/#thickness)/#thinness)/' "$work/source/client/man/site/"*.md
! "$maker" "$site/make_site.py" "$work/source" "$top_builddir" "$work/lost" >"$log" 2>&1 &&
    grep -q 'index.md: no client/man/site/hedge.md' "$log" &&
    grep -q 'cloth.md: no headline thinness in guide.html' "$log"
tap_result $? site__refuses_a_lost_link "$log"

tap_end
