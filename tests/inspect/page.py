"""page.py - the data in a page, read without a browser.

Room:     tests/inspect. May use: Python's standard library.
Does:     find the elements that hold them, as a parser of HTML sees them; decode.
Does not: know what they should be.
"""

import array
import base64
import html.parser
import json
import zlib


class _Elements(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.texts = {}
        self.policy = None
        self.addresses = []
        self._id = None

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self._id = given.get("id") if tag == "script" else None
        if tag == "meta" and given.get("http-equiv") == "Content-Security-Policy":
            self.policy = given["content"]
        self.addresses += [given[name] for name in ("src", "href") if name in given]

    def handle_endtag(self, tag):
        self._id = None

    def handle_data(self, data):
        if self._id:
            self.texts[self._id] = self.texts.get(self._id, "") + data


class Page:
    def __init__(self, path):
        elements = _Elements()
        with open(path, encoding="utf-8") as page:
            elements.feed(page.read())
        self.policy = elements.policy
        self.addresses = elements.addresses
        self.meta = json.loads(elements.texts.pop("pccd-meta"))
        self._blobs = elements.texts

    def section(self, place, count):
        blob, offset = place
        data = zlib.decompress(base64.b64decode(self._blobs[f"pccd-{blob:08}"]))
        return data[offset:offset + count]

    def flags(self, step):
        """Of the contacts of a step, with their kinds in bits 6 and 7."""
        contacts = self.meta["steps"][step]["contacts"]
        count = contacts["count"]
        return self.section(contacts["at"], 35 * count)[34 * count:]

    def positions(self, step, end, item=0):
        """Of an object at the end "x0" or "x1" of a step: [[x, y, z], ...]."""
        of = self.meta["steps"][step]["objects"][item]
        vertices = self.meta["meshes"][of["mesh"]]["vertices"]
        if self.meta["is_rounded"]:
            data = self.section(of[end], 24 + 6 * vertices)
            head = array.array("f", data[:24])
            numbers = array.array("H", data[24:])
            values = [head[i % 3] + head[3 + i % 3] * n for i, n in enumerate(numbers)]
        else:
            values = array.array("f", self.section(of[end], 12 * vertices))
        origin, unit = self.meta["origin"], self.meta["unit"]
        return [[values[3 * i + k] * unit + origin[k] for k in range(3)]
                for i in range(vertices)]
