"""Output of the commands: tables for people, JSON for programs, progress on stderr."""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import typer

from fuzzytrack.cli.text_table import table_lines, wrapped
from fuzzytrack.errors import DataError
from fuzzytrack.json_types import plain
from fuzzytrack.tasks import Progress

__all__ = [
    "RESULTS",
    "output_folder",
    "paragraph",
    "print_json",
    "print_table",
    "progress",
    "say",
    "say_aside",
    "say_notes",
    "show",
    "with_error",
    "write_json",
]

#: File in a folder of results: what `--json` prints.
RESULTS = "results.json"

_ARGUMENT = re.compile(r"`(\w+)`")


def say(text: str = "") -> None:
    """Print a line without wrapping it."""
    typer.echo(text)


def say_aside(text: str) -> None:
    """Print a line on standard error, which is no part of the result.

    Names of arguments in backquotes are written as options.
    """
    typer.echo(_ARGUMENT.sub(lambda found: f"--{found[1].replace('_', '-')}", text), err=True)


def say_notes(notes: Iterable[str]) -> None:
    """Print what was guessed, left out or put right, a line each, on standard error."""
    for note in notes:
        say_aside(f"note: {note}")


def paragraph(text: str) -> None:
    """Print text in lines as wide as the terminal, of at most 80 characters."""
    for line in wrapped(text, min(80, _terminal_width())):
        say(line)


def show(number: float, digits: int = 4) -> str:
    """Format a number for a table; a dash for NaN."""
    if not math.isfinite(number):
        return "–" if math.isnan(number) else str(number)
    text = f"{number:.{digits}g}"
    # Write plain digits rather than a power of ten where they are short.
    return f"{number:.0f}" if "e+" in text and abs(number) < 1e9 else text


def with_error(value: float, error: float) -> str:
    """Format a number and its standard error, to two digits of the error."""
    if not (error > 0 and math.isfinite(value)):
        return show(value)
    digits = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def print_table(
    columns: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    title: str = "",
    words: int = 1,
) -> None:
    """Print a table as wide as the terminal, 80 characters where there is none.

    Numbers are never broken, and names of trackers only at their colons; see
    `fuzzytrack.cli.text_table.table_lines`.

    Parameters
    ----------
    columns : sequence of str
        Heads.
    rows : sequence of sequence of str
        Cells; an empty row is an empty line.
    title : str
        Line above the table.
    words : int
        How many columns, from the left, hold words; the others hold numbers.
    """
    width = _terminal_width()
    for line in wrapped(title, width) if title else ():
        say(line)
    for line in table_lines(columns, rows, width, words):
        say(line)


def _terminal_width() -> int:
    from rich.console import Console

    return Console().width


def print_json(value: Any) -> None:
    """Print a value as JSON, with null for NaN and infinity."""
    say(json.dumps(plain(value), indent=2, ensure_ascii=False, allow_nan=False))


def write_json(path: Path, value: Any, indent: int = 2) -> None:
    """Write a value as JSON, with null for NaN and infinity; the file appears whole."""
    from fuzzytrack.io.files import whole_file

    text = json.dumps(plain(value), indent=indent, ensure_ascii=False, allow_nan=False)
    with whole_file(path) as draft:
        draft.write_text(text + "\n", encoding="utf-8")


def output_folder(
    path: str, *, force: bool = False, resume: bool | None = None, make: bool = True
) -> Path:
    """Folder for the results of a command, made if it does not exist.

    Parameters
    ----------
    path : str
        The folder.
    force : bool
        Whether it may hold files; those of the same names are replaced.
    resume : bool, optional
        Whether the results in it are continued; None for a command that cannot.
    make : bool
        Whether it is made now; otherwise it is only checked that it can be.

    Raises
    ------
    DataError
        If it holds files, and neither `force` nor `resume` is given.
    OSError
        If it is a file or cannot be made.
    """
    from fuzzytrack.io.files import check_output_folder

    folder = Path(path)
    if not (folder.is_dir() and any(folder.iterdir())):
        check_output_folder(path)
    elif not (force or resume):
        more = "" if resume is None else ", continue with --resume"
        raise DataError(
            f"{path or '.'}: holds files already; name another folder{more}, or replace them "
            "with --force"
        )
    if make:
        folder.mkdir(exist_ok=True)
    return folder


@contextmanager
def progress(label: str) -> Iterator[Progress]:
    """Progress bar with the remaining time on stderr, if that is a terminal.

    Yields
    ------
    callable
        Takes the share of the work that is done.
    """
    if not sys.stderr.isatty():
        yield lambda share: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(label, total=None)
        yield lambda share: bar.update(task, completed=share, total=1.0)
