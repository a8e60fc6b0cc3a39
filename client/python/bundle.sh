#!/bin/bash
# bundle.sh - the Python module as a folder that needs nothing but Python and the C library.
#
#   bundle.sh BUILD INTO
#
# Room:     client/python; make_wheel.sh and client/blender/make_addon.sh call it.
# Does:     put module, library, library for direct: and daemon into the folder INTO, with the
#           libraries that these need and that not every Linux has, which they look for beside
#           themselves.
# Needs:    patchelf.

set -eu
build=$1 into=$2
complain() {
    echo "bundle.sh: $1" >&2
    exit 1
}
command -v patchelf >/dev/null || complain "needs patchelf (Debian: patchelf)"
! nm -D "$build/.libs/libpccd.so.0" | grep -qE '__(a|ub|t)san_' ||
    complain "this build has a sanitiser in it"

mkdir -p "$into/libs" "$into/licenses"
cp -L "$build"/python/pccd/*.py "$build/python/pccd/py.typed" "$into"
for file in libpccd.so.0 libpccd-direct.so.0 libpccd-mpi.so.0; do
    # The last one only where it was built; MPI itself is the user's.
    [ "$file" = libpccd-mpi.so.0 ] && [ ! -e "$build/.libs/$file" ] ||
        cp -L "$build/.libs/$file" "$into"
done
cp -L "$build/pccdd" "$into"

# What is loaded with them, but for the C library, which comes with the system.
for file in "$into"/libpccd{,-direct}.so.0 "$into/pccdd"; do
    ldd "$file" | awk '$2 == "=>" { print $3 }'
done | sort -u | grep -vE '/(ld-linux[^/]*|lib(c|m|dl|rt|pthread|gcc_s))\.so\.[0-9]+$' |
    while read -r library; do
        cp -L "$library" "$into/libs"
        owner=$(dpkg -S "$(readlink -f "$library")" 2>/dev/null | sed 's/:.*//; q')
        if [ -n "$owner" ] && [ -e "/usr/share/doc/$owner/copyright" ]; then
            cp "/usr/share/doc/$owner/copyright" "$into/licenses/$owner"
        fi
    done
for file in "$into"/libpccd*.so.0 "$into/pccdd"; do
    strip --strip-unneeded "$file"
    patchelf --set-rpath '$ORIGIN/libs:$ORIGIN' "$file"
done
for file in "$into"/libs/*; do
    patchelf --set-rpath '$ORIGIN' "$file"
done
