#!/bin/bash
# dist_check.sh SOURCE TARBALL - is the tarball of a commit always the same?
#
# Room:     tests/dist.
# Does:     clone SOURCE twice, to folders of different names and with different umasks, make
#           dist in each at different times and compare; then look whether every file that git
#           tracks is in it. What is not committed is not in the clones, but what the page of
#           pccdctl inspect is made of, if it was fetched for this build, so that it is compared.

set -eu
source=$1 tarball=$2 modules=$PWD/client/inspect/npm
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# dist FOLDER UMASK: leaves FOLDER/build/TARBALL.
dist() (
    umask "$2"
    git clone -q "$source" "$work/$1"
    cd "$work/$1"
    autoreconf -fi >"$work/log" 2>&1 || { cat "$work/log" >&2 && exit 1; }
    mkdir -p build/client/inspect
    [ ! -d "$modules" ] || cp -R "$modules" build/client/inspect/npm
    cd build
    ../configure -q
    make dist >"$work/log" 2>&1 || { cat "$work/log" >&2 && exit 1; }
)

dist one 022
dist another-folder 077
if ! cmp "$work/one/build/$tarball" "$work/another-folder/build/$tarball"; then
    for folder in one another-folder; do
        tar -tvzf "$work/$folder/build/$tarball" --full-time >"$work/$folder.list"
    done
    diff "$work/one.list" "$work/another-folder.list" >&2 || :
    echo "dist_check: two tarballs of one commit differ" >&2
    exit 1
fi

git -C "$work/one" ls-files | LC_ALL=C sort >"$work/tracked"
tar -tzf "$work/one/build/$tarball" | sed 's|^[^/]*/||' | LC_ALL=C sort >"$work/packed"
if LC_ALL=C comm -23 "$work/tracked" "$work/packed" | grep . >&2; then
    echo "dist_check: tracked, and not in the tarball; see dist-tracked in Makefile.am" >&2
    exit 1
fi
sha256sum "$work/one/build/$tarball" | sed "s|$work/one/build/||"
