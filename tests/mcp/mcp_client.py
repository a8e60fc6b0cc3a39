"""mcp_client.py - a client of pccdctl mcp that has pipes and nothing else.

Room:     tests/mcp.
Does:     start a server with the environment that the TypeScript SDK passes on; hold each
          answer of a tool against its schema and its size; count the calls.
"""

import json
import os
import subprocess

ANSWER_BYTES = 2048
PASSED_ON = ("HOME", "LOGNAME", "PATH", "SHELL", "TERM", "USER")

try:
    from jsonschema import Draft202012Validator
except ImportError:
    Draft202012Validator = None


class Failed(Exception):
    """A tool's answer that says what went wrong."""


class Client:
    """A server in a folder, and its tools."""

    def __init__(self, folder, *options):
        passed_on = {key: os.environ[key] for key in PASSED_ON if key in os.environ}
        for key in ("ASAN_OPTIONS", "LD_LIBRARY_PATH", "PCCD_DIRECT"):  # of test builds
            if key in os.environ:
                passed_on[key] = os.environ[key]
        self.server = subprocess.Popen(
            [os.environ["PCCDCTL"], "mcp", "--daemon", os.environ["PCCD_DAEMON"],
             *options, str(folder)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=passed_on)
        self.number = 0
        self.calls = 0
        self.sizes = []
        self.tools = {}
        self.status = None

    def __enter__(self):
        self.request("initialize", protocolVersion="2025-06-18", capabilities={},
                     clientInfo={"name": "test", "version": "1"})
        self.send({"jsonrpc": "2.0", "method": "notifications/initialized"})
        self.tools = {tool["name"]: tool for tool in self.request("tools/list")["tools"]}
        return self

    def __exit__(self, *_):
        try:
            self.server.stdin.close()
        except BrokenPipeError:
            pass
        self.server.stdout.close()
        self.status = self.server.wait(timeout=100)

    def send(self, message):
        text = message if isinstance(message, bytes) else json.dumps(message).encode()
        self.server.stdin.write(text + b"\n")
        self.server.stdin.flush()

    def receive(self):
        return json.loads(self.server.stdout.readline())

    def ask(self, method, **params):
        """The whole answer to a request."""
        self.number += 1
        self.send({"jsonrpc": "2.0", "id": self.number, "method": method,
                   "params": params})
        answer = self.receive()
        assert answer["id"] == self.number, answer
        return answer

    def request(self, method, **params):
        return self.ask(method, **params)["result"]

    def call(self, tool, **arguments):
        """What a tool tells, looked at as its schema says."""
        self.calls += 1
        result = self.request("tools/call", name=tool, arguments=arguments)
        self.sizes.append(len(json.dumps(result, separators=(",", ":"))))
        assert self.sizes[-1] <= ANSWER_BYTES, (tool, arguments, self.sizes[-1])
        if result.get("isError"):
            raise Failed(result["content"][0]["text"])
        told = result["structuredContent"]
        assert json.loads(result["content"][0]["text"]) == told
        if Draft202012Validator is not None:
            Draft202012Validator(self.tools[tool]["outputSchema"]).validate(told)
        return told
