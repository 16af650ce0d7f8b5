"""The command that draws control surfaces."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import typer

from fuzzytrack.arrays import Array
from fuzzytrack.cli import options
from fuzzytrack.cli.output import print_table, say, show
from fuzzytrack.cli.pictures import check_picture, save_picture, surfaces
from fuzzytrack.fuzzy.loading import load_rulebase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.plurals import counted
from fuzzytrack.schedulers.review import grid_table

__all__ = ["surface"]

MAX_POINTS = 1001


def surface(
    rulebase: Annotated[str, typer.Argument(metavar="RULEBASE", help="Shipped name, or file.")],
    output: Annotated[
        str | None,
        typer.Option("--output", "-o", metavar="FILE.png", help="Draw it (or .pdf, .svg…)."),
    ] = None,
    csv: Annotated[
        str | None, typer.Option(metavar="FILE.csv", help="Write it, one row for each grid point.")
    ] = None,
    contour: Annotated[
        bool, typer.Option("--contour", help="Draw a contour map, not a surface in perspective.")
    ] = False,
    points: Annotated[
        int,
        typer.Option(
            min=2, max=MAX_POINTS, help="Points on each axis; corners of the sets are added."
        ),
    ] = 101,
    even: Annotated[
        bool, typer.Option("--even", help="Write --csv without the corners of the sets.")
    ] = False,
    method: Annotated[str, typer.Option(metavar="M", help="exact, relation or table.")] = "exact",
    at: Annotated[
        str | None,
        typer.Option(metavar="NAME=VALUE", help="Values of inputs after the second."),
    ] = None,
) -> None:
    """Draw the control surface of a rule base.

    All outputs; α and β as well, where the outputs are stiffness, or stiffness and damping.
    """
    system = FuzzySystem(load_rulebase(rulebase), method)
    others = system.rules.input_names[2:]
    if bool(others) != (at is not None):
        example = ",".join(f"{name}=..." for name in others)
        what = f"give the others a value with --at {example}" if others else "--at has no use"
        raise ValueError(f"{rulebase} has {counted(len(system.rules.inputs), 'input')}; {what}")
    fixed = {} if at is None else options.numbers_at(at, others)
    if output is not None:
        check_picture(output)
    if contour and (output is None or len(system.rules.inputs) == 1):
        needs = "-o FILE, the picture" if output is None else "two inputs; one gives a curve"
        raise ValueError(f"--contour needs {needs}")
    if even and csv is None:
        raise ValueError("--even needs --csv FILE, the table that it is about")
    table = _written(system, points, fixed, csv, corners=not even)
    if output is not None:
        style = "contour" if contour else "surface"
        save_picture(output, lambda: surfaces(system, points, fixed or None, style=style))
    _print_ranges(system, table)
    for written in filter(None, (output, csv)):
        say(f"wrote {written}")


def _written(
    system: FuzzySystem, points: int, fixed: dict[str, float], csv: str | None, *, corners: bool
) -> dict[str, Array]:
    """Table over the grid; written, if there is a file for it."""
    if csv is None:
        return grid_table(system, points, fixed, corners=corners)
    from fuzzytrack.io.formats import check_table, write_table

    check_table(csv)
    table = grid_table(system, points, fixed, corners=corners)
    write_table(csv, table)
    return table


def _print_ranges(system: FuzzySystem, table: dict[str, Array]) -> None:
    rows = []
    for name, values in table.items():
        if name in system.rules.input_names:
            continue
        known = values[~np.isnan(values)]
        ends = (known.min(), known.max()) if known.size else (np.nan, np.nan)
        rows.append([name, *map(show, ends)])
    print_table(["output", "least", "largest"], rows)
