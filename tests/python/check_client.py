"""check_client.py - every call of the Python module against a real daemon.

Room:     tests/python. Needs PCCD_DAEMON and PCCDCTL, set by make check.
Does:     answers, modes, slots, pages, meshes, errors; hashes against the C client's.
"""

import gc
import json
import os
import signal
import subprocess
import tempfile
import time
import unittest
import warnings

import numpy as np

import pccd
import support
from support import (TENT, TENT_TRIANGLES, Scene, cloth, cloth_triangles, dropped)

Settings = pccd.StepSettings


def write_ply(path, x, triangles):
    """As pccdctl reads it; coordinates in binary, so that they are the same floats."""
    with open(path, "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\n"
                   b"element vertex %d\nproperty float x\nproperty float y\n"
                   b"property float z\nelement face %d\n"
                   b"property list uchar int vertex_indices\nend_header\n"
                   % (len(x), len(triangles)))
        file.write(x.astype("<f4").tobytes())
        faces = np.empty(len(triangles), np.dtype([("n", "u1"), ("v", "<i4", 3)]))
        faces["n"], faces["v"] = 3, triangles
        file.write(faces.tobytes())


class Case(support.Case):
    """With a private daemon for all cases of a class, and a client for each."""

    @classmethod
    def setUpClass(cls):
        cls.owner = pccd.connect(private=True)

    @classmethod
    def tearDownClass(cls):
        cls.owner.close()

    def setUp(self):
        self.client = self.connect()
        self.settle(sessions_now=2, meshes_now=0, scenes_now=0, objects_now=0)

    def settle(self, **counts):
        """Wait until the daemon has freed what is gone: it does so in its own time."""
        until = time.monotonic() + 10
        stats = self.client.stats()
        while any(stats[name] != counts[name] for name in counts) and \
                time.monotonic() < until:
            time.sleep(0.005)
            stats = self.client.stats()
        for name, count in counts.items():
            self.assertEqual(stats[name], count, name)

    def connect(self, **options):
        """Closed when the case is over; with a region that is quickly made."""
        client = pccd.connect(self.owner.url, **{"result_bytes": 1 << 21, **options})
        self.addCleanup(client.close)
        return client

    def tent(self, client=None):
        """A scene with one tent: scene, mesh, object."""
        client = client or self.client
        scene = client.scene_create()
        mesh = client.mesh_create(TENT, TENT_TRIANGLES)
        return scene, mesh, client.scene_add(scene, mesh)


