#!/bin/sh
# make_page.sh - the page of `pccdctl inspect`, or an empty file.
#
#   make_page.sh MODE SRCDIR OUT     in the folder of the build
#
# MODE no: empty. auto: what the tarball brought, else bundled from what fetch_modules.sh has
# fetched, else empty, with a message. yes: the same, or an error. fetch: fetched where it is not
# there, and bundled, or an error. Without that no network is asked for anything.

set -eu
mode=$1 source=$2/client/inspect out=$3
modules=client/inspect/npm

leave_out() {
    case $mode in
    yes | fetch)
        echo "pccdctl inspect: $1" >&2
        exit 1
        ;;
    esac
    echo "pccdctl inspect is left out: $1" >&2
    : >"$out"
    exit 0
}

mkdir -p client/inspect
if [ "$mode" = no ]; then
    : >"$out"
    exit 0
fi
if [ "$mode" != fetch ] && [ -s "$source/page.dist.html" ]; then
    cp "$source/page.dist.html" "$out"
    exit 0
fi
if [ "$mode" = fetch ]; then
    why=$(sh "$source/fetch_modules.sh" "$2" 2>&1) || leave_out "$why"
fi
cmp -s "$source/package-lock.json" "$modules/fetched.json" ||
    leave_out "what it is made of was not fetched; ./bootstrap or configure --with-inspect=fetch does"
node "$source/build.mjs" "$modules" "$out.tmp" ||
    leave_out "node could not bundle it"
mv "$out.tmp" "$out"
