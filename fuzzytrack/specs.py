"""What a user writes for a scheduler or a tracker: a name, and parameters as ``:name=value``."""

from __future__ import annotations

import inspect
import math
import re
import types
import typing
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any

from fuzzytrack.numerals import as_number, is_number
from fuzzytrack.yamltree import suggestion

__all__ = [
    "Readers",
    "call_with",
    "check_options",
    "is_file",
    "kind_of",
    "parameters_of",
    "spelled",
    "split",
]

#: For types of parameters other than words and numbers, the functions that make them from a word.
Readers = Mapping[Any, Callable[[str], Any]]

# A name may be a path with points, as those of settings within settings are.
_OPTION = re.compile(r":([^\W\d][\w.-]*)=([^:]*)$")
# A comma before a parameter, where a colon should be, and a parameter where the name should be.
_COMMA = re.compile(r"\s*,\s*(?=[^\W\d]\w*\s*=)")
_BARE = re.compile(r"\s*[^\W\d]\w*\s*=")
_FILE = (".yaml", ".yml", ".fis", ".fll")
_SUFFIX = re.compile(r"\.(?:ya?ml|fis|fll)", re.IGNORECASE)


def is_file(name: str) -> bool:
    """Whether a name is that of a rule-base file."""
    return name.lower().endswith(_FILE)


def split(spec: str, what: str) -> tuple[str, dict[str, str]]:
    """Name, and the parameters after it; a name may hold colons, as Windows paths do.

    Parameters
    ----------
    spec : str
        For example ``fixed:alpha=0.5:beta=0.2``.
    what : str
        What it stands for, for messages: "tracker".

    Raises
    ------
    ValueError
        If a parameter is given twice, or is not written as name=value.
    """
    _refuse_commas(spec, what)
    name, options = spec.strip(), {}
    while found := _OPTION.search(name):
        key, value = found.groups()
        if key in options:
            raise ValueError(f"{what} {spec!r}: parameter {key!r} is given twice")
        options[key] = value.strip()
        name = name[: found.start()]
    head, colon, tail = name.rpartition(":")
    if colon and not is_file(name):
        raise ValueError(
            f"{what} {spec!r}: {tail!r} is no parameter; write parameters as name=value, for "
            f"example {head.partition(':')[0]}:name=value"
        )
    return name, dict(reversed(options.items()))


def _refuse_commas(spec: str, what: str) -> None:
    """Raise ValueError for parameters with commas between them, or without a name before them."""
    # The path of a file may hold anything.
    after = _SUFFIX.split(spec)[-1]
    name = "NAME:" if after == spec and _BARE.match(spec) else ""
    if _COMMA.search(after):
        right = spec[: len(spec) - len(after)] + _COMMA.sub(":", after)
        raise ValueError(
            f"{what} {spec!r}: parameters have colons between them; write {name}{right.strip()}"
        )
    if name:
        raise ValueError(f"{what} {spec!r}: a name is missing; write {name}{spec.strip()}")


def parameters_of(
    factory: Callable[..., Any], without: str | None = None
) -> dict[str, inspect.Parameter]:
    """Parameters of a factory that can be given by name."""
    try:
        signature = inspect.signature(factory, eval_str=True)
    except Exception:  # annotations that only a type checker can read
        signature = inspect.signature(factory)
    named = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return {k: p for k, p in signature.parameters.items() if p.kind in named and k != without}


def spelled(parameters: Mapping[str, inspect.Parameter]) -> tuple[str, ...]:
    """Parameters as a list shows them: ``name``, or ``name=default``."""
    empty = inspect.Parameter.empty
    return tuple(k if p.default is empty else f"{k}={p.default}" for k, p in parameters.items())


def check_options(options: Iterable[str], parameters: Collection[str]) -> None:
    """Raise ValueError for the first option that is no parameter."""
    for key in options:
        if key not in parameters:
            raise ValueError(f"unknown parameter {key!r}{suggestion(key, parameters)}")


def call_with(
    factory: Callable[..., Any],
    options: Mapping[str, str],
    readers: Readers,
    given: Mapping[str, Any] | None = None,
    others: Mapping[str, inspect.Parameter] | None = None,
) -> Any:
    """Call a factory with options as a user wrote them.

    Parameters
    ----------
    factory : callable
    options : mapping of str to str
        Its parameters, as words; the annotations of the factory say what they are.
    readers : mapping of type to callable
        See `Readers`.
    given : mapping, optional
        Further arguments, as they are.
    others : mapping, optional
        Parameters that a user may write beside those of the factory, for messages.

    Raises
    ------
    ValueError
        If a value does not fit, or a parameter is missing; says how to write it.
    """
    parameters = parameters_of(factory)
    arguments = dict(given or {})
    for key, text in options.items():
        arguments[key] = _value(key, text, parameters[key].annotation, readers)
    empty = inspect.Parameter.empty
    missing = [k for k, p in parameters.items() if p.default is empty and k not in arguments]
    if missing:
        raise ValueError(
            f"needs {' and '.join(missing)}; write it as "
            f"{''.join(f':{key}=...' for key in missing)}; "
            f"parameters: {', '.join(spelled({**parameters, **(others or {})}))}"
        )
    return factory(**arguments)


def kind_of(value: object) -> str:
    """What a wrong argument is, for messages: its type, or that it is a class."""
    return f"the class {value.__name__}" if isinstance(value, type) else type(value).__name__


def _value(key: str, text: str, annotation: Any, readers: Readers) -> Any:
    """Value of a parameter, as its annotation says; of several types the first that fits."""
    union = typing.get_origin(annotation) in (typing.Union, types.UnionType)
    kinds = typing.get_args(annotation) if union else (annotation,)
    for kind in kinds:
        if kind in readers:
            return readers[kind](text)
    known = [_WORDS[kind] for kind in kinds if kind in _WORDS]
    # Without an annotation that is known: a number if it looks like one.
    for name, read in known or [("", _whole), ("", _number), ("", str)]:
        try:
            return read(text)
        except ValueError:
            wanted = name
    raise ValueError(f"{key} must be {wanted}, got {text!r}")


def _number(text: str) -> float:
    value = math.inf if text == "inf" else as_number(text)
    if value is None:
        raise ValueError(text)
    return value


def _whole(text: str) -> int:
    if not is_number(text):
        raise ValueError(text)
    return int(text)


def _boolean(text: str) -> bool:
    words = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}
    if text.lower() not in words:
        raise ValueError(text)
    return words[text.lower()]


_WORDS: dict[Any, tuple[str, Callable[[str], Any]]] = {
    bool: ("true or false", _boolean),
    int: ("a whole number", _whole),
    float: ("a number", _number),
    str: ("a word", str),
}
