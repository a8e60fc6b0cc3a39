"""check_mcp.py - pccdctl mcp against clients that keep the protocol, and that do not.

Room:     tests/mcp.
Does:     hold answers against schemas and sizes; refuse what leaves the folder; answer
          damaged messages; end calls that are taken back.
"""

import json
import os
import pathlib
import random
import socket
import tempfile
import time
import unittest

from files import write_box, write_falling, write_mesh, write_scene, write_triangle
from mcp_client import ANSWER_BYTES, Client, Draft202012Validator, Failed

SEED = int(os.environ.get("PCCD_SEED", "1"))
MUTATIONS = 1000
ROBOT = """<robot name="r"><link name="base"><collision><geometry><mesh filename="%s"/>
</geometry></collision></link><link name="arm"><collision><origin xyz="40 0 0"/><geometry>
<box size="1 1 1"/></geometry></collision></link><joint name="pin" type="continuous">
<parent link="base"/><child link="arm"/></joint></robot>
"""


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="pccd-mcp-")
        self.addCleanup(folder.cleanup)
        self.outside = pathlib.Path(folder.name)
        self.path = self.outside / "allowed"
        self.path.mkdir()
        write_falling(self.path)

    def client(self, *options):
        client = Client(self.path, "--url", "direct:", *options)
        client.__enter__()
        self.addCleanup(client.__exit__)
        return client

    def refused(self, client, tool, *texts, **arguments):
        with self.assertRaises(Failed) as caught:
            client.call(tool, **arguments)
        for text in texts:
            self.assertIn(text, str(caught.exception))


