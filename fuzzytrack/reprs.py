"""Constructor code: what `repr` gives of schedulers, trackers, normalizations and fuzzy systems."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

__all__ = ["call", "constructor_code", "shown"]


def constructor_code(value: object, **renamed: str) -> str:
    """Code that makes a dataclass again, by the name of its class.

    Parameters without a default come first, by position; of the others only those that differ from
    their default are written.

    Parameters
    ----------
    value : object
        A dataclass. Of anything else, which may have a constructor of its own, Python's standard
        representation is returned, in angle brackets: it is no code.
    **renamed : str
        For fields that the constructor calls otherwise, its name for them.
    """
    kind = type(value)
    if not dataclasses.is_dataclass(value) or _has_own_constructor(kind):
        return object.__repr__(value)
    arguments, options = [], {}
    for field in dataclasses.fields(value):
        found = getattr(value, field.name) if field.init else None
        if field.init and field.default is dataclasses.MISSING:
            arguments.append(found)
        elif field.init and found != field.default:
            options[renamed.get(field.name, field.name)] = found
    return call(kind.__name__, arguments, options)


def call(name: str, arguments: list[Any], options: Mapping[str, Any]) -> str:
    """Code of a call."""
    parts = [*map(shown, arguments), *(f"{key}={shown(found)}" for key, found in options.items())]
    return f"{name}({', '.join(parts)})"


def shown(value: object) -> str:
    """Code of a value; texts stand in double quotes, as in the code of the project."""
    if isinstance(value, tuple):
        return f"({', '.join(map(shown, value))}{',' if len(value) == 1 else ''})"
    if not isinstance(value, str):
        return repr(value)
    text = repr(str(value))
    return f'"{text[1:-1]}"' if text[0] == "'" and '"' not in text else text


def _has_own_constructor(kind: type) -> bool:
    """Whether a class that is no dataclass itself, but derived from one, has its own arguments."""
    return "__init__" in vars(kind) and "__dataclass_fields__" not in vars(kind)
