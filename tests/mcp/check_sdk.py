"""check_sdk.py - runs check_sdk.mjs where its library is.

Room:     tests/mcp.
Does:     skip it by name where Node or the library is missing.
"""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

from files import write_falling, write_hinge

LIBRARY = pathlib.Path(os.environ.get("NODE_MODULES", "")) / "@modelcontextprotocol/sdk"
HERE = pathlib.Path(__file__).parent


class Sdk(unittest.TestCase):
    # If it failed, the client that agents have could not use the server, or would refuse
    # an answer.
    def test_sdk__calls_every_tool(self):
        has_library = "NODE_MODULES" in os.environ and LIBRARY.is_dir()
        if not has_library or not shutil.which("node"):
            self.skipTest("no node, or no @modelcontextprotocol/sdk in $NODE_MODULES")
        with tempfile.TemporaryDirectory(prefix="pccd-mcp-") as folder:
            write_falling(pathlib.Path(folder))
            write_hinge(pathlib.Path(folder))
            done = subprocess.run(["node", HERE / "check_sdk.mjs", folder], timeout=300,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  check=False)
            self.assertEqual(done.stdout, b"true\n", done.stdout.decode())
