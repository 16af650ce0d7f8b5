"""Command line: ``python -m benchmarks``."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from benchmarks import pictures
from benchmarks.report import markdown, show
from benchmarks.run import measure, plain
from benchmarks.scale import FULL, QUICK
from benchmarks.work import ROOT


def machine_text(figures: dict[str, Any]) -> str:
    """The machine in a sentence or two."""
    machine = figures["machine"]
    caches = ", ".join(f"{level} {size}" for level, size in machine["caches"].items())
    triad = ", ".join(
        f"{n} thread{'s' * (n != '1')} {speed['median']:.3g} GB/s (best {speed['best']:.3g})"
        for n, speed in figures["bandwidth"].items()
    )
    versions = ", ".join(f"{name} {version}" for name, version in machine["versions"].items())
    load = machine.get("load_average")
    busy = "" if load is None else (
        f" Load before and after: {load:.1f} and {machine['load_average_after']:.1f}."
    )  # fmt: skip
    return (
        f"{machine['processor']}, {machine['cores']} cores ({caches}), "
        f"{machine['memory_gb']} GB; {machine['system']}, Python {machine['python']}, {versions}. "
        f"Triad: {triad}.{busy}"
    )


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="smaller jobs, a minute or two")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all figures")
    parser.add_argument("--pictures", type=Path, metavar="FOLDER", help="draw the curves")
    parser.add_argument(
        "--docs", action="store_true", help="write tables and pictures into the documentation"
    )
    given = parser.parse_args(arguments)
    figures = measure(QUICK if given.quick else FULL, lambda text: print(text, file=sys.stderr))
    show(figures["rows"])
    described = machine_text(figures)
    print(described)
    print(f"{figures['scale']} run, {figures['seconds']:.0f} s")
    if given.json:
        given.json.write_text(json.dumps(plain(figures), indent=2) + "\n")
    folder = given.pictures
    if given.docs:
        folder = ROOT / "docs" / "images"
        text = f"*Measured on:* {described}\n\n{markdown(figures['rows'])}"
        (ROOT / "docs" / "speed-tables.txt").write_text(text)
    if folder:
        folder.mkdir(parents=True, exist_ok=True)
        pictures.draw(figures, folder)
    return int(any(row.broken for row in figures["rows"]))


if __name__ == "__main__":
    sys.exit(main())
