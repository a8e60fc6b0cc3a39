"""scenes.py - scenes whose content is known in fractions, for programs to write.

Room:     tests/files. The standard library; nothing of pccd.
Does:     say of each scene where its surfaces are at t = 0 and t = 1, and what is right
          of it: triangles, places (different positions of vertices), contacts that begin
          in between, when the first of them is. All coordinates are multiples of 1/64, so
          that six decimals and float32 hold them; contacts are counted in fractions, one
          by one.
Usage:    scenes.py FOLDER   writes FOLDER/scenes.json, FOLDER/NAME.0.obj and NAME.1.obj
"""

import itertools
import json
import os
import sys
from fractions import Fraction

F = Fraction


class Unsure(Exception):
    """Two features meet at a border: the scene says nothing that is sure."""


def box(low, high):
    """Vertices and quads."""
    vertices = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1])
                for z in (low[2], high[2])]
    return vertices, [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6),
                      (0, 2, 6, 4), (1, 5, 7, 3)]


def grid(cells, low, size, triangles=False):
    """A sheet at z = 0 of cells x cells quads, or each cut by the same diagonal."""
    vertices = [(low + size * i, low + size * j, 0) for i in range(cells + 1)
                for j in range(cells + 1)]
    faces = []
    for i, j in itertools.product(range(cells), repeat=2):
        a = i * (cells + 1) + j
        b = a + cells + 1
        faces += [(a, b, b + 1), (a, b + 1, a + 1)] if triangles else \
            [(a, b, b + 1, a + 1)]
    return vertices, faces


def spike(tip, half, height):
    """A pyramid of six triangles with its tip down; the base is square."""
    x, y, z = tip
    base = [(x + i * half, y + j * half, z + height) for i, j in
            ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return [tip] + base, [(0, 2, 1), (0, 3, 2), (0, 4, 3), (0, 1, 4), (1, 2, 3),
                          (1, 3, 4)]


def thing(name, shape, move=(0, 0, 0), **more):
    vertices, faces = shape
    return dict(name=name, vertices=[tuple(map(F, v)) for v in vertices],
                faces=[tuple(f) for f in faces], move=tuple(map(F, move)), **more)


COMB = [(0, 0), (5, 0), (5, 3), (4, 3), (4, 1), (3, 1), (3, 3), (2, 3), (2, 1), (1, 1),
        (1, 3), (0, 3)]
ELL = [(2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 0)]
DOWN = (0, 0, -2)
FRAMES = 24  # of an animation, at most
TIP = F(23, 32)  # above z = 0: it is there at 23/64


def polygon(corners, z=lambda x, y: 0):
    return [(x, y, z(x, y)) for x, y in corners], [tuple(range(len(corners)))]


def peg(x, y, z=TIP):
    return spike((x, y, z), F(1, 8), 4)


def slope(x, y):
    return F(x, 2) + F(y, 4)


def scenes():
    """By name: a list of things."""
    drop = thing("Spike", spike((F(1, 2), F(1, 4), TIP), F(1, 4), 4), DOWN)
    made = {
        "cube": [thing("Cube", box((-1, -1, -1), (1, 1, 1)))],
        "two": [thing("Left", box((-1, -1, -1), (1, 1, 1))),
                thing("Right", box((2, -1, -1), (4, 1, 1)))],
        "cloth": [thing("Cloth", grid(8, -4, 1), seams=True)],
        "ell": [thing("Ell", polygon(ELL)), thing("Peg", peg(F(5, 4), F(5, 4)), DOWN)],
        "comb": [thing("Comb", polygon(COMB)), thing("Peg", peg(F(3, 2), 2), DOWN),
                 thing("Pin", peg(F(7, 2), F(9, 4)), DOWN)],
        "slope": [thing("Slope", polygon(COMB, slope)),
                  thing("Peg", peg(F(3, 2), 2, TIP + 1), DOWN)],
        "flag": [thing("Flag", polygon([(0, 0), (1, 0), (2, 0), (2, 2), (0, 2)])),
                 thing("Peg", peg(F(5, 2), 1), DOWN)],
        "drop": [thing("Floor", grid(4, -2, 1)), drop],
        "pass": [thing("Floor", grid(4, -2, 1, triangles=True)),
                 thing("Spike", spike((F(21, 64), F(11, 64), TIP), 1, 2), DOWN)],
        "through": [thing("Floor", grid(4, -2, 1)),
                    thing("Spike", spike((F(1, 2), F(1, 4), F(-1)), F(1, 4), 4))],
        # The blade goes once through all of the body: each of its vertices meets it.
        "swing": [thing("Blade", ([(0, 0, -4), (0, 0, 4), (4, 0, 0)], [(0, 1, 2)]),
                        turn=True),
                  thing("Body", ([(1, F(9, 8), F(1, 4)), (F(5, 4), 1, F(3, 8)),
                                  (1, F(5, 4), F(1, 2)), (F(9, 8), F(7, 8), F(-1, 4))],
                                 [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)]))],
    }
    made["rain"] = [thing("Floor", grid(4, -2, 1))] + [
        thing(f"Spike{k}", spike((F(1, 2) + k, F(1, 4), TIP), F(1, 4), 4), DOWN)
        for k in range(-2, 2)]
    return made


