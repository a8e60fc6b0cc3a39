#!/bin/bash
# make_wheel.sh - the Python wheel: module, library, library for direct:, and daemon.
#
#   make_wheel.sh SOURCE BUILD INTO
#
# Room:     client/python; make wheel calls it.
# Does:     put together a folder of what was built and of the libraries that it needs and that
#           not every Linux has, let these be looked for beside it, and have setuptools pack it.
#           It asks for nothing over a network.
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
command -v patchelf >/dev/null || complain "needs patchelf (Debian: patchelf)"
! nm -D "$build/.libs/libpccd.so.0" | grep -qE '__(a|ub|t)san_' ||
    complain "this build has a sanitiser in it"

stage=$build/python/wheel
rm -rf "$stage"
mkdir -p "$stage/pccd/libs" "$stage/pccd/licenses" "$into"
cp "$source/client/python/pyproject.toml" "$source/client/python/README.md" "$source/LICENSE" "$stage"
cp -L "$build"/python/pccd/*.py "$build/python/pccd/py.typed" "$stage/pccd"
for file in libpccd.so.0 libpccd-direct.so.0; do
    cp -L "$build/.libs/$file" "$stage/pccd"
done
cp -L "$build/pccdd" "$stage/pccd"

# What is loaded with them, but for the C library, which comes with the system.
for file in "$stage"/pccd/libpccd*.so.0 "$stage/pccd/pccdd"; do
    ldd "$file" | awk '$2 == "=>" { print $3 }'
done | sort -u | grep -vE '/(ld-linux[^/]*|lib(c|m|dl|rt|pthread|gcc_s))\.so\.[0-9]+$' |
    while read -r library; do
        cp -L "$library" "$stage/pccd/libs"
        owner=$(dpkg -S "$(readlink -f "$library")" 2>/dev/null | sed 's/:.*//; q')
        if [ -n "$owner" ] && [ -e "/usr/share/doc/$owner/copyright" ]; then
            cp "/usr/share/doc/$owner/copyright" "$stage/pccd/licenses/$owner"
        fi
    done
for file in "$stage"/pccd/libpccd*.so.0 "$stage/pccd/pccdd"; do
    strip --strip-unneeded "$file"
    patchelf --set-rpath '$ORIGIN/libs' "$file"
done
for file in "$stage"/pccd/libs/*; do
    patchelf --set-rpath '$ORIGIN' "$file"
done

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
