"""judge_files.py - compares what pccdctl says of files with what is right of them.

Room:     tests/files. The standard library; pccdctl as a program, nothing else of pccd.
Does:     look through the folders of programs (PROGRAM-VERSION) for files that the
          writers of this folder name SCENE.WAY.ENDING, or SCENE.WAY.0.ENDING and on
          for those that go together, have each judged, and print a row for each and a
          line of sums.
Usage:    judge_files.py [--table] SCENES.JSON FOLDER...
          --table: all rows, not only those that are not as they should be; exit status 1
          when there are such.
Needs:    PCCDCTL, else pccdctl; PCCD_PYTHON, else python3, with the module pccd for what
          that reads.
"""

import argparse
import collections
import json
import os
import re
import subprocess
import sys
from fractions import Fraction

READ = {"obj", "ply", "stl", "glb", "gltf", "pc2", "mdd"}  # by pccdctl
BY_PYTHON = {"vtu", "vtk", "vtp", "msh", "xdmf", "off", "mesh"}
# What is not read says what it is.
KINDS = {"fbx": "FBX", "dae": "Collada|dae", "x3d": "X3D", "3ds": "3ds", "ply2": "ply2",
         "off": "OFF", "wrl": "VRML|wrl", "amf": "AMF", "3mf": "3MF"}
# By a word of the way: what may be refused, and the name that must be said then.
NAMES = {"surface": "POLYDATA",  # by meshio, which stops at it
         "draco": "KHR_draco_mesh_compression",
         "meshopt": "(EXT|KHR)_meshopt_compression"}
# By a word of the way: what else is told to pccdctl, and how exact the time is then.
OPTIONS = {"seam": ["--weld", "1e-9"]}
ROUGH = {"8": 2e-2, "quantize": 1e-3, "meshopt": 1e-3, "draco": 1e-3,
         "pc2": None, "resample": None}
NEVER = 2.0

Row = collections.namedtuple("Row", "program version scene way kind right said verdict")


def groups(folder):
    """The files of a folder that are judged together, by scene, way and ending."""
    found = collections.defaultdict(list)
    for name in sorted(os.listdir(folder)):
        parts = name.split(".")
        ending = parts[-1].lower()
        if len(parts) in (3, 4) and ending in READ | BY_PYTHON | set(KINDS):
            numbered = len(parts) == 4
            cache = parts[1] in ("pc2", "mdd")
            found[parts[0], parts[1], parts[1] if cache else ending].append(
                (int(parts[2]) if numbered else 0, os.path.join(folder, name)))
    return {key: [path for _, path in sorted(files)] for key, files in found.items()}


def ask(command, files):
    """Exit status, JSON or None, text."""
    try:
        done = subprocess.run(command + files, capture_output=True, timeout=60,
                              check=False)
    except subprocess.TimeoutExpired:
        return 124, None, "took more than a minute"
    text = done.stderr.decode(errors="replace")
    try:
        return done.returncode, json.loads(done.stdout), text
    except ValueError:
        return done.returncode, None, text


def first_time(said):
    """From 0 to 1 over all steps."""
    steps = said.get("steps", [said])
    for k, step in enumerate(steps):
        if step.get("toi_first") is not None:
            return (k + step["toi_first"]) / len(steps)
    return NEVER


def differences(right, said, rough):
    """What is said otherwise than it is."""
    wrong = []
    if said["triangles"] != right["triangles"]:
        wrong.append(f"{said['triangles']} triangles")
    # Of vertices that were made one, all but one are unused.
    places = said["vertices"] - said["unused_vertices"]
    if "welded" in said and places != right["places"]:
        wrong.append(f"{said['vertices']} vertices, {said['welded']} welded")
    crossed = said.get("steps", [said])[0].get("crossings", right.get("crossings"))
    if crossed != right.get("crossings", crossed):
        wrong.append(f"begins crossed {crossed} times")
    if said["contacts"] != right["contacts"]:
        wrong.append(f"{said['contacts']} contacts")
    elif rough is not None:
        first = float(Fraction(right["first"])) if "first" in right else None
        told = first_time(said)
        if first is not None and abs(told - first) > rough:
            wrong.append(f"first at {told:.9g}")
    if not said["complete"]:
        wrong.append("incomplete")
    return wrong


