#!/bin/sh
# make_page.sh - the page of `pccdctl inspect`, or an empty file.
#
#   make_page.sh MODE SRCDIR OUT     in the folder of the build; NODE and NPM are programs
#
# MODE no: empty. auto: what the tarball brought, else bundled, else empty, with a message: a
# machine without npm, or without a network, builds all the rest. yes: bundled, or an error.
# What npm fetched stays in the build folder; later bundles need no network.

set -eu
mode=$1 source=$2/client/inspect out=$3
modules=client/inspect/npm

leave_out() {
    if [ "$mode" = yes ]; then
        echo "pccdctl inspect: $1" >&2
        exit 1
    fi
    echo "pccdctl inspect is left out: $1." >&2
    echo "  To have it: configure --with-inspect=yes where node (18 or later) and npm can be used" >&2
    : >"$out"
    exit 0
}

mkdir -p "$modules"
if [ "$mode" = no ]; then
    : >"$out"
    exit 0
fi
if [ "$mode" = auto ] && [ -s "$source/page.dist.html" ]; then
    cp "$source/page.dist.html" "$out"
    exit 0
fi
if [ -z "${NODE:-}" ] || [ -z "${NPM:-}" ]; then
    leave_out "there is no node, or no npm"
fi
if ! cmp -s "$source/package-lock.json" "$modules/fetched.json"; then
    cp "$source/package.json" "$source/package-lock.json" "$modules/"
    (cd "$modules" && "$NPM" ci --ignore-scripts --prefer-offline --no-audit --no-fund \
        --fetch-retries=1 --fetch-retry-mintimeout=1000 --fetch-timeout=60000 \
        --loglevel=error >npm.log 2>&1) ||
        leave_out "npm could not fetch what the page is made of ($PWD/$modules/npm.log)"
    cp "$source/package-lock.json" "$modules/fetched.json"
fi
"$NODE" "$source/build.mjs" "$modules" "$out.tmp" ||
    leave_out "the page could not be bundled"
mv "$out.tmp" "$out"
