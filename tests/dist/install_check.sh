#!/bin/bash
# install_check.sh - what make install puts there, as somebody else meets it (TAP).
#
# Room:     tests/dist.
# Does:     install under DESTDIR; build and run programs of others, in C11 and in C++17,
#           against that and nothing of the source; take it away again. Then install for good,
#           in a mount namespace that ends with the test, and do there what the last line says.
#           Build such a program against the build folder, too.
# Does not: install anything where it would stay.

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-install-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log
root=$work/root
unset MAKEFLAGS MAKELEVEL MFLAGS PCCD_DAEMON PCCD_URL PCCD_DIRECT
export XDG_RUNTIME_DIR=$work/run
mkdir "$XDG_RUNTIME_DIR"

make -s -C "$top_builddir" install DESTDIR="$root" >"$log" 2>&1
# If it failed, nobody could install or package it.
tap_result $? install__works_under_destdir "$log"

program=$(find "$root" -name pccdctl -path '*/bin/*')
bin=${program%/pccdctl}
lib=$(dirname "$(find "$root" -name libpccd.so.0)")
{
    for name in pccdd pccdctl pccd-load; do
        [ -x "$bin/$name" ] || echo "no program $name"
    done
    for name in libpccd.so libpccd.so.0 libpccd-direct.so.0 pkgconfig/pccd.pc \
        cmake/pccd/pccdConfig.cmake cmake/pccd/pccdConfigVersion.cmake; do
        [ -e "$lib/$name" ] || echo "no $name beside the library"
    done
    if [ "${PCCD_MPI:-no}" != no ]; then
        [ -x "$bin/pccd-mpi" ] || echo "no program pccd-mpi"
        for name in libpccd-mpi.so libpccd-mpi.so.0 pkgconfig/pccd-mpi.pc; do
            [ -e "$lib/$name" ] || echo "no $name beside the library"
        done
    fi
    # Without scdoc there are no pages at all.
    find "$root" -name '*.[18]' | sed 's|.*/||; s|\.[18]$||' | sort >"$work/pages"
    find "$bin" -type f | sed 's|.*/||' | sort >"$work/programs"
    [ ! -s "$work/pages" ] || diff "$work/programs" "$work/pages"
} >"$log"
[ ! -s "$log" ]
# If it failed, something would be described that is not there, or the other way round.
tap_result $? install__has_programs_libraries_and_their_pages "$log"

find "$root" -type f \( -perm -100 -o -name '*.so*' \) | while read -r file; do
    # What is root's is no danger: a compiler names the folder of its own OpenMP there.
    readelf -d "$file" 2>/dev/null | grep -E 'R(UN)?PATH' |
        grep -vE 'path: \[/usr/lib/[^]:]*\]' | sed "s|^|${file#"$root"}: |"
done >"$log"
[ ! -s "$log" ]
# If it failed, a program would look for libraries where it was built, which is anybody's.
tap_result $? install__programs_have_no_path_to_libraries "$log"

# The unit starts the program that was installed.
prefix_bin=${bin#"$root"}
grep -rhoE '^ExecStart=[^ ]*' "$root" --include=pccdd.service | sort -u >"$log"
[ "$(cat "$log")" = "ExecStart=$prefix_bin/pccdd" ]
tap_result $? install__units_start_the_installed_daemon "$log"

# ---- programs of others ----------------------------------------------------------------

export PKG_CONFIG_SYSROOT_DIR=$root PKG_CONFIG_PATH=$lib/pkgconfig
export LD_LIBRARY_PATH=$lib PATH=$bin:$PATH
cp "$top_srcdir/client/examples/hello.c" "$work/game.c"
cat >"$work/game.cc" <<'END'
#include <pccd.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string_view>
#include <vector>

struct closer {
    void operator()(pccd_client *client) const { pccd_close(client); }
};

int main()
{
    pccd_client *made = nullptr;
    pccd_options options;
    pccd_options_init(&options);
    options.private_daemon = true;
    if (pccd_connect(&options, &made) != PCCD_OK) {
        std::fprintf(stderr, "%s\n", pccd_error_text(nullptr));
        return 1;
    }
    std::unique_ptr<pccd_client, closer> client(made);
    const std::vector<std::array<double, 3>> x0 = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}},
        {{.25, .25, 1}}, {{.75, .25, 4}}, {{.25, .75, 4}}};
    auto x1 = x0;
    for (std::size_t i = 3; i < x1.size(); i++) {
        x1[i][2] -= 2;
    }
    const std::uint32_t triangles[2][3] = {{0, 1, 2}, {3, 4, 5}};
    std::uint32_t scene, mesh, object;
    pccd_answer answer{};
    if (pccd_scene_create(made, nullptr, &scene) != PCCD_OK ||
        pccd_mesh_create(made, x0.data(), PCCD_FORMAT_F64, 6, triangles, 2, &mesh,
                         nullptr) != PCCD_OK ||
        pccd_scene_add(made, scene, mesh, &object) != PCCD_OK ||
        pccd_step_x1(made, scene, object, x1.data(), PCCD_FORMAT_F64, 6, nullptr,
                     &answer) != PCCD_OK) {
        std::fprintf(stderr, "%s\n", pccd_error_text(made));
        return 1;
    }
    const bool is_right = answer.count == 1 && answer.contacts[0].kind == PCCD_VF &&
                          answer.contacts[0].toi <= 0.5 && answer.contacts[0].toi > 0.499;
    pccd_answer_release(made, &answer);
    return is_right && !std::string_view(pccd_version()).empty() ? 0 : 1;
}
END

