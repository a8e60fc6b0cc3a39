"""raw_client.py - a client written from PROTOCOL.md, and from nothing else.

Room:     tests/python. The standard library and msgpack; nothing of ours.
Does:     what a client in another language would do first: connect, hello, shared memory,
          a mesh, a scene, steps, pages of records; go on with a session whose connection
          was lost, and make it anew with another daemon. Section names in the comments
          are those of PROTOCOL.md.
Does not: spin, keep several steps in flight by itself, or start daemons.
"""

import array
import fcntl
import mmap
import os
import select
import socket
import struct
import threading
import time

import msgpack

PAYLOADS = 0x1000  # "The upload ring"
CLIENT_WAIT, RESULT_HEAD, SLOT, SLOT_BYTES = 0x200, 0x280, 0x400, 64
SEGMENT = struct.Struct("<IHHIIQQ")  # "A step"
X1, X0X1, RIGID = 0, 1, 2
F32, F64 = 0, 1
CONTACT = struct.Struct("<IIIIIIdd2f3fI")  # "Records"
NEAR = struct.Struct("<IIIIIIdd2f3fI")  # "What is near"
BOUND = struct.Struct("<d")
EDGE = struct.Struct("<II")
F_GET_SEALS = 1034
SEALS, FUTURE_WRITE = 0x1 | 0x2 | 0x4, 0x10


class Refused(Exception):
    """An error of the daemon's."""

    def __init__(self, code, name, text, fatal, *_newer):
        super().__init__(f"{name}: {text}")
        self.code, self.name, self.text, self.fatal = code, name, text, fatal


class Lost(Exception):
    """The connection is at its end."""