class Protocol(Case):
    # If it failed, a client would speak another version than the server.
    def test_versions__are_agreed_on(self):
        client = self.client()
        for asked, told in (("2024-11-05", "2024-11-05"), ("2025-11-25", "2025-11-25"),
                            ("1999-01-01", "2025-11-25"), (7, "2025-11-25")):
            self.assertEqual(client.request("initialize", protocolVersion=asked)
                             ["protocolVersion"], told)

    # If it failed, a damaged message would end the server, or be left without an answer.
    def test_messages__are_answered_whatever_they_are(self):
        client = self.client()
        wrong = {b"{": -32700, b"\xff\xfe": -32700,
                 b'{"jsonrpc":"2.0","id":1,"method":"x"': -32700,
                 b"[]": -32600, b"1": -32600, b'"x"': -32600, b"{}": -32600,
                 b'{"jsonrpc":"2.0","id":3,"method":5}': -32600,
                 b'{"jsonrpc":"1.0","id":3,"method":"ping"}': -32600,
                 b'{"jsonrpc":"2.0","id":[],"method":"ping"}': -32600,
                 b'{"jsonrpc":"2.0","id":null,"method":"ping"}': -32600,
                 b'{"jsonrpc":"2.0","id":true,"method":"ping"}': -32600,
                 b'{"jsonrpc":"2.0","id":"' + 300 * b"x" + b'","method":"ping"}': -32600,
                 b'{"jsonrpc":"2.0","id":4,"method":"tools/sell"}': -32601,
                 b'{"jsonrpc":"2.0","id":4,"method":"ping","params":[]}': -32602,
                 b'{"jsonrpc":"2.0","id":4,"method":"tools/call"}': -32602,
                 b'{"jsonrpc":"2.0","id":4,"method":"tools/call",'
                 b'"params":{"name":"rm"}}': -32602,
                 b'{"jsonrpc":"2.0","id":4,"method":"resources/read",'
                 b'"params":{"uri":"file:///etc/passwd"}}': -32602,
                 b"[" * 100000: -32700, b"x" * (3 << 20): -32600}
        for text, code in wrong.items():
            client.send(text)
            answer = client.receive()
            self.assertEqual(answer["error"]["code"], code, text[:80])
            self.assertLess(len(json.dumps(answer)), ANSWER_BYTES)
        for quiet in (b"", b" \r",
                      b'{"jsonrpc":"2.0","method":"notifications/initialized"}',
                      b'{"jsonrpc":"2.0","method":"nothing"}',
                      b'{"jsonrpc":"2.0","id":1,"result":{}}',
                      b'[{"jsonrpc":"2.0","method":"nothing"}]'):
            client.send(quiet)
        for number in (7, "seven", -1, 2.5, ""):
            client.send({"jsonrpc": "2.0", "id": number, "method": "ping"})
            self.assertEqual(client.receive(), {"jsonrpc": "2.0", "id": number,
                                                "result": {}})

    # If it failed, a part of a batch would be lost.
    def test_batches__are_answered_at_once(self):
        client = self.client()
        client.send([{"jsonrpc": "2.0", "id": 1, "method": "ping"},
                     {"jsonrpc": "2.0", "method": "notifications/initialized"}, 5,
                     {"jsonrpc": "2.0", "id": "b", "method": "tools/call",
                      "params": {"name": "scene", "arguments": {}}}])
        answers = client.receive()
        self.assertEqual([answer.get("id") for answer in answers], [1, None, "b"])
        self.assertEqual(answers[1]["error"]["code"], -32600)
        self.assertEqual(answers[2]["result"]["structuredContent"]["row_count"], 5)

    # If it failed, a last message without its line end would be lost, and a client that
    # ends at once would have no answer.
    def test_end_of_input__comes_after_the_answers(self):
        client = self.client()
        client.server.stdin.write(
            b'{"jsonrpc":"2.0","id":9,"method":"tools/call","params":'
            b'{"name":"check","arguments":{"files":["box%d.obj"]}}}')
        client.server.stdin.close()
        self.assertEqual(client.receive()["result"]["structuredContent"]["verdict"],
                         "free")
        self.assertEqual(client.server.wait(timeout=60), 0)

    # If it failed, a schema would be none, or its tool be refused by a client.
    def test_schemas__are_schemas_of_objects(self):
        tools = self.client().tools
        self.assertEqual(list(tools), ["scene", "check", "near", "crossings", "sweep",
                                       "explain", "more", "record", "verify"])
        for tool in tools.values():
            for schema in (tool["inputSchema"], tool["outputSchema"]):
                self.assertEqual(schema["type"], "object")
                self.assertIs(schema["additionalProperties"], False)
                if Draft202012Validator is not None:
                    Draft202012Validator.check_schema(schema)
                for field in schema["properties"].values():
                    self.assertTrue(field["description"])
            self.assertTrue(tool["description"])

    def deaf(self):
        """The URL of a daemon that never answers."""
        name = str(self.outside / "deaf")
        listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.addCleanup(listener.close)
        listener.bind(name)
        listener.listen()
        return f"unix:{name}"

    # If it failed, a client that gives up would wait behind what it no longer wants, and
    # be answered twice.
    def test_calls__are_taken_back(self):
        client = self.client("--url", self.deaf())
        call = {"name": "check", "arguments": {"files": ["box%d.obj"]}}
        client.send({"jsonrpc": "2.0", "id": 50, "method": "tools/call", "params": call})
        client.send({"jsonrpc": "2.0", "id": 51, "method": "tools/call", "params": call})
        client.send({"jsonrpc": "2.0", "id": 52, "method": "ping"})
        self.assertEqual(client.receive()["id"], 52)
        for number in (51, 99, 50):
            client.send({"jsonrpc": "2.0", "method": "notifications/cancelled",
                         "params": {"requestId": number}})
        client.send({"jsonrpc": "2.0", "id": 53, "method": "ping"})
        self.assertEqual(client.receive()["id"], 53)
        while children(client):  # or the test would end by its time
            time.sleep(0.01)

    # If it failed, what never ends would keep the server for ever.
    def test_calls__end_after_their_time(self):
        client = self.client("--seconds", "1", "--url", self.deaf())
        self.refused(client, "check", "more than 1 seconds", files=["box%d.obj"])
        self.assertEqual(client.call("scene", files=["box%d.obj"])["frames"], 4)
        self.assertEqual(children(client), [])

    # If it failed, the server would stay, or leave a daemon, when its client is gone.
    def test_server__ends_with_its_client(self):
        client = Client(self.path, "--url", self.deaf())
        with client:
            client.send({"jsonrpc": "2.0", "id": 50, "method": "tools/call", "params":
                         {"name": "check", "arguments": {"files": ["box%d.obj"]}}})
            while not children(client):
                time.sleep(0.01)
            worker = children(client)[0]
            client.server.kill()
        while os.path.exists(f"/proc/{worker}") and state(worker) != "Z":
            time.sleep(0.01)

    # If it failed, each call would cost a descriptor, until there are none.
    def test_descriptors__are_given_back(self):
        client = self.client()

        def held():
            return len(os.listdir(f"/proc/{client.server.pid}/fd"))
        before = held()
        for i in range(40):
            told = client.call("check", files=["box%d.obj"], **{"with": ["floor.obj"]})
            if i % 10 == 0:
                client.call("explain", handle=told["contacts_handle"], row=i % 7,
                            picture=True)
                self.refused(client, "check", files=["nothing.obj", "box1.obj"])
        self.assertEqual(held(), before)

    # If it failed, the daemon that a client's environment names, or a private one, would
    # not serve.
    def test_daemon__needs_no_environment(self):
        with Client(self.path) as client:
            told = client.call("check", files=["box%d.obj"], **{"with": ["floor.obj"]})
        self.assertEqual((told["verdict"], client.status), ("meets", 0))

    # If it failed, some message would end the server, or be answered by what is no JSON.
    def test_mutations__leave_a_server_that_answers(self):
        client = self.client()
        chance = random.Random(SEED)
        calls = [{"name": "check", "arguments": {"files": ["box%d.obj"],
                                                 "with": ["floor.obj"],
                                                 "thickness": 0.5,
                                                 "between": ["box,floor"]}},
                 {"name": "near", "arguments": {"files": ["box1.obj", "floor.obj"],
                                                "what": "pairs", "distance": 7}},
                 {"name": "explain", "arguments": {"handle": "contacts-2", "row": 3}},
                 {"name": "more", "arguments": {"handle": "contacts-2", "offset": 5}},
                 {"name": "scene", "arguments": {"folder": "."}}]
        for number in range(MUTATIONS):
            text = bytearray(json.dumps(
                {"jsonrpc": "2.0", "id": number, "method": "tools/call",
                 "params": chance.choice(calls)}).encode())
            for _ in range(chance.randrange(1, 5)):
                at = chance.randrange(len(text))
                what = chance.randrange(4)
                if what == 0:
                    text[at] = chance.randrange(256)
                elif what == 1:
                    del text[at:at + chance.randrange(1, 9)]
                elif what == 2:
                    text[at:at] = text[at:at + chance.randrange(20)]
                else:
                    text[at] = chance.choice(b'{}[]",:09-.eE\\tfn')
                text = text or bytearray(b"0")
            client.send(bytes(text).replace(b"\n", b" "))
            client.send({"jsonrpc": "2.0", "id": "end", "method": "resources/list"})
            count = 0
            while (answer := client.receive()) != {"jsonrpc": "2.0", "id": "end",
                                                   "result": {"resources": []}}:
                count += 1
                if "structuredContent" in json.dumps(answer):
                    self.assertLessEqual(len(json.dumps(answer)), 2 * ANSWER_BYTES, text)
            self.assertLess(count, 3, text)


