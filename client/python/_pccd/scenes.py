"""scenes.py - scenes, the objects in them, what these may meet, and who shares them.

Room:     client/python. May import: answer, link, restore, values, wire.
Does:     a request each; what was answered is kept for another daemon, and the last step
          that another client has made of a shared scene, until it is asked for.
Source:   client/lib/scene.c, client/lib/filter.c, client/lib/shared.c.
"""

from __future__ import annotations

from typing import Any, Dict, NamedTuple, Optional, Set

from .answer import Answer, hash_text
from .restore import Restore
from .values import Options, PccdError, failure
from .wire import (FEATURE_FILTERS, FEATURE_SHARED, SLOT_BYTES_MIN, ObjectWhat, Quality,
                   Share, Status)


class ObjectSettings(NamedTuple):
    """What an object may meet. Two objects are tested against each other if
    a.group & b.mask and b.group & a.mask have a bit in common each, and the pair is not
    ignored; an object against itself if its self_collision is on."""

    group: int  # of 64 bits: the groups that it is in; at first 1
    mask: int  # the groups that it may meet; at first all
    self_collision: bool


class SceneNews(NamedTuple):
    """The last step that another client has made in a shared scene."""

    number: int  # of the step among those of the scene, from 1
    mode: int
    incomplete: int
    total: int  # records, which scene_read gives
    hash: str


