#!/bin/bash
# python_check.sh - pccd.mpi: a Python program over ranks, beside one process (TAP).
set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
# shellcheck source=tests/mpi/ranks.sh
. "$top_srcdir/tests/mpi/ranks.sh"
ranks_rest=yes
# shellcheck source=tests/python/find.sh
. "$top_srcdir/tests/python/find.sh"

work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-mpi-python-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log

why=
[ -n "$python" ] || why=$no_python
[ -z "$python" ] || "$python" -c 'import mpi4py' 2>/dev/null || why="no mpi4py"
[ "${PCCD_MPI:-no}" = openmpi ] || why="no --with-mpi=openmpi, which Debian's mpi4py is for"
if [ -n "$why" ]; then
    tap_skip mpi__python_answers_as_one_process "$why"
    tap_skip mpi__wheel_serves_ranks "$why"
    tap_end
    exit
fi

status=0
for count in 1 2 3; do
    ranks "$count" "$python" "$top_srcdir/tests/mpi/python_ranks.py" >"$log" 2>&1 || { status=1; break; }
done
# If it failed, a Python program over ranks would have another answer, or none.
tap_result $status mpi__python_answers_as_one_process "$log"

if ! command -v patchelf >/dev/null; then
    tap_skip mpi__wheel_serves_ranks "no patchelf"
else
    "$BASH" "$top_srcdir/client/python/bundle.sh" "$top_builddir" "$work/pccd" >"$log" 2>&1 &&
        (cd / && PYTHONPATH=$work ranks 2 "$python" "$top_srcdir/tests/mpi/python_ranks.py") >>"$log" 2>&1 &&
        PYTHONPATH=$work "$python" -c 'import pccd.mpi; print(pccd.mpi.__file__)' 2>>"$log" | grep -q "^$work/"
    # If it failed, who has the wheel would have to build libpccd-mpi nevertheless.
    tap_result $? mpi__wheel_serves_ranks "$log"
fi
tap_end