class Answers(Case):
    """What a step finds."""

    # If this failed, a contact that anybody can work out would come out wrong.
    def test_answer__holds_the_contact_of_the_tent(self):
        scene, _, tent = self.tent()
        with self.client.step_x1(scene, tent, dropped()) as answer:
            self.assertEqual((answer.count, answer.total), (1, 1))
            self.assertEqual(list(answer.counts)[:2], [1, 0])
            contact = answer.contacts[0]
            self.assertEqual(contact["kind"], pccd.Kind.VF)
            self.assertEqual(contact["flags"], pccd.ContactFlag.PROVED)
            self.assertEqual((contact["object_a"], contact["object_b"]), (tent, tent))
            self.assertEqual((contact["feature_a"], contact["feature_b"]), (3, 0))
            self.assertLessEqual(contact["toi"], 0.5)
            self.assertGreaterEqual(contact["toi_hi"], 0.5)
            np.testing.assert_allclose(contact["param"], [0.25, 0.25], atol=1e-5)
            np.testing.assert_array_equal(contact["normal"], [0, 0, 1])
            self.assertEqual(answer.toi_first, contact["toi"])
            self.assertEqual(len(answer.pairs), 0)
            self.assertGreater(answer.times.step, 0)
            self.assertGreater(answer.counters.candidates[pccd.Kind.VF], 0)

    # If this failed, the two clients would not be talking about the same answers.
    def test_hashes__are_those_of_pccdctl(self):
        triangles = cloth_triangles(40)
        frames = [cloth(40, step) for step in (0, 0.2, 0.5, 0.51)]
        frames = [np.concatenate([x, x * [1, 1, 0]]).astype(np.float32) for x in frames]
        triangles = np.concatenate([triangles, triangles + 1600])
        with tempfile.TemporaryDirectory() as folder:
            paths = [f"{folder}/{number}.ply" for number in range(len(frames))]
            for path, x in zip(paths, frames):
                write_ply(path, x, triangles)
            text = subprocess.run([os.environ["PCCDCTL"], "check", "--json", "--url",
                                   self.owner.url, *paths], check=False,
                                  stdout=subprocess.PIPE, timeout=60).stdout
        steps = json.loads(text)["steps"]
        scene = self.client.scene_create()
        body = self.client.scene_add(scene, self.client.mesh_create(frames[0], triangles))
        for told, x in zip(steps, frames[1:]):
            with self.client.step_x1(scene, body, x) as answer:
                self.assertGreater(answer.total, 0)
                self.assertEqual(answer.hash, told["hash"])
        self.assertEqual(len(steps), 3)

    # If this failed, a way to say where vertices go would move them elsewhere.
    def test_ways__to_move_give_the_same_bytes(self):
        scene, _, tent = self.tent()
        want = self.client.step_x1(scene, tent, dropped()).hash
        self.assertEqual(want, self.client.step_x0x1(scene, tent, TENT, dropped()).hash)
        wide = self.client.step_x0x1(scene, tent, TENT.astype(float), dropped().tolist())
        self.assertEqual(want, wide.hash)
        with self.client.frame(scene, 2 * 2 * 36, segment_max=2) as frame:
            for first in (0, 3):
                x0, x1 = frame.x0x1(tent, 3, first=first)
                x0[:], x1[:] = TENT[first:first + 3], dropped()[first:first + 3]
            self.assertEqual(want, self.client.wait(frame.commit()).hash)
        still, moved = np.eye(4)[:3], np.eye(4)[:3]
        moved[2, 3] = -2
        with self.client.frame(scene, 2 * 192, segment_max=2) as frame:
            frame.rigid(tent, 3, still, still)
            frame.rigid(tent, 3, still, moved, first=3)
            self.assertEqual(want, self.client.wait(frame.commit()).hash)

    # If this failed, what is written to an array would be rounded to floats, though the
    # mesh has doubles.
    def test_arrays__have_the_type_of_the_mesh(self):
        for dtype in (np.float32, np.float64):
            scene = self.client.scene_create()
            mesh = self.client.mesh_create(TENT.astype(dtype), TENT_TRIANGLES)
            body = self.client.scene_add(scene, mesh)
            with self.client.frame(scene, 3 * 6 * 24, segment_max=2) as frame:
                self.assertEqual(frame.x1(body, 6).dtype, dtype)
                self.assertEqual(frame.x0x1(body, 6)[0].dtype, dtype)
            batch = self.client.batch([pccd.Part(scene, body, 6)])
            self.assertEqual(batch.begin().dtype, dtype)
            batch.abort()

    # If this failed, a mode would be answered by another's rules.
    def test_modes__answer_what_they_promise(self):
        scene, _, tent = self.tent()

        def ask(mode, x1=dropped()):
            return self.client.step_x0x1(scene, tent, TENT, x1, Settings(mode=mode))

        first = ask(pccd.Mode.FIRST)
        self.assertEqual((first.count, first.verdict), (1, pccd.Verdict.NONE))
        some = ask(pccd.Mode.ANY)
        self.assertEqual((some.count, some.verdict), (0, pccd.Verdict.YES))
        self.assertEqual(ask(pccd.Mode.ANY, TENT).verdict, pccd.Verdict.NO)
        pairs = ask(pccd.Mode.PAIRS)
        self.assertEqual(pairs.pairs.dtype, pccd.PAIR)
        self.assertIn((0, tent, 3, tent, 0), pairs.pairs.tolist())
        self.assertEqual(len(pairs.contacts), 0)

    # If this failed, a setting would change the answer, or not be what was used.
    def test_settings__are_used_and_change_no_byte(self):
        scene = Scene(self.client)
        want = scene.hash(0.5)
        for settings in (Settings(method=pccd.Method.PAPER), Settings(threads=1),
                         Settings(method=pccd.Method.WIDE, tolerance=1e-3),
                         Settings(method=pccd.Method.PAPER, tuning="scheduler=paper,"
                                  "high-level=disjoint,refit=paper")):
            with self.client.step_x0x1(scene.scene, scene.cloth, cloth(20),
                                       cloth(20, 0.5), settings) as answer:
                self.assertEqual(answer.hash, want)
                if settings.method:
                    self.assertEqual(answer.method, settings.method)
        self.fails(pccd.Status.E_INVAL, scene.hash, 0.5, Settings(mode=9))

    # If this failed, an answer would go to another step, or be lost.
    def test_answers__are_taken_in_any_order(self):
        scene = Scene(self.client)
        self.assertIsNone(self.client.poll())
        numbers = [scene.submit(step) for step in (0.3, 0.6, 0.9)]
        hashes = {number: self.client.wait(number).hash for number in reversed(numbers)}
        other = Scene(self.connect())
        self.assertEqual([hashes[number] for number in numbers],
                         [other.hash(step) for step in (0.3, 0.6, 0.9)])
        numbers = [self.client.submit_still(scene.scene) for _ in range(3)]
        taken = []
        while len(taken) < 3:
            answer = self.client.poll()
            if answer is not None:
                taken.append(answer.step)
        self.assertEqual(taken, numbers)
        self.fails(pccd.Status.E_INVAL, self.client.wait, numbers[0])

    # If this failed, a step that was refused would be reported to nobody, or end others.
    def test_steps__that_fail_say_why(self):
        scene, _, tent = self.tent()
        self.client.step_x1(scene, tent, TENT).release()
        bad = TENT.copy()
        bad[2, 1] = np.nan
        error = self.fails(pccd.Status.E_NOTFINITE, self.client.step_x1, scene, tent, bad)
        self.assertIn("frame.submit", error.text)
        with self.client.frame(scene, bad.nbytes) as frame:
            frame.x1(tent, 6)[:] = bad
            number = frame.commit()
        answer = None
        while answer is None:
            answer = self.client.poll()
        self.assertEqual((answer.step, answer.count), (number, 0))
        self.assertEqual(answer.error.status, pccd.Status.E_NOTFINITE)
        self.assertEqual(self.client.step_x1(scene, tent, dropped()).total, 1)

    # If this failed, who gives a step little time would wait for all of it.
    def test_steps__end_when_they_are_cancelled_or_late(self):
        scene = Scene(self.client)
        late = self.client.step_x1(scene.scene, scene.cloth, cloth(20, 0.5),
                                   Settings(deadline_ns=1))
        self.assertEqual(late.incomplete, pccd.Incomplete.DEADLINE)
        number = scene.submit(0.7)
        self.client.cancel(number)
        self.assertIn(self.client.wait(number).incomplete,
                      (pccd.Incomplete.CANCELLED, pccd.Incomplete.COMPLETE))
        self.fails(pccd.Status.E_INVAL, self.client.cancel, number)


