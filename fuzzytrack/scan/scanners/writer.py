"""Configurations of scan trackers as YAML, with the meaning of every number beside it."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator

from fuzzytrack.errors import ScannerError
from fuzzytrack.fuzzy.saving import yaml_text
from fuzzytrack.scan.part import Parameter, Part, Word, declared
from fuzzytrack.scan.scanners.reader import FORMAT_VERSION, PART, SENSOR, Configuration, Roles

__all__ = ["SCHEMA_FILE", "SCHEMA_LINE", "dumps_configuration", "part_name"]

#: File of the JSON Schema, beside the configurations that name it.
SCHEMA_FILE = "scanner.schema.json"
#: First line of a file: where editors find its JSON Schema.
SCHEMA_LINE = f"# yaml-language-server: $schema={SCHEMA_FILE}"
_WIDTH = 96
# Where comments begin, if the number leaves room.
_MARGIN = 34


def dumps_configuration(
    configuration: Configuration, roles: Roles, base: Configuration | None = None
) -> str:
    """Write a configuration as YAML text.

    Parameters
    ----------
    configuration : Configuration
    roles : mapping of str to Registry
        The registry of the parts of each role.
    base : Configuration, optional
        The one that `configuration.based_on` names; then only what differs from it is written.

    Returns
    -------
    str
        Text that loads to an equal configuration. What each number means stands beside it.

    Raises
    ------
    ScannerError
        If a part is not registered, so that no file can name it.
    """
    return "\n".join(_lines(configuration, roles, base)) + "\n"


def part_name(role: str, part: Part, roles: Roles) -> str:
    """Name under which the kind of a part is registered.

    Raises
    ------
    ScannerError
        If it is not registered.
    """
    for name in roles[role].names():
        # Installed plug-ins are loaded by name only; one that cannot be loaded made no part.
        try:
            if roles[role].get(name) is type(part):
                return name
        except ValueError:
            continue
    raise ScannerError(
        f"{role} {type(part).__name__} is not registered, so a file cannot name it; register it: "
        f"one of {', '.join(roles[role].names())}"
    )


def _lines(configuration: Configuration, roles: Roles, base: Configuration | None) -> Iterator[str]:
    yield SCHEMA_LINE
    yield f"scanner: {FORMAT_VERSION}"
    yield f"name: {yaml_text(configuration.name)}"
    if configuration.description:
        yield from _prose("description", configuration.description)
    if base is not None:
        yield f"based_on: {yaml_text(configuration.based_on)}"
    for role, part in configuration.parts:
        old = None if base is None else base.part(role)
        if part == old:
            continue
        yield ""
        name = "" if role == SENSOR else part_name(role, part, roles)
        shown = _shown(part, old)
        if not shown:
            yield f"{role}: {yaml_text(name)}" if name else f"{role}: {{}}"
            continue
        yield f"{role}:"
        if name:
            yield f"  {PART}: {yaml_text(name)}"
        for key in shown:
            yield from _entry(key, getattr(part, key), declared(type(part))[key])


def _shown(part: Part, old: Part | None) -> list[str]:
    """Names of the numbers and words that are written: all, or what differs from a part."""
    same_kind = type(part) is type(old)
    return [
        key
        for key in declared(type(part))
        if not same_kind or getattr(part, key) != getattr(old, key)
    ]


def _entry(key: str, value: object, meant: Parameter | Word) -> Iterator[str]:
    """A number or word with its meaning: behind it, or above it where there is no room."""
    line = f"  {key}: {_value(value)}"
    comment = _meaning(meant)
    if len(line) < _MARGIN and _MARGIN + len(comment) <= _WIDTH:
        yield f"{line:<{_MARGIN}}# {comment}"
    else:
        yield from (f"  # {text}" for text in textwrap.wrap(comment, _WIDTH - 4))
        yield line


def _meaning(meant: Parameter | Word) -> str:
    if isinstance(meant, Word):
        choices = f" ({', '.join(meant.choices)})" if meant.choices else ""
        return f"{meant.meaning}{choices}"
    return f"{meant.meaning}{f' ({meant.unit})' if meant.unit else ''}"


def _value(value: object) -> str:
    if isinstance(value, str):
        return yaml_text(value)
    text = repr(value).removesuffix(".0")
    mantissa, exponent, power = text.partition("e")
    # Some YAML readers take 1e-06 for a word.
    dot = ".0" if exponent and "." not in mantissa else ""
    return f"{mantissa}{dot}{exponent}{power}"


def _prose(key: str, text: str) -> Iterator[str]:
    """Long text folded over several lines, other text on one line."""
    if len(text) < _WIDTH - len(key) or text != " ".join(text.split()):
        yield f"{key}: {yaml_text(text)}"
        return
    yield f"{key}: >-"
    lines = textwrap.wrap(text, _WIDTH, break_long_words=False, break_on_hyphens=False)
    yield from (f"  {line}" for line in lines)
