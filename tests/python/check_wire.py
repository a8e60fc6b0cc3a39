"""check_wire.py - the constants of the Python client are those of the C headers.

Room:     tests/python. Reads proto/*.h and client/lib/pccd.h.
Does:     compare every enum, status, limit, offset and record.
"""

import os
import re
import sys
import unittest

import numpy as np

import pccd
from _pccd import observe, wire

ROOT = os.environ["top_srcdir"]


def header(path):
    """A header without its comments."""
    with open(f"{ROOT}/{path}", encoding="utf-8") as file:
        text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
    return text.replace("\\\n", "\n")


TYPES = header("proto/pccd_types.h")
SHM = header("proto/shm.h")
LIMITS = header("proto/proto_limits.h")
TRACE = header("proto/pccd_trace.h")
DAEMON = header("proto/pccd_daemon.h")


def c_enum(text, name, prefix):
    """Names without prefix, and values, of a C enum; the count at its end is left out."""
    body = re.search(r"enum " + name + r" \{(.*?)\}", text, re.S).group(1)
    items = re.findall(r"(\w+) = (\d+)u?", body)
    return {key[len(prefix):]: int(value) for key, value in items
            if not key.endswith("_COUNT")}


def c_struct(text, name):
    """A C struct of numbers as a numpy type, aligned as C does it."""
    kinds = {"uint16_t": "<u2", "uint32_t": "<u4", "uint64_t": "<u8", "double": "<f8",
             "float": "<f4"}
    body = re.search(r"struct " + name + r" \{(.*?)\}", text, re.S).group(1)
    fields = []
    for kind, field, count in re.findall(r"(\w+) (\w+)(?:\[(\d+)\])?;", body):
        fields.append((field, kinds[kind], (int(count),) if count else ()))
    return np.dtype(fields, align=True)


def define(text, name):
    """The number behind a #define; (1u << 20) and the like are computed."""
    value = re.search(r"#define " + name + r" (.*)", text).group(1)
    return int(eval(re.sub(r"(?<=\d)(u|ull)\b", "", value)))  # of our own headers