class Slots(Case):
    """The upload ring."""

    # If this failed, a frame could take a slot that the daemon reads, or never get one.
    def test_slots__are_given_back(self):
        scene, _, tent = self.tent()
        frames = [self.client.frame(scene, 72) for _ in range(4)]
        self.fails(pccd.Status.E_BUSY, self.client.frame, scene, 72)
        self.fails(pccd.Status.E_BUSY, self.client.frame, scene, 1 << 20)
        frames.pop().abort()
        with self.assertRaises(ZeroDivisionError), self.client.frame(scene, 72) as frame:
            frame.x1(tent, 6)[:] = 1 / 0
        frame = self.client.frame(scene, 72)
        frame.x1(tent, 6)[:] = dropped()
        self.assertEqual(self.client.wait(frame.commit()).total, 1)
        self.fails(pccd.Status.E_INVAL, frame.commit)
        self.fails(pccd.Status.E_INVAL, frame.x1, tent, 6)
        for frame in frames:
            frame.abort()

    # If this failed, more steps than slots would be refused, mixed up, or torn.
    def test_steps__wait_for_a_slot_when_all_are_in_flight(self):
        scene, other = Scene(self.client), Scene(self.connect(slot_count=1))
        times = [(7 * i % 11) / 11 for i in range(24)]
        numbers = [scene.submit(step) for step in times]
        self.assertEqual([self.client.wait(number).hash for number in numbers],
                         [other.hash(step) for step in times])
        self.assertEqual(self.client.stats()["slots_torn"], 0)

    # If this failed, answers that nobody takes could pile up without bound.
    def test_steps__are_refused_while_32_answers_wait(self):
        scene, _, _ = self.tent()
        numbers = [self.client.submit_still(scene) for _ in range(32)]
        self.fails(pccd.Status.E_BUSY, self.client.submit_still, scene)
        self.fails(pccd.Status.E_BUSY, self.client.frame, scene, 72)
        for number in numbers:
            self.client.wait(number).release()
        self.client.wait(self.client.submit_still(scene)).release()

    # If this failed, a write after the commit could tear a step that is being read.
    def test_frames__are_not_written_after_their_commit(self):
        scene, _, tent = self.tent()
        with self.client.frame(scene, 72) as frame:
            x1 = frame.x1(tent, 6)
            x1[:] = dropped()
            number = frame.commit()
        with self.assertRaises(ValueError):
            x1[0] = 0
        self.client.wait(number).release()

    # If this failed, more than was announced would be written into the next slot.
    def test_frames__hold_what_was_announced(self):
        scene, _, tent = self.tent()
        with self.client.frame(scene, 72) as frame:
            self.fails(pccd.Status.E_LIMIT, frame.x1, tent, 64)
            self.fails(pccd.Status.E_INVAL, frame.x1, tent, 0)
            self.fails(pccd.Status.E_INVAL, frame.x1, tent, 6, dtype=np.int32)
            self.fails(pccd.Status.E_INVAL, frame.rigid, tent, 6, np.eye(4), np.eye(4))
            frame.x1(tent, 3)
            self.fails(pccd.Status.E_LIMIT, frame.x1, tent, 3, first=3)
        self.fails(pccd.Status.E_LIMIT, self.client.frame, scene, 72, 65537)
        with self.client.frame(scene, 72) as frame:
            frame.x1(tent, 6, first=1)[:] = 0  # beyond the last vertex
            self.fails(pccd.Status.E_SEGMENT, self.client.wait, frame.commit())

    # If this failed, a larger step would need another client, or take away what is read.
    def test_ring__grows_and_answers_stay_readable(self):
        small, _, tent = self.tent()
        held = self.client.step_x1(small, tent, dropped())
        want = held.records.tobytes()
        scene = Scene(self.client, side=200)
        with self.client.step_x1(scene.scene, scene.cloth, cloth(200, 0.2)) as answer:
            self.assertGreater(answer.total, 0)
            self.assertEqual(held.records.tobytes(), want)
        held.release()
        self.assertEqual(self.client.step_x1(small, tent, TENT).total, 1)


