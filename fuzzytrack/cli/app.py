"""The application: all commands in one place."""

from __future__ import annotations

from importlib import import_module
from typing import Annotated, Any

import typer
from typer.main import get_command

from fuzzytrack.cli.complaints import Command, Commands
from fuzzytrack.version import __version__

__all__ = ["app"]

# Module and function of each command, and its line in the list of commands. A module is imported
# when its command is called, so that a command loads only what it uses.
COMMANDS = {
    "demo": ("demo:demo", "Track a simulated turning target, and draw the results."),
    "sample": (
        "sample:sample",
        "Write a small simulated recording to try things with, or list them.",
    ),
    "track": (
        "track:track",
        "Track the plots of a file, or of several files in their order.",
    ),
    "scan": (
        "scan:scan",
        "Make tracks of plots without identities, scan by scan, as a radar gives them.",
    ),
    "compare": ("compare:compare", "Compare trackers on recorded plots, with or without truth."),
    "score": (
        "score:score",
        "Score tracks against true positions: OSPA, GOSPA, SIAP, CLEAR MOT, IDF1, HOTA and more.",
    ),
    "testbed": (
        "testbed:experiment",
        "Run trackers on many random draws of a scenario.",
    ),
    "tune": (
        "tune:tune",
        "Tune the numbers of a tracker, and judge it on tracks that it was not tuned on.",
    ),
    "studio": (
        "studio:studio",
        "Edit rule bases, draw surfaces and run experiments on a page in the browser.",
    ),
    "simulate": (
        "simulate:simulate",
        "Write the plots of a simulated target, or the scans of a scene of many targets.",
    ),
    "surface": ("surface:surface", "Draw the control surface of a rule base."),
    "certify": (
        "certify:certify",
        "Prove that the error shrinks for any order of gains, or show an order that makes it grow.",
    ),
    "gains": (
        "gains:gains",
        "Show properties of fixed gains: stability, poles, noise and lag.",
    ),
    "trackers": (
        "trackers:trackers",
        "List trackers, schedulers and normalizations with their sources, plug-ins included.",
    ),
    "reproduce": (
        "reproduce:reproduce",
        "Rebuild the experiments of a paper, and compare its numbers with ours.",
    ),
    "rulebase": (
        "rulebase:rulebase",
        "List, show, copy, check, explain, convert, edit and export rule bases.",
    ),
    "scanner": (
        "scanner:scanner",
        "List, show, check, copy and tune configurations of scan trackers; list their parts.",
    ),
    "design": ("design:design", "Compute gains by a design rule, and show their properties."),
    "completion": (
        "completion:completion",
        "Print the script with which a shell completes commands, options and names.",
    ),
    "cache": ("cache:cache", "Show where compiled code is kept and how much of it, or remove it."),
}


class Application(Commands):
    """The commands by name; the one that is called is imported in place of its placeholder."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Find the command that is called."""
        name, _, rest = super().resolve_command(ctx, args)
        return name, self.loaded(str(name)), rest

    def loaded(self, name: str) -> Any:
        """Import a command."""
        return load_command(name)


def load_command(name: str) -> Any:
    """Import a command, with its arguments and options."""
    module, _, attribute = COMMANDS[name][0].partition(":")
    found = getattr(import_module(f"fuzzytrack.cli.{module}"), attribute)
    if isinstance(found, typer.Typer):
        return get_command(found)
    alone = typer.Typer(add_completion=False, rich_markup_mode=None)
    alone.command(name, cls=Command)(found)
    return get_command(alone)


app = typer.Typer(
    name="fuzzytrack",
    cls=Application,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _line() -> None:
    """Placeholder of a command in the list."""


for _name, (_home, _help) in COMMANDS.items():
    app.command(_name, help=_help)(_line)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"fuzzytrack {__version__}")
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