# build_and_run NAME COMPILER... FILE
build_and_run() {
    local name=$1
    shift
    if nm -D "$lib/libpccd.so.0" | grep -qE '__(a|ub|t)san_'; then
        tap_skip "$name" "the library is built with a sanitiser"
        return
    fi
    # shellcheck disable=SC2046 # words on purpose
    (cd "$work" && "$@" -Wall -Wextra -Wpedantic -Wconversion -Werror -o game \
        $(pkg-config --cflags --libs pccd)) >"$log" 2>&1 &&
        (cd / && timeout 60 "$work/game") >>"$log" 2>&1
    tap_result $? "$name" "$log"
}
if ! command -v pkg-config >/dev/null; then
    tap_skip install__c11_program_works "no pkg-config"
    tap_skip install__cxx17_program_works "no pkg-config"
else
    # If it failed, a game could not be built against what was installed.
    # shellcheck disable=SC2086 # CC may hold flags
    build_and_run install__c11_program_works ${CC-cc} -std=c11 game.c
    # If one failed, who copies it would have to find out what it wants defined.
    for example in "$top_srcdir"/client/examples/*.c; do
        name=${example##*/} name=${name%.c}
        for compiler in gcc clang; do
            if command -v $compiler >/dev/null; then
                # shellcheck disable=SC2046 # words on purpose
                $compiler -std=c11 -Wall -Wextra -Wpedantic -Wconversion -Werror -c \
                    -o "$work/example.o" "$example" $(pkg-config --cflags pccd)
            fi
        done >"$log" 2>&1
        [ ! -s "$log" ] && [ -s "$work/example.o" ]
        tap_result $? install__example_${name}_is_plain_c11 "$log"
        rm -f "$work/example.o"
    done
    if command -v g++ >/dev/null; then
        # If it failed, one in C++ could not.
        build_and_run install__cxx17_program_works g++ -std=c++17 game.cc
    else
        tap_skip install__cxx17_program_works "no g++"
    fi
fi
name=install__cmake_project_works
if nm -D "$lib/libpccd.so.0" | grep -qE '__(a|ub|t)san_'; then
    tap_skip $name "the library is built with a sanitiser"
elif ! command -v cmake >/dev/null || ! command -v g++ >/dev/null; then
    tap_skip $name "no cmake, or no g++"
else
    mkdir "$work/project"
    cp "$top_srcdir/client/cpp/falling.cc" "$work/project"
    cat >"$work/project/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.13)
project(game CXX)
find_package(pccd REQUIRED COMPONENTS direct)
add_executable(game falling.cc)
target_compile_features(game PRIVATE cxx_std_17)
target_link_libraries(game PRIVATE pccd::pccd)
END
    cmake -S "$work/project" -B "$work/made" -DCMAKE_PREFIX_PATH="${bin%/bin}" >"$log" 2>&1 &&
        cmake --build "$work/made" >>"$log" 2>&1 &&
        (cd / && timeout 60 "$work/made/game" >>"$log" 2>&1)
    # If it failed, a project that is built by CMake would have to find our files itself.
    tap_result $? $name "$log"
fi

# The installed tool finds the installed daemon, and the engine for its own process.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv .2 .2 1\nv .4 .2 2\nv .2 .4 2\nf 1 2 3\nf 4 5 6\n' \
    >"$work/0.obj"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv .2 .2 -1\nv .4 .2 1\nv .2 .4 1\nf 1 2 3\nf 4 5 6\n' \
    >"$work/1.obj"
for host in daemon direct; do
    [ $host = direct ] && url='--url direct:' || url=--private
    # shellcheck disable=SC2086 # words
    (cd / && "$bin/pccdctl" check --json $url "$work/0.obj" "$work/1.obj") \
        >"$log" 2>&1
    [ $? -eq 1 ] && grep -qE '"(total|contacts)": 1\b' "$log"
    # If it failed, the tool would work in the build folder alone.
    tap_result $? install__tool_computes_with_$host "$log"
done
"$bin/pccd-load" --daemon "$bin/pccdd" --clients 2 --requests 20 >"$log" 2>&1
# If it failed, the load harness would work in the build folder alone.
tap_result $? install__load_harness_runs "$log"

# ---- away with it ----------------------------------------------------------------------