class Pages(Case):
    """The result region."""

    # If this failed, an answer larger than the region would lose records, or repeat some.
    def test_pages__make_up_the_whole_answer(self):
        whole = Scene(self.client, 60)
        little = Scene(self.connect(result_bytes=1 << 16), 60)
        ask = (cloth(60, 0.5), Settings(mode=pccd.Mode.PAIRS))
        with self.client.step_x1(whole.scene, whole.cloth, *ask) as answer:
            want, total = answer.records.tobytes(), answer.total
        self.assertGreater(total * pccd.PAIR.itemsize, 3 << 16)
        answer = little.client.step_x1(little.scene, little.cloth, *ask)
        self.assertEqual(answer.incomplete, pccd.Incomplete.RESULT_FULL)
        got, first = [], 0
        for page in little.client.pages(little.scene, answer):
            self.assertEqual((page.first, page.total), (first, total))
            first += page.count
            got.append(page.records.tobytes())
        self.assertGreater(len(got), 3)
        self.assertEqual(b"".join(got), want)
        little.client.step_x1(little.scene, little.cloth, cloth(60)).release()
        self.fails(pccd.Status.E_STATE, little.client.fetch, little.scene, answer.step, 0)
        self.client.config_set("contacts-max", "2000")  # more than a page, and not all
        answer = little.client.step_x1(little.scene, little.cloth, cloth(60, 0.5))
        self.client.config_set("contacts-max", "16777216")
        self.assertEqual((answer.incomplete, answer.total),
                         (pccd.Incomplete.CONTACT_LIMIT, 2000))
        self.assertEqual(sum(page.count for page in
                             little.client.pages(little.scene, answer)), 2000)

    # If this failed, a page would be overwritten while somebody reads it, or never again.
    def test_pages__are_released_in_any_order(self):
        client = self.connect(result_bytes=1 << 16)
        scene, other = Scene(client), Scene(self.client)
        want = []
        for step in (0.1, 0.4, 0.5):
            with self.client.step_x1(other.scene, other.cloth, cloth(20, step)) as answer:
                want.append(answer.records.tobytes())
        for _ in range(50):
            answers = [client.step_x1(scene.scene, scene.cloth, cloth(20, step))
                       for step in (0.1, 0.4, 0.5)]
            for answer, records in zip(answers, want):
                if answer.incomplete == 0:
                    self.assertEqual(answer.records.tobytes(), records)
            for index in (1, 2, 0):
                answers[index].release()
            self.assertEqual(answers[0].count, 0)
            client.step_x1(scene.scene, scene.cloth, cloth(20)).release()
        self.assertEqual([answer.incomplete for answer in answers], [0, 0, 0])

    # If this failed, the daemon's memory could be written, or an answer lose its page.
    def test_records__cannot_be_written(self):
        scene, _, tent = self.tent()
        with self.client.step_x1(scene, tent, dropped()) as answer:
            with self.assertRaises(ValueError):
                answer.contacts["toi"][0] = 0
            kept = answer.contacts.copy()
        self.assertEqual(kept["feature_a"].tolist(), [3])
        self.fails(pccd.Status.E_STATE, lambda: answer.contacts)

    # If this failed, who forgets to release would fill the region without being told.
    def test_answers__that_are_dropped_give_their_page_back(self):
        client = self.connect(result_bytes=1 << 16)
        scene = Scene(client)
        for _ in range(40):
            self.assertEqual(client.step_x1(scene.scene, scene.cloth, cloth(20, 0.5))
                             .incomplete, 0)
            client.step_x1(scene.scene, scene.cloth, cloth(20))
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always", ResourceWarning)
            toi = client.step_x1(scene.scene, scene.cloth, cloth(20, 0.5)).contacts["toi"]
            gc.collect()
        self.assertEqual([entry.category for entry in told], [ResourceWarning])
        self.assertGreater(len(toi), 0)


