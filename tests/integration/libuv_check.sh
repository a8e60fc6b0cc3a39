#!/bin/bash
# libuv_check.sh - the daemon in its sandbox, over the libuv of each Debian (TAP).
#
# What libuv asks of the kernel differs from one to the next, and only a call that the sandbox
# forbids shows it. Without mmdebstrap or a network this is skipped, by name.

set -u
: "${top_srcdir:?is set by make check}" "${PCCDD:?}" "${PCCDCTL:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-libuv-XXXXXX") || exit 99
trap 'rm -rf --one-file-system "$work"' EXIT
log=$work/log
unset PCCD_URL
export GOMP_SPINCOUNT=2000 # else the daemon would start /proc/self/exe anew, which may be a loader

printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv .2 .2 1\nv .3 .2 4\nv .2 .3 4\nf 1 2 3\nf 4 5 6\n' >"$work/a.obj"
sed 's/ 1$/ -1/; s/ 4$/ 2/' "$work/a.obj" >"$work/b.obj"

# What this machine's apt is told of old lists holds for the other Debian's, too.
for option in Acquire::Check-Valid-Until Acquire::Check-Date; do
    apt-config dump $option 2>/dev/null | grep -i '"false"'
done >"$work/apt.conf"

# fetch SUITE: its libuv to $work/SUITE/libuv.so.1.
fetch() {
    local root=$work/$1.root keyring=/usr/share/keyrings/debian-archive-keyring.gpg
    [ -e $keyring ] || keyring=
    timeout 300 mmdebstrap --quiet --variant=extract --include=libuv1 \
        --aptopt="$work/apt.conf" ${keyring:+--keyring=$keyring} "$1" "$root" >"$log" 2>&1 &&
        mkdir "$work/$1" && cp "$root"/usr/lib/*/libuv.so.1 "$work/$1/"
}

# serves SUITE
serves() {
    local uv=$work/$1 socket=$work/$1.sock status=1 daemon loader libc
    local -a command=(env LD_LIBRARY_PATH="$uv" "$PCCDD")
    if ! "${command[@]}" --version >"$log" 2>&1; then
        # It wants a newer C library than is here: that, and whatever else is here.
        libc=$(find "$work/$1.root" -name libc.so.6 | head -n 1)
        loader=$(find "$work/$1.root" -name 'ld-linux*.so.*' | head -n 1)
        command=("$loader" --library-path "$uv:${libc%/*}" "$PCCDD")
    fi
    "${command[@]}" --socket "$socket" --sandbox on --threads 2 >"$log" 2>&1 &
    daemon=$!
    for _ in $(seq 100); do
        [ ! -S "$socket" ] && kill -0 $daemon 2>/dev/null || break
        sleep 0.1
    done
    if grep -q "$uv/libuv.so.1" /proc/$daemon/maps 2>>"$log"; then
        PCCD_URL=unix:$socket timeout 60 "$PCCDCTL" check --json \
            "$work/a.obj" "$work/b.obj" >>"$log" 2>&1
        [ $? -eq 1 ] && status=0 # something meets
    fi
    kill -TERM $daemon 2>>"$log"
    wait $daemon || status=1
    [ ! -e "$socket" ] || status=1
    return $status
}

for suite in bookworm trixie sid; do
    name=libuv__of_debian_${suite}_serves_in_the_sandbox
    if ! ldd "$PCCDD" | grep -q libseccomp || nm -D "$PCCDD" | grep -qE '__(a|ub|t)san_'; then
        tap_skip $name "no sandbox in this build"
    elif ! command -v mmdebstrap >/dev/null; then
        tap_skip $name "no mmdebstrap"
    elif ! fetch $suite; then
        tap_skip $name "it cannot be fetched: $(tail -n 1 "$log" | tr -d '#')"
    else
        serves $suite
        # If it failed, pccd would not start on that Debian.
        tap_result $? $name "$log"
    fi
done

tap_end
