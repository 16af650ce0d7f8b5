"""Scan trackers by name: shipped configurations, files, and texts that name one."""

from __future__ import annotations

import os
import re
from typing import Any

from fuzzytrack import specs
from fuzzytrack.scan.scan_tracker import ScanTracker
from fuzzytrack.scan.scanners.loading import (
    dumps,
    load_configuration,
    loads_configuration,
    shipped_scanners,
)
from fuzzytrack.scan.scanners.numbers import with_values
from fuzzytrack.scan.scanners.reader import SENSOR, Configuration
from fuzzytrack.scan.scanners.roles import ROLES
from fuzzytrack.yamltree import quoted

__all__ = [
    "as_scanner",
    "configuration_of",
    "dumps_scanner",
    "load_scanner",
    "loads_scanner",
    "make_scanner",
    "save_scanner",
    "scanner_of",
]

# The last number after a name: ``default:clutter.tau=12``.
_CHANGE = re.compile(r":([a-z]\w*\.[a-z]\w*)=([^:]*)$")


def load_scanner(name_or_path: str | os.PathLike[str]) -> ScanTracker:
    """Scan tracker of a shipped configuration, or of a file.

    Parameters
    ----------
    name_or_path : str or path
        A name out of `shipped_scanners`, or a path: anything that ends in ``.yaml`` or ``.yml``,
        holds a separator or is a path object.

    Raises
    ------
    ScannerError
        If there is no such name, or the file cannot be read, or is no configuration; names file,
        line, column, the offending word and the allowed words.
    """
    return scanner_of(load_configuration(name_or_path))


def loads_scanner(text: str | bytes, file: str = "<text>") -> ScanTracker:
    """Scan tracker of a YAML text.

    Parameters
    ----------
    text : str or bytes
        At most 128 KiB; bytes are UTF-8.
    file : str
        Name for messages; a file that it is based on is looked for in its folder.

    Raises
    ------
    ScannerError
        As for `load_scanner`.
    """
    return scanner_of(loads_configuration(text, file))


def make_scanner(text: str) -> ScanTracker:
    """Scan tracker that a text names: a configuration, and numbers that are changed.

    Parameters
    ----------
    text : str
        Name or file, and after it ``:role.number=value`` as often as needed.

    Raises
    ------
    ScannerError
        As for `load_scanner`.
    ValueError
        If there is no such number, or it is out of range; says what is allowed.

    Examples
    --------
    >>> from fuzzytrack.scan.scanners import make_scanner
    >>> make_scanner("default:sensor.detection=0.8").sensor.detection
    0.8
    """
    name, changes = text.strip(), {}
    while found := _CHANGE.search(name):
        key, value = found.groups()
        if key in changes:
            raise ValueError(f"{text!r}: number {key!r} is given twice")
        changes[key] = value.strip()
        name = name[: found.start()]
    before, colon, rest = name.partition(":")
    if colon and (before in shipped_scanners() or before.endswith((".yaml", ".yml"))):
        raise ValueError(
            f"{text!r}: {quoted(rest)} changes no number; expected role.number=value, as in "
            f"{before}:sensor.detection=0.8"
        )
    return scanner_of(with_values(load_configuration(name), changes))


def as_scanner(scanner: ScanTracker | str | os.PathLike[str]) -> ScanTracker:
    """The scan tracker itself, or the one of a text or path; see `make_scanner`.

    Raises
    ------
    ScannerError, ValueError
        As for `make_scanner`.
    TypeError
        If it is something else.
    """
    if isinstance(scanner, str):
        return make_scanner(scanner)
    if isinstance(scanner, os.PathLike):
        return load_scanner(scanner)
    if not isinstance(scanner, ScanTracker):
        raise TypeError(
            "scanner must be a ScanTracker, the name of a configuration or the path of a file, "
            f"got {specs.kind_of(scanner)}"
        )
    return scanner


def dumps_scanner(scanner: ScanTracker, description: str = "", based_on: str = "") -> str:
    """Write a scan tracker as YAML text that loads to an equal one.

    Parameters
    ----------
    scanner : ScanTracker
    description : str
        What it is for.
    based_on : str
        Name or path of a configuration; then only what differs from it is written.

    Raises
    ------
    ScannerError
        If a part is not registered, so that no file can name it.
    """
    return dumps(configuration_of(scanner, description, based_on))


def save_scanner(
    scanner: ScanTracker,
    path: str | os.PathLike[str],
    description: str = "",
    based_on: str = "",
) -> None:
    """Write a scan tracker to a file, whole or not at all; see `dumps_scanner`.

    Raises
    ------
    ScannerError
        As for `dumps_scanner`; the file is then as it was.
    OSError
        If the file cannot be written; it is then as it was.
    """
    from fuzzytrack.io.files import whole_file

    text = dumps(configuration_of(scanner, description, based_on), os.fspath(path))
    with whole_file(path) as draft:
        draft.write_text(text, encoding="utf-8")


def scanner_of(configuration: Configuration) -> ScanTracker:
    """Scan tracker of a configuration."""
    parts: dict[str, Any] = dict(configuration.parts)
    return ScanTracker(**parts, name=configuration.name)


def configuration_of(
    scanner: ScanTracker, description: str = "", based_on: str = ""
) -> Configuration:
    """Configuration of a scan tracker; see `dumps_scanner`."""
    parts = tuple((role, getattr(scanner, role)) for role in (SENSOR, *ROLES))
    return Configuration(scanner.name, description, parts, based_on)
