"""command.py - "bake check": the add-on without a window.

Room:     client/blender. Needs Blender.
Does:     read the arguments behind "--", check the file that is open, print a line for
          each finding or an object of JSON, and end Blender with an exit status:
          0 nothing crosses or meets, 1 something does, 2 an argument is wrong, 4 it could
          not be checked (also: not to its end).
Threads:  one; SIGINT ends the check after the frame at hand.
"""

import argparse
import json
import os
import signal
import sys
import traceback

import bpy

from .shape import Refusal

DONE, FOUND, USAGE, FAILED = 0, 1, 2, 4  # as pccdctl's (client/ctl/ctl.h)


def parser():
    made = argparse.ArgumentParser(
        prog="bake check", description="Check the file that Blender has open. Exit "
        "status: 0 nothing crosses or meets, 1 something does, 2 an argument is wrong, 4 "
        "it could not be checked.")
    made.add_argument("--frames", metavar="A:B", help="from frame A to frame B (default: "
                      "those of the scene)")
    made.add_argument("--objects", metavar="NAME,...", action="append", default=[],
                      help="objects to check; may be given several times (default: every "
                      "mesh that is shown)")
    made.add_argument("--thickness", metavar="R", type=float, default=0.0,
                      help="radius of every feature in Blender's units: two of radius R "
                      "meet when they are 2 R apart (default: 0)")
    made.add_argument("--rest-exclusion", metavar="D", type=float, default=0.0,
                      help="pairs of one object that are nearer than D in the first "
                      "frame have no thickness (default: 0)")
    made.add_argument("--rings", metavar="N", type=int, default=0,
                      help="nor have those that N edges or fewer join, 0 to 8 (default: "
                      "0)")
    made.add_argument("--steps", metavar="N", type=int, default=1,
                      help="cut the way between two frames into N straight pieces "
                      "(default: 1)")
    made.add_argument("--no-self", action="store_true",
                      help="do not test an object against itself")
    made.add_argument("--json", action="store_true", help="one JSON object instead of "
                      "text")
    made.add_argument("-o", "--output", metavar="FILE", help="write text or JSON there "
                      "(Blender prints lines of its own to the standard output)")
    made.add_argument("--save", metavar="FILE.blend", help="save a copy of the file with "
                      "markers at what was found")
    made.add_argument("--marker-size", metavar="S", type=float, default=0.0,
                      help="how far a marker reaches (default: it depends on the places)")
    return made


def frames_of(text, scene):
    """(first, last); ValueError."""
    if text is None:
        return scene.frame_start, scene.frame_end
    first, colon, last = text.partition(":")
    return int(first), int(last if colon else first)


def start(options):
    """The Check that the options ask for, and its source; Refusal."""
    from . import check, extract  # these need the library, which may be missing
    scene, view_layer = bpy.context.scene, bpy.context.view_layer
    try:
        first, last = frames_of(options.frames, scene)
    except ValueError:
        raise UsageError(f"--frames {options.frames}: not A:B") from None
    try:
        settings = check.Settings(first, last, options.thickness, options.rest_exclusion,
                                  options.rings, options.steps, not options.no_self)
    except Refusal as problem:
        raise UsageError(str(problem)) from None
    names = [name for text in options.objects for name in text.split(",") if name]
    source = extract.Source(scene, view_layer, extract.objects_named(view_layer, names))
    return check.Check(settings, source), source


class UsageError(Refusal):
    """An argument is wrong."""


def write(text, path):
    """To a file, or to the standard output."""
    if path is None:
        print(text, flush=True)
        return
    with open(path, "w", encoding="utf-8") as file:
        file.write(text + "\n")


def bake_check(options):
    """The exit status."""
    checking, source = start(options)
    signal.signal(signal.SIGINT, lambda *_: checking.cancel())
    try:
        while checking.tick():
            pass
    finally:
        checking.close()
        source.restore()
    from . import report
    if options.json:
        made = report.report(checking, bpy.data.filepath,
                             bpy.context.scene.unit_settings.scale_length)
        write(json.dumps(made), options.output)
    else:
        lines = [report.finding_text(one) for one in checking.findings]
        write("\n".join(lines + [report.summary_text(checking)]), options.output)
    if options.save:
        from . import markers
        markers.make(bpy.context.scene, checking.findings, options.marker_size)
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(options.save), copy=True)
    return FAILED if not checking.is_complete else FOUND if checking.findings else DONE


def main():
    """Ends Blender."""
    arguments = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    try:
        status = bake_check(parser().parse_args(arguments))
    except UsageError as problem:
        print(f"bake check: {problem}", file=sys.stderr)
        status = USAGE
    except (Refusal, OSError, MemoryError, ImportError) as problem:
        print(f"bake check: {problem}", file=sys.stderr)
        status = FAILED
    except Exception:  # Blender would end with 0
        traceback.print_exc()
        status = FAILED
    sys.stdout.flush()
    sys.exit(status)
