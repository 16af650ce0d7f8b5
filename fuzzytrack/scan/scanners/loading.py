"""Configurations of scan trackers from files and texts, and to files."""

from __future__ import annotations

import os
from pathlib import Path

from fuzzytrack.errors import ScannerError
from fuzzytrack.scan.scanners.reader import Configuration, ScannerReader
from fuzzytrack.scan.scanners.roles import ROLES
from fuzzytrack.scan.scanners.writer import SCHEMA_FILE, dumps_configuration
from fuzzytrack.scan.sensor import Sensor
from fuzzytrack.shipped import Shipped
from fuzzytrack.specs import is_file
from fuzzytrack.yamltree import Document

__all__ = [
    "dumps",
    "load_configuration",
    "loads_configuration",
    "scanner_path",
    "shipped_scanners",
]

# How many files may be based on one another.
_MAX_CHAIN = 8

_SHIPPED = Shipped("configuration", "scanners", SCHEMA_FILE, ScannerError)


def loads_configuration(text: str | bytes, file: str = "<text>") -> Configuration:
    """Read a configuration from YAML text.

    Parameters
    ----------
    text : str or bytes
        At most 128 KiB; bytes are UTF-8.
    file : str
        Name for messages; a file that it is based on is looked for in its folder.

    Raises
    ------
    ScannerError
        If the text is no configuration; names file, line, column, the offending word and the
        allowed words.
    """
    return _read(Document(text, file, failure=ScannerError), ())


def load_configuration(name_or_path: str | os.PathLike[str]) -> Configuration:
    """Read a shipped configuration, or a file.

    Parameters
    ----------
    name_or_path : str or path
        A name out of `shipped_scanners`, or a path: anything that ends in ``.yaml`` or ``.yml``,
        holds a separator or is a path object.

    Raises
    ------
    ScannerError
        If there is no such name, or the file cannot be read, or is no configuration.
    """
    return _read(_SHIPPED.document(name_or_path), ())


def _read(document: Document, before: tuple[str, ...]) -> Configuration:
    """Configuration of a document, on which files are based, one on the other."""
    chain = (*before, document.file)

    def base(text: str) -> Configuration:
        found = _SHIPPED.document(_beside(text, document.file))
        places = [os.path.realpath(file) for file in chain]
        if os.path.realpath(found.file) in places:
            said = ", ".join([*chain, found.file])
            raise ScannerError(
                f"based_on: each file is based on the next one, in a circle: {said}; base one of "
                "them on a file outside"
            )
        if len(chain) > _MAX_CHAIN:
            raise ScannerError(
                f"based_on: more than {_MAX_CHAIN} files are based on one another; copy the "
                "numbers of some into one"
            )
        return _read(found, chain)

    return ScannerReader(document, Sensor, ROLES, base).configuration()


def _beside(text: str, file: str) -> str | Path:
    """Name, or path that is looked for in the folder of a file."""
    is_path = is_file(text) or "/" in text or os.sep in text
    return Path(file).parent / text if is_path else text


def dumps(configuration: Configuration, file: str = "<text>") -> str:
    """Write a configuration as YAML text; of one that is based on another, what differs from it.

    Parameters
    ----------
    configuration : Configuration
    file : str
        Where it will lie; a file that it is based on is looked for in its folder.

    Raises
    ------
    ScannerError
        If a part is not registered, or what it is based on cannot be read.
    """
    base = None
    if configuration.based_on:
        base = load_configuration(_beside(configuration.based_on, file))
    text = dumps_configuration(configuration, ROLES, base)
    if loads_configuration(text, file) != configuration:
        raise ScannerError(f"configuration {configuration.name!r} cannot be written as YAML")
    return text


def shipped_scanners() -> tuple[str, ...]:
    """Names of the configurations that come with fuzzytrack, in alphabetical order."""
    return _SHIPPED.names()


def scanner_path(name_or_path: str | os.PathLike[str]) -> Path:
    """Path of a shipped configuration by name, or the path that was given.

    Parameters
    ----------
    name_or_path : str or path
        As for `load_configuration`.

    Raises
    ------
    ScannerError
        If it is the name of no shipped configuration.
    """
    return _SHIPPED.path(name_or_path)
