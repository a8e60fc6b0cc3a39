#!/bin/bash
# test_python_contacts.sh - contacts as HDF5 and Parquet (TAP).
set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCD_DAEMON:?}" "${PCCDCTL:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"
# shellcheck source=tests/python/find.sh
. "$top_srcdir/tests/python/find.sh"

with=$(python_with 'numpy, h5py')
if [ -z "${with:=$python}" ]; then
    tap_skip check_contacts "$no_python"
    tap_end
    exit
fi
work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
XDG_RUNTIME_DIR=$work timeout 120 "$with" "$top_srcdir/tests/python/tap.py" check_contacts
