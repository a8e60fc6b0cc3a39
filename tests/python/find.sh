# find.sh - the Python that tests use; sourced by bash scripts.
#
# $python: the first of $PYTHON, python3 and /usr/bin/python3 that has msgpack and numpy; ""
# without one. The modules of client/python and of this folder can be imported, and no
# compiled files are left in the sources.

unset PCCD_URL PYTHONHOME PYTHONSTARTUP
PYTHONPATH=$top_srcdir/client/python:$top_srcdir/tests/python
PYTHONDONTWRITEBYTECODE=1
export PYTHONPATH PYTHONDONTWRITEBYTECODE

python=
for candidate in "${PYTHON-}" python3 /usr/bin/python3; do
    if [ -n "$candidate" ] && "$candidate" -c 'import msgpack, numpy' 2>/dev/null; then
        python=$candidate
        break
    fi
done
