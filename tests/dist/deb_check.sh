#!/bin/bash
# deb_check.sh SOURCE RESULT - build Debian's packages of SOURCE and have lintian judge them.
#
# Room:     tests/dist.
# Does:     build in a copy, which is removed; the packages are left in the folder RESULT.
#           Nothing is installed. DEB_BUILD_OPTIONS as for dpkg-buildpackage: nocheck,
#           parallel=N. Fails on what lintian calls an error or a warning.

set -eu
source=$1 result=$2

for tool in dpkg-buildpackage dh dh_python3 lintian; do
    command -v $tool >/dev/null || {
        echo "deb_check: no $tool (apt-get install dpkg-dev debhelper dh-python lintian)" >&2
        exit 1
    }
done

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/pccd"
cd "$source"
if git rev-parse --show-toplevel >/dev/null 2>&1; then
    git ls-files -co --exclude-standard
else
    find . -name build -prune -o -type f -print # an unpacked tarball
fi | tar -cf - --verbatim-files-from -T - | tar -xf - -C "$work/pccd"

# The page of pccdctl inspect, as a tarball has it: a package fetches nothing.
page=${result%/*}/client/inspect/page.html
[ ! -s "$page" ] || cp "$page" "$work/pccd/client/inspect/page.dist.html"

cd "$work/pccd"
: "${DEB_BUILD_OPTIONS:=parallel=$(nproc)}"
export DEB_BUILD_OPTIONS
dpkg-buildpackage -us -uc -b
rm -rf "$result"
mkdir -p "$result"
cp "$work"/*.deb "$work"/*.changes "$work"/*.buildinfo "$result"
run_as_root=()
[ "$(id -u)" -ne 0 ] || run_as_root=(--allow-root)
lintian "${run_as_root[@]}" --fail-on error,warning --info "$result"/*.changes
echo "deb_check: $(find "$result" -name '*.deb' | wc -l) packages in $result"
