"""check_abi.py - what the build has made of pccd.h is what the C compiler makes of it.

Room:     tests/python. Needs CC, top_srcdir and top_builddir, set by make check.
Does:     a C program prints sizes, offsets and values of everything in pccd/abi.py; the
          way to the library, and what is said when there is none.
"""

import ctypes
import ctypes.util
import enum
import inspect
import os
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import pccd
from pccd import abi, observe

ROOT, BUILD = os.environ["top_srcdir"], os.environ["top_builddir"]
HEADERS = [f"proto/common/pccd_{name}.h" for name in ("types", "trace", "daemon")]
HEADERS.append("client/lib/pccd_batch.h")
STRUCTS = {name: item for name, item in vars(abi).items()
           if isinstance(item, type) and issubclass(item, ctypes.Structure)}
ENUMS = {name: item for name, item in vars(abi).items()
         if isinstance(item, type) and issubclass(item, (enum.IntEnum, enum.IntFlag)) and
         item.__module__ == "pccd.abi"}


def header(path):
    """A header without its comments."""
    with open(f"{ROOT}/{path}", encoding="utf-8") as file:
        return re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)


def compiled(lines):
    """What a C program with these lines prints, as a dictionary of numbers."""
    with tempfile.TemporaryDirectory() as folder:
        source = "\n".join(["#include <stddef.h>", "#include <stdio.h>",
                            '#include "pccd.h"', "int main(void) {", *lines, "}"])
        with open(f"{folder}/abi.c", "w", encoding="utf-8") as file:
            file.write(source)
        includes = [f"-iquote{ROOT}/{room}" for room in ("client/lib", "proto/common")]
        subprocess.run([*os.environ.get("CC", "cc").split(), "-std=c11", *includes, "-o",
                        f"{folder}/abi", f"{folder}/abi.c"], check=True)
        text = subprocess.run([f"{folder}/abi"], check=True, stdout=subprocess.PIPE,
                              encoding="ascii").stdout
    return {name: int(value) for name, value in map(str.split, text.splitlines())}


def sentence(name, expression):
    """A line of C that prints a number."""
    return f'printf("{name} %lld\\n", (long long)({expression}));'


