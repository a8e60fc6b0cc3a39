#!/bin/sh
# after_install.sh - the last thing that `make install` does, unless it has a DESTDIR.
#
#   after_install.sh BINDIR LIBDIR PKGCONFIGDIR PYTHONDIR     PKG_CONFIG and PYTHON3 are programs
#
# As root, has the loader learn of a library where it looks for some. Then looks whether shells, the loader, pkg-config
# and Python find what was installed. The last line is what to set for those that do not.

set -u
bindir=$1 libdir=$2 pkgconfigdir=$3 pythondir=$4
PATH_before=$PATH
PATH=$PATH:/usr/sbin:/sbin
settings=

# need VARIABLE FOLDER: the folder comes first in a list that may be there already.
need() {
    settings="$settings $1=\"$2\${$1:+:\$$1}\""
}
is_in() { # FOLDER LIST
    case :$2: in *:"$1":*) return 0 ;; esac
    return 1
}

# -v -N -X: list the folders that the loader looks into, and write nothing.
if [ "$(id -u)" -eq 0 ] && ldconfig -v -N -X 2>/dev/null | grep -q "^$libdir:"; then
    ldconfig
fi
is_in "$bindir" "$PATH_before" || need PATH "$bindir"
ldconfig -p 2>/dev/null | grep -qF "=> $libdir/libpccd.so.0" ||
    is_in "$libdir" "${LD_LIBRARY_PATH-}" || need LD_LIBRARY_PATH "$libdir"
[ "$("${PKG_CONFIG:-pkg-config}" --variable=libdir pccd 2>/dev/null)" = "$libdir" ] ||
    need PKG_CONFIG_PATH "$pkgconfigdir"
if [ -n "${PYTHON3-}" ]; then
    (cd / && "$PYTHON3" -c 'import importlib.util, os, sys
found = importlib.util.find_spec("pccd")
sys.exit(not found or os.path.dirname(found.origin) != os.path.realpath(sys.argv[1]))' \
        "$pythondir" 2>/dev/null) || need PYTHONPATH "$pythondir"
fi

if [ -z "$settings" ]; then
    echo "pccd is installed: shells, compilers and Python find it."
else
    echo "pccd is installed. So that shells, compilers and Python find it, say, and write into ~/.profile:"
    echo "export$settings"
fi