class RawClient:
    """One connection at a time. `unanswered` has the requests that no answer came to."""

    def __init__(self, path, timeout=20, **said):
        self.path, self.timeout = path, timeout
        self.said = {"client": "raw", "resumable": True, **said}
        self.next_id, self.unanswered, self.answers = 1, {}, {}
        self.notifications = []
        self.upload = self.result = None
        self.fence = threading.Lock()  # taken and given back: a full fence
        self.session = self.connect()

    # -- "Transport", "Messages" --

    def connect(self, **resume):
        """A connection that has said hello; what was agreed on."""
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.socket.connect(self.path)
        return self.call("hello", version_min=1, version_max=1, **self.said, **resume)

    def cut(self):
        """Lose the connection, as by a crash in between."""
        self.socket.close()

    def send(self, method, **params):
        """Send a request; its id."""
        id_, self.next_id = self.next_id, self.next_id + 1
        message = msgpack.packb([0, id_, method, params])
        if method != "hello":
            self.unanswered[id_] = message
        self.transmit(message)
        return id_

    def transmit(self, message):
        """One datagram."""
        try:
            self.socket.sendall(message)
        except OSError as problem:
            raise Lost(str(problem)) from None

    def receive(self):
        """Take one message in, with the descriptors that came with it."""
        if not select.select([self.socket], [], [], self.timeout)[0]:
            raise Lost("no answer")
        fds = array.array("i")
        try:
            data, control, _, _ = self.socket.recvmsg(1 << 16, socket.CMSG_SPACE(8))
        except OSError as problem:
            raise Lost(str(problem)) from None
        if not data:
            raise Lost("closed")
        for level, kind, content in control:
            if level == socket.SOL_SOCKET and kind == socket.SCM_RIGHTS:
                fds.frombytes(content)
        message = msgpack.unpackb(data)
        if message[0] == 2:
            self.notifications.append(tuple(message[1:3]))
        else:
            self.unanswered.pop(message[1], None)
            self.answers[message[1]] = (message[2], message[3], list(fds))

    def wait(self, id_):
        """The result of a request, or its error."""
        while id_ not in self.answers and 0 not in self.answers:
            self.receive()
        # A fatal error may name no request.
        error, result, fds = self.answers.pop(id_ if id_ in self.answers else 0)
        if error is not None:
            raise Refused(*error)
        return {**result, "descriptors": fds} if fds else result

    def call(self, method, **params):
        """A request and its result."""
        return self.wait(self.send(method, **params))

    # -- "The upload ring" --

    @staticmethod
    def map(fd, size, writable):
        """Map a memory after a look at its seals: without them a read could kill us. That
        of the answers can be written by nobody here."""
        seals = fcntl.fcntl(fd, F_GET_SEALS)
        mode = fcntl.fcntl(fd, fcntl.F_GETFL) & os.O_ACCMODE
        read_only = mode == os.O_RDONLY or seals & FUTURE_WRITE != 0
        assert seals & SEALS == SEALS and read_only != writable, (seals, mode)
        assert os.fstat(fd).st_size == size
        access = mmap.PROT_READ | mmap.PROT_WRITE if writable else mmap.PROT_READ
        memory = mmap.mmap(fd, size, mmap.MAP_SHARED, access)
        os.close(fd)
        return memory

    def attach(self, slot_count=4, slot_bytes=1 << 16, result_bytes=1 << 20):
        """Both memories; the slots are free."""
        told = self.call("shm.attach", slot_count=slot_count, slot_bytes=slot_bytes,
                         result_bytes=result_bytes)
        fds = told.pop("descriptors")
        assert len(fds) == 2, fds
        self.upload = self.map(fds[0], told["upload_bytes"], True)
        self.result = self.map(fds[1], told["result_bytes"], False)
        self.words = memoryview(self.upload)[:PAYLOADS].cast("Q")
        self.stride, self.slot_count = told["slot_stride"], told["slot_count"]
        self.next_slot = 0
        return told

    def fenced(self):
        """A full fence."""
        with self.fence:
            pass

    # -- "Writing a slot" --

    def write_slot(self, payload):
        """The next slot in turn, which must be free; what a request says of it."""
        assert len(payload) <= self.stride
        slot, self.next_slot = self.next_slot, (self.next_slot + 1) % self.slot_count
        word = (SLOT + slot * SLOT_BYTES) // 8
        self.words[word] += 1  # odd: being written
        self.fenced()
        begin = PAYLOADS + slot * self.stride
        self.upload[begin:begin + len(payload)] = payload
        self.fenced()
        self.words[word] += 1
        return {"slot": slot, "seq": self.words[word]}

    # -- "A step" --

    def make_mesh(self, vertices, triangles, want=0):
        """A mesh of (x, y, z) and (a, b, c); what the commit says, and its handle."""
        mesh = self.call("mesh.create", vertex_count=len(vertices), want=want,
                         triangle_count=len(triangles))["mesh"]
        for part, code, rows in ((0, "d", vertices), (1, "I", triangles)):
            size = 24 if part == 0 else 12
            for first in range(0, len(rows), self.stride // size):
                chunk = rows[first:first + self.stride // size]
                data = struct.pack(f"<{3 * len(chunk)}{code}",
                                   *(number for row in chunk for number in row))
                self.call("mesh.data", mesh=mesh, part=part, first=first,
                          format=F64 if part == 0 else 0, count=len(chunk),
                          **self.write_slot(data))
        return {**self.call("mesh.commit", mesh=mesh), "mesh": mesh}

    def write_motions(self, motions):
        """(object, first, ...) move to x1, from x0 to x1, or by m0 and m1; what a
        request says of its slot. A motion: {"object": handle, "first": 0, "x1": rows,
        ...}."""
        table = len(motions) * SEGMENT.size
        head, body = b"", b""
        for motion in motions:
            kind = RIGID if "m0" in motion else X0X1 if "x0" in motion else X1
            places = []
            for key in (("m0", "m1") if kind == RIGID else ("x0", "x1")):
                rows = motion.get(key)
                places.append(table + len(body) if rows is not None else 0)
                if rows is not None:
                    flat = [number for row in rows for number in row]
                    body += struct.pack(f"<{len(flat)}d", *flat)
            head += SEGMENT.pack(motion["object"], kind, F64, motion.get("first", 0),
                                 motion.get("count") or len(motion["x1"]), *places)
        where = self.write_slot(head + body) if motions else {}
        return {"segments": len(motions), **where}

    def submit(self, scene, motions, **settings):
        """A step; its message's id."""
        return self.send("frame.submit", scene=scene, **self.write_motions(motions),
                         **settings)

    def step(self, scene, motions, **settings):
        """The same; its answer, with `contacts` of all its pages."""
        return self.all_pages(scene, self.wait(self.submit(scene, motions, **settings)))

    # -- "Records", "The result region" --

    def records(self, answer, layout):
        """The records of a page, which is given back."""
        if not answer.get("count"):
            return []
        size = layout.size * answer["count"]
        page = self.result[answer["offset"]:answer["offset"] + size]
        self.fenced()  # every read of the page comes before the store
        self.words[RESULT_HEAD // 8] = answer["release"]
        return list(layout.iter_unpack(page))

    def all_pages(self, scene, answer):
        """An answer with the records of further pages, too."""
        assert answer.get("record_bytes", CONTACT.size) in (0, CONTACT.size), answer
        answer["contacts"] = self.records(answer, CONTACT)
        page = answer
        while page.get("incomplete") == 1 and page.get("cursor", 0) < answer["total"]:
            page = self.call("frame.fetch", scene=scene, step=answer["step"],
                             cursor=page["cursor"])
            answer["contacts"] += self.records(page, CONTACT)
        return answer

    # -- "What is near" --

    def near(self, scene, motions=(), what=0, end=1, **settings):
        """What is near after the motions; the answer, with `near` of all its pages."""
        layout = BOUND if what == 2 else NEAR
        page = answer = self.call("scene.near", scene=scene, what=what, end=end,
                                  **self.write_motions(motions), **settings)
        answer["near"] = self.records(page, layout)
        while page.get("incomplete") == 1 and page.get("cursor", 0) < answer["total"]:
            page = self.call("near.fetch", scene=scene, step=answer["step"],
                             cursor=page["cursor"])
            answer["near"] += self.records(page, layout)
        return answer

    def edges(self, mesh, count):
        """The edges of a mesh."""
        found = []
        while len(found) < count:
            found += self.records(self.call("mesh.edges", mesh=mesh, first=len(found),
                                            count=count - len(found)), EDGE)
        return found

    # -- "Completion without a wake-up" --

    def wait_quietly(self, id_):
        """As a client that lets a daemon leave out wake-ups: it says that it will
        block."""
        while id_ not in self.answers:
            self.words[CLIENT_WAIT // 8] = 1
            self.fenced()
            try:
                self.receive()
            finally:
                self.words[CLIENT_WAIT // 8] = 0
        return self.wait(id_)

    # -- "When the connection is lost" --

    def resume(self):
        """Another connection; whether the session goes on. What has no answer is sent
        once more, in order, and unchanged."""
        old, until = self.session, time.monotonic() + self.timeout
        while True:
            self.cut()
            try:
                self.session = self.connect(
                    resume_epoch=old["epoch"], resume_session=old["session"],
                    token_hi=old.get("token_hi", 0), token_lo=old.get("token_lo", 0))
                break
            except (Lost, OSError):  # the next daemon is not there yet
                if time.monotonic() > until:
                    raise
                time.sleep(0.01)
        if not self.session.get("resumed", False):
            return False
        for id_ in sorted(self.unanswered):
            self.transmit(self.unanswered[id_])
        return True

    def close(self):
        """Nobody comes back."""
        self.send("bye")
        self.socket.close()
