"""Numbers of a configuration by their names, ``clutter.tau``: read, checked and changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from fuzzytrack.numerals import is_number
from fuzzytrack.scan.part import Parameter, Part, Word, declared
from fuzzytrack.scan.scanners.reader import Configuration
from fuzzytrack.yamltree import suggestion

__all__ = ["declarations", "values", "with_values"]


def declarations(configuration: Configuration) -> dict[str, Parameter | Word]:
    """What the numbers and words of all parts mean, by name."""
    return {
        f"{role}.{key}": meant
        for role, part in configuration.parts
        for key, meant in declared(type(part)).items()
    }


def values(configuration: Configuration) -> dict[str, float | int | str]:
    """Numbers and words of all parts, by name."""
    return {
        f"{role}.{key}": getattr(part, key)
        for role, part in configuration.parts
        for key in declared(type(part))
    }


def with_values(
    configuration: Configuration, changes: Mapping[str, float | int | str]
) -> Configuration:
    """The same with other numbers and words.

    Parameters
    ----------
    configuration : Configuration
    changes : mapping of str to number or str
        By names such as ``clutter.tau``; a number may be written as a text.

    Raises
    ------
    ValueError
        If there is no such number, or it is out of range; says what is allowed.
    """
    known = declarations(configuration)
    by_role: dict[str, dict[str, float | int | str]] = {}
    for name, value in changes.items():
        if name not in known:
            raise ValueError(
                f"{configuration.name} has no number {name!r}{suggestion(name, known)}"
            )
        meant = known[name]
        if isinstance(meant, Parameter) and isinstance(value, str):
            value = float(value) if is_number(value) else value
        if not meant.allows(value):
            unit = getattr(meant, "unit", "")
            raise ValueError(
                f"{name} must be {meant.allowed}{f' ({unit})' if unit else ''}, not {value!r}"
            )
        role, _, key = name.partition(".")
        by_role.setdefault(role, {})[key] = value
    for role, numbers in by_role.items():
        part: Part = configuration.part(role)
        configuration = configuration.with_part(role, replace(part, **numbers))
    return configuration
