#!/bin/bash
# container_check.sh - the recipe of the container, as far as it can be judged without making one
# (TAP).
#
# Room:     tests/dist.
# Does:     compare the packages that it names with what the programs load and configure wants;
#           start the daemon as its entry does, in a folder that anybody may write to.
# Does not: build it: that takes docker and a network (daemon/container/Dockerfile says how).

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCDCTL:?}" "${PCCDD:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-container-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log
recipe=$top_srcdir/daemon/container/Dockerfile
unset PCCD_URL

# packages_of N: what stage N of the recipe installs.
packages_of() {
    awk -v stage="$1" '/^FROM / { n++ } n == stage' "$recipe" |
        sed -n '/apt-get install/,/rm -rf/p' | tr ' ' '\n' |
        grep -E '^[a-z0-9][a-z0-9+.-]+$' | grep -vxE 'apt-get|install|update|rm' | sort -u
}

name=container__installs_what_its_programs_load
# Packages of libraries have other names in each Debian: only that of the recipe can tell.
debian=$(sed -n 's/^FROM debian:\([a-z]*\)-slim$/\1/p' "$recipe")
here=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
if [ "$here" != "$debian" ] || ! command -v dpkg-query >/dev/null; then
    tap_skip $name "the recipe is for Debian $debian, here is ${here:-another system}"
elif nm -D "$top_builddir/.libs/libpccd.so.0" | grep -qE '__(a|ub|t)san_'; then
    tap_skip $name "the build has a sanitiser in it"
else
    for file in "$PCCDD" "$PCCDCTL" "$top_builddir/.libs/libpccd-direct.so.0"; do
        ldd "$file" | awk '$2 == "=>" { print $3 }'
    done | sort -u | while read -r library; do
        folder=${library%/*}
        dpkg-query -S "*/${folder##*/}/${library##*/}" 2>/dev/null | sed 's/:.*//; q'
    done | grep -vxE 'libc6|libgcc-s1|zlib1g' | sort -u >"$work/loaded"
    packages_of 2 | grep -vx 'libgcc-s1' >"$work/installed"
    diff "$work/loaded" "$work/installed" >"$log" && [ -s "$work/loaded" ]
    # If it failed, the daemon would not start there, or it would carry what nobody needs.
    tap_result $? $name "$log"
fi

# What ./bootstrap cannot do without.
sed -n "/^needs='/,/'$/s/^[a-z]*:[^ ]*  *\([^']*\).*/\1/p" "$top_srcdir/bootstrap" | sort -u >"$work/wanted"
packages_of 1 >"$work/installed"
diff "$work/wanted" "$work/installed" >"$log" && [ -s "$work/wanted" ]
# If it failed, configure would stop there, in front of somebody who wanted no compiler.
tap_result $? container__builds_with_what_bootstrap_installs "$log"

# The entry, with the folder of the volume.
mkdir -m 1777 "$work/volume"
entry=$(sed -n 's/^ENTRYPOINT \[\(.*\)\]$/\1/p' "$recipe" | tr -d '",' |
    sed "s|/run/pccd/|$work/volume/|; s|^pccdd|$PCCDD|")
# shellcheck disable=SC2086 # words
$entry >"$log" 2>&1 &
daemon=$!
health=$(sed -n 's/^HEALTHCHECK .*CMD \[\(.*\)\]$/\1/p' "$recipe" | tr -d '",' | sed "s|^pccdctl|$PCCDCTL|")
status=1
for _ in $(seq 100); do
    # shellcheck disable=SC2086 # words
    PCCD_URL=unix:$work/volume/pccd.sock $health >>"$log" 2>&1 && status=0 && break
    sleep 0.1
done
kill -TERM $daemon 2>>"$log"
wait $daemon || status=1
# If it failed, the container would end at once, or be taken for ill.
tap_result $status container__serves_in_its_volume "$log"

tap_end