def minus(a, b):
    return tuple(p - q for p, q in zip(a, b))


def cross(a, b):
    return tuple(a[i] * b[j] - a[j] * b[i] for i, j in ((1, 2), (2, 0), (0, 1)))


def det(a, b, c):
    return sum(x * y for x, y in zip(a, cross(b, c)))


def when(a, b, c, way):
    """The t in [0, 1] at which three vectors have no volume; the first one moves."""
    speed = det(way, b, c)
    t = -det(a, b, c) / speed if speed != 0 else -1
    return t if 0 <= t <= 1 else None


def sure(t, meet):
    if meet and t in (0, 1):
        raise Unsure("at an end of the motion")
    return t if meet else None


def inside(p, corners):
    """Whether p, in the plane of the polygon, is in it, by the largest projection."""
    n = [F(0)] * 3
    for a, b in zip(corners, corners[1:] + corners[:1]):
        n = [x + y for x, y in zip(n, cross(a, b))]
    away = max(range(3), key=lambda k: abs(n[k]))
    u, v = [k for k in range(3) if k != away]
    odd = False
    for a, b in zip(corners, corners[1:] + corners[:1]):
        side = (b[u] - a[u]) * (p[v] - a[v]) - (b[v] - a[v]) * (p[u] - a[u])
        within = min(a[u], b[u]) <= p[u] <= max(a[u], b[u])
        if side == 0 and within and min(a[v], b[v]) <= p[v] <= max(a[v], b[v]):
            raise Unsure("on a side")
        if (a[v] > p[v]) != (b[v] > p[v]):
            odd ^= (side > 0) == (b[v] > a[v])
    return odd


def meets_face(p, way, corners):
    a, b = corners[:2]
    c = next(c for c in corners[2:] if any(cross(minus(b, a), minus(c, a))))
    t = when(minus(p, a), minus(b, a), minus(c, a), way)
    if t is None:
        return None
    at = tuple(x + t * w for x, w in zip(p, way))
    return sure(t, inside(at, corners))


def meets_edge(p, q, way, a, b):
    u, v = minus(q, p), minus(b, a)
    t = when(minus(p, a), u, v, way)
    if t is None:
        return None
    w = minus(tuple(x + t * y for x, y in zip(p, way)), a)
    n = cross(u, v)
    size = sum(x * x for x in n)
    along_u, along_v = det(v, w, n) / size, det(u, w, n) / size
    if along_u in (0, 1) or along_v in (0, 1):
        raise Unsure("at an end of an edge")
    return sure(t, 0 < along_u < 1 and 0 < along_v < 1)


def edges(faces):
    """Those of the faces, and both diagonals of quads: nobody says which one cuts it."""
    sides, diagonals = set(), set()
    for f in faces:
        sides |= {tuple(sorted(pair)) for pair in zip(f, f[1:] + f[:1])}
        if len(f) == 4:
            diagonals |= {tuple(sorted(f[::2])), tuple(sorted(f[1::2]))}
    return sides, diagonals


