"""Error messages of the commands: one line on stderr and exit status 2, never a traceback."""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Iterable
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from fuzzytrack.errors import (
    CacheWarning,
    FileError,
    NoRuleFiresWarning,
    PluginWarning,
    PrecisionWarning,
    TrackWarning,
    in_one_sentence,
)
from fuzzytrack.plugins.scripts import loaded_scripts, place_in_script

__all__ = ["Command", "Commands", "one_line", "printable"]

# Arguments in a message: at its beginning, as in "jobs: ..." or "jobs and scheduler: ...", and
# anywhere in backquotes.
_ARGUMENTS = re.compile(r"^\w+(?: and \w+)*(?=: )|`\w+`")


# Warnings that commands show.
_SHOWN = (CacheWarning, NoRuleFiresWarning, PluginWarning, PrecisionWarning, TrackWarning)


class Command(TyperCommand):
    """A command; a message about an argument of a function names the option instead."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command."""
        try:
            return super().invoke(ctx)
        except ValueError as error:
            message = _with_options(str(error), self.params)
            if message == str(error):
                raise
            raise ValueError(message) from error

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write what the command takes, options that belong together under their heading."""
        found: dict[str, list[tuple[str, str]]] = {"Arguments": [], "Options": []}
        for each in self.get_params(ctx):
            heading = getattr(each, "rich_help_panel", None) or "Options"
            if each.param_type_name == "argument":
                heading = "Arguments"
            record = each.get_help_record(ctx)
            if record is not None:
                found.setdefault(heading, []).append(record)
        for heading, records in found.items():
            if records:
                with formatter.section(heading):
                    formatter.write_dl(records)


class Commands(TyperGroup):
    """A group of commands; an error in any of them becomes one line on stderr."""

    def main(self, *args: Any, **extra: Any) -> Any:
        """Run a command and leave with its exit status."""
        extra["standalone_mode"] = False
        with warnings.catch_warnings():
            warnings.showwarning = _show_warning  # type: ignore[assignment]
            # Each line once in a command, which may run a tracker many times.
            for category in _SHOWN:
                warnings.simplefilter("default", category)
            try:
                status = super().main(*args, **extra)
            except Exception as error:
                line = _line(error, self)
                if line is None:
                    raise
                sys.exit(_complain(line, 2))
        sys.exit(status if isinstance(status, int) else 0)

    def invoke(self, ctx: Any) -> Any:
        """Run a command."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            # typer would print a message of its own.
            raise typer.Exit(_complain("interrupted", 130)) from None


def _with_options(message: str, parameters: Iterable[Any]) -> str:
    """Message with the names of arguments written as the options for them."""
    options: dict[str, str] = {p.name: o for p in parameters for o in p.opts if o[:2] == "--"}

    def written(found: re.Match[str]) -> str:
        names = found.group().strip("`").split(" and ")
        if not options.keys() & names:
            return found.group()
        return " and ".join(options.get(name, name) for name in names)

    return _ARGUMENTS.sub(written, message)


def _line(error: Exception, program: Any) -> str | None:
    """Error as one line; None if it is a mistake in this package, which needs the traceback."""
    # Wrong usage; the module of its class depends on the version of typer.
    if hasattr(error, "format_message"):
        return _usage(error, program)
    if isinstance(error, FileError) and error.location:
        return one_line(error)
    scripts = ", ".join(script.path for script in loaded_scripts())
    place = place_in_script(error)
    # A note names the tracker whose step has raised the error: that is not about an argument.
    notes = getattr(error, "__notes__", ())
    if place is None and isinstance(error, OSError | ValueError) and not (scripts and notes):
        return one_line(error)
    if not scripts:
        return None
    line = ", ".join([f"{place or scripts}: {in_one_sentence(error)}", *notes])
    more = "; fuzzytrack.testing.check_scheduler or check_tracker says more" if notes else ""
    return printable(line + more)


def one_line(error: Exception) -> str:
    """Error as one line; a place in a file comes first, as compilers print it."""
    if isinstance(error, FileError) and error.location:
        return printable(str(error))
    if isinstance(error, OSError) and error.filename is not None:
        return printable(f"error: {error.filename}: {error.strerror}")
    if isinstance(error, OSError) and error.strerror:
        return printable(f"error: {error.strerror}")
    return printable(f"error: {error}")


def _usage(error: Any, program: Any) -> str:
    if type(error).__name__ == "NoArgsIsHelpError":
        return str(error.format_message())
    context = getattr(error, "ctx", None)
    where = f" (see {context.command_path} --help)" if context is not None else ""
    message = error.format_message().rstrip(".")
    option = getattr(error, "option_name", "") if "No such option" in message else ""
    meant = _option_meant(error, option, program) if option.startswith("--") else ""
    if meant:
        message = f"No such option: {option}{meant}"
    return printable(f"error: {message}{where}")


# A longer list of commands is cut short.
_NAMED = 6


def _option_meant(error: Any, option: str, program: Any) -> str:
    """What to write for an option that a command has not: a longer or shorter word, or none."""
    for other in getattr(error, "possibilities", None) or ():
        if other.startswith(option) or option.startswith(other):
            return f"; did you mean {other}?"
    others = _commands_with(option, program)
    if len(others) > _NAMED:
        others[4:] = [f"and {len(others) - 4} other commands"]
    return f"; it belongs to {', '.join(others)}" if others else ""


def _commands_with(option: str, program: Any) -> list[str]:
    """Commands that have an option, by what is typed to call them."""
    found = []
    for name in program.commands:
        command = program.loaded(name) if hasattr(program, "loaded") else program.commands[name]
        if hasattr(command, "commands"):
            found += [f"{name} {below}" for below in _commands_with(option, command)]
        elif any(option in parameter.opts for parameter in command.params):
            found.append(name)
    return found


def printable(text: str) -> str:
    """Escape the characters of a message that would control the terminal."""
    line = " ".join(part.strip() for part in text.splitlines())
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in line)


def _complain(line: str, status: int) -> int:
    typer.echo(line, err=True)
    return status


def _show_warning(message: Warning | str, *rest: Any) -> None:
    typer.echo(printable(f"warning: {message}"), err=True)
