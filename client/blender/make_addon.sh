#!/bin/bash
# make_addon.sh - the add-on for Blender as a zip, for "Install from disk".
#
#   make_addon.sh SOURCE BUILD FILE.zip
#
# Room:     client/blender; make blender-addon calls it.
# Does:     pack the add-on with the Python module and the libraries that this needs. It asks
#           for nothing over a network.
# Needs:    python3, patchelf.

set -eu
source=$1 build=$2 zip=$3
stage=$build/client/blender/stage
rm -rf "$stage"
mkdir -p "$stage/pccd_blender" "$(dirname "$zip")"
cp -L "$source"/client/blender/addon/*.py "$source/LICENSE" "$source/client/blender/README.md" \
    "$stage/pccd_blender"
"$BASH" "$source/client/python/bundle.sh" "$build" "$stage/pccd_blender/pccd" || exit 1

SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$source" log -1 --format=%ct 2>/dev/null ||
    stat -c %Y "$source/configure.ac")}
export SOURCE_DATE_EPOCH
cd "$stage"
python3 - "$zip" <<'END'
import os
import sys
import time
import zipfile

when = time.gmtime(max(int(os.environ["SOURCE_DATE_EPOCH"]), 315532800))[:6]
with zipfile.ZipFile(sys.argv[1] + ".new", "w", zipfile.ZIP_DEFLATED) as made:
    for folder, folders, names in os.walk("pccd_blender"):
        folders.sort()
        for name in sorted(names):
            path = os.path.join(folder, name)
            info = zipfile.ZipInfo(path, when)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = (0o100755 if os.access(path, os.X_OK) else 0o100644) << 16
            with open(path, "rb") as file:
                made.writestr(info, file.read())
os.replace(sys.argv[1] + ".new", sys.argv[1])
END
rm -rf "$stage"
echo "$zip"
