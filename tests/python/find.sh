# find.sh - the Python that tests use; sourced by bash scripts.
#
# $python: the first of $PYTHON, python3 and /usr/bin/python3 that has msgpack and numpy; ""
# without one, and then $no_python says why. The module of the build folder and those of this
# folder can be imported, and no compiled files are left in the sources.
#
#   python_with MODULES   print the first of $python and /usr/bin/python3 that imports these;
#                         nothing without one, or without $python

unset PCCD_URL PCCD_LIBRARY PYTHONHOME PYTHONSTARTUP
PYTHONPATH=$top_builddir/python:$top_srcdir/tests/python
PYTHONDONTWRITEBYTECODE=1
export PYTHONPATH PYTHONDONTWRITEBYTECODE

python=
for candidate in "${PYTHON-}" python3 /usr/bin/python3; do
    if [ -n "$candidate" ] && "$candidate" -c 'import msgpack, numpy' 2>/dev/null; then
        python=$candidate
        break
    fi
done
no_python="no python3 with msgpack and numpy"
if nm -D "$top_builddir/.libs/libpccd.so.0" 2>/dev/null | grep -qE '__(a|ub|t)san_'; then
    python= no_python="libpccd is built with a sanitiser, which Python is not"
fi

python_with() {
    local candidate
    for candidate in "$python" /usr/bin/python3; do
        if [ -n "$python" ] && "$candidate" -c "import $1" 2>/dev/null; then
            printf '%s\n' "$candidate"
            return
        fi
    done
}