class Meshes(Case):
    """Registration, and errors."""

    # If this failed, feature numbers of edges would name other edges.
    def test_edges__are_sorted_and_whole(self):
        mesh = self.client.mesh_create(cloth(50), cloth_triangles(50))
        info = self.client.mesh_info(mesh)
        edges = self.client.mesh_edges(mesh)
        sides = cloth_triangles(50)[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        sides.sort(axis=1)
        want = np.unique(sides, axis=0)
        want = want[np.lexsort((want[:, 0], want[:, 1]))]
        np.testing.assert_array_equal(edges, want)
        self.assertEqual(info.edge_count, len(want))
        self.assertEqual((info.vertex_count, info.triangle_count, info.generation),
                         (2500, 4802, 1))

    # If this failed, a hierarchy would not be seen, or not be over its scene.
    def test_boxes__cover_the_scene(self):
        scene, _, tent = self.tent()
        self.assertEqual(len(self.client.scene_boxes(scene, pccd.Tree.FACES, 0)), 0)
        self.client.step_x1(scene, tent, dropped()).release()
        root = self.client.scene_boxes(scene, pccd.Tree.FACES, 0)
        self.assertEqual(len(root), 1)
        self.assertTrue((root["low1"] <= dropped().min(axis=0)).all())
        self.assertTrue((root["high1"] >= dropped().max(axis=0)).all())
        self.assertEqual(len(self.client.scene_boxes(scene, pccd.Tree.FACES, 31)), 0)

    # If this failed, a body could not break, or would leave its objects behind.
    def test_meshes__are_replaced_under_their_handle(self):
        scene, mesh, tent = self.tent()
        self.client.step_x1(scene, tent, dropped()).release()
        info = self.client.mesh_replace(mesh, cloth(5), cloth_triangles(5))
        self.assertEqual((info.vertex_count, info.generation), (25, 2))
        self.assertEqual(self.client.step_x1(scene, tent, cloth(5)).total, 0)
        bad = cloth_triangles(5)
        bad[3, 1] = 25
        self.fails(pccd.Status.E_INDEX, self.client.mesh_replace, mesh, cloth(5), bad)
        self.assertEqual(self.client.step_x1(scene, tent, cloth(5, 0.1)).error, None)
        self.assertEqual(self.client.mesh_info(mesh).generation, 2)

    # If this failed, what was dropped would still be charged, or still collide.
    def test_meshes_scenes_and_objects__go(self):
        before = self.client.stats()
        scene, mesh, tent = self.tent()
        second = self.client.scene_add(scene, mesh)
        self.client.mesh_destroy(mesh)
        self.fails(pccd.Status.E_HANDLE, self.client.mesh_info, mesh)
        self.fails(pccd.Status.E_HANDLE, self.client.scene_add, scene, mesh)
        self.assertGreater(self.client.step_x1(scene, tent, dropped()).total, 1)
        self.client.scene_remove(scene, np.uint32(second))
        self.assertEqual(self.client.step_x0x1(scene, tent, TENT, dropped()).total, 1)
        self.client.scene_destroy(scene)
        self.fails(pccd.Status.E_HANDLE, self.client.wait,
                   self.client.submit_still(scene))
        self.settle(**{name: before[name] for name in (
            "meshes_now", "scenes_now", "objects_now", "triangles_now")})

    # If this failed, a wrong mesh would be taken, or stay half made in the daemon.
    def test_meshes__that_are_wrong_are_refused(self):
        before = self.client.stats()["meshes_now"]
        bad = TENT.copy()
        bad[0, 0] = np.inf
        status = pccd.Status
        for want, x, triangles in (
                (status.E_NOTFINITE, bad, TENT_TRIANGLES),
                (status.E_INDEX, TENT, TENT_TRIANGLES + 4),
                (status.E_INDEX, TENT, TENT_TRIANGLES.astype(int) - 1),
                (status.E_INVAL, TENT[:, :2], TENT_TRIANGLES),
                (status.E_INVAL, TENT[:0], TENT_TRIANGLES),
                (status.E_INVAL, TENT + 0j, TENT_TRIANGLES),  # these were read as others
                (status.E_INVAL, TENT.astype(str), TENT_TRIANGLES),
                (status.E_INVAL, np.ma.masked_array(TENT, TENT > 0), TENT_TRIANGLES),
                (status.E_INVAL, TENT, TENT_TRIANGLES[:0]),
                (status.E_INVAL, TENT, np.ma.masked_array(TENT_TRIANGLES, 1)),
                (status.E_INVAL, TENT, TENT_TRIANGLES.astype(float)),
                (status.E_INVAL, TENT, TENT_TRIANGLES.reshape(-1))):
            self.fails(want, self.client.mesh_create, x, triangles)
        radii = np.ones(6)
        for bad in (radii + 0j, radii.astype(str), np.ma.masked_array(radii, radii > 0)):
            self.fails(status.E_INVAL, self.client.mesh_create, TENT, TENT_TRIANGLES, bad)
            self.fails(status.E_INVAL, pccd.joints_screw, bad[:3], [0, 0, 1], 1)
        self.fails(status.E_HANDLE, self.client.mesh_replace, 0, TENT, TENT_TRIANGLES)
        self.settle(meshes_now=before)

    # If this failed, steps would go to scenes and objects of nobody.
    def test_handles__that_are_wrong_are_refused(self):
        scene, _, tent = self.tent()
        for call in (lambda: self.client.scene_destroy(77),
                     lambda: self.client.scene_remove(scene, 77),
                     lambda: self.client.mesh_destroy(77),
                     lambda: self.client.step_x1(scene, 77, TENT),
                     lambda: self.client.step_x1(77, tent, TENT)):
            self.fails(pccd.Status.E_HANDLE, call)
        self.fails(pccd.Status.E_INVAL, self.client.step_x0x1, scene, tent, TENT,
                   TENT[1:])
        self.assertEqual(self.client.step_x1(scene, tent, dropped()).total, 1)


class Others(Case):
    """What is not about steps."""

    # If this failed, nobody could see from Python what the daemon does.
    def test_counters_and_recordings__are_read(self):
        scene = Scene(self.client)
        self.assertEqual(self.client.stats()["pid"], self.client.daemon_pid)
        self.assertEqual(self.client.daemon.cpu, self.client.daemon_cpu)
        self.assertEqual(self.client.daemon.features, self.client.features)
        begun = self.client.trace_start(events=4096)
        self.assertGreaterEqual(begun.threads, 1)
        self.assertEqual(begun.events_max, 4096)
        self.fails(pccd.Status.E_STATE, self.client.trace_start)
        for step in (0.2, 0.4, 0.6):
            scene.hash(step)
        ended = self.client.trace_stop()
        events = self.client.trace_dump()
        self.assertEqual(len(events), ended.events)
        self.assertEqual((events["kind"] == pccd.TraceKind.STEP).sum(), 3)
        self.assertTrue((events["end_ns"] >= events["begin_ns"]).all())
        thread = self.client.stats_thread()
        self.assertGreater(thread["number"], 0)
        self.assertEqual(self.client.stats_thread(any=True)["number"], thread["number"])
        self.fails(pccd.Status.E_INVAL, self.client.stats_thread, thread["threads"])

    # If this failed, nobody could see from Python who uses the daemon, and how.
    def test_lists_and_settings__tell_what_there_is(self):
        scene = Scene(self.client)
        want = scene.hash(0.5)
        mine = self.client.list_sessions()[0]
        self.assertEqual(mine["pid"], os.getpid())
        self.assertEqual((mine["objects"], mine["steps"]), (2, 1))
        session = mine["session"]
        other = self.connect()
        for client, whose in ((self.client, 0), (other, session)):
            entry, = client.list_scenes(whose)
            self.assertEqual((entry["scene"], entry["hash"]), (scene.scene, want))
            objects = client.list_objects(scene.scene, whose)
            self.assertEqual([item["object"] for item in objects],
                             [scene.floor, scene.cloth])
            meshes = client.list_meshes(whose)
            self.assertEqual([item["vertex_count"] for item in meshes], [81, 400])
        self.assertEqual(other.list_scenes(), [])
        self.fails(pccd.Status.E_HANDLE, self.client.list_scenes, 1 << 40)
        steps = self.client.histogram(pccd.HistogramKind.STEPS)
        self.assertEqual(steps.counts.sum(), steps.total)
        self.assertEqual(len(steps.below_ns), 27)
        settings = self.client.config_list()
        for setting in settings:
            self.assertEqual(self.client.config_get(setting.name), setting)
        number = [item for item in settings if item.value.isdigit()][0]
        self.assertEqual(self.client.config_set(number.name, number.value), number.value)
        self.fails(pccd.Status.E_INVAL, self.client.config_set, number.name, "x")
        self.fails(pccd.Status.E_INVAL, self.client.config_get, "nothing")

    # If this failed, who shares a scene would not be told of its steps.
    def test_watch__tells_of_the_steps_of_others(self):
        scene = Scene(self.client)
        session = self.client.list_sessions()[0]["session"]
        other = self.connect()
        self.fails(pccd.Status.E_STATE, other.watch_next)
        self.fails(pccd.Status.E_HANDLE, other.watch_start, 1 << 40)
        self.fails(pccd.Status.E_STATE, other.watch_next)
        other.watch_start(other.list_sessions()[0]["session"])
        scene.hash(0.5)
        self.assertIsNone(other.watch_next(0))
        self.assertIsNone(other.watch_next(0.01))
        other.watch_start(session, scene.scene)
        wants = [scene.hash(step) for step in (0.3, 0.6)]
        for want in wants:
            event = other.watch_next()
            self.assertEqual((event.hash, event.scene, event.session, event.lost),
                             (want, scene.scene, session, 0))
            self.assertGreater(event.total, 0)
        other.watch_stop()
        scene.hash(0.1)
        other.ping()
        self.fails(pccd.Status.E_STATE, other.watch_next)

    # If this failed, a script that looks after a full daemon would
    # take one of its places.
    def test_observer__only_looks(self):
        observer = self.connect(observes=True)
        self.assertEqual(observer.stats()["sessions_now"], 3)
        self.fails(pccd.Status.E_STATE, observer.scene_create)

    # If this failed, a daemon that hangs would hang its clients for ever.
    def test_waits__end_at_their_timeout(self):
        with pccd.connect(private=True, timeout=2, result_bytes=1 << 16) as client:
            scene = Scene(client)
            want = scene.hash(0.5)
            os.kill(client.daemon_pid, signal.SIGSTOP)
            try:
                number = scene.submit(0)
                self.fails(pccd.Status.E_AGAIN, client.wait, number, timeout=0)
                self.fails(pccd.Status.E_TIMEOUT, client.wait, number, timeout=0.05)
                self.fails(pccd.Status.E_TIMEOUT, scene.hash, 0.1)
            finally:
                os.kill(client.daemon_pid, signal.SIGCONT)
            self.assertEqual(client.wait(number, timeout=10).error, None)
            with client.step_x0x1(scene.scene, scene.cloth, cloth(20),
                                  cloth(20, 0.5)) as answer:
                self.assertEqual(answer.hash, want)


if __name__ == "__main__":
    unittest.main()
