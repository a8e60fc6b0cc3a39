#!/bin/bash
# make_wheel.sh - the Python wheel: module, library, library for direct:, and daemon.
#
#   make_wheel.sh SOURCE BUILD INTO
#
# Room:     client/python; make wheel calls it.
# Does:     have setuptools pack what bundle.sh puts together. It asks for nothing over a
#           network.
# Needs:    python3 with setuptools and wheel, patchelf.

set -eu
source=$1 build=$2 into=$3
complain() {
    echo "make wheel: $1" >&2
    exit 1
}
python=
for candidate in "${PYTHON3-}" python3 /usr/bin/python3; do
    if [ -n "$candidate" ] && "$candidate" -c 'import setuptools, wheel' 2>/dev/null; then
        python=$candidate
        break
    fi
done
[ -n "$python" ] || complain "needs python3 with setuptools and wheel (Debian: python3-setuptools python3-wheel)"

stage=$build/python/wheel
rm -rf "$stage"
mkdir -p "$stage" "$into"
cp "$source/client/python/pyproject.toml" "$source/client/python/README.md" "$source/LICENSE" "$stage"
"$BASH" "$source/client/python/bundle.sh" "$build" "$stage/pccd" || exit 1

# It runs where the C library is not older than the one it was built with.
libc=$(ldd --version | sed -n '1s/.* \([0-9]*\)\.\([0-9]*\)$/\1_\2/p')
platform=manylinux_${libc:?the C library tells no version}_$(uname -m)
cd "$stage"
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$source" log -1 --format=%ct 2>/dev/null ||
    stat -c %Y "$source/configure.ac")}
export SOURCE_DATE_EPOCH
"$python" - "$platform" "$into" <<'END' >"$stage/log" 2>&1 || { cat "$stage/log" >&2; exit 1; }
import sys
from setuptools import build_meta

platform, into = sys.argv[1:]
options = ["--python-tag=py3", "--plat-name=" + platform]
print("made:", build_meta.build_wheel(into, {"--build-option": options}))
END
sed -n "s|^made: |$into/|p" "$stage/log"
