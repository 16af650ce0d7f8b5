"""Trackers by name: what a user may write for one, and what there is to choose from."""

from __future__ import annotations

import inspect
import re
import types
import typing
import warnings
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from fuzzytrack.errors import PluginWarning, RuleBaseError
from fuzzytrack.fuzzy.loading import load_rulebase, shipped_rulebases
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.normalizations import normalizations
from fuzzytrack.plugins import Registry
from fuzzytrack.schedulers import FuzzyScheduler, GainScheduler, schedulers
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.base import Tracker, trackers
from fuzzytrack.yamltree import suggestion

__all__ = ["CatalogEntry", "catalog", "make_tracker"]

_OPTION = re.compile(r":([^\W\d]\w*)=([^:]*)$")
_FILE = (".yaml", ".yml")


@dataclass(frozen=True)
class CatalogEntry:
    """Something that trackers are made of, by name.

    Attributes
    ----------
    kind : {"rule base", "scheduler", "tracker", "normalization"}
    name : str
        As a user writes it: for a normalization in the settings of a rule base, for the others
        where a tracker is asked for.
    parameters : tuple of str
        Parameters that it takes after its name; those with a default as ``name=default``.
    source : str
        Paper, or other origin.
    package : str
        Package that brings it; of a script, its file.
    """

    kind: str
    name: str
    parameters: tuple[str, ...]
    source: str
    package: str


def catalog() -> tuple[CatalogEntry, ...]:
    """List everything that has a name: rule bases, schedulers, trackers, normalizations."""
    start = _spelt(_start_parameters())
    fuzzy = (*_spelt(_parameters(FuzzyScheduler, without="rules")), *start)
    entries = [
        CatalogEntry("rule base", rules.name, fuzzy, rules.source, "fuzzytrack")
        for rules in map(load_rulebase, _scheduling())
    ]
    for plugin in schedulers:
        if _kind(plugin.name) != "scheduler":
            continue
        own = _spelt(_parameters(plugin.factory))
        entries.append(
            CatalogEntry("scheduler", plugin.name, (*own, *start), plugin.source, plugin.package)
        )
    for plugin in trackers:
        if _kind(plugin.name) != "tracker":
            continue
        own = _spelt(_parameters(plugin.factory))
        entries.append(CatalogEntry("tracker", plugin.name, own, plugin.source, plugin.package))
    for plugin in normalizations:
        entries.append(
            CatalogEntry("normalization", plugin.name, (), plugin.source, plugin.package)
        )
    return tuple(entries)


def make_tracker(spec: str) -> Tracker:
    """Make a tracker of what a user wrote.

    Parameters
    ----------
    spec : str
        A rule-base file (``my.yaml``), the name of a shipped rule base (``stiffness-damping``), of
        a scheduler (``fixed``) or of a tracker, and parameters after it, each as ``:name=value``:
        those of the scheduler or tracker, and for a rule base or scheduler also those of
        `fuzzytrack.AlphaBetaTracker`.

    Returns
    -------
    Tracker

    Raises
    ------
    ValueError
        If there is no such name or parameter, a parameter is missing, or a value does not fit;
        says what there is.
    RuleBaseError
        If a rule base cannot be read, or cannot schedule gains.

    Examples
    --------
    >>> from fuzzytrack.trackers.catalog import make_tracker
    >>> make_tracker("fixed:alpha=0.5:beta=0.2").scheduler
    FixedGains(0.5, 0.2)
    >>> make_tracker("stiffness-damping:method=relation:start=one-point").start_mode
    'one-point'
    """
    name, options = _split(spec.strip())
    try:
        tracker = _make(name, options)
    except RuleBaseError:
        raise  # it says where in the file
    except (TypeError, ValueError) as error:
        raise ValueError(f"tracker {spec!r}: {error}") from error
    if not isinstance(tracker, Tracker):
        raise ValueError(f"tracker {spec!r}: its plug-in made a {type(tracker).__name__}")
    return tracker


def _make(name: str, options: dict[str, str]) -> Any:
    if not name:
        raise ValueError("a name is missing; for example stiffness-damping")
    if _kind(name) != "tracker":
        scheduler = _make_scheduler(name, options, _start_parameters())
        return _call(AlphaBetaTracker, options, {"scheduler": scheduler})
    factory = trackers.get(name)
    _check(options, _parameters(factory))
    return _call(factory, options)


def _make_scheduler(
    name: str, options: dict[str, str], others: Mapping[str, inspect.Parameter] | None = None
) -> GainScheduler:
    """Scheduler by name or file, out of its own options, which are taken from `options`."""
    if name.lower().endswith(_FILE) or _kind(name) == "rule base":
        factory: Callable[..., Any] = FuzzyScheduler
        is_file = name.lower().endswith(_FILE)
        given: dict[str, Any] = {"rules": load_rulebase(Path(name) if is_file else name)}
    elif _kind(name) == "scheduler":
        factory, given = schedulers.get(name), {}
    else:
        raise ValueError(
            f"no such tracker{suggestion(name, _names())}; or a file that ends in .yaml"
        )
    parameters = {k: p for k, p in _parameters(factory).items() if k not in given}
    _check(options, {**parameters, **(others or {})})
    own = {key: options.pop(key) for key in tuple(options) if key in parameters}
    scheduler: GainScheduler = _call(factory, own, given)
    return scheduler


