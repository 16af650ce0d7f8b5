"""Bad input ends in one line and exit status 2, never in a traceback."""

from __future__ import annotations

import sys
import warnings
from typing import Any

import typer
from typer.core import TyperGroup

from fuzzytrack.errors import FileError, NoRuleFiresWarning, PluginWarning

__all__ = ["Commands", "one_line"]


class Commands(TyperGroup):
    """The commands, with what goes wrong in any of them put into one line on stderr."""

    def main(self, *args: Any, **extra: Any) -> Any:
        """Run a command and leave with its exit status."""
        extra["standalone_mode"] = False
        with warnings.catch_warnings():
            warnings.showwarning = _show_warning  # type: ignore[assignment]
            for category in (NoRuleFiresWarning, PluginWarning):
                warnings.simplefilter("always", category)
            try:
                status = super().main(*args, **extra)
            except (OSError, ValueError) as error:
                sys.exit(_complain(one_line(error), 2))
            # Wrong usage; where its class lives depends on the version of typer.
            except Exception as error:
                if not hasattr(error, "format_message"):
                    raise
                sys.exit(_complain(_usage(error), 2))
        sys.exit(status if isinstance(status, int) else 0)

    def invoke(self, ctx: Any) -> Any:
        """Run a command."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            # typer would make its own end of it.
            raise typer.Exit(_complain("interrupted", 130)) from None


def one_line(error: Exception) -> str:
    """Say in one line what is wrong; a place in a file comes first, as compilers print it."""
    if isinstance(error, FileError) and error.location:
        return _printable(str(error))
    if isinstance(error, OSError) and error.filename is not None:
        return _printable(f"error: {error.filename}: {error.strerror}")
    return _printable(f"error: {error}")


def _usage(error: Any) -> str:
    if type(error).__name__ == "NoArgsIsHelpError":
        return str(error.format_message())
    context = getattr(error, "ctx", None)
    where = f" (see {context.command_path} --help)" if context is not None else ""
    return _printable(f"error: {error.format_message().rstrip('.')}{where}")


def _printable(text: str) -> str:
    """Leave nothing in a message that a terminal would obey."""
    line = " ".join(part.strip() for part in text.splitlines())
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in line)


def _complain(line: str, status: int) -> int:
    typer.echo(line, err=True)
    return status


def _show_warning(message: Warning | str, *rest: Any) -> None:
    typer.echo(_printable(f"warning: {message}"), err=True)
