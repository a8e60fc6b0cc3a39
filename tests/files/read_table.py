"""read_table.py - times and memory of reading mesh files, beside others.

Room:     tests/files. numpy, meshio; trimesh if it is there; the program read_mesh.
Does:     write a wavy sheet in each format, read it in turns by each reader, and print a
          table: seconds of processor time (medians), ratios to this build.
Usage:    read_table.py [--triangles N] [--turns N] FOLDER READ_MESH [OLD_READ_MESH]
"""

import argparse
import json
import os
import statistics
import struct
import subprocess
import sys

import numpy as np

CHUNK = 1 << 16
LIBRARIES = {
    "meshio": "import meshio; f = meshio.read",
    "trimesh": "import trimesh; f = lambda p: trimesh.load(p, process=False)",
}


def sheet(triangles):
    """About so many, in a square of quads that are cut in two."""
    n = max(2, round((triangles / 2) ** 0.5))
    u, v = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    x = np.column_stack([u.ravel(), v.ravel(), 0.1 * np.sin(9 * u + 5 * v).ravel()])
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    quads = np.column_stack([corner, corner + 1, corner + n + 2, corner + n + 1])
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return x.astype(np.float32), faces.astype(np.uint32)


def in_chunks(array):
    return (array[i:i + CHUNK] for i in range(0, len(array), CHUNK))


def write_text(file, rows, form):
    for chunk in in_chunks(rows):
        file.write("".join(form % tuple(row) for row in chunk.tolist()).encode())


def ply_header(x, faces, encoding):
    return (f"ply\nformat {encoding} 1.0\nelement vertex {len(x)}\nproperty float x\n"
            f"property float y\nproperty float z\nelement face {len(faces)}\n"
            "property list uchar uint vertex_indices\nend_header\n").encode()


def write_ascii_ply(file, x, faces):
    file.write(ply_header(x, faces, "ascii"))
    write_text(file, x, "%.9g %.9g %.9g\n")
    write_text(file, faces, "3 %d %d %d\n")


def write_binary_ply(file, x, faces):
    file.write(ply_header(x, faces, "binary_little_endian"))
    file.write(x.tobytes())
    for chunk in in_chunks(faces):
        rows = np.empty(len(chunk), [("count", "u1"), ("corners", "<u4", 3)])
        rows["count"], rows["corners"] = 3, chunk
        file.write(rows.tobytes())


def write_obj(file, x, faces):
    write_text(file, x, "v %.9g %.9g %.9g\n")
    write_text(file, faces + 1, "f %d %d %d\n")


def write_ascii_stl(file, x, faces):
    file.write(b"solid sheet\n")
    for chunk in in_chunks(faces):
        write_text(file, x[chunk].reshape(-1, 9),
                   "facet normal 0 0 1\nouter loop\nvertex %.9g %.9g %.9g\n"
                   "vertex %.9g %.9g %.9g\nvertex %.9g %.9g %.9g\nendloop\nendfacet\n")
    file.write(b"endsolid sheet\n")


def write_binary_stl(file, x, faces):
    file.write(bytes(80) + struct.pack("<I", len(faces)))
    for chunk in in_chunks(faces):
        rows = np.zeros(len(chunk), [("x", "<f4", (4, 3)), ("more", "<u2")])
        rows["x"][:, 1:] = x[chunk]
        file.write(rows.tobytes())


def write_glb(file, x, faces):
    data = x.tobytes() + faces.tobytes()
    views = [{"buffer": 0, "byteOffset": 0, "byteLength": x.nbytes},
             {"buffer": 0, "byteOffset": x.nbytes, "byteLength": faces.nbytes}]
    accessors = [{"bufferView": 0, "componentType": 5126, "count": len(x), "type": "VEC3",
                  "min": x.min(0).tolist(), "max": x.max(0).tolist()},
                 {"bufferView": 1, "componentType": 5125, "count": faces.size,
                  "type": "SCALAR"}]
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}], "buffers": [{"byteLength": len(data)}],
        "bufferViews": views, "accessors": accessors,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    }).encode()
    text += b" " * (-len(text) % 4)
    file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)))
    file.write(struct.pack("<I4s", len(text), b"JSON") + text)
    file.write(struct.pack("<I4s", len(data), b"BIN\0") + data)


WRITERS = {"ascii.ply": write_ascii_ply, "binary.ply": write_binary_ply,
           "ascii.stl": write_ascii_stl, "binary.stl": write_binary_stl,
           "sheet.obj": write_obj, "sheet.glb": write_glb}


def read_once(reader, path):
    """Vertices, triangles, seconds, bytes of arrays, most memory; None: it cannot."""
    if reader in LIBRARIES:
        code = ("import sys, time; " + LIBRARIES[reader] + "; t = time.process_time(); "
                "f(sys.argv[1]); print(sys.argv[1], 0, 0, time.process_time() - t, 0, 0)")
        command = [sys.executable, "-c", code, path]
    else:
        command = [reader, "1", path]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return None
    return [float(word) for word in done.stdout.split("\n")[-2].split()[1:]]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--triangles", type=int, default=1000000)
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--formats", nargs="*", default=list(WRITERS))
    parser.add_argument("folder")
    parser.add_argument("readers", nargs="+")
    wanted = parser.parse_args()
    x, faces = sheet(wanted.triangles)
    readers = wanted.readers + list(LIBRARIES)
    print(f"{len(x)} vertices, {len(faces)} triangles; medians of {wanted.turns}")
    print("format", "MB", *(os.path.relpath(reader) if reader not in LIBRARIES else reader
                            for reader in readers), "memory/arrays", sep="\t")
    for name in wanted.formats:
        path = os.path.join(wanted.folder, name)
        with open(path, "wb") as file:
            WRITERS[name](file, x, faces)
        times = {reader: [] for reader in readers}
        for _ in range(wanted.turns):
            for reader in readers:
                got = read_once(reader, path)
                times[reader].append(got[2] if got else float("nan"))
                if reader == readers[0]:
                    ours = got
        own = statistics.median(times[readers[0]])
        medians = [statistics.median(times[reader]) for reader in readers]
        cells = [f"{median:.3f} ({median / max(own, 1e-9):.2f})" for median in medians]
        print(name, f"{os.path.getsize(path) / 1e6:.0f}", *cells,
              f"{ours[4] / ours[3]:.2f}", sep="\t", flush=True)
        os.remove(path)


if __name__ == "__main__":
    main()
