#!/bin/bash
# test_cpp.sh - pccd.hpp by every compiler and standard that there is (TAP).
#
# Room:     tests/cpp.
# Does:     build check.cc, which tries the header against a daemon and in this process, and the
#           example, with what pkg-config tells of the build folder.

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-cpp-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log
export PKG_CONFIG_PATH=$top_builddir
unset PCCD_URL

# build NAME FLAGS... FILE: the program $work/NAME.
build() {
    local name=$1
    shift
    # shellcheck disable=SC2046 # words on purpose
    "$@" -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -o "$work/$name" \
        $(pkg-config --cflags --libs pccd) >"$log" 2>&1
}

try() { # NAME FLAGS...
    local name=$1
    shift
    build check "$@" "$top_srcdir/tests/cpp/check.cc" &&
        timeout 120 "$work/check" >"$work/tap" 2>>"$log"
    local status=$?
    grep -v '^ok' "$work/tap" >>"$log" 2>/dev/null
    tap_result $status "$name" "$log"
    rm -f "$work/check" "$work/tap"
}

why=
command -v pkg-config >/dev/null || why="no pkg-config"
if nm -D "$top_builddir/.libs/libpccd.so.0" | grep -qE '__(a|ub|t)san_'; then
    why="the library is built with a sanitiser" # of one compiler
fi
if [ -n "$why" ]; then
    tap_skip cpp__keeps_its_promises "$why"
    tap_end
    exit
fi
for compiler in g++ clang++; do
    for standard in 17 20; do
        name=cpp__keeps_its_promises_with_${compiler}_$standard
        if command -v $compiler >/dev/null; then
            # If it failed, a program in C++ could not be built, or would be told another thing
            # than one in C.
            try "${name//+/x}" $compiler -std=c++$standard
        else
            tap_skip "${name//+/x}" "no $compiler"
        fi
    done
done
if command -v g++ >/dev/null; then
    # If it failed, engines that are compiled without exceptions could not use it.
    try cpp__works_without_exceptions g++ -std=c++17 -fno-exceptions
    build falling g++ -std=c++17 "$top_srcdir/client/cpp/falling.cc" &&
        timeout 60 "$work/falling" >>"$log" 2>&1 && grep -q 'above the floor' "$log"
    # If it failed, who begins with the example would begin with an error.
    tap_result $? cpp__example_stops_above_the_floor "$log"
else
    tap_skip cpp__works_without_exceptions "no g++"
    tap_skip cpp__example_stops_above_the_floor "no g++"
fi

# A project of somebody's, that asks CMake for us.
project() { # VERSION EXTRA [LANGUAGES]
    mkdir -p "$work/project"
    cp "$top_srcdir/client/cpp/falling.cc" "$work/project"
    cat >"$work/project/CMakeLists.txt" <<END
cmake_minimum_required(VERSION 3.13)
project(game ${3-CXX})
find_package(pccd $1 REQUIRED)
add_executable(game falling.cc)
target_compile_features(game PRIVATE cxx_std_17)
target_link_libraries(game PRIVATE pccd::pccd)
$2
END
    rm -rf "$work/made"
    cmake -S "$work/project" -B "$work/made" -Dpccd_DIR="$top_builddir" \
        ${MPI_C_COMPILER:+-DMPI_C_COMPILER="$MPI_C_COMPILER"} >"$log" 2>&1
}
version=$(sed -n 's/^#define PCCD_VERSION_M[AI][JN]OR //p' "$top_srcdir/client/lib/pccd.h" | paste -sd.)
if command -v cmake >/dev/null && command -v g++ >/dev/null; then
    # shellcheck disable=SC2016 # CMake's own
    project "$version COMPONENTS direct" \
        'file(GENERATE OUTPUT direct CONTENT $<TARGET_FILE:pccd::direct>)' &&
        cmake --build "$work/made" >>"$log" 2>&1 && timeout 60 "$work/made/game" >>"$log" 2>&1 &&
        [ -e "$(cat "$work/made/direct")" ]
    # If it failed, a project that is built by CMake would have to find our files itself.
    tap_result $? cmake__finds_the_build_folder "$log"
    if [ -e "$top_builddir/.libs/libpccd-mpi.so.0" ]; then
        # It has to find the MPI that ours was built for.
        mpicc=$(sed -n 's/^MPICC = //p' "$top_builddir/Makefile")
        export MPI_C_COMPILER=$mpicc
        project "$version COMPONENTS mpi" "enable_language(C)
file(WRITE \"\${CMAKE_BINARY_DIR}/ranks.c\" \"#include <pccd_mpi.h>
int main(void) { return pccd_mpi_error_text(0)[0]; }\")
add_executable(ranks \"\${CMAKE_BINARY_DIR}/ranks.c\")
target_link_libraries(ranks PRIVATE pccd::mpi)" "C CXX" &&
            cmake --build "$work/made" >>"$log" 2>&1 && "$work/made/ranks" >>"$log" 2>&1
        # If it failed, a simulator of many machines would have to find our files itself.
        tap_result $? cmake__finds_the_library_for_mpi "$log"
    else
        tap_skip cmake__finds_the_library_for_mpi "it was built without MPI"
    fi
    ! project 99.0 '' && grep -q 'pccd' "$log"
    # If it failed, a project that needs a newer release would be built against this one.
    tap_result $? cmake__refuses_a_version_that_is_newer "$log"
    ! project "$version COMPONENTS wings" '' && grep -q 'no component wings' "$log"
    # If it failed, it would be told of a part that is not there.
    tap_result $? cmake__names_a_component_that_is_missing "$log"
else
    for name in finds_the_build_folder finds_the_library_for_mpi refuses_a_version_that_is_newer \
        names_a_component_that_is_missing; do
        tap_skip cmake__$name "no cmake, or no g++"
    done
fi
tap_end