def _call(
    factory: Callable[..., Any], options: Mapping[str, str], given: Mapping[str, Any] | None = None
) -> Any:
    parameters = _parameters(factory)
    arguments = dict(given or {})
    for key, text in options.items():
        arguments[key] = _value(key, text, parameters[key].annotation)
    empty = inspect.Parameter.empty
    missing = [k for k, p in parameters.items() if p.default is empty and k not in arguments]
    if missing:
        raise ValueError(
            f"needs {' and '.join(missing)}; write it as "
            f"{''.join(f':{key}=...' for key in missing)}; "
            f"parameters: {', '.join(_spelt(parameters))}"
        )
    return factory(**arguments)


def _check(options: Iterable[str], parameters: Collection[str]) -> None:
    for key in options:
        if key not in parameters:
            raise ValueError(f"unknown parameter {key!r}{suggestion(key, parameters)}")


# -------------------------------------------------------------------- words


def _split(spec: str) -> tuple[str, dict[str, str]]:
    """Name, and the parameters after it; a name may hold colons, as Windows paths do."""
    name, options = spec, {}
    while found := _OPTION.search(name):
        key, value = found.groups()
        if key in options:
            raise ValueError(f"tracker {spec!r}: parameter {key!r} is given twice")
        options[key] = value.strip()
        name = name[: found.start()]
    head, colon, tail = name.rpartition(":")
    if colon and not name.lower().endswith(_FILE):
        raise ValueError(
            f"tracker {spec!r}: {tail!r} is no parameter; write parameters as name=value, for "
            f"example {head.partition(':')[0]}:name=value"
        )
    return name, dict(reversed(options.items()))


def _scheduling() -> tuple[str, ...]:
    """Shipped rule bases that schedule gains."""
    return tuple(name for name in shipped_rulebases() if load_rulebase(name).scheduler)


def _kind(name: str) -> str | None:
    """What a name stands for; no plug-in can take the name of something built in."""
    registries: dict[str, Registry[Any]] = {"scheduler": schedulers, "tracker": trackers}
    kinds = [kind for kind, registry in registries.items() if name in registry.names()]
    # What is built in first, otherwise in this order.
    kinds.sort(key=lambda kind: name not in registries[kind].built_in())
    if name in shipped_rulebases():
        kinds.insert(0, "rule base")
    for hidden in kinds[1:]:
        _report(hidden, name, registries[hidden].package(name), kinds[0])
    return kinds[0] if kinds else None


@cache
def _report(kind: str, name: str, package: str, taken_by: str) -> None:
    """Warn, once, of a plug-in that cannot be named."""
    warnings.warn(
        f"{kind} {name!r} of {package} has the name of a {taken_by}; it is skipped",
        PluginWarning,
        stacklevel=4,
    )


def _names() -> tuple[str, ...]:
    return (*_scheduling(), *schedulers.names(), *trackers.names())


# -------------------------------------------------------------------- signatures


def _parameters(
    factory: Callable[..., Any], without: str | None = None
) -> dict[str, inspect.Parameter]:
    try:
        signature = inspect.signature(factory, eval_str=True)
    except NameError:  # annotations that only a type checker sees
        signature = inspect.signature(factory)
    named = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return {k: p for k, p in signature.parameters.items() if p.kind in named and k != without}


def _start_parameters() -> dict[str, inspect.Parameter]:
    return _parameters(AlphaBetaTracker, without="scheduler")


def _spelt(parameters: Mapping[str, inspect.Parameter]) -> tuple[str, ...]:
    empty = inspect.Parameter.empty
    return tuple(k if p.default is empty else f"{k}={p.default}" for k, p in parameters.items())


def _value(key: str, text: str, annotation: Any) -> Any:
    """Value of a parameter, as its annotation says; of several types the first that fits."""
    union = typing.get_origin(annotation) in (typing.Union, types.UnionType)
    kinds = typing.get_args(annotation) if union else (annotation,)
    for kind in kinds:
        if kind in _NAMED:
            return _NAMED[kind](text)
    readers = [_READERS[kind] for kind in kinds if kind in _READERS]
    # Without an annotation that we know: a number if it looks like one.
    for name, read in readers or [("", int), ("", float), ("", str)]:
        try:
            return read(text)
        except ValueError:
            wanted = name
    raise ValueError(f"{key} must be {wanted}, got {text!r}")


def _boolean(text: str) -> bool:
    words = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}
    if text.lower() not in words:
        raise ValueError(text)
    return words[text.lower()]


_READERS: dict[Any, tuple[str, Callable[[str], Any]]] = {
    bool: ("true or false", _boolean),
    int: ("a whole number", int),
    float: ("a number", float),
    str: ("a word", str),
}
_NAMED: dict[Any, Callable[[str], Any]] = {
    RuleBase: load_rulebase,
    GainScheduler: lambda text: _make_scheduler(text, {}),
}
