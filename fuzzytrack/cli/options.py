"""Options that several commands share, and how lists and pairs are written."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Literal

import typer

from fuzzytrack.numerals import as_number
from fuzzytrack.plugins.scripts import load_script
from fuzzytrack.yamltree import suggestion

__all__ = [
    "LIVE",
    "Dt",
    "FeedWay",
    "Folder",
    "Force",
    "Gate",
    "Json",
    "Plots",
    "Plugins",
    "Scenario",
    "ScenarioOrNone",
    "Seed",
    "Sigma",
    "StateFile",
    "lags",
    "load_plugins",
    "names",
    "numbers_at",
    "pairs",
]

#: Heading of options of live feeds in the help.
LIVE = "Live feeds"

Plots = Annotated[str, typer.Argument(metavar="FILE", help="CSV (or Parquet) file.")]
Gate = Annotated[
    str,
    typer.Option(
        "--gate",
        metavar="K|auto|none",
        help="Do not use plots more than K sigma from their prediction. [auto: 20]",
    ),
]
Seed = Annotated[int, typer.Option(min=0, help="Seed of the noise.")]
_SCENARIO = typer.Argument(metavar="SCENARIO", help="Name of a shipped scenario, or FILE.yaml.")
Scenario = Annotated[str, _SCENARIO]
ScenarioOrNone = Annotated[str | None, _SCENARIO]
Dt = Annotated[float, typer.Option("--dt", metavar="T", help="Sampling time, s.")]
Sigma = Annotated[
    float | None,
    typer.Option("--sigma", metavar="S", help="Standard deviation of a measured position, m."),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")]
Folder = Annotated[
    str | None,
    typer.Option("--output", "-o", metavar="DIR", help="Folder for the results; made if need be."),
]
Force = Annotated[bool, typer.Option("--force", help="Replace the results that are in the folder.")]
Plugins = Annotated[
    list[str] | None,
    typer.Option(
        "--plugin", metavar="FILE.py", help="Load plug-ins from a script; may be repeated."
    ),
]
StateFile = Annotated[
    str | None,
    typer.Option(
        "--state",
        metavar="FILE",
        help="With --follow, save the state, and go on from it.",
        rich_help_panel=LIVE,
    ),
]
FeedWay = Annotated[
    str | None,
    typer.Option(
        "--feed",
        metavar="again|onward",
        help="From a state, lines come from the first one again, or go on. [default: again]",
        rich_help_panel=LIVE,
    ),
]


def load_plugins(files: Iterable[str] | None) -> None:
    """Load the scripts that follow ``--plugin``."""
    for file in files or ():
        load_script(file)


def names(text: str, option: str) -> list[str]:
    """Names with commas between them."""
    found = [name.strip() for name in text.split(",")]
    if not all(found):
        raise ValueError(f"{option}: a name is missing in {text!r}; write A,B,C")
    return found


def pairs(text: str, option: str) -> dict[str, str]:
    """Pairs ``name=value`` with commas between them."""
    found: dict[str, str] = {}
    for part in text.split(","):
        name, equals, value = (word.strip() for word in part.partition("="))
        if not (name and equals and value):
            raise ValueError(f"{option}: expected NAME=VALUE,NAME=VALUE, got {text!r}")
        if name in found:
            raise ValueError(f"{option}: {name!r} is given twice")
        found[name] = value
    return found


def numbers_at(text: str, wanted: Iterable[str], option: str = "--at") -> dict[str, float]:
    """Numbers for each of the wanted names, written as pairs."""
    wanted = tuple(wanted)
    found = pairs(text, option)
    numbers = {}
    for name, value in found.items():
        if name not in wanted:
            raise ValueError(f"{option}: no such input {name!r}{suggestion(name, wanted)}")
        number = as_number(value)
        if number is None:
            raise ValueError(f"{option}: {name} must be a finite number, got {value!r}")
        numbers[name] = number
    missing = [name for name in wanted if name not in numbers]
    if missing:
        raise ValueError(f"{option}: needs {', '.join(missing)} too; got {text!r}")
    return numbers


def lags(text: str) -> float | dict[str, float] | Literal["auto"] | None:
    """Lag of a clock (s), or that of each group, or that it is fitted: what follows ``--lag``."""
    if text == "none":
        return None
    if text == "auto":
        return "auto"
    given = pairs(text, "--lag") if "=" in text else {"": text}
    found = {name: as_number(value) for name, value in given.items()}
    numbers = {name: value for name, value in found.items() if value is not None}
    if len(numbers) < len(found):
        raise ValueError(f"--lag: expected seconds, GROUP=SECONDS,…, auto or none, got {text!r}")
    return numbers if "=" in text else numbers[""]
