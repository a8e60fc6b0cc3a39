#!/bin/sh
# fetch_modules.sh - what the page of `pccdctl inspect` is bundled from, by npm.
#
#   fetch_modules.sh SRCDIR      in the folder of the build
#
# The only thing here that asks a network. ./bootstrap runs it, and make_page.sh where configure
# was given --with-inspect=fetch. What it has fetched stays in client/inspect/npm; while that is
# what package-lock.json names, nothing is fetched again. Fails with one line that says why.

set -eu
source=$1/client/inspect
modules=client/inspect/npm

if cmp -s "$source/package-lock.json" "$modules/fetched.json"; then
    exit 0
fi
if ! node -e 'process.exit(parseInt(process.versions.node) < 18 ? 1 : 0)' 2>/dev/null ||
    ! command -v npm >/dev/null; then
    echo "there is no node (18 or later) with npm; on Debian: apt-get install nodejs npm" >&2
    exit 1
fi
mkdir -p "$modules"
rm -f "$modules/fetched.json"
cp "$source/package.json" "$source/package-lock.json" "$modules/"
(cd "$modules" && npm ci --ignore-scripts --prefer-offline --no-audit --no-fund \
    --fetch-retries=1 --fetch-retry-mintimeout=1000 --fetch-timeout=60000 \
    --loglevel=error >npm.log 2>&1) || {
    echo "npm could not fetch what it is made of ($PWD/$modules/npm.log)" >&2
    exit 1
}
cp "$source/package-lock.json" "$modules/fetched.json"
[ -s client/inspect/page.html ] || rm -f client/inspect/page.html # made without
