"""The command `reproduce`: published experiments rebuilt, with published and own numbers."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path
from typing import Annotated, Any

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.output import (
    RESULTS,
    output_folder,
    print_json,
    print_table,
    progress,
    say,
    show,
    with_error,
    write_json,
)
from fuzzytrack.cli.pictures import save_picture
from fuzzytrack.papers.catalog import PAPERS, reproduce_all
from fuzzytrack.papers.reproduction import Reproduction
from fuzzytrack.yamltree import suggestion

__all__ = ["reproduce"]


def reproduce(
    paper: Annotated[str, typer.Argument(metavar="PAPER", help=f"{', '.join(PAPERS)}, or all.")],
    runs: Annotated[
        int | None,
        typer.Option(min=1, help="Monte Carlo runs. [default: each paper's own]"),
    ] = None,
    seed: options.Seed = 0,
    output: options.Folder = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Rebuild the experiments of a paper, and compare its numbers with ours.

    A number matches if the difference is within rounding, or within the Monte Carlo error of both.
    """
    chosen = list(PAPERS) if paper == "all" else [paper]
    if chosen[0] not in PAPERS:
        raise ValueError(f"no such paper {paper!r}{suggestion(paper, [*PAPERS, 'all'])}")
    folder = None if output is None else output_folder(output, force=force)
    with progress(f"rebuilding {paper}") as watch:
        found = reproduce_all(chosen, runs, seed, watch)
    one = found[0].to_json_dict()
    results = one if paper != "all" else {"papers": [each.to_json_dict() for each in found]}
    written = [] if folder is None else _write(folder, found, results)
    if json:
        print_json(results)
        return
    for each in found:
        _print(each)
    for path in written:
        say(f"wrote {path}")


def _write(folder: Path, found: list[Reproduction], results: dict[str, Any]) -> list[Path]:
    written = [folder / RESULTS]
    write_json(written[0], results)
    drawings = [(each.paper, *item) for each in found for item in each.pictures.items()]
    with progress("drawing") as watch:
        for number, (paper, name, draw) in enumerate(drawings, 1):
            written.append(folder / f"{paper}-{name}.png")
            save_picture(written[-1], draw)
            watch(number / len(drawings))
    return written


def _print(found: Reproduction) -> None:
    reasons = list(dict.fromkeys(r.why for r in found.rows if r.why))
    rows: list[list[Any]] = [
        [
            r.table,
            r.quantity,
            "–" if r.published is None else show(r.published, 6),
            with_error(r.ours, math.nan if r.se is None else r.se),
            ("" if r.published is None else r.verdict)
            + (f" ({reasons.index(r.why) + 1})" if r.why else ""),
        ]
        for r in found.rows
    ]
    print_table(["", "", "published", "ours", "verdict"], rows, title=found.title, words=2)
    counts = Counter(r.verdict for r in found.rows)
    say(", ".join(f"{verdict}: {count}" for verdict, count in counts.items()))
    for number, why in enumerate(reasons, 1):
        say(f"({number}) {why}")
    for note in found.notes:
        say(f"* {note}")
    say()