def contacts(a, b):
    """The times of all contacts of two things, in fractions."""
    way = minus(a["move"], b["move"])
    back = tuple(-w for w in way)
    times = []
    for p, q, w in (a, b, way), (b, a, back):
        for v, f in itertools.product(p["vertices"], q["faces"]):
            times.append(meets_face(v, w, [q["vertices"][k] for k in f]))
    (sides_a, cuts_a), (sides_b, cuts_b) = edges(a["faces"]), edges(b["faces"])
    for e, f in itertools.product(sides_a | cuts_a, sides_b | cuts_b):
        t = meets_edge(*(a["vertices"][k] for k in e), way,
                       *(b["vertices"][k] for k in f))
        if t is not None and (e in cuts_a or f in cuts_b):
            raise Unsure("on a diagonal")
        times.append(t)
    return [t for t in times if t is not None]


def crossings(a, b):
    """How many edges of one pass through a face of the other at t = 0."""
    count = 0
    for one, other in (a, b), (b, a):
        sides, cuts = edges(one["faces"])
        for e, f in itertools.product(sides | cuts, other["faces"]):
            p, q = (one["vertices"][k] for k in e)
            t = meets_face(p, minus(q, p), [other["vertices"][k] for k in f])
            if t is not None and e in cuts:
                raise Unsure("a diagonal")
            count += t is not None
    return count


def truth(name, things):
    """What is right of a scene, whoever has written it."""
    right = {"triangles": sum(len(f) - 2 for one in things for f in one["faces"]),
             "places": len({v for one in things for v in one["vertices"]}),
             "moves": any(any(one["move"]) or "turn" in one for one in things),
             "crossings": sum(crossings(a, b)
                              for a, b in itertools.combinations(things, 2))}
    if name == "swing":
        return {**right, "contacts": 4}
    times = [t for a, b in itertools.combinations(things, 2)
             if any(minus(a["move"], b["move"])) for t in contacts(a, b)]
    if any((t * FRAMES).denominator == 1 for t in times):
        raise Unsure("at the end of a frame: in two steps")
    right["contacts"] = len(times)
    return {**right, "first": str(min(times))} if times else right


# What programs have of their own: Blender's, whose monkey has two pairs of its vertices
# at one place, and two triangles with the same corners once all is cut, of which Blender
# itself keeps one; and a sphere of three.js.
OWN = {"globe": {"triangles": 224, "places": 114},
       "ball": {"triangles": 960, "places": 482},
       "ico": {"triangles": 80, "places": 42},
       "monkey": {"triangles": 968, "places": 505, "cut": 967}}


def everything():
    """As JSON has it: numbers are doubles, which hold all of these fractions."""
    made = {name: {"things": [], "right": {**right, "moves": False, "contacts": 0}}
            for name, right in OWN.items()}
    for name, things in scenes().items():
        in_doubles = [{**one, "move": list(map(float, one["move"])),
                       "vertices": [list(map(float, v)) for v in one["vertices"]]}
                      for one in things]
        made[name] = {"things": in_doubles, "right": truth(name, things)}
    return made


def write_obj(path, things, moved):
    """The plainest file, for programs that only turn one format into another."""
    with open(path, "w", encoding="ascii") as out:
        first = 1
        for one in things:
            out.write(f"o {one['name']}\n")
            for v in one["vertices"]:
                x, y, z = v
                if moved and "turn" in one:  # by 90 degrees
                    x, y = -y, x
                at = [float(a + moved * m) for a, m in zip((x, y, z), one["move"])]
                out.write("v %.6f %.6f %.6f\n" % tuple(at))
            for f in one["faces"]:
                out.write("f " + " ".join(str(k + first) for k in f) + "\n")
            first += len(one["vertices"])


def main():
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "scenes.json"), "w", encoding="ascii") as out:
        json.dump(everything(), out)
    for name, things in scenes().items():
        for moved in (0, 1) if truth(name, things)["moves"] else (0,):
            write_obj(os.path.join(folder, f"{name}.{moved}.obj"), things, moved)


if __name__ == "__main__":
    main()
