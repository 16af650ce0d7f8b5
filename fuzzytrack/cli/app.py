"""The application: all commands in one place."""

from __future__ import annotations

from typing import Annotated

import typer

from fuzzytrack import __version__
from fuzzytrack.cli.certifying import certify
from fuzzytrack.cli.comparing import compare
from fuzzytrack.cli.demonstration import demo
from fuzzytrack.cli.errors import Commands
from fuzzytrack.cli.experimenting import experiment
from fuzzytrack.cli.gains import design, gains
from fuzzytrack.cli.listing import trackers
from fuzzytrack.cli.output import say
from fuzzytrack.cli.reproducing import reproduce
from fuzzytrack.cli.rulebases import rulebase
from fuzzytrack.cli.simulating import simulate
from fuzzytrack.cli.surface import surface
from fuzzytrack.cli.tracking import track

__all__ = ["app"]

app = typer.Typer(
    name="fuzzytrack",
    cls=Commands,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)

app.command()(demo)
app.command()(track)
app.command()(compare)
app.command("testbed")(experiment)
app.command()(simulate)
app.command()(surface)
app.add_typer(rulebase, name="rulebase")
app.command()(certify)
app.command()(gains)
app.add_typer(design, name="design")
app.command()(trackers)
app.command()(reproduce)


def _version(wanted: bool) -> None:
    if wanted:
        say(f"fuzzytrack {__version__}")
        raise typer.Exit


@app.callback()
def fuzzytrack(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Fuzzy-logic gain scheduling for alpha-beta trackers.

    Start with `fuzzytrack demo`. Every command has --help.
    """
