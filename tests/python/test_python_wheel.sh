#!/bin/bash
# test_python_wheel.sh - the wheel, as somebody without a compiler meets it (TAP).

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-wheel-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log
unset PCCD_URL PCCD_DAEMON PCCD_DIRECT PCCD_LIBRARY PYTHONPATH PYTHONHOME PYTHONSTARTUP
export XDG_RUNTIME_DIR=$work/run PIP_DISABLE_PIP_VERSION_CHECK=1
mkdir "$XDG_RUNTIME_DIR"

why=
python=
for candidate in "${PYTHON-}" python3 /usr/bin/python3; do
    if [ -n "$candidate" ] &&
        "$candidate" -c 'import ensurepip, numpy, setuptools, venv, wheel' 2>/dev/null; then
        python=$candidate
        break
    fi
done
[ -n "$python" ] || why="no python3 with numpy, setuptools, venv and wheel"
command -v patchelf >/dev/null || why="no patchelf"
! nm -D "$top_builddir/.libs/libpccd.so.0" | grep -qE '__(a|ub|t)san_' ||
    why="the build has a sanitiser in it"
if [ -n "$why" ]; then
    for name in wheel__is_made wheel__is_installed_without_a_network wheel__computes_in_its_daemon \
        wheel__computes_without_a_daemon wheel__brings_what_it_needs; do
        tap_skip $name "$why"
    done
    tap_end
    exit
fi

PYTHON3=$python "$BASH" "$top_srcdir/client/python/make_wheel.sh" "$top_srcdir" "$top_builddir" \
    "$work/dist" >"$log" 2>&1
status=$?
wheel=$(ls "$work"/dist/pccd-*-py3-none-manylinux_*.whl 2>>"$log")
[ $status -eq 0 ] && [ "$(cat "$log")" = "$wheel" ]
# If it failed, nobody without a compiler could have pccd in Python.
tap_result $? wheel__is_made "$log"

"$python" -m venv --system-site-packages "$work/env" >"$log" 2>&1 &&
    "$work/env/bin/pip" install --no-index "$wheel" >>"$log" 2>&1
# If it failed, it would be a file that pip does not take, or would have to fetch something for.
tap_result $? wheel__is_installed_without_a_network "$log"

awk '/^```python$/ { on = 1; next } /^```$/ { on = 0 } on' "$top_srcdir/README.md" >"$work/readme.py"
# The daemon that it starts would outlive it; its own ends with it.
run() { # CONNECT NAME
    sed "s/pccd\.connect()/pccd.connect($1)/" "$work/readme.py" >"$work/tried.py"
    grep -LF "pccd.connect($1)" "$work/tried.py" >"$log" # a README that connects otherwise
    (cd / && PATH=/usr/bin:/bin timeout 60 "$work/env/bin/python" "$work/tried.py") >>"$log" 2>&1
    [ "$(cat "$log")" = "vertex 3 hits face 0 at t = 0.500" ]
    tap_result $? "$2" "$log"
}
# If one failed, the first lines that anybody tries would not do what they say.
run 'private=True' wheel__computes_in_its_daemon
run '"direct:"' wheel__computes_without_a_daemon

# Of the system they take the C library alone.
for file in "$work"/env/lib/python*/site-packages/pccd/{libpccd.so.0,libpccd-direct.so.0,pccdd}; do
    ldd "$file" | grep -vF "$work/env/" |
        grep -vE '^\s*(linux-vdso|/lib.*/ld-linux|lib(c|m|dl|rt|pthread|gcc_s)\.so)' |
        sed "s|^|${file##*/}: |"
done >"$log" 2>&1
[ ! -s "$log" ]
# If it failed, it would work here and fail where a library is missing or another one.
tap_result $? wheel__brings_what_it_needs "$log"

tap_end