class Confined(Case):
    # If it failed, an agent could read files that nobody has shown it.
    def test_files__outside_of_the_folder_are_refused(self):
        write_box(self.outside / "secret0.obj", (0, 0, 0), (1, 1, 1))
        write_box(self.outside / "secret1.obj", (0, 0, 0), (1, 1, 1))
        (self.path / "link.obj").symlink_to("../secret0.obj")
        (self.path / "up").symlink_to("..")
        (self.path / "here.obj").symlink_to("box0.obj")
        for name, files in (("out.json", "../secret%d.obj"),
                            ("abs.json", str(self.outside / "secret0.obj")),
                            ("by.json", ["link.obj", "box1.obj"])):
            write_scene(self.path / name, [{"name": "a", "files": files},
                                           {"name": "b", "files": "box0.obj"}])
        (self.path / "out.gltf").write_text(json.dumps(
            {"asset": {"version": "2.0"}, "buffers": [{"uri": "link.obj",
                                                       "byteLength": 96}],
             "bufferViews": [{"buffer": 0, "byteLength": 96}], "scene": 0,
             "scenes": [{"nodes": [0]}],
             "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3",
                            "count": 3}],
             "nodes": [{"mesh": 0}],
             "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]}))
        client = self.client()
        outside = "outside of the folder"
        for name in ("../secret0.obj", "/etc/passwd", str(self.outside / "secret0.obj"),
                     "link.obj",
                     "up/secret0.obj", "./../secret0.obj", "/proc/self/environ"):
            self.refused(client, "scene", outside, name, files=[name])
            self.refused(client, "check", outside, name, files=[name, "box1.obj"])
            self.refused(client, "check", outside, name, files=["box%d.obj"],
                         **{"with": [name]})
            self.refused(client, "near", outside, name, files=[name, "box1.obj"])
            self.refused(client, "crossings", outside, name, files=[name])
            self.refused(client, "verify", outside, name, recording=name)
            self.refused(client, "sweep", outside, name, file=name)
            self.refused(client, "sweep", outside, name, file="r.urdf", srdf=name,
                         meshes=["."])
            self.refused(client, "sweep", outside, name, file="r.urdf", meshes=[name])
        for name in ("../secret%d.obj", "up/secret%d.obj"):
            self.refused(client, "check", files=[name])
        for name, member in (("out.json", "../secret%d.obj"), ("abs.json", "secret0.obj"),
                             ("by.json", "link.obj"), ("out.gltf", "link.obj")):
            self.refused(client, "scene", outside, member, files=[name])
            self.refused(client, "near", outside, member, files=[name, "box0.obj"]
                         if name == "out.gltf" else [name])
        for name in ("..", "up", "/", "/etc"):
            self.refused(client, "scene", outside, folder=name)
        for name in ("here.obj", str(self.path / "box0.obj"), "./box0.obj"):
            self.assertEqual(client.call("scene", files=[name])["row_count"], 1)

    # If it failed, a robot would have meshes that nobody has shown the agent, or tell by
    # its errors what lies around the folder.
    def test_meshes_of_robots__outside_of_the_folder_are_refused(self):
        write_box(self.outside / "secret.obj", (0, 0, 0), (1, 1, 1))
        (self.path / "link.obj").symlink_to("../secret.obj")
        client = self.client()
        (self.path / "r.urdf").write_text(ROBOT % "package://x/box0.obj")
        try:
            self.assertEqual(client.call("sweep", file="r.urdf")["verdict"], "free")
        except Failed as why:
            self.assertIn("built without expat", str(why))
            self.skipTest("built without expat")
        for names, text in ((("../secret.obj", "../nothing.obj", "link.obj",
                              "file:///etc/passwd", "file:///etc/nothing",
                              str(self.outside / "secret.obj")),
                             "outside of the folder"),
                            (("package://x/secret.obj", "secret.obj"), "is not there")):
            for name in names:
                (self.path / "r.urdf").write_text(ROBOT % name)
                self.refused(client, "sweep", text, file="r.urdf")

    # If it failed, a call would wait for a byte that nobody writes, until its time is
    # over.
    def test_pipes__are_refused_at_once(self):
        os.mkfifo(self.path / "never.obj")
        os.mkfifo(self.path / "never.json")
        (self.path / "to.obj").symlink_to("never.obj")
        listener = socket.socket(socket.AF_UNIX)
        self.addCleanup(listener.close)
        listener.bind(str(self.path / "heard.obj"))
        write_scene(self.path / "of.json", [{"name": "a", "files": "never.obj"},
                                            {"name": "b", "files": "box0.obj"}])
        client = self.client("--seconds", "9", "--write")
        for name, member in (("never.obj", "never.obj"), ("to.obj", "to.obj"),
                             ("never.json", "never.json"), ("heard.obj", "heard.obj"),
                             ("of.json", "never.obj")):
            self.refused(client, "scene", f"{member}: cannot open: it is no file",
                         files=[name])
            self.refused(client, "check", f"{member}: cannot open: it is no file",
                         files=[name] if name.endswith("json") else [name, "box1.obj"])
            self.refused(client, "near", f"{member}: cannot open: it is no file",
                         files=[name] if name.endswith("json") else [name, "box1.obj"])
        self.refused(client, "scene", "it is no file", folder="never.obj")
        self.refused(client, "check", "never.obj: cannot open: it is no file",
                     files=["box%d.obj"], **{"with": ["never.obj"]})
        self.refused(client, "verify", "never.obj", recording="never.obj")

    # If it failed, something would be written that was not allowed, or over something.
    def test_writing__is_allowed_and_into_new_files(self):
        (self.path / "to").symlink_to("../new.png")
        (self.path / "gone.png").symlink_to("nowhere.png")
        (self.path / "old.rec").write_text("mine")
        client = self.client()
        told = client.call("check", files=["box%d.obj"], **{"with": ["floor.obj"]})
        self.refused(client, "explain", "without --write", handle=told["contacts_handle"],
                     row=0,
                     output="p.png")
        self.refused(client, "scene", "without --write", files=["box0.obj"],
                     output="s.json")
        self.refused(client, "record", "without --write", files=["box%d.obj"],
                     output="s.rec")
        client = self.client("--write")
        told = client.call("check", files=["box%d.obj"], **{"with": ["floor.obj"]})
        for name in ("../new.png", str(self.outside / "new.png"), "/tmp/new.png", "to",
                     "gone.png",
                     "p.obj", "no/p.png"):
            self.refused(client, "explain", name, handle=told["contacts_handle"], row=0,
                         output=name)
        self.refused(client, "record", "old.rec", files=["box%d.obj"], output="old.rec")
        self.refused(client, "scene", "s.json", files=["box0.obj"], output="../s.json")
        self.refused(client, "record", "not named FILE.rec", files=["box%d.obj"],
                     output="box0.obj")
        self.assertEqual(sorted(entry.name for entry in self.outside.iterdir()),
                         ["allowed"])
        self.assertEqual((self.path / "old.rec").read_text(), "mine")
        self.assertFalse((self.path / "nowhere.png").exists())
        client.call("explain", handle=told["contacts_handle"], row=0, output="p.png")
        self.assertEqual((self.path / "p.png").read_bytes()[:4], b"\x89PNG")

    # If it failed, a file whose name is an option would be one.
    def test_names__are_no_options(self):
        write_box(self.path / "--help", (0, 0, 0), (1, 1, 1))
        client = self.client()
        self.refused(client, "near", files=["--version"])
        self.assertEqual(client.call("scene", files=["--help"])["row_count"], 1)


class Tools(Case):
    # If it failed, what is asked would be taken for something else.
    def test_arguments__are_named_where_they_are_wrong(self):
        client = self.client()
        for tool, text, arguments in (
                ("check", '"files" is missing', {}),
                ("check", 'no argument "thicknes"', {"files": ["a"], "thicknes": 1}),
                ("check", '"thickness" is no number from 0', {"files": ["a"],
                                                              "thickness": -1}),
                ("check", '"thickness" is no number', {"files": ["a"], "thickness": "1"}),
                ("check", '"rings" is no whole number from 0 to 8', {"files": ["a"],
                                                                     "rings": 1.5}),
                ("check", '"mode" is one of all|first', {"files": ["a"], "mode": "al"}),
                ("check", '"self_pairs" is true or false', {"files": ["a"],
                                                            "self_pairs": 1}),
                ("check", '"files"', {"files": [1]}), ("check", '"files"', {"files": {}}),
                ("check", '"files"', {"files": []}), ("check", '"files"',
                                                      {"files": [""]}),
                ("check", '"files"', {"files": ["x" * 5000]}),
                ("check", '"files"', {"files": ["x"] * 2000}),
                ("check", "nothing.obj: cannot open", {"files": ["nothing.obj",
                                                                 "box1.obj"]}),
                ("check", "between", {"files": ["box%d.obj"], "between": ["a,b"]}),
                ("near", "--distance is missing", {"files": ["box0.obj"],
                                                   "what": "pairs"}),
                ("explain", 'no handle "x"', {"handle": "x", "row": 0}),
                ("explain", '"row" is no whole number', {"handle": "x", "row": -1}),
                ("more", 'no handle "contacts-9"', {"handle": "contacts-9"}),
                ("verify", "floor.obj", {"recording": "floor.obj"}),
                ("sweep", '"file" is missing', {}),
                ("sweep", '"motions" is no whole number from 1', {"file": "a.urdf",
                                                                  "motions": 0}),
                ("sweep", "floor.obj", {"file": "floor.obj"}),
                ("sweep", "hinge.json: cannot open", {"file": "hinge.json"}),
                ("scene", '"files" is missing', {"with": ["box0.obj"]})):
            self.refused(client, tool, text, **arguments)

    # If it failed, a handle would give other rows than those it was given for, or for
    # ever.
    def test_handles__are_kept_for_a_while(self):
        client = self.client()
        told = client.call("check", files=["box%d.obj"], **{"with": ["floor.obj"]})
        handle = told["contacts_handle"]
        first = client.call("more", handle=handle)
        self.assertEqual((first["tool"], first["row_count"]), ("check", told["contacts"]))
        self.assertEqual(client.call("more", handle=handle,
                                     offset=told["contacts"])["rows"], [])
        self.refused(client, "more", "has rows 0 to", handle=handle,
                     offset=told["contacts"] + 1)
        self.refused(client, "explain", "has rows 0 to", handle=handle,
                     row=told["contacts"])
        self.refused(client, "explain", "no records of two", handle=told["handle"], row=0)
        for _ in range(32):
            client.call("scene")
        self.refused(client, "more", "is gone", handle=handle)

    # If it failed, only the first ranges of a robot with many joints would be told.
    def test_ranges__go_on_in_more(self):
        names = [f"joint {i}" for i in range(30)]
        write_scene(self.path / "chain.json",
                    [{"name": "hand", "files": "box0.obj", "joint": names[-1]},
                     {"name": "floor", "files": "floor.obj"}],
                    joints=[{"name": name, "type": "prismatic", "range": [0, 1],
                             **({"parent": parent} if parent else {})}
                            for parent, name in zip([None] + names, names)])
        client = self.client()
        told = client.call("sweep", file="chain.json")
        self.assertEqual((told["verdict"], told["row_count"]), ("free", 30))
        rows = told["rows"]
        while "next_offset" in told:
            told = client.call("more", handle=told["handle"], offset=told["next_offset"])
            rows += told["rows"]
        self.assertEqual([row["joints"] for row in rows], [[name] for name in names])

    # If it failed, an answer would be longer than an agent wants to read, or no answer.
    def test_answers__have_room_for_long_names(self):
        long = "n" * 200
        for i in range(3):
            write_box(self.path / f"{long}{i}.obj", (0, 0, 9 - 9 * i), (2, 2, 11 - 9 * i))
        write_scene(self.path / "long.json", [
            {"name": letter * 900, "files": files} for letter, files in
            (("ä", f"{long}%d.obj"), ("b", "floor.obj"), ("c", "box1.obj"))])
        client = self.client()
        client.call("scene")
        client.call("scene", files=["long.json"])
        told = client.call("check", files=["long.json"])
        self.assertEqual(told["verdict"], "meets")
        self.assertGreater(len(client.call("more",
                                           handle=told["contacts_handle"])["rows"]), 0)
        client.call("explain", handle=told["contacts_handle"], row=0)
        near = client.call("near", files=["long.json"], what="pairs", distance=30)
        client.call("explain", handle=near["handle"], row=1)
        write_box(self.path / "half.obj", (1, 1, 11), (3, 3, 13))
        write_scene(self.path / "joints.json", [
            {"name": "ä" * 900, "files": "box0.obj", "joint": "€" * 900},
            {"name": "b" * 900, "files": "half.obj"}],
            joints=[{"name": "€" * 900, "type": "prismatic", "range": [0, 1]}])
        jam = client.call("sweep", file="joints.json")["first"]
        self.assertTrue(jam["initial"] and jam["joints"][0].endswith("..."))
        self.refused(client, "check", files=["x" * 4000, "y" * 4000])
        for letter in "xé€😀":  # 1, 6, 6 and 12 bytes in an answer
            for count in (120, 380, 900):
                self.refused(client, "check", letter * 9, files=[letter * count])
                self.refused(client, "more", letter * 9, handle=letter * count)

    # If it failed, what has no room would be cut without a word, and be read, or written
    # as a certificate, as if it were whole.
    def test_reports__that_are_too_long_are_refused(self):
        write_scene(self.path / "long.json", [
            {"name": "a" * 4000000, "files": [f"box{i}.obj" for i in (2, 3, 2, 3, 2)]},
            {"name": "b" * 4000000, "files": "floor.obj"}])
        client = self.client("--write")
        self.refused(client, "check", "more than 64 MiB", files=["long.json"],
                     output="long.jsonl")
        self.assertFalse((self.path / "long.jsonl").exists())

    # If it failed, a question would be asked as another one.
    def test_options__reach_the_commands(self):
        client = self.client()
        both = {"files": ["box%d.obj"], "with": ["floor.obj"]}
        first = client.call("check", mode="first", **both)
        self.assertLess(first["contacts"], client.call("check", **both)["contacts"])
        self.assertEqual(client.call("check", mode="any", **both)["verdict"], "meets")
        self.assertEqual(client.call("check", separation=3, self_pairs=False,
                                     **both)["first"]["step"], 2)
        near = client.call("near", files=["box1.obj", "floor.obj"], what="vertices",
                           distance=7, self_pairs=False)
        self.assertEqual(near["rows"][0]["bound"], 6)
        write_box(self.path / "in.obj", (10, 10, -50), (12, 12, -48))
        depth = client.call("near", files=["in.obj", "floor.obj"], what="depth")
        self.assertEqual(depth["distance_max"], 40)
        told = client.call("crossings", files=["in.obj", "floor.obj"])
        self.assertEqual((told["verdict"], told["found"]), ("no", 0))
        told = client.call("crossings", files=["box3.obj", "floor.obj"])  # it touches
        self.assertEqual((told["verdict"], told["found"]), ("yes", 0))

    # If it failed, thick contacts would be drawn as others.
    def test_pictures__are_of_what_was_asked(self):
        client = self.client()
        both = {"files": ["box%d.obj"], "with": ["floor.obj"]}
        told = client.call("check", thickness=0.5, **both)
        client.call("explain", handle=told["contacts_handle"], row=0)
        self.refused(client, "explain", "thickness", handle=told["contacts_handle"],
                     row=0, picture=True)
        told = client.call("check", **both)
        uris = [client.call("explain", handle=told["contacts_handle"], row=i,
                            picture=True)["picture"]
                for i in range(10)]
        kept = [one["uri"] for one in client.request("resources/list")["resources"]]
        self.assertEqual(sorted(kept), sorted(uris[-8:]))
        self.assertEqual(client.ask("resources/read", uri=uris[0])["error"]["code"],
                         -32602)

    # If it failed, a box that leaves its floor would never have a safe step.
    def test_touching__is_left_out_where_it_leaves(self):
        for i in (0, 1):
            write_box(self.path / f"up{i}.obj", (0, 0, 3 * i), (2, 2, 2 + 3 * i))
        client = self.client()
        both = {"files": ["up%d.obj"], "with": ["floor.obj"]}
        self.assertEqual(client.call("check", **both)["safe_step"], 0)
        told = client.call("check", touching="left-out", **both)
        self.assertEqual((told["verdict"], told["safe_step"]), ("free", 1))

    # If it failed, a step that begins crossed would be called free.
    def test_verdict__says_how_steps_begin(self):
        for i in (0, 1):
            write_triangle(self.path / f"pin{i}.obj", (1, 1, -1), (1.5, 1, 2), (1, 1.5,
                                                                                2))
        write_triangle(self.path / "plate.obj", (0, 0, 0), (8, 0, 0), (0, 8, 0))
        client = self.client()
        told = client.call("check", files=["pin%d.obj"], **{"with": ["plate.obj"]})
        self.assertEqual((told["verdict"], told["crossings"]), ("crossed", 2))
        told = client.call("check", files=["pin%d.obj"], mode="any",
                           **{"with": ["plate.obj"]})
        self.assertEqual((told["verdict"], told["row_count"]), ("crossed", 1))
        self.assertNotIn("first", told)


def state(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except (FileNotFoundError, ProcessLookupError):  # the latter while it is read
        return "Z"


def children(client):
    """Processes of a server that live."""
    pid = client.server.pid
    text = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text()
    return [int(child) for child in text.split() if state(child) != "Z"]
