"""check_batch.py - steps of many scenes by one request, from Python, against a real
daemon and in this process.

Room:     tests/python. Needs PCCD_DAEMON, set by make check.
Does:     the answers of steps by themselves; parts of every way; what fails; arrays that
          are used too late.
"""

import unittest

import numpy as np

import pccd
from check_client import Case
from support import TENT, TENT_TRIANGLES, dropped

WORLDS = 7


class Batches(Case):
    """Worlds with a tent each."""

    def worlds(self, client):
        """Handles of scenes and bodies, which are the same in each new session."""
        mesh = client.mesh_create(TENT, TENT_TRIANGLES)
        scenes = [client.scene_create() for _ in range(WORLDS)]
        return scenes, [client.scene_add(scene, mesh) for scene in scenes]

    @staticmethod
    def positions():
        """Of all worlds: some tents fall through their floor, at different times."""
        return np.stack([dropped(0.25 + 0.5 * i) for i in range(WORLDS)])

    # If this failed, Python would show other contacts of a scene in a batch than of the
    # scene by itself.
    def test_batch__answers_as_steps_do(self):
        for url in (self.client.url, "direct:"):
            with pccd.connect(url) as together, pccd.connect(url) as apart:
                scenes, bodies = self.worlds(together)
                batch = together.batch(
                    [pccd.Part(s, b, len(TENT)) for s, b in zip(scenes, bodies)])
                self.assertEqual(len(batch), WORLDS)
                self.assertEqual(self.worlds(apart), (scenes, bodies))
                x1 = self.positions()
                with batch.step(x1) as answer:
                    self.assertEqual(answer.scenes["scene"].tolist(), scenes)
                    self.assertEqual(answer.scenes["status"].tolist(), WORLDS * [0])
                    self.assertGreater(answer.total, 0)
                    for i, (scene, body) in enumerate(zip(scenes, bodies)):
                        with apart.step_x1(scene, body, x1[i]) as alone:
                            one = answer.scenes[i]
                            self.assertEqual(one["total"], alone.total)
                            self.assertEqual(one["toi_first"], alone.toi_first)
                            self.assertEqual(one["number"], 1)
                            self.assertEqual("2:%016x%016x" % tuple(one["hash"]),
                                             alone.hash)
                            self.assertEqual(answer.contacts(i).tobytes(),
                                             alone.contacts.tobytes())
                            self.assertEqual(answer.why(i), "")
                    self.assertFalse(answer.scenes.flags.writeable)
                self.fails(pccd.Status.E_STATE, lambda: answer.scenes)

    # If this failed, a part would move in another way than it was said to, or an array be
    # written when its step is on its way.
    def test_parts__move_in_every_way(self):
        client = self.client
        scenes, bodies = self.worlds(client)
        way = pccd.BatchWay
        identity, falls = np.eye(3, 4), np.eye(3, 4)
        falls[2, 3] = -2
        batch = client.batch([
            pccd.Part(scenes[0], bodies[0], len(TENT), dtype=np.float64),
            pccd.Part(scenes[1], bodies[1], 3, 3, way=way.X0X1),
            pccd.Part(scenes[2], bodies[2], 3, 3, way=way.RIGID),
            pccd.Part(scenes[3])])
        places = batch.begin()
        places[0][...] = dropped()
        places[1][0][...], places[1][1][...] = TENT[3:], dropped()[3:]
        places[2][0][...], places[2][1][...] = identity, falls
        self.assertIsNone(places[3])
        step = batch.commit(pccd.StepSettings(mode=pccd.Mode.FIRST))
        with self.assertRaises(ValueError):
            places[0][0, 0] = 1
        with client.batch_wait(step) as answer:
            self.assertEqual(answer.scenes["total"].tolist(), [1, 1, 1, 0])
            self.assertEqual(answer.scenes["toi_first"][3], 2)
            self.assertTrue((abs(answer.scenes["toi_first"][:3] - 0.5) < 1e-6).all())
        with self.assertRaisesRegex(pccd.PccdError, "2 arrays for 4 parts"):
            batch.submit([dropped(), dropped()])
        self.assertIsNone(client.batch_poll())

    # If this failed, one world with a mistake would spoil the others, or not be told.
    def test_scene__that_fails_says_why(self):
        client = self.client
        scenes, bodies = self.worlds(client)
        bodies[2] += 1 << 20
        batch = client.batch(
            [pccd.Part(s, b, len(TENT)) for s, b in zip(scenes, bodies)])
        x1 = self.positions()
        x1[4, 1, 1] = np.nan
        with batch.step(x1) as answer:
            self.assertEqual(answer.failed, 2)
            self.assertEqual([pccd.Status(status).name for status in
                              answer.scenes["status"][[2, 4]]],
                             ["E_HANDLE", "E_NOTFINITE"])
            self.assertIn("is not in the scene", answer.why(2))
            self.assertIn("y of vertex 1 is nan", answer.why(4))
            self.assertGreater(answer.scenes["total"][5], 0)
        with self.assertRaisesRegex(pccd.PccdError, "no parts"):
            client.batch([])

    # If this failed, an array that is kept would be memory that is not there.
    def test_arrays__outlive_their_client(self):
        client = pccd.connect(self.client.url)
        scenes, bodies = self.worlds(client)
        batch = client.batch([pccd.Part(scenes[0], bodies[0], len(TENT))])
        place = batch.begin()
        batch.abort()
        answer = batch.step(dropped()[None])
        kept = answer.scenes
        client.close()
        self.assertEqual(kept["total"][0], 1)
        self.assertTrue(np.isfinite(place).all())
        answer.release()
        with self.assertRaises(pccd.PccdError):
            batch.step(dropped()[None])


if __name__ == "__main__":
    unittest.main()