make -s -C "$top_builddir" uninstall DESTDIR="$root" >"$log" 2>&1
status=$?
find "$root" ! -type d >>"$log"
[ $status -eq 0 ] && ! find "$root" ! -type d | grep -q .
# If it failed, something would stay behind.
tap_result $? uninstall__takes_all_away "$log"

# ---- for good --------------------------------------------------------------------------

unset PKG_CONFIG_SYSROOT_DIR PKG_CONFIG_PATH LD_LIBRARY_PATH
PATH=${PATH#"$bin":}
prefix=$(sed -n 's/^prefix=//p' "$top_builddir/client/lib/pccd.pc")

# What a newcomer does, in a namespace in which what is written to the prefix and to /etc
# (the loader's cache) is written to memory.
cat >"$work/newcomer.sh" <<'END'
prefix=$1 work=$2
mount -t tmpfs none "$work/memory" || exit 77
for folder in "$prefix" /etc; do
    upper=$work/memory/${folder//\//_}
    mkdir -p "$upper/new" "$upper/work" &&
        mount -t overlay -o "lowerdir=$folder,upperdir=$upper/new,workdir=$upper/work" none \
            "$folder" || exit 77
done
make -C "$top_builddir" -j2 install >"$work/installed" || exit 1
line=$(grep -v '^make' "$work/installed" | tail -n 1)
echo "the last line: $line"
case $line in
'export '*) eval "$line" ;;
'pccd is installed: '*) ;;
*) exit 1 ;;
esac
cd "$work" || exit 1
[ "$(command -v pccdctl)" = "$prefix/bin/pccdctl" ] && pccdctl version --private || exit 1
cp "$top_srcdir/client/examples/hello.c" game.c
${CC-cc} -o first game.c $(pkg-config --cflags --libs pccd) && ./first || exit 1
if command -v python3 >/dev/null; then
    python3 -c 'import importlib.util
print(importlib.util.find_spec("pccd").origin)' || exit 1
fi
for url in '' direct:; do
    if python3 -c 'import numpy'; then
        PCCD_URL=$url PCCD_DAEMON=$prefix/bin/pccdd python3 -c 'import pccd
print(pccd.__file__, pccd.library.lib._name)
with pccd.connect(private=True) as client:
    print(client, client.scene_create())' || exit 1
    fi
done
END
name=install__last_line_is_all_there_is_to_do
as_root=-m
[ "$(id -u)" -eq 0 ] || as_root=-rm
mkdir -p "$work/memory"
if nm -D "$top_builddir/.libs/libpccd.so.0" | grep -qE '__(a|ub|t)san_'; then
    tap_skip $name "the library is built with a sanitiser"
elif ! command -v pkg-config >/dev/null || ! command -v unshare >/dev/null; then
    tap_skip $name "no pkg-config, or no unshare"
elif ! mkdir -p "$prefix" 2>/dev/null || [ ! -d "$prefix" ]; then
    tap_skip $name "$prefix cannot be made"
else
    unshare $as_root bash "$work/newcomer.sh" "$prefix" "$work" >"$log" 2>&1
    status=$?
    # If it failed, what was installed would not be found by who does as told.
    if [ $status -eq 77 ] || grep -q '^unshare: ' "$log"; then
        tap_skip $name "no overlay can be mounted here"
    else
        tap_result $status $name "$log"
    fi
fi

# If it failed, an installation to a folder that nothing looks into would leave a user to find
# out what to set.
PATH=/usr/bin:/bin PKG_CONFIG=pkg-config PYTHON3=$(command -v python3) \
    sh "$top_srcdir/client/lib/after_install.sh" "$work/b" "$work/l" "$work/p" "$work/y" >"$log" 2>&1
[ "$(tail -n 1 "$log")" = "export PATH=\"$work/b\${PATH:+:\$PATH}\"\
 LD_LIBRARY_PATH=\"$work/l\${LD_LIBRARY_PATH:+:\$LD_LIBRARY_PATH}\"\
 PKG_CONFIG_PATH=\"$work/p\${PKG_CONFIG_PATH:+:\$PKG_CONFIG_PATH}\"\
$([ -z "$(command -v python3)" ] || echo " PYTHONPATH=\"$work/y\${PYTHONPATH:+:\$PYTHONPATH}\"")" ]
tap_result $? install__elsewhere_says_what_to_set "$log"

# ---- not installed at all --------------------------------------------------------------

name=build_folder__serves_a_program_as_it_stands
if command -v pkg-config >/dev/null; then
    # shellcheck disable=SC2046,SC2086 # words on purpose
    (cd "$work" && PKG_CONFIG_PATH=$top_builddir && export PKG_CONFIG_PATH &&
        ${CC-cc} -o first "$top_srcdir/client/examples/hello.c" $(pkg-config --cflags --libs pccd) &&
        ./first) >"$log" 2>&1
    # If it failed, the first program could not be tried without an installation.
    tap_result $? $name "$log"
else
    tap_skip $name "no pkg-config"
fi

tap_end