class Wire(unittest.TestCase):
    """Against proto/*.h."""

    # If this failed, an error would carry another's name.
    def test_statuses__are_those_of_the_header(self):
        items = re.findall(r"X\((\w+), (-?\d+),", TYPES)
        self.assertEqual({name: int(value) for name, value in items},
                         {status.name: status.value for status in pccd.Status})
        self.assertGreater(len(items), 20)

    # If this failed, a setting or a field would mean something else to the daemon.
    def test_enums__are_those_of_the_headers(self):
        for python, text, name, prefix in (
                (pccd.Mode, TYPES, "pccd_mode", "PCCD_MODE_"),
                (pccd.Method, TYPES, "pccd_method", "PCCD_METHOD_"),
                (pccd.Scheduler, TYPES, "pccd_scheduler", "PCCD_SCHEDULER_"),
                (pccd.HighLevel, TYPES, "pccd_high_level", "PCCD_HIGH_LEVEL_"),
                (pccd.Refit, TYPES, "pccd_refit", "PCCD_REFIT_"),
                (pccd.Quality, TYPES, "pccd_quality", "PCCD_QUALITY_"),
                (pccd.Share, TYPES, "pccd_share", "PCCD_SHARE_"),
                (pccd.ObjectWhat, TYPES, "pccd_object_what", "PCCD_OBJECT_"),
                (pccd.Format, TYPES, "pccd_format", "PCCD_FORMAT_"),
                (pccd.Kind, TYPES, "pccd_kind", "PCCD_"),
                (pccd.ContactFlag, TYPES, "pccd_contact_flag", "PCCD_"),
                (pccd.Verdict, TYPES, "pccd_verdict", "PCCD_VERDICT_"),
                (pccd.Tree, TRACE, "pccd_tree", "PCCD_TREE_"),
                (pccd.TraceKind, TRACE, "pccd_trace_kind", "PCCD_TRACE_"),
                (pccd.HistogramKind, DAEMON, "pccd_histogram_kind", "PCCD_HISTOGRAM_")):
            with self.subTest(name):
                self.assertEqual(c_enum(text, name, prefix),
                                 {key: item.value
                                  for key, item in python.__members__.items()})
        incomplete = c_enum(TYPES, "pccd_incomplete", "PCCD_")
        self.assertEqual({name.replace("INCOMPLETE_", ""): value
                          for name, value in incomplete.items()},
                         {item.name: item.value for item in pccd.Incomplete})

    # If this failed, a record would be read at other offsets than it was written to.
    def test_records__have_the_layout_of_the_headers(self):
        for dtype, text, name in ((pccd.CONTACT, TYPES, "pccd_contact"),
                                  (pccd.PAIR, TYPES, "pccd_pair"),
                                  (pccd.EDGE, TYPES, "pccd_edge"),
                                  (pccd.BOX, TRACE, "pccd_box"),
                                  (pccd.TRACE_EVENT, TRACE, "pccd_trace_event")):
            with self.subTest(name):
                layout = c_struct(text, name)
                self.assertEqual(dtype.itemsize, layout.itemsize)
                self.assertEqual(dtype.fields, layout.fields)

    # If this failed, this client would ask for what the daemon refuses, or too little.
    def test_limits__are_those_of_the_header(self):
        for name in ("VERSION_MIN", "VERSION_MAX", "FEATURE_RESUME", "FEATURE_OBSERVE",
                     "FEATURE_FILTERS", "FEATURE_SHARED", "FEATURE_HELD",
                     "MESSAGE_BYTES_MAX", "SLOTS_MAX", "INFLIGHT_MAX", "REPLIES_KEPT",
                     "SEGMENTS_MAX", "SLOT_BYTES_MIN", "RESULT_BYTES_MIN"):
            with self.subTest(name):
                self.assertEqual(getattr(wire, name), define(LIMITS, "PROTO_" + name))
        self.assertEqual(wire.HISTOGRAM_BUCKETS, define(DAEMON, "PCCD_HISTOGRAM_BUCKETS"))

    # If this failed, a word of the upload ring would be stored beside its place.
    def test_words__stand_where_the_header_says(self):
        offsets = dict(re.findall(r"\(struct proto_upload, (\w+)\) == (\w+)", SHM))
        for field, index in (("head", wire.HEAD), ("client_wait", wire.CLIENT_WAIT),
                             ("result_head", wire.RESULT_HEAD), ("slots", wire.SLOT_SEQ)):
            with self.subTest(field):
                self.assertEqual(int(offsets[field], 16), 8 * index)
        sizes = dict(re.findall(r"sizeof\(struct proto_(\w+)\) == (\w+)", SHM))
        self.assertEqual(int(sizes["upload"], 16), wire.PAYLOADS)
        self.assertEqual(int(sizes["slot"]), 8 * wire.SLOT_WORDS)

    # If this failed, the daemon would read another segment than was meant.
    def test_segments__have_the_layout_of_the_header(self):
        layout = c_struct(SHM, "proto_segment")
        self.assertEqual(wire.SEGMENT.size, layout.itemsize)
        packed = np.frombuffer(wire.SEGMENT.pack(1, 2, 3, 4, 5, 6, 7), layout)[0]
        self.assertEqual(packed.tolist(), (1, 2, 3, 4, 5, 6, 7))
        kinds = c_enum(SHM, "proto_segment_kind", "PROTO_SEGMENT_")
        kinds.pop("KIND", None)
        self.assertEqual(kinds, {"X1": wire.X1, "X0X1": wire.X0X1, "RIGID": wire.RIGID})
        self.assertEqual(define(SHM, "PROTO_RIGID_BYTES"), wire.RIGID_BYTES)

    # If this failed, the module would name another release than the library beside it.
    def test_version__is_the_librarys(self):
        parts = [define(header("client/lib/pccd.h"), "PCCD_VERSION_" + part)
                 for part in ("MAJOR", "MINOR", "PATCH")]
        self.assertEqual(pccd.__version__, ".".join(map(str, parts)))

    # If this failed, a time, a counter or a field of an answer would be 0 for ever.
    def test_answers__have_fields_of_the_manifest(self):
        with open(f"{ROOT}/proto/messages.def", encoding="utf-8") as file:
            text = re.search(r"#define PROTO_FRAME_ANSWER\(F\)(.*?)\n\n", file.read(),
                             re.S).group(1)
        fields = set(re.findall(r"F\(\w+, (\w+),", text))
        read = {"ns_" + name for name in pccd.StepTimes._fields}
        read |= set(pccd.StepCounters._fields)
        read |= {name for name in vars(pccd.Answer(1, pccd.Result()))
                 if not name.startswith("_")} - {"error", "records"}
        read |= {"hash_hi", "hash_lo", "record_bytes", "offset", "release"}
        self.assertEqual(read - fields, set())

    # If this failed, the client would need more than Debian's python3-msgpack and -numpy.
    def test_imports__are_the_standard_library_msgpack_and_numpy(self):
        folder = f"{ROOT}/client/python"
        paths = [f"{at}/{name}" for at, _, names in os.walk(folder) for name in names
                 if name.endswith(".py")]
        allowed = sys.stdlib_module_names | {"msgpack", "numpy", "pccd", "_pccd", ""}
        allowed = allowed - {"ctypes"}  # nor anything compiled of ours
        self.assertGreater(len(paths), 10)
        for path in paths:
            with open(path, encoding="utf-8") as file:
                names = re.findall(r"^ *(?:import|from) (\w*)", file.read(), re.M)
            self.assertEqual(set(names) - allowed, set(), path)

    # If this failed, a step that is watched, or a histogram, would lack a field.
    def test_events_and_histograms__have_every_field_of_the_manifest(self):
        with open(f"{ROOT}/proto/messages.def", encoding="utf-8") as file:
            text = file.read()
        step = re.search(r"#define PROTO_STEP_REQUEST\(F\)(.*?)\n\n", text, re.S).group(1)
        fields = set(re.findall(r"F\(\w+, (\w+),", step)) - {"hash_hi", "hash_lo", "code"}
        self.assertEqual(fields | {"hash", "status"}, set(pccd.StepEvent._fields))
        buckets = re.findall(r"F\(u64, b(\d+), REQ", text)
        self.assertEqual(int(buckets[0]), observe.BUCKET_FIRST)
        self.assertEqual(len(buckets) + 1, wire.HISTOGRAM_BUCKETS)


if __name__ == "__main__":
    unittest.main()
