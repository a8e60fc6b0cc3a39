#!/bin/bash
# bootstrap_check.sh - what ./bootstrap asks a system for before it builds (TAP).
#
# Room:     tests/dist.
# Does:     run a copy of it where all programs are false ones, which note how they are called:
#           with and without an apt-get, with and without what is needed.
# Does not: install or build anything: the false autoreconf ends it.

set -u
: "${top_srcdir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-bootstrap-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log
mkdir "$work/source" "$work/tools"
cp "$top_srcdir/bootstrap" "$work/source/"
for tool in sh awk tr dirname cat chmod find mkdir touch; do
    ln -s "$(command -v $tool)" "$work/tools/"
done

# false_program FOLDER NAME LINE
false_program() {
    mkdir -p "$work/$1"
    printf '#!/bin/sh\n%s\n' "$3" >"$work/$1/$2"
    chmod +x "$work/$1/$2"
}
false_program root id 'echo 0'
false_program user id 'echo 1000'
for tool in gcc cc make automake libtoolize python3 scdoc spin node npm; do
    false_program all $tool 'exit 0'
done
false_program all autoreconf "echo built >>$work/calls; exit 1"
false_program all pkg-config '[ "$2" != msgpack-c ]' # of some systems it is msgpack
false_program old pkg-config 'case $2 in msgpack*) exit 1 ;; esac'
false_program apt apt-get "echo \"\$@\" >>$work/calls"
false_program apt dpkg-query 'exit 1' # a name that is no package's any more

false_program demo autoreconf 'echo "#!/bin/sh" >configure; chmod +x configure'
false_program demo make "echo make \"\$@\" >>$work/calls
echo 'echo shown' >build/pccdctl; chmod +x build/pccdctl"

# bootstrap_with FOLDER...: with the programs of these; what was called is in calls.
what=
bootstrap_with() {
    local path= expected=1
    [ "$what" = '' ] || expected=0
    for folder in "$@"; do path=$path$work/$folder:; done
    : >"$work/calls"
    (cd "$work/source" && env -i PATH="$path$work/tools" "$work/tools/sh" ./bootstrap $what) \
        </dev/null >"$log" 2>&1
    [ $? -eq $expected ] && { echo "calls:"; cat "$work/calls"; } >>"$log"
}

bootstrap_with root apt all && [ "$(cat "$work/calls")" = built ]
# If it failed, each run would want root and a network, since a package has another name.
tap_result $? bootstrap__asks_for_nothing_that_is_there "$log"

bootstrap_with root apt old all &&
    grep -q '^install .* libmsgpack-dev$' "$work/calls" && tail -n 1 "$work/calls" | grep -q built
# If it failed, something would be missing, or more be installed than is missing.
tap_result $? bootstrap__installs_what_is_missing "$log"

bootstrap_with user apt old all && [ ! -s "$work/calls" ] &&
    grep -q 'library msgpack-c/msgpack (as root: apt-get install libmsgpack-dev)' "$log"
# If it failed, who may not install would not know what to ask for.
tap_result $? bootstrap__tells_a_user_what_root_has_to_install "$log"

bootstrap_with user && [ ! -s "$work/calls" ] &&
    grep -q 'missing: .*program autoreconf.*library libuv.*library cmocka' "$log" &&
    grep -q 'only on Debian' "$log" && ! grep -q 'not found' "$log"
# If it failed, users of other systems would learn of one thing at a time, by a failure.
tap_result $? bootstrap__names_all_that_is_missing_on_another_system "$log"

bootstrap_with user all && [ "$(cat "$work/calls")" = built ]
# If it failed, it would not build there although everything is there.
tap_result $? bootstrap__builds_on_another_system "$log"

what=demo
bootstrap_with user demo all && grep -q 'make .*demo-programs$' "$work/calls" &&
    [ "$(grep -c make "$work/calls")" -eq 1 ] && grep -q 'takes [1-9].* minutes' "$log" &&
    grep -q '^shown$' "$log"
# If it failed, the picture would wait for all that is not in it, and nobody would know how long.
tap_result $? bootstrap__builds_for_the_demo_what_it_needs "$log"

what=wheel
! bootstrap_with user demo all && [ ! -s "$work/calls" ] && grep -q 'missing: program patchelf ' "$log" &&
    false_program demo patchelf 'exit 0' && bootstrap_with user demo all &&
    tail -n 1 "$work/calls" | grep -q 'make .* wheel$'
# If it failed, the first command that README has for Python would end with what is missing.
tap_result $? bootstrap__makes_the_python_package "$log"

what=check
bootstrap_with user demo all # nothing has passed
for part in idle alone beside; do
    grep -q "make .*check-$part\$" "$work/calls" || echo "not run: check-$part"
done >>"$log"
! grep '^not run' "$log" && grep -q '^0 passed, 1 failed, 0 skipped$\|^0 passed, 0 failed, 0 skipped$' "$log"
# If it failed, a part of the tests would not be run, and nobody would know.
tap_result $? bootstrap__checks_by_all_three_parts "$log"

tap_end