class Scenes(Restore):
    """A connection with scenes."""

    def __init__(self, options: Options) -> None:
        super().__init__(options)
        self._news: Dict[int, SceneNews] = {}  # that were not taken
        self._waiting: Set[int] = set()  # steps that wait for another client's

    def _check_feature(self, feature: int, what: str) -> None:
        if not self._features & feature:
            raise failure(Status.E_VERSION, f"the daemon at {self.url} has no {what}: it "
                          "is older than this client")

    def scene_create(self, quality: int = Quality.DEFAULT, rebuild_ratio: float = 0.0,
                     rebuild_triangles_max: int = 0, *, name: Optional[str] = None,
                     share: int = Share.CREATE, rights: int = 0,
                     owner: Optional[int] = None) -> int:
        """An empty scene. The first three say how its hierarchies are built and kept;
        zeros are the defaults, and the answers never depend on any of it.

        With a name the scene is shared with other clients of the daemon. share: make it
        (E_STATE: there is one), make it unless there is one, or take part (E_AGAIN: there
        is none yet). rights, of a scene that is made: who may take part, as a file's: 4
        to read, 2 to write besides; 0 = 0o600. E_ACCESS: this user may not. Each user has
        names of their own: with owner, the scene of that user is taken part in."""
        settings: Dict[str, Any] = {"quality": int(quality),
                                    "rebuild_ratio": float(rebuild_ratio),
                                    "rebuild_triangles_max": int(rebuild_triangles_max)}
        if share not in (Share.CREATE, Share.OPEN, Share.ATTACH):
            raise failure(Status.E_INVAL, "scene.create: share is Share.CREATE, OPEN or "
                          f"ATTACH, not {share!r}")
        if name is None and (share or rights or owner is not None):
            raise failure(Status.E_INVAL, "scene.create: only a scene with a name has "
                          "share, rights and owner")
        if owner is not None and share != Share.ATTACH:
            raise failure(Status.E_INVAL, "scene.create: with an owner, share is "
                          "Share.ATTACH: another user's scene is taken part in")
        if name is not None:
            self._check_feature(FEATURE_SHARED, "scenes that clients share")
            if not 1 <= len(name.encode()) <= 255:
                raise failure(Status.E_INVAL, "scene.create: a name has 1 to 255 bytes")
            settings.update(name=name, share=int(share), rights=int(rights))
            if owner is not None:
                settings.update(share=int(Share.OTHER), owner=int(owner))
        scene: int = self._call("scene.create", **settings)["scene"]
        if self._kept is not None:
            if name is not None and share == Share.CREATE:
                settings["share"] = int(Share.OPEN)  # others may be faster next time
            self._kept.add_scene(scene, settings)
        return scene

    def scene_destroy(self, scene: int) -> None:
        """Drop a scene and its objects; leave it if it is shared."""
        kept = self._kept
        self._news.pop(scene, None)
        self._wait(self._send("scene.destroy", {"scene": scene}, then=lambda call: (
            kept.remove_scene(scene) if kept is not None else None)))

    def scene_add(self, scene: int, mesh: int) -> int:
        """An object: an instance of a mesh, at the mesh's registered positions."""
        made: int = self._call("scene.add", scene=scene, mesh=mesh)["object"]
        if self._kept is not None:
            self._kept.add_object(scene, mesh, made, self._next_step)
        return made

    def scene_remove(self, scene: int, object: int) -> None:
        """Drop an object."""
        kept = self._kept
        self._wait(self._send("scene.remove", {"scene": scene, "object": object},
                              then=lambda call: (kept.remove_object(scene, object)
                                                 if kept is not None else None)))

    # -- what objects may meet --

    def object_set(self, scene: int, object: int, *, group: Optional[int] = None,
                   mask: Optional[int] = None,
                   self_collision: Optional[bool] = None) -> ObjectSettings:
        """Set what is given, for the steps that are submitted from now on, and return all
        of it. E_HANDLE, E_VERSION; E_ACCESS: the object is another client's."""
        self._check_feature(FEATURE_FILTERS, "filters")
        what: Dict[str, Any] = {}
        bits = 0
        for key, bit, value in (("group", ObjectWhat.GROUP, group),
                                ("mask", ObjectWhat.MASK, mask)):
            if value is not None:
                if not 0 <= value < 1 << 64:
                    raise failure(Status.E_INVAL, f"{key} is {value}, not of 64 bits")
                what[key] = int(value)
                bits |= bit
        if self_collision is not None:
            what["self"] = bool(self_collision)
            bits |= ObjectWhat.SELF
        result = self._wait(self._send(
            "object.set", {"scene": scene, "object": object, "what": bits, **what},
            then=lambda call: (self._kept.filter_object(scene, object, what)
                               if self._kept is not None and bits else None)))
        return ObjectSettings(result["group"], result["mask"], result["self"])

    def object_get(self, scene: int, object: int) -> ObjectSettings:
        """What an object may meet, as it is."""
        return self.object_set(scene, object)

    def pair_ignore(self, scene: int, object_a: int, object_b: int,
                    ignored: bool = True) -> int:
        """Have two objects ignore each other, or not any more; how many pairs of the
        scene do now. Removing either ends it. E_LIMIT; E_ACCESS: neither is ours."""
        self._check_feature(FEATURE_FILTERS, "filters")
        pair = {"scene": scene, "a": object_a, "b": object_b, "ignored": bool(ignored)}
        result = self._wait(self._send(
            "scene.ignore", pair,
            then=lambda call: (self._kept.ignore_pair(scene, object_a, object_b, ignored)
                               if self._kept is not None else None)))
        pairs: int = result["pairs"]
        return pairs

    # -- scenes that clients share --

    def scene_wait(self, scene: int, timeout: Optional[float] = None) \
            -> Optional[SceneNews]:
        """The last step that another client has made in a shared scene, once; steps may
        be left out, the last never is. None: none within the timeout (seconds; None: the
        client's own, 0: without waiting)."""
        deadline = self._deadline(timeout)
        while self._receive():
            pass
        while scene not in self._news and (timeout != 0 or not self._is_up):
            try:
                self._progress(deadline)
            except PccdError as problem:
                if problem.status != Status.E_TIMEOUT:
                    raise
                break
        return self._news.pop(scene, None)

    def scene_read(self, scene: int, number: int, cursor: int = 0) -> Answer:
        """A page of the answer to step `number` of a shared scene, whoever made it, as
        long as it is the last one (else E_STATE); to be released as any other."""
        if number < 1:
            raise failure(Status.E_INVAL, "steps count from 1")
        self._reserve(SLOT_BYTES_MIN)
        return Answer(0, self._call("frame.fetch", scene=scene, step=0, number=number,
                                    cursor=cursor))

    def _restore(self) -> None:
        self._waiting.clear()  # another daemon holds nothing yet
        super()._restore()

    def _notified(self, method: str, params: Dict[str, Any]) -> None:
        if method == "scene.held":
            self._waiting.add(params["step"])
            return
        if method != "scene.step":
            super()._notified(method, params)
            return
        self._news[params["scene"]] = SceneNews(
            params["number"], params["mode"], params["incomplete"], params["total"],
            hash_text(params))