class Abi(unittest.TestCase):
    """Against the compiler."""

    # If this failed, an answer would be read at other places than it was written to, or
    # the
    # library write beyond what Python gave it.
    def test_structs__lie_as_the_compiler_has_them(self):
        want, lines = {}, []
        for name, struct in STRUCTS.items():
            want[name] = ctypes.sizeof(struct)
            lines.append(sentence(name, f"sizeof(struct {name})"))
            for field, _ in struct._fields_:
                at = getattr(struct, field)
                want[f"{name}.{field}"] = at.offset << 32 | at.size
                lines.append(sentence(
                    f"{name}.{field}",
                    f"(long long)offsetof(struct {name}, {field}) << 32 | (long long)"
                    f"sizeof(((struct {name} *)0)->{field})"))
        self.assertGreater(len(STRUCTS), 20)
        self.assertEqual(compiled(lines), want)

    # If this failed, something that a C program can ask of its connection could not be
    # asked from Python.
    def test_options__are_keywords_of_connect(self):
        keywords = set(inspect.signature(pccd.connect).parameters)
        own = {"no_autostart": "autostart", "private_daemon": "private",
               "no_keep": "keep", "timeout_ms": "timeout", "reconnect_ms": "reconnect"}
        fields = {field for field, _ in abi.pccd_options._fields_}
        fields -= {"struct_bytes", "unmap", "unmap_context"}
        self.assertEqual({own.get(field, field) for field in fields}, keywords)

    # If this failed, a setting or an error would mean something else to the library.
    def test_enumerators__have_the_compilers_values(self):
        text = "".join(map(header, HEADERS))
        names = set(re.findall(r"^ *(PCCD_\w+) *=", text, re.M))
        names |= {"PCCD_" + name for name in re.findall(r"^ *X\((\w+),", text, re.M)}
        names = sorted(name for name in names if not name.endswith("_COUNT"))
        values = compiled([sentence(name, name) for name in names])
        told = {}
        for item in ENUMS.values():
            for key, member in item.__members__.items():
                told.setdefault(key, set()).add(int(member))
        for name, value in values.items():
            ends = [name.split("_", k)[-1] for k in range(1, name.count("_") + 1)]
            self.assertTrue(any(value in told.get(end, ()) for end in ends), name)
        self.assertEqual(len(values), sum(len(item.__members__)
                                          for item in ENUMS.values()))
        self.assertGreater(len(values), 70)

    # If this failed, a function would be called with arguments that it does not take, or
    # be
    # missing in Python.
    def test_functions__are_those_of_the_library(self):
        with open(f"{ROOT}/client/lib/libpccd.map", encoding="ascii") as file:
            names = re.findall(r"^ +(pccd_\w+);", file.read(), re.M)
        self.assertEqual(sorted(abi.PROTOTYPES), sorted(names))
        sources = ""
        for name in os.listdir(f"{ROOT}/client/python/module"):
            with open(f"{ROOT}/client/python/module/{name}", encoding="utf-8") as file:
                sources += file.read()
        unused = {name for name in names if not re.search(rf"\b{name}\b", sources)}
        # Others do the same: frame and wait; arrays; Python's own len; names of a
        # recording.
        self.assertEqual(unused, {
            "pccd_ask_near", "pccd_batch_contacts", "pccd_batch_pairs", "pccd_batch_step",
            "pccd_batch_submit", "pccd_frame_bytes", "pccd_mesh_create",
            "pccd_mesh_replace", "pccd_method_name", "pccd_step", "pccd_step_x0x1",
            "pccd_step_x1"})

    # If this failed, records would come out as other columns.
    def test_records__have_the_layout_of_the_structs(self):
        for dtype, struct in ((pccd.CONTACT, abi.pccd_contact),
                              (pccd.PAIR, abi.pccd_pair), (pccd.NEAR, abi.pccd_near),
                              (pccd.EDGE, abi.pccd_edge),
                              (pccd.SCENE, abi.pccd_scene_answer),
                              (pccd.JOINT, abi.pccd_joint),
                              (pccd.MANIFOLD, abi.pccd_manifold),
                              (pccd.BOX, abi.pccd_box), (pccd.TRACE_EVENT,
                              abi.pccd_trace_event)):
            self.assertEqual(dtype.itemsize, ctypes.sizeof(struct))
            for name, _ in struct._fields_:
                self.assertEqual(dtype.fields[name][1], getattr(struct, name).offset)
        self.assertEqual(pccd.CONTACT["normal"], np.dtype(("<f4", (3,))))

    # If this failed, a setting of a step could not be given from Python.
    def test_settings__are_all_of_the_struct(self):
        fields = {name for name, _ in abi.pccd_step_settings._fields_} - {
            "struct_bytes", "joints", "joint_count"}  # of Motions
        self.assertEqual({name for name in vars(pccd.StepSettings())
                          if not name.startswith("_")}, fields)
        with self.assertRaisesRegex(pccd.PccdError, "threads is -1"):
            pccd.StepSettings(threads=-1)

    # If this failed, a histogram would be drawn over other times.
    def test_buckets__begin_where_the_daemons_do(self):
        with open(f"{ROOT}/proto/messages.def", encoding="utf-8") as file:
            buckets = re.findall(r"F\(u64, b(\d+), REQ", file.read())
        self.assertEqual(int(buckets[0]), observe.BUCKET_FIRST)

    # If this failed, the module would need more than Debian's python3-numpy.
    def test_imports__are_the_standard_library_and_numpy(self):
        paths = [f"{ROOT}/client/python/module/{name}"
                 for name in os.listdir(f"{ROOT}/client/python/module")]
        allowed = sys.stdlib_module_names | {"numpy", "pccd", ""}
        self.assertGreater(len(paths), 5)
        for path in paths:
            with open(path, encoding="utf-8") as file:
                names = re.findall(r"^ *(?:import|from) (\w*)", file.read(), re.M)
            own = {"mpi4py"} if path.endswith("/mpi.py") else set()
            self.assertEqual(set(names) - allowed - own, set(), path)


class Library(unittest.TestCase):
    """How libpccd is found."""

    @staticmethod
    def import_with(library):
        """What `import pccd` says in another process."""
        done = subprocess.run([sys.executable, "-c", "import pccd"], check=False,
                              env={**os.environ, "PCCD_LIBRARY": library},
                              stderr=subprocess.PIPE, encoding="utf-8")
        return done.returncode, done.stderr

    # If this failed, nobody would know where a library is looked for.
    def test_library__that_is_not_there_is_named(self):
        code, text = self.import_with("/nowhere/libpccd.so.0")
        self.assertNotEqual(code, 0)
        self.assertIn("ImportError: pccd 0.1.0 needs libpccd 0.1.0", text)
        self.assertIn("/nowhere/libpccd.so.0: cannot open", text)
        self.assertEqual(self.import_with(f"{BUILD}/.libs/libpccd.so.0"), (0, ""))
        code, text = self.import_with(f"{ctypes.util.find_library('c')}")
        self.assertIn("undefined symbol: pccd_version", text)

    # If this failed, a library of another release would be called with structs that it
    # does
    # not know.
    def test_library__of_another_release_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(f"{folder}/other.c", "w", encoding="ascii") as file:
                file.write('const char *pccd_version(void) { return "9.9.9"; }\n')
            subprocess.run([*os.environ.get("CC", "cc").split(), "-shared", "-fPIC", "-o",
                            f"{folder}/other.so", f"{folder}/other.c"], check=True)
            code, text = self.import_with(f"{folder}/other.so")
        self.assertNotEqual(code, 0)
        self.assertIn("other.so: is libpccd 9.9.9", text)
        self.assertEqual(pccd.__version__, pccd.library.lib.pccd_version().decode())


if __name__ == "__main__":
    unittest.main()
