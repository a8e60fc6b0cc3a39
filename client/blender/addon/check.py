"""check.py - checks objects frame by frame.

Room:     client/blender. Needs numpy and pccd; no Blender.
Does:     ask at each frame which edges pass through which faces and what is too near, and
          of each two frames what meets between them; gather that by objects.
Does not: know where shapes come from: it is given a function that tells them.
Threads:  one. tick() takes as long as one frame does; between two ticks it may be
          cancelled.
"""

import dataclasses

import numpy as np

from .library import pccd
from .shape import Refusal, check_same, check_shape

PLACES_MAX = 1000  # of one finding that are kept, the first in time
LENGTH_MAX = 1e18
KINDS = {
    "crossing": "cross",  # edges pass through faces at the frame
    "touch": "touch",  # at the frame; without a thickness
    "near": "are within the thickness of each other",  # at the frame
    "contact": "meet on the way to the next frame",
}


@dataclasses.dataclass(frozen=True)
class Settings:
    """What is asked. radius: half of the thickness, in Blender's units. rest_distance,
    rest_rings: pairs of one object that are nearer than that in the first frame, or that
    so few edges join, have no thickness. steps: how many straight pieces the way from a
    frame to the next is cut into. with_self: whether an object may meet itself."""

    first: int
    last: int
    radius: float = 0.0
    rest_distance: float = 0.0
    rest_rings: int = 0
    steps: int = 1
    with_self: bool = True

    def __post_init__(self):
        if self.last < self.first:
            raise Refusal(f"frames {self.first} to {self.last}: the last is before the "
                          "first")
        for name, value in (("thickness", self.radius),
                            ("rest exclusion", self.rest_distance)):
            if not 0 <= value <= LENGTH_MAX:
                raise Refusal(f"{name} {value}: a length from 0 to 1e18")
        if not 0 <= self.rest_rings <= 8:
            raise Refusal(f"rings {self.rest_rings}: from 0 to 8")
        if not 1 <= self.steps <= 100:
            raise Refusal(f"steps {self.steps}: from 1 to 100 a frame")


@dataclasses.dataclass(frozen=True)
class Finding:
    """One kind of thing between two objects, or within one, at a frame or on the way to
    the next. frame: where the way begins; not whole where a frame has several steps.
    count: how many pairs of features. time: of the first, 0 .. 1 of the step; 0 at a
    frame. places (k, 3) and times (k,): of the first of them in time."""

    frame: float
    to: float
    kind: str
    objects: tuple
    count: int
    time: float
    places: np.ndarray
    times: np.ndarray


