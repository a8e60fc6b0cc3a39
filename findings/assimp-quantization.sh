#!/bin/sh
# assimp-quantization.sh - assimp: quantised positions of glTF are copied into floats bit by bit.
#
# Seen with assimp 5.2.5 (Debian 12). KHR_mesh_quantization lets POSITION be of 16 or 8 bits, which
# a node's scale brings to size. assimp takes the bytes of three int16 numbers, and of those that
# follow, for three floats: it ends without an error, and vertices are where nothing is. Look at the
# componentType of POSITION before such a file is given to it.

. "$(dirname "$0")/unpack.sh"
unpack assimp-utils=5.2.5~ds0-1+b1 libassimp5=5.2.5~ds0-1+b1 libminizip1=1.1-8+deb12u1 \
    libdraco7=1.5.5+dfsg-2
python3 - "$folder/q.gltf" <<'PROGRAM'
import base64, json, struct, sys

corners = [(0, 0, 0, 0), (100, 0, 0, 0), (0, 100, 0, 0), (0, 0, 0, 0)]
# A fourth number fills 8 bytes; the fourth corner is not named.
data = b"".join(struct.pack("<4h", *corner) for corner in corners)
json.dump({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "extensionsUsed": ["KHR_mesh_quantization"],
    "extensionsRequired": ["KHR_mesh_quantization"],
    "nodes": [{"mesh": 0, "scale": [0.01, 0.01, 0.01]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64,"
                 + base64.b64encode(data).decode()}],
    "bufferViews": [{"buffer": 0, "byteLength": len(data), "byteStride": 8}],
    "accessors": [{"bufferView": 0, "componentType": 5122, "count": 3, "type": "VEC3",
                   "min": [0, 0, 0], "max": [100, 100, 0]}],
}, open(sys.argv[1], "w"))
PROGRAM
root=$folder/root
LD_LIBRARY_PATH=$root/usr/lib/x86_64-linux-gnu "$root/usr/bin/assimp" export "$folder/q.gltf" \
    "$folder/q.obj" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
# Right were: v 0 0 0, v 1 0 0, v 0 1 0.
expect "$(grep '^v ' "$folder/q.obj" | tr -d '\r')" 'v 0 0 0
v 1.40129846e-45 0 0
v 9.18354962e-41 0 0'
