"""scenes.py - meshes, scenes, objects, what these may meet, and who shares them.

Room:     client/python. May import: abi, answer, library, values, numpy.
Does:     a call of libpccd each; waits in parts, so that Ctrl-C ends them.
Source:   client/lib/pccd.h says of each call what it does.
"""

from __future__ import annotations

import ctypes
import math
import time
from ctypes import byref
from typing import Any, Callable, Dict, List, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import abi
from .abi import Share, Status, Tree
from .answer import Answer
from .library import PccdError, failure, lib, new_turn
from .points import Bodies, Shape
from .values import (BOX, EDGE, MeshInfo, ObjectSettings, SceneNews, enumerator,
                     format_of, object_settings, pack_indices, pack_vertices,
                     real_numbers, refusal, truth, u32, with_size)

SLICE_MS = 200  # of a wait: between two, Python sees to signals


class Scenes:
    """A connection with scenes; Client is all of it."""

    def __init__(self, timeout: float) -> None:
        self._handle = ctypes.c_void_p()
        self._turn = new_turn()
        self._timeout = timeout
        # Of every mesh its last MeshInfo, its handle, its triangles, once somebody has
        # asked its edges, and the dtype of its vertices; of every scene that of each
        # object's mesh.
        self._infos: Dict[int, List[Any]] = {}
        self._objects: Dict[int, Dict[int, List[Any]]] = {}
        self._keeps = True  # the triangles

    def _failure(self, status: int) -> PccdError:
        if not self._handle:
            return refusal(Status.E_DISCONNECTED, "the client is closed")
        return failure(self._handle, status)

    def _check_open(self) -> None:
        if not self._handle:
            raise self._failure(Status.E_DISCONNECTED)

    def _check(self, status: int) -> None:
        if status:
            raise self._failure(status)

    def _in_slices(self, call: Callable[[int], Any], timeout: Optional[float]) -> int:
        """The status of a call with a timeout in milliseconds, in parts of it."""
        left = 1000 * (self._timeout if timeout is None else max(0.0, timeout))
        end = 1000 * time.monotonic() + left
        while left > SLICE_MS:
            status = int(call(SLICE_MS))
            if status != Status.E_TIMEOUT:
                return status
            left = end - 1000 * time.monotonic()
        return int(call(max(0 if timeout == 0 else 1, math.ceil(left))))

    # -- meshes --

    def _mesh_put(self, mesh: int, x: ArrayLike, triangles: Optional[ArrayLike],
                  radii: Optional[ArrayLike], edges: Optional[ArrayLike],
                  points: Optional[ArrayLike]) -> int:
        vertices = pack_vertices("x", x)
        data, info = with_size(abi.pccd_mesh_data()), abi.pccd_mesh_info()
        data.x, data.format = vertices.ctypes.data, format_of(vertices.dtype)
        data.vertex_count = len(vertices)
        kept = []  # until the library has copied them
        faces: Optional[NDArray[np.uint32]] = np.empty((0, 3), np.uint32)
        for count, (name, given) in enumerate(
                (("points", points), ("edges", edges), ("triangles", triangles)), 1):
            if given is not None:
                kept.append(pack_indices(name, given, count))
                setattr(data, name, kept[-1].ctypes.data)
                setattr(data, name[:-1] + "_count", len(kept[-1]))
        if radii is not None:
            thick = np.ascontiguousarray(real_numbers("radii", radii), np.float64)
            if thick.shape != (len(vertices),):
                raise refusal(Status.E_INVAL, f"radii is {thick.shape}, not "
                              f"({len(vertices)},)")
            data.radii = thick.ctypes.data
        made = ctypes.c_uint32(mesh)
        if triangles is not None:
            faces = kept[-1].copy() if self._keeps else None
        self._check(lib.pccd_mesh_put(self._handle, byref(data), byref(made),
                                      byref(info)))
        now: List[Any] = [MeshInfo.of(info), made.value, faces, None, vertices.dtype]
        if mesh:
            self._infos[mesh][:] = now  # of its objects, too
        else:
            self._infos[made.value] = now
        return made.value

    def mesh_create(self, x: ArrayLike, triangles: Optional[ArrayLike] = None,
                    radii: Optional[ArrayLike] = None, *,
                    edges: Optional[ArrayLike] = None,
                    points: Optional[ArrayLike] = None) -> int:
        """Register a mesh, x: (n, 3) float32 or float64, triangles: (m, 3) vertex
        indices, radii: (n,), of vertices, for objects without a radius of their own.
        edges (m, 2), rods, and points (m,), clouds, are named by themselves; of the
        three one has to be there. Copied. E_NOTFINITE, E_INDEX, E_QUOTA, E_LIMIT,
        E_INVAL."""
        return self._mesh_put(0, x, triangles, radii, edges, points)

    def mesh_replace(self, mesh: int, x: ArrayLike,
                     triangles: Optional[ArrayLike] = None,
                     radii: Optional[ArrayLike] = None, *,
                     edges: Optional[ArrayLike] = None,
                     points: Optional[ArrayLike] = None) -> Any:
        """Give a mesh, and every object made of it, other vertices and triangles, at the
        positions given here; on failure they go on as they were. Its MeshInfo."""
        self.mesh_info(mesh)
        return self.mesh_info(self._mesh_put(mesh, x, triangles, radii, edges, points))

    def mesh_info(self, mesh: int) -> Any:
        """The MeshInfo of when the mesh was made or replaced last."""
        if u32("mesh", mesh) not in self._infos:
            raise refusal(Status.E_HANDLE, f"there is no mesh 0x{mesh:x}")
        return self._infos[mesh][0]

    def mesh_edges(self, mesh: int) -> NDArray[np.uint32]:
        """The unique edges (edge_count, 2) in the order of the records' feature numbers:
        vertex indices, the lower one first."""
        edges = np.empty(self.mesh_info(mesh).edge_count, EDGE)
        self._check(lib.pccd_mesh_edges(self._handle, u32("mesh", mesh),
                                        edges.ctypes.data, len(edges)))
        return edges.view(np.uint32).reshape(-1, 2)

    def mesh_destroy(self, mesh: int) -> None:
        """Drop a mesh; objects made of it stay."""
        self._check(lib.pccd_mesh_destroy(self._handle, u32("mesh", mesh)))
        self._infos.pop(mesh, None)

    # -- scenes and objects --

    def scene_create(self, *, name: Optional[str] = None,
                     share: Union[int, str] = Share.CREATE, rights: int = 0,
                     owner: Optional[int] = None) -> int:
        """An empty scene.

        With a name the scene is shared with other clients of the daemon. share: make it
        (E_STATE: there is one), make it unless there is one, or take part (E_AGAIN: there
        is none yet). rights, of a scene that is made: who may take part, as a file's: 4
        to read, 2 to write besides; 0 = 0o600. E_ACCESS: this user may not. Each user has
        names of their own: with owner, the scene of that user is taken part in."""
        share = enumerator(Share, "share", share)
        if share not in (Share.CREATE, Share.OPEN, Share.ATTACH):
            raise refusal(Status.E_INVAL, "scene.create: share is Share.CREATE, OPEN or "
                          f"ATTACH, not {share!r}")
        if name is None and (share or rights or owner is not None):
            raise refusal(Status.E_INVAL, "scene.create: only a scene with a name has "
                          "share, rights and owner")
        if owner is not None and share != Share.ATTACH:
            raise refusal(Status.E_INVAL, "scene.create: with an owner, share is "
                          "Share.ATTACH: another user's scene is taken part in")
        scene = ctypes.c_uint32()
        text = None if name is None else name.encode()
        if owner is not None:
            self._check(lib.pccd_scene_join(self._handle, u32("owner", owner), text,
                                            byref(scene)))
            return scene.value
        settings = with_size(abi.pccd_scene_settings(
            name=text, share=share, rights=u32("rights", rights)))
        self._check(lib.pccd_scene_create(self._handle, byref(settings), byref(scene)))
        return scene.value

    def scene_destroy(self, scene: int) -> None:
        """Drop a scene and its objects; leave it if it is shared."""
        self._check(lib.pccd_scene_destroy(self._handle, u32("scene", scene)))
        self._objects.pop(scene, None)

    def scene_add(self, scene: int, mesh: int) -> int:
        """An object: an instance of a mesh, at the mesh's registered positions."""
        made = ctypes.c_uint32()
        self._check(lib.pccd_scene_add(self._handle, u32("scene", scene),
                                       u32("mesh", mesh), byref(made)))
        if mesh in self._infos:
            self._objects.setdefault(scene, {})[made.value] = self._infos[mesh]
        return made.value

    def scene_remove(self, scene: int, object: int) -> None:
        """Drop an object."""
        self._check(lib.pccd_scene_remove(self._handle, u32("scene", scene),
                                          u32("object", object)))
        self._objects.get(scene, {}).pop(object, None)

    def bodies(self, scene: int) -> Bodies:
        """What this client's objects in a scene are made of, for stencils, points and
        manifolds of records; until objects or meshes change. E_STATE: the client was told
        not to keep that (keep=False); E_HANDLE: a mesh is destroyed, and nobody has asked
        for its edges before."""
        shapes = {}
        for handle, mesh in self._objects.get(u32("scene", scene), {}).items():
            if mesh[2] is None:
                raise refusal(Status.E_STATE, "bodies: this client keeps no triangles")
            edges = self.mesh_edges(mesh[1]) if mesh[3] is None else mesh[3]
            mesh[3] = edges
            shapes[handle] = Shape(mesh[0].vertex_count, mesh[2], edges)
        return Bodies(shapes)

    def _check_whole(self, scene: int, object: int, count: int) -> None:
        """That so many vertices are all that an object has."""
        info = self._objects.get(scene, {}).get(object)
        if info is not None and info[0].vertex_count != count:
            raise refusal(Status.E_SEGMENT, f"{count} vertices for object 0x{object:x}, "
                          f"which has {info[0].vertex_count}: Motions move a part")

    def _dtype_of(self, scene: int, object: int) -> Any:
        """That in which the vertices of an object's mesh were given."""
        info = self._objects.get(scene, {}).get(object)
        return np.dtype(np.float32) if info is None else info[4]

    def scene_boxes(self, scene: int, tree: Union[int, str],
                    level: int) -> NDArray[Any]:
        """The boxes (BOX) of a level of a scene's hierarchies, the root being level 0,
        as the last step that used the tree left them; none beyond the last level."""
        boxes, count = np.empty(0, BOX), ctypes.c_uint32(1)
        while True:
            self._check(lib.pccd_scene_boxes(
                self._handle, u32("scene", scene), enumerator(Tree, "tree", tree),
                u32("level", level),
                boxes.ctypes.data, len(boxes), byref(count)))
            if count.value <= len(boxes):
                return boxes[:count.value]
            boxes = np.empty(count.value, BOX)

    # -- what objects may meet --

    def object_set(self, scene: int, object: int,
                   **attributes: Optional[float]) -> ObjectSettings:
        """Set those of ObjectSettings that are given, for steps submitted from then on,
        and return all of them. E_HANDLE; E_ACCESS: the object is another
        client's."""
        settings = object_settings(attributes)
        if settings.what:
            self._check(lib.pccd_object_set(self._handle, u32("scene", scene),
                                            u32("object", object), byref(settings)))
        return self.object_get(scene, object)

    def object_name(self, scene: int, object: int, name: str) -> None:
        """Say what an object is called, for the people who look at a recording of this
        client; "": it has no name any more. E_HANDLE; E_INVAL: more than 255 bytes."""
        self._check(lib.pccd_object_name(self._handle, u32("scene", scene),
                                         u32("object", object), name.encode()))

    def object_get(self, scene: int, object: int) -> ObjectSettings:
        """What an object may meet, as it is."""
        settings = with_size(abi.pccd_object_settings())
        self._check(lib.pccd_object_get(self._handle, u32("scene", scene),
                                        u32("object", object), byref(settings)))
        return ObjectSettings(*(getattr(settings, name)
                                for name in ObjectSettings._fields))

    def user_data(self, scene: int, objects: ArrayLike) -> NDArray[np.uint64]:
        """Of each object, in an array of any shape, its user_data as this client has last
        set or got it, else 0: user_data(scene, answer.contacts["object_a"]). The daemon
        is not asked."""
        handles = np.asarray(objects, order="C")
        if handles.dtype != np.uint32:
            handles = np.reshape([u32("an object", one) for one in handles.flat],
                                 handles.shape).astype(np.uint32)
        numbers = np.empty(handles.shape, np.uint64)
        self._check(lib.pccd_user_data(self._handle, u32("scene", scene),
                                       handles.ctypes.data, handles.size,
                                       numbers.ctypes.data))
        return numbers

    def pair_ignore(self, scene: int, object_a: int, object_b: int,
                    ignored: bool = True) -> None:
        """Have two objects ignore each other, or not any more. Removing either ends it.
        E_LIMIT; E_ACCESS: neither is ours."""
        self._check(lib.pccd_pair_ignore(self._handle, u32("scene", scene),
                                         u32("object_a", object_a),
                                         u32("object_b", object_b),
                                         truth("ignored", ignored)))

    def pair_clearance(self, scene: int, object_a: int, object_b: int,
                       clearance: float) -> None:
        """Have two objects meet in steps within this distance and the separation, in the
        place of their radii: at 0 where their features pass through each other. Removing
        either ends it, and so does pair_ignore. E_INVAL; E_LIMIT; E_ACCESS: neither is
        ours."""
        self._check(lib.pccd_pair_clearance(self._handle, u32("scene", scene),
                                            u32("object_a", object_a),
                                            u32("object_b", object_b), clearance))

    # -- scenes that clients share --

    def scene_wait(self, scene: int, timeout: Optional[float] = None) -> Any:
        """The last step that another client has made in a shared scene, once, as
        SceneNews; steps may be left out, the last never is. None: none within the timeout
        (seconds; None: the client's own, 0: without waiting)."""
        scene, news = u32("scene", scene), abi.pccd_scene_news()
        status = self._in_slices(
            lambda ms: lib.pccd_scene_wait(self._handle, scene, ms, byref(news)), timeout)
        if status in (Status.E_AGAIN, Status.E_TIMEOUT):
            return None
        self._check(status)
        return SceneNews.of(news)

    def scene_read(self, scene: int, number: int, cursor: int = 0) -> Answer:
        """A page of the answer to step `number` of a shared scene, whoever made it, as
        long as it is the last one (else E_STATE); to be released as any other."""
        answer = self._new_answer()
        self._check(lib.pccd_scene_read(self._handle, u32("scene", scene), int(number),
                                        int(cursor), byref(answer)))
        answer._come(self)
        return answer

    def _new_answer(self) -> Answer:
        raise NotImplementedError
