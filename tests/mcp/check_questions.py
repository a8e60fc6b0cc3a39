"""check_questions.py - eleven questions about files, which the tools alone answer.

Room:     tests/mcp.
Does:     ask as an agent would that has seen nothing but the descriptions of the tools;
          hold the answers against what the files were made of, and the number of calls.
"""

import math
import pathlib
import tempfile
import unittest

from files import (write_box, write_falling, write_hinge, write_mesh, write_scene,
                   write_triangle)
from mcp_client import Client, Failed


class Questions(unittest.TestCase):
    """Each is asked of a server of its own, so that no call is saved by another one."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="pccd-mcp-")
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)

    def asked(self, calls, *options):
        """A server; after the case that many calls were made."""
        client = Client(self.path, "--url", "direct:", *options)
        client.__enter__()
        self.addCleanup(lambda: self.assertEqual(client.calls, calls))
        self.addCleanup(client.__exit__)
        return client

    # If it failed, nobody could begin without having seen the folder.
    def test_question_1__what_is_there(self):
        write_falling(self.path)
        (self.path / "notes.txt").write_text("no mesh")
        ask = self.asked(2)
        files = [row["file"] for row in ask.call("scene")["rows"]]
        self.assertEqual(files, ["box0.obj", "box1.obj", "box2.obj", "box3.obj",
                                 "floor.obj"])
        told = ask.call("scene", files=["box%d.obj", "floor.obj"])
        self.assertEqual(told["frames"], 4)
        self.assertEqual([(row["object"], row["frames"], row["triangles"], row["low"],
                           row["high"])
                          for row in told["rows"]],
                         [("box", 4, 12, [0, 0, 10], [2, 2, 12]),
                          ("floor", 1, 12, [-50, -50, -100], [50, 50, 0])])

    # If it failed, the first contact would be told of another step, or at another time.
    def test_question_2__when_does_the_box_meet_the_floor(self):
        write_falling(self.path)
        told = self.asked(1).call("check", files=["box%d.obj"], **{"with": ["floor.obj"]})
        self.assertEqual(told["verdict"], "meets")
        self.assertEqual(told["first"]["step"], 3)
        self.assertAlmostEqual(told["first"]["t"], 0.5, 9)
        self.assertEqual((told["first"]["from"], told["first"]["to"]), ("box2.obj",
                                                                        "box3.obj"))
        self.assertEqual([(pair["a"], pair["b"]) for pair in told["rows"][0]["pairs"]],
                         [("box", "floor")])

    # If it failed, what passes between two frames would not be seen.
    def test_question_3__does_a_bullet_pass_between_frames(self):
        write_box(self.path / "shot0.obj", (-9, 0, 0), (-8, 1, 1))
        write_box(self.path / "shot1.obj", (8, 0, 0), (9, 1, 1))
        write_box(self.path / "wall.obj", (0, -5, -5), (0.5, 5, 5))
        ask = self.asked(3)
        for shot in ("shot0.obj", "shot1.obj"):
            self.assertEqual(ask.call("crossings", files=[shot, "wall.obj"])["verdict"],
                             "no")
        told = ask.call("check", files=["shot%d.obj"], mode="first",
                        **{"with": ["wall.obj"]})
        self.assertEqual(told["verdict"], "meets")
        self.assertAlmostEqual(told["first"]["t"], 8 / 17, 9)

    # If it failed, a distance would be another one.
    def test_question_4__how_far_apart(self):
        write_box(self.path / "a.obj", (0, 0, 0), (1, 1, 1))
        write_box(self.path / "b.obj", (4, 5, 0), (6, 6, 1))
        told = self.asked(1).call("near", files=["a.obj", "b.obj"])
        self.assertEqual((told["distance_min"], told["distance_max"]), (5, 5))

    # If it failed, what passes through would be missed, or its edges be others.
    def test_question_5__what_passes_through(self):
        write_triangle(self.path / "plate.obj", (0, 0, 0), (8, 0, 0), (0, 8, 0))
        write_triangle(self.path / "pin.obj", (1, 1, -1), (1.5, 1, 2), (1, 1.5, 2))
        told = self.asked(1).call("crossings", files=["pin.obj", "plate.obj"])
        self.assertEqual((told["verdict"], told["found"]), ("yes", 2))
        self.assertEqual({row["a"] for row in told["rows"]}, {"pin.obj edge 0-1",
                                                              "pin.obj edge 0-2"})

    # If it failed, thickness would not be kept, or meet at another time.
    def test_question_6__is_the_thickness_kept(self):
        for i, height in enumerate((4, 2, 0.25)):
            write_triangle(self.path / f"sheet{i}.obj", (0, 0, height), (4, 0, height),
                           (0, 4, height))
        write_triangle(self.path / "table.obj", (-9, -9, 0), (20, -9, 0), (-9, 20, 0))
        ask = self.asked(2)
        files = {"files": ["sheet%d.obj"], "with": ["table.obj"]}
        self.assertEqual(ask.call("check", **files)["verdict"], "free")
        told = ask.call("check", thickness=0.5, **files)
        self.assertEqual((told["verdict"], told["first"]["step"]), ("meets", 2))
        self.assertAlmostEqual(told["first"]["t"], (2 - 1) / 1.75, 2)

    # If it failed, an agent could not tell which parts of a scene meet, or leave them
    # out.
    def test_question_7__which_objects_meet(self):
        for i in (0, 1):
            write_box(self.path / f"arm{i}.obj", (3 * i, 0, 0), (1 + 3 * i, 1, 1))
            write_box(self.path / f"leg{i}.obj", (3 * i, 0, 50), (1 + 3 * i, 1, 51))
        write_box(self.path / "wall.obj", (3, -5, -5), (4, 5, 5))
        write_scene(self.path / "robot.json", [
            {"name": name, "files": file} for name, file in
            (("arm", "arm%d.obj"), ("leg", "leg%d.obj"), ("wall", "wall.obj"))])
        ask = self.asked(2)
        told = ask.call("check", files=["robot.json"])
        self.assertEqual([(pair["a"], pair["b"]) for pair in told["rows"][0]["pairs"]],
                         [("arm", "wall")])
        told = ask.call("check", files=["robot.json"], between=["leg,wall", "arm,leg"])
        self.assertEqual((told["verdict"], told["safe_step"]), ("free", 1))

    # If it failed, the place of a contact would be another one, or nobody would see it.
    def test_question_8__where_do_they_meet(self):
        write_triangle(self.path / "tip0.obj", (1, 1, 3), (1, 2, 9), (2, 1, 9))
        write_triangle(self.path / "tip1.obj", (1, 1, -1), (1, 2, 9), (2, 1, 9))
        write_triangle(self.path / "plate.obj", (0, 0, 0), (8, 0, 0), (0, 8, 0))
        ask = self.asked(2)
        told = ask.call("check", files=["tip%d.obj"], **{"with": ["plate.obj"]})
        self.assertEqual(told["contacts"], 1)
        told = ask.call("explain", handle=told["contacts_handle"], row=0, picture=True)
        self.assertEqual((told["kind"], told["proved"]), ("vertex-face", True))
        self.assertAlmostEqual(told["t"], 0.75, 9)
        self.assertEqual(told["a"], {"object": "tip", "vertices": [0], "start": [[1, 1,
                                                                                  3]],
                                     "end": [[1, 1, -1]]})
        self.assertEqual(told["b"]["vertices"], [0, 1, 2])
        self.assertEqual([round(x, 9) for x in told["point"]], [1, 1, 0])
        self.assertEqual(told["normal"], [0, 0, 1])
        picture = ask.request("resources/read", uri=told["picture"])["contents"][0]
        self.assertEqual(picture["mimeType"], "image/png")
        self.assertTrue(picture["blob"].startswith("iVBORw0KGgo"))

    # If it failed, what has no room in one answer could not be read to its end.
    def test_question_9__what_are_all_contacts(self):
        n = 6
        for i, height in enumerate((1, -1)):
            write_mesh(self.path / f"points{i}.obj",
                       [(x, y, height + dz) for x in range(n) for y in range(n)
                        for dz in (0, 4)] + [(-5, -5, 9)],
                       [(2 * k + 1, 2 * k + 2, 2 * n * n + 1) for k in range(n * n)])
        write_triangle(self.path / "plate.obj", (-1, -1, 0), (40, -1, 0), (-1, 40, 0))
        ask = self.asked(5)
        told = ask.call("check", files=["points%d.obj"], self_pairs=False,
                        **{"with": ["plate.obj"]})
        rows, offset = [], 0
        while offset is not None and ask.calls < 9:
            told_more = ask.call("more", handle=told["contacts_handle"], offset=offset)
            rows += told_more["rows"]
            offset = told_more.get("next_offset")
        faces = {row["a"] for row in rows if "vertex" in row["a"]}
        self.assertEqual(told["contacts"], n * n)
        self.assertEqual(len(rows), n * n)
        self.assertEqual(faces, {f"points vertex {2 * k}" for k in range(n * n)})

    # If it failed, an answer could not be shown to somebody who does not believe it.
    def test_question_10__is_that_proved(self):
        write_falling(self.path)
        ask = self.asked(6, "--write")
        ask.call("scene", files=["box%d.obj", "floor.obj"], output="fall.json")
        told = ask.call("check", files=["fall.json"], output="fall.jsonl")
        self.assertEqual((told["certificate"], told["standing"], told["new"]),
                         ("fall.jsonl", 0, 0))
        self.assertEqual(ask.call("verify", recording="fall.jsonl",
                                  files=["fall.json"])["verdict"], "pass")
        with self.assertRaisesRegex(Failed, "a certificate wants files"):
            ask.call("verify", recording="fall.jsonl")
        self.assertEqual(ask.call("record", files=["fall.json"],
                                  output="fall.rec")["steps"], 3)
        proved = ask.call("verify", recording="fall.rec")
        self.assertEqual(proved["verdict"], "pass")
        self.assertEqual(proved["contacts"], told["contacts"])
        self.assertGreater(proved["non_contacts"], 0)

    # If it failed, a hinge would jam elsewhere, or at another part, or be called free.
    def test_question_11__where_does_the_hinge_jam(self):
        write_hinge(self.path)
        ask = self.asked(7)
        told = ask.call("sweep", file="hinge.json")
        first = told["first"]
        low, high = map(float, first["bracket"].split(" to "))
        self.assertEqual((told["verdict"], told["looked_within"]), ("jams", True))
        self.assertEqual((first["joints"], {first["a"], first["b"]}, first["initial"]),
                         (["pin"], {"post", "leaf"}, False))
        self.assertLessEqual(low, math.pi / 6)
        self.assertLessEqual(math.pi / 6, high)
        self.assertLessEqual(high - low, 1e-6)
        self.assertAlmostEqual(first["value"][0], high, 8)
        self.assertEqual((first["within_bracket"], told["without_collision"]), (True, []))
        row = told["rows"][0]
        self.assertEqual((row["low"], row["high"]), ([0], [1.5]))
        self.assertEqual((row["beyond_limits"], row["initial_pairs"]), ([], []))
        self.assertEqual([jam["from"] for jam in row["jams"]], ["begin", "end"])
        high, low = map(float, row["jams"][1]["bracket"].split(" to "))
        self.assertGreater(high, low)  # as it goes: from the value that is free
        told = ask.call("sweep", file="hinge.json", joints=["pin=0:0.4"], least=1e-6)
        low, high = told["rows"][0]["least_distance"]
        self.assertEqual(told["verdict"], "free")
        self.assertAlmostEqual(low, math.sin(math.pi / 6 - 0.4), 5)
        self.assertAlmostEqual(high, low, 5)
        told = ask.call("sweep", file="hinge.json", clearance=["0.1"], bracket=1e-9)
        self.assertAlmostEqual(told["first"]["value"][0], 0.42343135397717, 8)
        told = ask.call("sweep", file="hinge.json", joints=["pin=1:2"])
        self.assertEqual(told["rows"][0]["beyond_limits"], ["pin"])
        with self.assertRaisesRegex(Failed, "no two shapes may meet"):
            ask.call("sweep", file="hinge.json", allow=["post,leaf"])
        with self.assertRaisesRegex(Failed, "hinge.json has no such joint"):
            ask.call("sweep", file="hinge.json", joints=["knee"])
        with self.assertRaisesRegex(Failed, "the low end is no number"):
            ask.call("sweep", file="hinge.json", joints=["pin=x:1"])


if __name__ == "__main__":
    unittest.main()
