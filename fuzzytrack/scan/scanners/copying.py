"""A new configuration that begins with another one."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from fuzzytrack.errors import ScannerError
from fuzzytrack.fuzzy.saving import yaml_text
from fuzzytrack.scan.scanners.loading import (
    dumps,
    load_configuration,
    loads_configuration,
    scanner_path,
    shipped_scanners,
)
from fuzzytrack.scan.scanners.writer import SCHEMA_LINE
from fuzzytrack.yamltree import Document

__all__ = ["new_configuration"]

_LANGUAGE_SERVER = "# yaml-language-server:"


def new_configuration(origin: str, file: str, *, whole: bool) -> str:
    """Text of a configuration that begins with another one, and is named after its file.

    Parameters
    ----------
    origin : str
        Name or path of the other one.
    file : str
        Where the text will lie.
    whole : bool
        Whether it is a copy with all numbers and comments; otherwise it is based on the other one,
        and has comments that say what may be changed.

    Raises
    ------
    ScannerError
        If the other one cannot be read.
    """
    before = load_configuration(origin)
    name = Path(file).stem
    if whole and not before.based_on:
        return _copied(scanner_path(origin), name)
    if whole:
        return dumps(replace(before, name=name, based_on=""), file)
    based_on = origin
    if origin not in shipped_scanners():
        based_on = Path(os.path.relpath(origin, Path(file).parent)).as_posix()
        based_on = based_on if "/" in based_on else f"./{based_on}"
    lines = [
        SCHEMA_LINE,
        "scanner: 1",
        f"name: {yaml_text(name)}",
        f"based_on: {yaml_text(based_on)}",
        "",
        f"# Only what differs from {before.name} is written here. For example:",
        "# sensor:",
        f"#   detection: {getattr(before.part('sensor'), 'detection', 0.9):g}",
        "",
    ]
    return "\n".join(lines)


def _copied(source: Path, name: str) -> str:
    """Text of a file under another name, with its comments."""
    body = source.read_text(encoding="utf-8").removeprefix("\ufeff")
    document = Document(body, str(source), failure=ScannerError)
    _, node = document.entries(document.root, "the configuration")["name"]
    body = body[: node.start] + yaml_text(name) + body[node.end :]
    first, _, rest = body.partition("\n")
    copy = f"{SCHEMA_LINE}\n{rest if first.startswith(_LANGUAGE_SERVER) else body}"
    loads_configuration(copy, str(source))
    return copy