class Check:
    """A check that goes on by a frame with each tick().

    source(moment, with_triangles)    the shapes at a frame, always the same objects in
                                      the same order; Refusal
    findings, frames, steps           what was found so far: Finding, and a dictionary
                                      for each frame and each step (report.py)
    total, done                       how many ticks there are, and were
    """

    def __init__(self, settings, source):
        self.settings = settings
        self.findings, self.frames, self.steps = [], [], []
        self.total = (settings.last - settings.first) * settings.steps + 1
        self.done, self._is_to_end = 0, False
        self.meshes = []  # of each object: its name and MeshInfo
        self._source = source
        self._client = self._moves = None
        self._shapes, self._x0, self._x1 = [], None, None

    def moment(self, number):
        """The frame of a tick; an int where it is whole."""
        whole, rest = divmod(number, self.settings.steps)
        frame = self.settings.first + whole
        return frame + rest / self.settings.steps if rest else frame

    @property
    def is_complete(self):
        """Whether every frame was looked at, and nothing was left out."""
        return self.done == self.total and \
            all(one["complete"] for one in self.frames + self.steps)

    @property
    def is_cancelled(self):
        """Whether cancel() has left frames out."""
        return self._is_to_end and self.done < self.total

    def tick(self):
        """Look at the next frame. Whether there are more. Whatever is raised ends it."""
        if self._is_to_end or self.done == self.total:
            self.close()
            return False
        moment = self.moment(self.done)
        try:
            shapes = self._source(moment, self.done == 0)
            for shape in shapes:
                check_shape(shape, moment)
            if self.done == 0:
                self._begin(shapes)
            else:
                self._move(shapes, moment)
            self._look(moment)
            self.done += 1
        except pccd.PccdError as problem:
            self.close()
            raise Refusal(f"frame {moment:g}: {problem}") from None
        except BaseException:
            self.close()
            raise
        if self.done == self.total:
            self.close()
        return self.done < self.total

    def cancel(self):
        """The next tick ends it; what was found stays. [also from a signal]"""
        self._is_to_end = True

    def close(self):
        """Free what the library has; may be called twice."""
        client, self._client = self._client, None
        if client is not None:
            client.close()

    # -- what is asked --

    def _begin(self, shapes):
        """Register the objects as they are in the first frame."""
        if not shapes:
            raise Refusal("no object to check")
        client = self._client = pccd.connect("direct:", name="blender", timeout=3600)
        self._scene = client.scene_create()
        self._moves, self._handles, self._of = pccd.Motions(), [], {}
        vertices = np.cumsum([0] + [len(shape.x) for shape in shapes])
        self._first_vertex = vertices[:-1]
        self._x1 = np.concatenate([shape.x for shape in shapes])
        self._x0 = self._x1.copy()
        triangles, edges = [], []
        for k, shape in enumerate(shapes):
            try:
                mesh = client.mesh_create(shape.x, shape.triangles)
            except pccd.PccdError as problem:
                raise Refusal(f'"{shape.name}": {problem}') from None
            info = client.mesh_info(mesh)
            self.meshes.append((shape.name, info))
            triangles.append(shape.triangles + vertices[k])
            edges.append(client.mesh_edges(mesh) + vertices[k])
            handle = client.scene_add(self._scene, mesh)
            client.object_name(self._scene, handle, shape.name)
            client.object_set(self._scene, handle, radius=self.settings.radius,
                              rest_distance=self.settings.rest_distance,
                              rest_rings=self.settings.rest_rings,
                              self_collision=self.settings.with_self)
            self._of[handle] = k
            self._moves.x1(handle, self._x1[vertices[k]:vertices[k + 1]])
        self._triangles, self._edges = np.concatenate(triangles), np.concatenate(edges)
        self._first_triangle = np.cumsum([0] + [len(t) for t in triangles])[:-1]
        self._first_edge = np.cumsum([0] + [len(e) for e in edges])[:-1]
        self._shapes = shapes

    def _move(self, shapes, moment):
        """What meets from the last frame to this one."""
        before = self.moment(self.done - 1)
        if [shape.name for shape in shapes] != [shape.name for shape in self._shapes]:
            raise Refusal(f"other objects at frame {moment:g} than before")
        for was, shape in zip(self._shapes, shapes):
            check_same(was, shape, before, moment)
        self._x0[:] = self._x1
        np.concatenate([shape.x for shape in shapes], out=self._x1)
        with self._client.step(self._scene, self._moves) as answer:
            told = {"from": before, "to": moment, "mode": "all",
                    "contacts": answer.total, **self._kinds(answer),
                    "possible": answer.possible, "initial": answer.initial,
                    "toi_first": answer.toi_first if answer.toi_first <= 1 else None,
                    "safe_step": answer.safe_step, "crowded": bool(answer.crowded),
                    "hash": answer.hash}
            records, told["complete"] = self._records(answer)
        self.steps.append(told)
        # What is too near at the frame already was told of the frame.
        records = records[records["flags"] & pccd.ContactFlag.INITIAL == 0]
        self._gather("contact", before, moment, records, records["toi"])

    def _look(self, moment):
        """What crosses, touches or is too near at the frame."""
        what = pccd.NearWhat
        with self._client.near(self._scene, what.CROSSINGS) as answer:
            told = {"frame": moment, "crossings": answer.crossings,
                    "verdict": pccd.Verdict(answer.verdict).name.lower()}
            records, told["complete"] = self._records(answer)
        self._gather("crossing", moment, moment, records, np.zeros(len(records)))
        with self._client.near(self._scene, what.PAIRS) as answer:
            records, is_whole = self._records(answer)
            told["near"] = answer.total
        told["complete"] = told["complete"] and is_whole
        self.frames.append(told)
        self._gather("near" if self.settings.radius else "touch", moment, moment, records,
                     np.zeros(len(records)))

    def _records(self, answer):
        """All records of an answer, a copy, and whether none is missing."""
        parts, missing = [], pccd.Incomplete.COMPLETE
        for page in self._client.pages(self._scene, answer):
            parts.append(page.records.copy())
            missing = page.incomplete
        return np.concatenate(parts), missing == pccd.Incomplete.COMPLETE

    @staticmethod
    def _kinds(answer):
        return {kind.name.lower(): answer.counts[kind] for kind in pccd.Kind}

    # -- what was found --

    def _gather(self, kind, frame, to, records, times):
        """A finding for each two objects."""
        if len(records) == 0:
            return
        a, b = (np.array([self._of[handle] for handle in records[name].tolist()])
                for name in ("object_a", "object_b"))
        pairs, which = np.unique(np.stack([np.minimum(a, b), np.maximum(a, b)], 1),
                                 axis=0, return_inverse=True)
        for k, pair in enumerate(pairs):
            mine = np.flatnonzero(which.reshape(-1) == k)
            kept = mine[np.argsort(times[mine], kind="stable")[:PLACES_MAX]]
            names = dict.fromkeys(self._shapes[i].name for i in pair)
            self.findings.append(Finding(
                frame, to, kind, tuple(names), len(mine), float(times[mine].min()),
                self._places(records[kept], a[kept], b[kept], times[kept]),
                times[kept]))

    def _places(self, records, a, b, times):
        """Where, (k, 3): the middle between the nearest points of both features."""
        share = times[:, None, None]
        p, q = records["param"].astype(float).T
        places = np.empty((len(records), 3))
        for kind in np.unique(records["kind"]):
            mine = np.flatnonzero(records["kind"] == kind)
            ends = []
            for side, name in ((a, "feature_a"), (b, "feature_b")):
                vertices, weights = self._feature(kind, name == "feature_b", side[mine],
                                                  records[name][mine], p[mine], q[mine])
                x = self._x1[vertices]
                if share.any():
                    x0 = self._x0[vertices]
                    x = x0 + share[mine] * (x - x0)
                ends.append(np.einsum("ck,ckd->cd", weights, x))
            if kind == pccd.NearKind.EF:  # it tells where along its edge alone
                ends[1] = ends[0]
            places[mine] = (ends[0] + ends[1]) / 2
        return places

    def _feature(self, kind, is_b, objects, features, p, q):
        """The vertices (k, 1 .. 3) of features, and the weights of the point meant."""
        one = np.ones_like(p)
        if kind in (pccd.Kind.VF, pccd.NearKind.EF) and is_b:
            return (self._triangles[self._first_triangle[objects] + features],
                    np.stack([one - p - q, p, q], 1))
        if kind == pccd.Kind.VF:
            return (self._first_vertex[objects] + features)[:, None], one[:, None]
        if kind in (pccd.Kind.EE, pccd.NearKind.EF):
            at = q if is_b else p
            return (self._edges[self._first_edge[objects] + features],
                    np.stack([one - at, at], 1))
        raise Refusal(f"an answer has contacts of the kind {kind}, which has no place")
