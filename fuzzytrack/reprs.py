"""What `repr` gives: constructor code, or of values that hold arrays a summary in one line."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

__all__ = ["call", "constructor_code", "shown", "summary"]

# Entries of a sequence, and characters of a fact, that a summary shows.
_ENTRIES = 4
_CHARACTERS = 72


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


def summary(value: object, *names: str, **facts: object) -> str:
    """A value that holds arrays in one line, in angle brackets: it is no code.

    Parameters
    ----------
    value : object
    *names : str
        Its attributes to show; of an array the shape, of a mapping the keys, and the beginning of
        what is long.
    **facts : object
        Further facts, by name.
    """
    found = {**{name: getattr(value, name) for name in names}, **facts}
    shown_facts = ", ".join(_fact(name, fact) for name, fact in found.items())
    return f"<{type(value).__name__}: {shown_facts}>"


def _fact(name: str, fact: object) -> str:
    if isinstance(fact, np.ndarray) and fact.ndim:
        return f"{name}.shape={fact.shape}"
    if isinstance(fact, float | np.floating | np.ndarray):
        return f"{name}={fact:.6g}"
    if isinstance(fact, Mapping):
        fact = tuple(fact)
    if isinstance(fact, tuple) and len(fact) > _ENTRIES:
        text = f"({', '.join(map(shown, fact[:_ENTRIES]))}, … {len(fact)} in all)"
    else:
        text = shown(fact)
    return f"{name}={text if len(text) <= _CHARACTERS else text[: _CHARACTERS - 1] + '…'}"


def _has_own_constructor(kind: type) -> bool:
    """Whether a class that is no dataclass itself, but derived from one, has its own arguments."""
    return "__init__" in vars(kind) and "__dataclass_fields__" not in vars(kind)
