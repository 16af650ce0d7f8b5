"""The command that writes a rule base as source of another language."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.output import output_folder, print_json, progress, say, show
from fuzzytrack.plurals import counted

__all__ = ["LANGUAGES", "export"]

#: What a rule base can be written as.
LANGUAGES = ("c99",)


def export(
    name: Annotated[str, typer.Argument(metavar="RULEBASE", help="Shipped name, or file.")],
    to: Annotated[str, typer.Option(metavar="c99", help="The language.")],
    output: Annotated[
        str,
        typer.Option(
            "--output", "-o", metavar="DIR", help="Folder for the files; made if need be."
        ),
    ],
    number: Annotated[
        str,
        typer.Option(
            metavar="double|float|q15",
            help="Numbers of inputs and outputs; q15 are integers of 16 bits over the universes.",
        ),
    ] = "double",
    filter: Annotated[
        bool, typer.Option("--filter", help="Write the whole tracker, too; not with q15.")
    ] = False,
    axes: Annotated[
        int, typer.Option(min=1, max=12, metavar="N", help="Axes of space of the tracker.")
    ] = 2,
    table: Annotated[
        bool,
        typer.Option(
            "--table",
            help="Where no table at the break points of the sets is exact, write one on a finer "
            "grid, with a measured error, rather than formulas; with q15 always.",
        ),
    ] = False,
    nodes: Annotated[
        int | None,
        typer.Option(metavar="N", help="Nodes on each input of such a table. [default: by inputs]"),
    ] = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Write a rule base as a C99 header, with a program that checks it against fuzzytrack."""
    # Other commands about rule bases need none of it.
    from fuzzytrack.interop.c99 import export_c

    if to not in LANGUAGES:
        raise ValueError(f"--to: unknown language {to!r}; one of {', '.join(LANGUAGES)}")
    # A rule base that is refused leaves no empty folder.
    folder = output_folder(output, force=force, make=False)
    with progress("Measuring errors") as report:
        made = export_c(
            name,
            number=number,
            filter=filter,
            axes=axes,
            table=table,
            nodes=nodes,
            progress=report,
        )
    folder.mkdir(exist_ok=True)
    made.write(folder)
    written = [str(folder / file) for file in made.files]
    if json:
        print_json({**made.figures, "files": written})
        return
    for line in _summary(made.figures):
        say(line)
    for file in written:
        say(f"wrote {file}")


def _summary(figures: Mapping[str, Any]) -> list[str]:
    """What was written, a line for each fact."""
    from fuzzytrack.interop.c99.c_program import operations_in_words

    unit = " steps" if figures["number"] == "q15" else ""
    nodes = " x ".join(map(str, figures["nodes"]))
    lines = [f"method      {figures['method']}{f', {nodes} nodes' if nodes else ''}"]
    for name, error in figures["errors"].items():
        ulps = f", {counted(error['ulps'], 'ulp')}" if "ulps" in error else ""
        lines.append(
            f"error       {name}: {show(error['largest'], 3)}{unit} at most{ulps}; "
            f"bound {show(error['bound'], 3)}{unit}"
        )
    stack = "" if figures["ram_bytes"] is None else f", stack {figures['ram_bytes']} bytes"
    moving = figures.get("filter")
    if moving:
        met = moving["errors_met"]
        errors = met or moving["errors_allowed"]
        words = ", ".join(f"{word} {show(e, 2)}" for word, e in errors.items())
        how = "met in a trial, which is no bound" if met else "at most"
        lines.append(
            f"filter      {moving['ram_bytes_per_track']} bytes a track; error {words}: {how}"
        )
    return [
        *lines,
        f"memory      ROM {figures['rom_bytes']} bytes and the code{stack}",
        f"operations  {operations_in_words(figures['operations'])} at most",
    ]
