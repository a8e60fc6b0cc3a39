"""check_contacts.py - contacts as HDF5 and Parquet, read back.

Room:     tests/python.
Does:     compare the columns of python3 -m pccd check --contacts with pccdctl's CSV of
          the same frames; what needs a module that is not there is skipped by its
          name, and that there is a clear error then is tried anyway. Parquet is read
          by what parquet.thrift says of it, and by pyarrow where that is.
"""

import csv
import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np

FLOOR = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
POST = [(.25, .25, 1), (.25, .25, 4), (.375, .25, 4)]
WHOLE = ("i0", "i1", "i2", "i3", "proved")
HIDDEN = """import importlib, runpy, sys
real = importlib.import_module
def without(name, *rest):
    if name == 'h5py':
        raise ImportError(name)
    return real(name, *rest)
importlib.import_module = without
sys.argv[0] = 'pccd'
runpy.run_module('pccd', run_name='__main__')"""


def is_here(name):
    return importlib.util.find_spec(name) is not None


class Thrift:
    """Structs of the compact protocol: what they have by the numbers of their fields."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        self.at += count
        return self.data[self.at - count:self.at]

    def varint(self):
        value, shift = 0, 0
        while True:
            byte = self.take(1)[0]
            value, shift = value | (byte & 127) << shift, shift + 7
            if byte < 128:
                return value

    def value(self, kind):
        if kind in (5, 6):  # i32, i64
            number = self.varint()
            return number >> 1 ^ -(number & 1)
        if kind == 8:
            return self.take(self.varint())
        if kind == 9:
            head = self.take(1)[0]
            count = self.varint() if head >> 4 == 15 else head >> 4
            return [self.value(head & 15) for _ in range(count)]
        assert kind == 12, kind
        made, field = {}, 0
        while (head := self.take(1)[0]) != 0:
            field += head >> 4
            made[field] = self.value(head & 15)
        return made


def read_parquet(path):
    """The columns of required values in plain pages, each a chunk in every row group."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:4] == data[-4:] == b"PAR1"
    size = int.from_bytes(data[-8:-4], "little")
    end = Thrift(data[-8 - size:-8]).value(12)
    schema = end[2][1:]
    assert end[2][0][5] == len(schema) and all(element[3] == 0 for element in schema)
    columns = {element[4].decode(): [] for element in schema}
    for group in end[4]:
        assert len(group[1]) == len(schema)
        for element, chunk in zip(schema, group[1]):
            told = chunk[3]
            page = Thrift(data[told[9]:told[9] + told[7]])
            head = page.value(12)
            assert head[1] == 0 and head[5][2] == 0 and told[4] == 0 and told[2] == [0]
            assert told[3] == [element[4]] and told[1] == element[1]
            assert head[2] == head[3] == len(page.data) - page.at
            assert head[5][1] == told[5] == group[3]
            if element[1] == 6:
                values = [page.take(int.from_bytes(page.take(4), "little")).decode()
                          for _ in range(told[5])]
                assert element[6] == 0 and page.at == len(page.data)
            else:
                values = np.frombuffer(page.data[page.at:],
                                       {2: "<i8", 5: "<f8"}[element[1]]).tolist()
            columns[element[4].decode()] += values
    assert {len(values) for values in columns.values()} == {end[3]}
    return columns


