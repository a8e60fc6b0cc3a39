"""report.py - what a check has found, as text and as JSON.

Room:     client/blender. Needs no Blender.
Does:     a line for each finding; an object whose keys are those of `pccdctl check
          --json` where they mean the same.
"""

from .check import KINDS
from .library import pccd
from .shape import frame_text, plural


def finding_text(finding):
    """"frame 12 -> 13: 4 contacts of Cloth and Ball, the first at t = 0.25"."""
    if finding.kind == "contact":
        where = f"frame {frame_text(finding.frame)} -> {frame_text(finding.to)}"
        when = f", the first at t = {finding.time:.6g}"
    else:
        where, when = f"frame {frame_text(finding.frame)}", ""
    what = {"crossing": plural(finding.count, "crossing"),
            "touch": plural(finding.count, "touch", "touches"),
            "near": plural(finding.count, "pair") + " within the thickness",
            "contact": plural(finding.count, "contact")}[finding.kind]
    who = " and ".join(finding.objects) if len(finding.objects) > 1 else \
        f"{finding.objects[0]} and itself"
    return f"{where}: {what} of {who}{when}"


def summary_text(check):
    """The last line."""
    frames = plural(check.done, "frame" if check.settings.steps == 1 else "moment")
    text = f"{frames} of {check.total} looked at: " if check.done < check.total else \
        f"{frames} looked at: "
    if not check.findings:
        text += "nothing crosses or meets"
    else:
        first = check.findings[0]
        text += f"{plural(len(check.findings), 'finding')}, the first at frame " + \
            frame_text(first.frame)
    if any(step["crowded"] for step in check.steps):
        text += "; most pairs are within the thickness: is it above the length of the " \
            "edges? See rings and rest exclusion"
    if check.is_cancelled:
        text += " (cancelled)"
    elif check.done == check.total and not check.is_complete:
        text += "; NOT COMPLETE: there was more than an answer holds"
    return text


def report(check, path, unit):
    """What --json prints. unit: metres of one of Blender's units."""
    made = {"file": path, "unit_metres": unit,
            "frames": f"{check.settings.first}:{check.settings.last}",
            "steps_per_frame": check.settings.steps,
            "thickness": check.settings.radius,
            "rest_exclusion": check.settings.rest_distance,
            "rings": check.settings.rest_rings,
            "objects": [], "cancelled": check.is_cancelled,
            "complete": check.is_complete}
    for name, info in check.meshes:
        made["objects"].append({"name": name, "vertices": info.vertex_count,
                                "edges": info.edge_count,
                                "triangles": info.triangle_count,
                                "degenerate_triangles": info.degenerate_count})
    for key in ("vertices", "edges", "triangles"):
        made[key] = sum(one[key] for one in made["objects"])
    made["crossings"] = sum(one["crossings"] for one in check.frames)
    made["near"] = sum(one["near"] for one in check.frames)
    for key in ["contacts", "possible"] + [kind.name.lower() for kind in pccd.Kind]:
        made[key] = sum(step[key] for step in check.steps)
    made["moments"], made["steps"] = check.frames, check.steps
    made["findings"] = [
        {"frame": one.frame, "to": one.to, "kind": one.kind,
         "meaning": KINDS[one.kind], "objects": list(one.objects), "count": one.count,
         "toi_first": one.time, "place": [float(x) for x in one.places[0]]}
        for one in check.findings]
    return made