def in_words(right):
    text = f"{right['triangles']} triangles, {right['places']} places, "
    text += f"{right['contacts']} contacts"
    if right.get("crossings"):
        text += f", begins crossed {right['crossings']} times"
    return text + (f" from {right['first']} on" if "first" in right else "")


def judge(program, version, key, files, scenes):
    scene, way, kind = key
    right = dict(scenes[scene]["right"])
    right["triangles"] = right.get(way, right["triangles"])  # as the program has cut it
    words = set(re.split("[-_]", way))
    by_python = kind in BY_PYTHON
    command = [os.environ.get("PCCDCTL", "pccdctl")]
    if by_python:
        command = [os.environ.get("PCCD_PYTHON") or "python3", "-m", "pccd"]
    command += ["check", "--json"]
    for word in words & set(OPTIONS):
        command += OPTIONS[word]
    status, said, text = ask(command, files * 2 if len(files) == 1 and not right["moves"]
                             else files)
    if status == 3 and not by_python:
        sys.exit(f"nothing was judged: {text.strip()}")
    name = next((NAMES[w] for w in words if w in NAMES), KINDS.get(kind))
    must_refuse = kind in KINDS and not by_python
    lines = [line for line in text.strip().splitlines() if line]
    if said is not None and status in (0, 1):
        rough = max((ROUGH[w] or NEVER for w in words | {kind} if w in ROUGH),
                    default=1e-5)
        wrong = differences(right, said, rough)
        told = ", ".join(wrong) or f"{said['vertices']} vertices, " + (
            f"{said['welded']} welded, " if "welded" in said else "") + \
            f"{said['contacts']} contacts"
        verdict = "wrong" if wrong or must_refuse else "right"
    else:
        told = lines[-1] if lines else f"exit status {status}"
        for path in files:
            told = told.replace(path, "*." + kind)
        if re.search("No module named|has no meshio", told):
            verdict = "not judged"
        elif status not in (2, 4):
            verdict = "wrong"
        elif name is not None:
            named = re.search(name, told.replace("*." + kind, ""), re.IGNORECASE)
            verdict = "refused by name" if named else "refused without a name"
        else:
            verdict = "refused, is to be read"
    expected = f"refused, naming {name}" if must_refuse else in_words(right)
    return Row(program, version, scene, way, kind, expected, told, verdict)


def main():
    ask_for = argparse.ArgumentParser()
    ask_for.add_argument("--table", action="store_true")
    ask_for.add_argument("scenes")
    ask_for.add_argument("folders", nargs="+")
    asked = ask_for.parse_args()
    with open(asked.scenes, encoding="ascii") as file:
        scenes = json.load(file)
    rows = []
    for folder in asked.folders:
        program, _, version = os.path.basename(folder.rstrip("/")).rpartition("-")
        rows += [judge(program, version, key, files, scenes)
                 for key, files in sorted(groups(folder).items())]
    good = "right", "refused by name"
    if all(row.verdict == "not judged" for row in rows):
        sys.exit("nothing was judged: none can be by this Python")
    print("| program | version | scene | way | format | right | pccd says | verdict |")
    print("|---|---|---|---|---|---|---|---|")
    for row in rows:
        if asked.table or row.verdict not in good + ("not judged",):
            print("| " + " | ".join(row) + " |")
    counts = collections.Counter(row.verdict for row in rows)
    print(f"\n{len(rows)} items: " + ", ".join(
        f"{counts[verdict]} {verdict}" for verdict in
        good + ("not judged", "refused without a name", "refused, is to be read",
                "wrong")))
    return any(row.verdict not in good + ("not judged",) for row in rows)


if __name__ == "__main__":
    sys.exit(main())
