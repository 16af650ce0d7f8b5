"""Commands that do what is on the page of the studio."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["command_line"]


def command_line(command: str, arguments: Sequence[str], options: Mapping[str, Any]) -> str:
    """Write a command as it is typed.

    Parameters
    ----------
    command : str
        Such as ``testbed``.
    arguments : sequence of str
        What follows it.
    options : mapping of str to value
        Values of options by the names of arguments of functions; lists are written with commas,
        True as the option alone, and None is left out.
    """
    words = ["fuzzytrack", command, *arguments]
    for name, value in options.items():
        if value is None:
            continue
        listed = isinstance(value, Sequence) and not isinstance(value, str)
        words.append(f"--{name.replace('_', '-')}")
        if value is not True:
            words.append(",".join(map(str, value)) if listed else f"{value}")
    return shlex.join(words)
