#!/bin/bash
# test_abi_headers.sh - the installed headers and the library's symbols, as a user meets them.
#
# Compiles each installed header alone, as C11 and as C++, and compares what libpccd.so
# exports with libpccd.map and with the declarations of pccd.h.

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?is set by make check}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
mkdir "$work/include"
cp "$top_srcdir"/client/lib/pccd{,_batch,_near,_points,_rays,_turning,_weld}.h "$top_srcdir"/proto/common/pccd_*.h "$work/include"
strict="-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -fsyntax-only -I$work/include"

# The first of its arguments that is a command.
first_of() {
    for command in "$@"; do
        command -v "$command" >/dev/null 2>&1 && printf '%s' "$command" && return
    done
}

# If this failed, a program could not include the header first, or at all.
compiles_alone() {
    local header=$1 name=$2 suffix=$3
    shift 3
    printf '#include <%s>\n#include <%s>\nint pccd_test_unit;\n' "$header" "$header" \
        >"$work/unit.$suffix"
    # shellcheck disable=SC2086 # the flags are words
    "$@" $strict "$work/unit.$suffix" >"$work/log" 2>&1
    tap_result $? "headers__${header%.h}_compiles_alone_as_$name" "$work/log"
}

cxx=$(first_of "${CXX-}" g++ clang++ c++)
for header in pccd.h pccd_batch.h pccd_near.h pccd_points.h pccd_rays.h pccd_turning.h pccd_weld.h pccd_daemon.h pccd_trace.h pccd_types.h; do
    # shellcheck disable=SC2086 # CC may hold flags
    compiles_alone $header c11 c ${CC-cc} -std=c11
    for standard in c++11 c++17; do
        if [ -n "$cxx" ]; then
            compiles_alone $header "${standard/c++/cxx}" cc "$cxx" "-std=$standard"
        else
            tap_skip "headers__${header%.h}_compiles_alone_as_${standard/c++/cxx}" \
                "no C++ compiler"
        fi
    done
done

# If this failed, a type of ours would hide behind a function of its name, and a C++ program
# would have to write struct before it.
if [ -n "$cxx" ]; then
    {
        echo '#include <pccd.h>'
        cat "$work"/include/*.h | sed -n 's/^struct \(pccd_[a-z0-9_]*\) {$/\1 *test_\1;/p'
    } >"$work/names.cc"
    # shellcheck disable=SC2086 # the flags are words
    "$cxx" -std=c++11 $strict "$work/names.cc" >"$work/log" 2>&1 &&
        [ "$(grep -c test_ "$work/names.cc")" -gt 20 ]
    tap_result $? headers__name_types_as_nothing_else "$work/log"
else
    tap_skip headers__name_types_as_nothing_else "no C++ compiler"
fi

library=$top_builddir/.libs/libpccd.so
map=$top_srcdir/client/lib/libpccd.map
sed -n 's/^ *\(pccd_[a-z0-9_]*\);$/\1/p' "$map" | LC_ALL=C sort >"$work/map"
if [ -e "$library" ]; then
    nm -D --defined-only "$library" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' |
        LC_ALL=C sort >"$work/exported"
    # Those of client/lib/mpi_hooks.h, which are for libpccd-mpi alone, have a version of their own.
    { cat "$work/map" && printf 'cli_mpi_%s\n' expect lend lent own threads watch weigh write; } | LC_ALL=C sort |
        diff - "$work/exported" >"$work/log" 2>&1 &&
        [ "$(nm -D "$library" | grep -c 'cli_mpi_[a-z]*@@PCCD_PRIVATE$')" -eq 8 ]
    # If this failed, a symbol came or went unnoticed, or a private one leaked.
    tap_result $? symbols__are_those_of_the_map "$work/log"
    readelf -d "$library" >"$work/log" && grep -q 'SONAME.*\[libpccd\.so\.0\]' "$work/log" &&
        grep -qx 'libpccd\.so\.0 libpccd0 .*' "$top_srcdir/debian/libpccd0.symbols"
    # If this failed, programs would look for another file than the package libpccd0 has.
    tap_result $? library__has_the_name_of_its_package "$work/log"
else
    tap_skip symbols__are_those_of_the_map "no shared library was built"
    tap_skip library__has_the_name_of_its_package "no shared library was built"
fi

direct=$top_builddir/.libs/libpccd-direct.so.0
if [ -e "$direct" ]; then
    nm -D --defined-only "$direct" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' \
        >"$work/exported"
    echo pccd_direct_host >"$work/wanted"
    diff "$work/wanted" "$work/exported" >"$work/log" 2>&1
    # If this failed, a program that loads the engine would see names of its insides.
    tap_result $? direct__exports_its_entrance_alone "$work/log"
    { ldd "$library" || echo none; } | grep -E 'gomp|libomp|gmp|xxhash|libuv|pccd-direct' \
        >"$work/log"
    [ ! -s "$work/log" ]
    # If this failed, every client would load what only the engine needs.
    tap_result $? symbols__libpccd_loads_nothing_of_the_engine "$work/log"
    ldd "$direct" | grep libuv >"$work/log"
    [ ! -s "$work/log" ]
    # If this failed, the service could have threads and loops that nobody asked for.
    tap_result $? direct__has_no_event_loop "$work/log"
else
    tap_skip direct__exports_its_entrance_alone "no shared library was built"
fi

# Functions that pccd.h declares: a name before "(", not a type, comments taken away.
# shellcheck disable=SC2086
${CC-cc} -std=c11 -E -P -I"$work/include" "$work/include/pccd.h" |
    tr '\n' ' ' | tr ';' '\n' | grep -v typedef |
    grep -o '\<pccd_[a-z0-9_]* *(' | tr -d ' (' | LC_ALL=C sort -u >"$work/declared"
diff "$work/declared" "$work/map" >"$work/log" 2>&1
# If this failed, a documented function could not be linked, or a linkable one is documented
# nowhere.
tap_result $? symbols__are_those_of_the_header "$work/log"

tap_end
