"""__main__.py - python3 -m pccd check FILES: pccdctl check of whatever meshio reads.

Room:     client/python. Needs the program pccdctl: the one that $PCCDCTL names, or else
          the one in the build folder that the module lies in, or in $PATH.
Does:     write what meshio has read into a temporary folder, as OBJ; have pccdctl check
          that, and what it reads itself as it is; print what it says, with the names that
          were given. So the report, the options and the exit status are pccdctl's.
Threads:  one for each of pccdctl's two outputs.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import traceback
from typing import IO, Dict, List, Optional, TextIO

from . import contacts, files

USAGE = """Usage: python3 -m pccd check [OPTION...] FILE [FILE...]
Find the contacts of a mesh that moves from file to file, as pccdctl check does, in
files of VTU, PVD, legacy VTK, Gmsh, XDMF and whatever else meshio reads. Solid cells
give their boundary. --contacts FILE.parquet, .h5 or .hdf5 writes contacts with their
geometry. Other options and the exit status are those of pccdctl check:
0 when nothing meets, 1 when something does, 2 after wrong usage, 3 without a daemon,
4 after any other error."""


def pccdctl() -> str:
    """The program; a Refusal without one."""
    here = os.path.dirname(os.path.abspath(__file__))
    beside = os.path.join(os.path.dirname(os.path.dirname(here)), "pccdctl")
    found = os.environ.get("PCCDCTL") or (
        beside if os.access(beside, os.X_OK) else shutil.which("pccdctl"))
    if not found:
        raise files.Refusal("no program pccdctl in $PATH: PCCDCTL names its file")
    return found


def with_values(program: str) -> List[str]:
    """The options of pccdctl check that have a value, by its help."""
    told = subprocess.run([program, "check", "--help"], stdout=subprocess.PIPE, text=True,
                          check=False).stdout
    return re.findall(r"(--[a-z][a-z0-9-]*)=", told)


class Run:
    """The arguments of pccdctl, and what its files are called by the user."""

    def __init__(self, folder: str, is_json: bool):
        self.folder = folder
        self.is_json = is_json
        self.names: Dict[str, str] = {}
        self.arguments: List[str] = []
        self.table: Optional[str] = None  # of contacts, which is not CSV
        # No name that is given has this in it.
        self.mark = os.path.basename(folder)

    def add(self, given: str) -> None:
        """A file; what pccdctl does not read is written as one that it does."""
        for path in files.expand(given):
            if files.is_native(path):
                self.arguments.append(path)
                continue
            number = str(len(self.names))
            # With the digits of its own name, by which pccdctl judges the order.
            made = os.path.join(self.folder, re.sub("[^A-Za-z0-9._-]", "_",
                                                    os.path.basename(path))
                                + f".{self.mark}.{number}.obj")
            files.Mesh(path).write(made)
            self.names[number] = path
            self.arguments.append(made)

    def option(self, word: str, value: Optional[str] = None) -> None:
        """An option, and its value if that is a word of its own."""
        name, _, own = word.partition("=")
        path = own if value is None else value
        if name == "--contacts" and contacts.is_named(path):
            contacts.need(path)
            self.table = path
            self.arguments += ["--geometry", "--contacts",
                               os.path.join(self.folder, "contacts.csv")]
        else:
            self.arguments += [word] if value is None else [word, value]

    def pass_on(self, source: IO[bytes], to: TextIO) -> None:
        """Lines, with the names that were given, whose bytes may be no text."""
        made = re.compile(os.fsencode(f"{re.escape(self.folder)}/[A-Za-z0-9._-]*?"
                                      rf"\.{re.escape(self.mark)}\.(\d+)\.obj"))

        def name(match: re.Match[bytes]) -> bytes:
            given = self.names[match[1].decode()]
            is_json = self.is_json and to is sys.stdout
            return os.fsencode(json.dumps(given)[1:-1] if is_json
                               else files.shown(given))
        for line in source:
            to.buffer.write(made.sub(name, line))
            to.buffer.flush()

    def run(self, program: str) -> int:
        """Its exit status."""
        with subprocess.Popen([program, "check", *self.arguments],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE) as child:
            assert child.stdout is not None and child.stderr is not None
            other = threading.Thread(target=self.pass_on, args=(child.stderr, sys.stderr))
            other.start()
            self.pass_on(child.stdout, sys.stdout)
            other.join()
        if self.table is not None and child.returncode in (0, 1):
            contacts.write(os.path.join(self.folder, "contacts.csv"), self.table)
        return child.returncode if child.returncode >= 0 else 4


def check(given: List[str]) -> int:
    """Check files; the exit status."""
    program = pccdctl()
    valued = with_values(program)
    with tempfile.TemporaryDirectory(prefix="pccd-check-") as folder:
        run = Run(folder, "--json" in given)
        words = iter(given)
        for word in words:
            if word in valued:
                run.option(word, next(words, None))
            elif word.startswith("-") and word != "-":
                run.option(word)
            else:
                run.add(word)
        return run.run(program)


def main(words: List[str]) -> int:
    """The program."""
    if words in (["--help"], ["-h"]):
        print(USAGE)
        return 0
    if words[:1] != ["check"]:
        print(USAGE, file=sys.stderr)
        return 2
    try:
        return check(words[1:])
    except files.Refusal as refusal:
        files.complain(f"pccd: {refusal}")
    except Exception:  # pylint: disable=broad-except
        traceback.print_exc()  # Python would end with 1, which says that something meets
    return 4


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
