"""The page of all settings of scenes: ``docs/scene-settings.md``, made from the settings.

Sphinx makes it before it reads the pages; run as a script with the name of a folder, this file
writes it there.
"""

import sys
from pathlib import Path

HEAD = """\
# All settings of scenes

You find every key of a scene of many targets, with its unit, what it may be, and what it is unless
given. {doc}`scenes` explains the format. Where two numbers may stand, the least and the largest,
one number stands for both. This page is generated from the program when the documentation is built.
"""


def table(part):
    """Settings of a part as a table."""
    from fuzzytrack.simulation.scene.schema import setting_rows

    lines = ["| Key | Is | Value | Default |", "|---|---|---|---|"]
    for name, meaning, allowed, default in setting_rows(part):
        lines.append(f"| `{name}` | {meaning} | {allowed} | {default} |")
    return "\n".join(lines)


def sections():
    """Heading and text of each part."""
    from fuzzytrack.simulation.scene import CLUTTER, OwnShip, Radar, Region, ScanTimes, TargetGroup

    yield "scans", "When the radar scans.", ScanTimes
    yield "radar", "What the radar sees.", Radar
    yield "own", "Where the radar is.", OwnShip
    yield "region, within", "A region: one of the first four keys, and what belongs to it.", Region
    yield "traffic", "Each group of targets, under its name.", TargetGroup
    for name, part in CLUTTER.items():
        summary = f"{part.summary[0].upper()}{part.summary[1:]}."
        yield f"clutter, kind: {name}", summary, part


def page():
    """The page."""
    parts = [f"## {title}\n\n{text}\n\n{table(part)}\n" for title, text, part in sections()]
    return "\n".join([HEAD, *parts])


def write(folder):
    """Write ``scene-settings.md``."""
    (Path(folder) / "scene-settings.md").write_text(page(), encoding="utf-8")


def setup(app):
    """Write the page when Sphinx begins."""
    write(app.srcdir)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


if __name__ == "__main__":
    write(sys.argv[1])