class Contacts(unittest.TestCase):
    def setUp(self):
        made = tempfile.TemporaryDirectory()
        self.addCleanup(made.cleanup)
        self.folder = made.name
        for number, drop in enumerate((0, 2, 0, 1)):
            with open(os.path.join(made.name, f"f{number}.obj"), "w",
                      encoding="utf-8", errors="surrogateescape") as to:
                moved = [(x, y, z - drop) for x, y, z in POST]
                to.write("o fl\N{LATIN SMALL LETTER O WITH DIAERESIS}r\n")
                to.writelines("v %g %g %g\n" % point for point in FLOOR)
                to.write("f 1 2 3\no post\udcff\n")  # a byte that is no text
                to.writelines("v %g %g %g\n" % point for point in moved)
                to.write("f 4 5 6\n")

    def run_it(self, status, *words):
        done = subprocess.run(words, cwd=self.folder, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, timeout=100, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done

    def check(self, status, *words):
        return self.run_it(status, sys.executable, "-m", "pccd", "check", "--private",
                           *words)

    def table(self, *files):
        """The columns of pccdctl's CSV."""
        self.run_it(1, os.environ["PCCDCTL"], "check", "--private", "--geometry",
                    "--contacts", "true.csv", *files)
        with open(os.path.join(self.folder, "true.csv"), newline="",
                  encoding="utf-8", errors="backslashreplace") as rows:
            rows = list(csv.DictReader(rows))
        return {name: [row[name] for row in rows] for name in rows[0]}

    def compare(self, true, columns, count):
        """The columns that were read back, as lists; to the last bit."""
        self.assertEqual(set(columns), set(true) | {"step"})
        self.assertEqual({len(values) for values in columns.values()}, {count})
        for name, values in true.items():
            want = [int(v or -1) if name in WHOLE or name == "step" else
                    v if name in ("kind", "object_a", "object_b") else float(v)
                    for v in values]
            self.assertEqual(columns[name], want, name)

    def read(self, name):
        path = os.path.join(self.folder, name)
        if name.endswith(".parquet"):
            return read_parquet(path)
        h5py = importlib.import_module("h5py")
        with h5py.File(path, "r") as file:
            return {name: [v.decode() for v in data[:]] if data.dtype == object
                    else data[:].tolist() for name, data in file["contacts"].items()}

    def round_trip(self, name):
        true = self.table("f0.obj", "f1.obj", "f2.obj")
        said = self.check(1, "--contacts", name, "f0.obj", "f1.obj", "f2.obj").stdout
        self.assertIn("f2.obj: 1 (1 vf", said)
        columns = self.read(name)
        self.compare(true, columns, 2)
        self.assertEqual(columns["step"], [1, 2])
        self.assertEqual(columns["object_b"], ["fl\u00f6r"] * 2)
        self.assertEqual(columns["object_a"], ["post\\xff"] * 2)
        self.assertEqual([columns["b" + axis][0] for axis in "xyz"], [.25, .25, 0])
        self.assertEqual([columns["n" + axis][1] for axis in "xyz"], [0, 0, -1])
        # What touches at t = 0 leaves: a column that not each table has.
        self.check(1, "--touching", "told", "--contacts", name, "f3.obj", "f0.obj")
        self.assertEqual(set(self.read(name)), set(columns) | {"touching"})
        self.assertEqual(set(self.read(name)["touching"]), {"leaves"})
        # Of one step there is its number, too; of none there are the columns.
        self.check(1, f"--contacts={name}", "f0.obj", "f1.obj")
        self.assertEqual(self.read(name)["step"], [1])
        self.check(0, "--contacts", name, "f0.obj", "f0.obj")
        self.assertEqual({len(values) for values in self.read(name).values()}, {0})
        self.assertEqual([at for at in os.listdir(self.folder) if ".part" in at], [])

    @unittest.skipUnless(is_here("h5py"), "no h5py (Debian: python3-h5py)")
    # If it failed, numbers would not be those of the CSV, or names would be spoilt.
    def test_hdf5__has_what_the_csv_has(self):
        self.round_trip("hits.h5")

    # If it failed, numbers would not be those of the CSV, or names would be spoilt.
    def test_parquet__has_what_the_csv_has(self):
        self.round_trip("hits.parquet")

    @unittest.skipUnless(is_here("pyarrow"), "no pyarrow")
    # If it failed, the library that most have would read something else.
    def test_parquet__is_read_by_pyarrow(self):
        self.check(1, "--contacts", "hits.parquet", "f0.obj", "f1.obj", "f2.obj")
        path = os.path.join(self.folder, "hits.parquet")
        columns = importlib.import_module("pyarrow.parquet").read_table(path).to_pydict()
        self.assertEqual(columns, read_parquet(path))

    # If it failed, hours of work would end in a traceback, or without a file.
    def test_module__that_is_missing_is_named_before_the_work(self):
        done = self.run_it(4, sys.executable, "-c", HIDDEN, "check", "--contacts",
                           "hits.h5", "nowhere.obj", "f1.obj")
        self.assertIn("pccd: hits.h5: this needs the Python module h5py (Debian: "
                      "python3-h5py)", done.stderr)

    @unittest.skipUnless(is_here("h5py"), "no h5py (Debian: python3-h5py)")
    # If it failed, a folder that is not there would be found by a traceback.
    def test_folder__that_is_missing_is_told(self):
        done = self.check(4, "--contacts", "nowhere/hits.h5", "f0.obj", "f1.obj")
        self.assertIn("pccd: nowhere/hits.h5: cannot write", done.stderr)
