#!/bin/sh
# make_files.sh - has the programs that are here write the scenes of scenes.py.
#
# Usage:    make_files.sh FOLDER
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
scenes=$folder/scenes
python3 "$here/scenes.py" "$scenes"
if command -v blender >/dev/null; then
    # Blender's Python takes for its own what belongs to another one that is first in $PATH.
    PATH=/usr/bin:/bin blender -b --factory-startup -P "$here/write_blender.py" -- \
        "$scenes/scenes.json" "$folder" 2>&1 | grep -E '^(not written|Traceback|[A-Za-z]*Error)' || :
else
    echo "not written: no blender"
fi
if [ -d "${NODE_MODULES:-}" ]; then
    node "$here/write_gltf.mjs" "$scenes" "$folder" >"$folder/log" 2>&1 || tail -3 "$folder/log"
    node "$here/write_three.mjs" "$scenes" "$folder" >"$folder/log" 2>&1 || tail -3 "$folder/log"
    rm -f "$folder/log"
else
    echo "not written: no folder \$NODE_MODULES"
fi
/usr/bin/python3 "$here/write_numpy.py" "$scenes" "$folder" 2>&1 | grep '^not written' || :
"$here/write_tools.sh" "$scenes" "$folder"
