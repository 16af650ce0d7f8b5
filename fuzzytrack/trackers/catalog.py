"""Trackers by name: the texts that name one, and the list of all names."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from fuzzytrack import specs
from fuzzytrack.errors import PluginWarning, RuleBaseError
from fuzzytrack.fuzzy.loading import load_rulebase, refuse_other_files, shipped_rulebases
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.normalizations import normalizations
from fuzzytrack.plugins import Registry
from fuzzytrack.schedulers import FuzzyScheduler, GainScheduler, schedulers
from fuzzytrack.schedulers.catalog import (
    READERS,
    scheduler_of_rules,
    scheduling_rulebases,
    take_scheduler,
)
from fuzzytrack.schedulers.settings import read_settings
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.base import Tracker, trackers
from fuzzytrack.trackers.lane_tracker import LaneTracker
from fuzzytrack.yamltree import suggestion

__all__ = [
    "CatalogEntry", "Trackers", "as_lane_tracker", "as_tracker", "as_trackers", "catalog",
    "make_tracker", "tracker_of_rules", "tracker_parameters",
]  # fmt: skip


#: What functions take for several trackers; see `as_trackers`.
Trackers = Mapping[str, Tracker | str] | Sequence[str]


@dataclass(frozen=True)
class CatalogEntry:
    """A tracker, or a part of one, that has a name.

    Attributes
    ----------
    kind : {"rule base", "scheduler", "tracker", "normalization"}
    name : str
        As a user writes it: for a normalization in the settings of a rule base, for the others
        where a tracker is needed.
    parameters : tuple of str
        Parameters that it takes after its name; those with a default as ``name=default``.
    source : str
        Paper, or other origin.
    package : str
        Package that it comes from; for a script, its file.
    """

    kind: str
    name: str
    parameters: tuple[str, ...]
    source: str
    package: str


def catalog() -> tuple[CatalogEntry, ...]:
    """List everything that has a name: rule bases, schedulers, trackers, normalizations."""
    start = specs.spelled(_start_parameters())
    entries = [
        CatalogEntry("rule base", rules.name, (*_used(rules), *start), rules.source, "fuzzytrack")
        for rules in map(load_rulebase, scheduling_rulebases())
    ]
    for plugin in schedulers:
        if _kind(plugin.name) != "scheduler":
            continue
        own = specs.spelled(specs.parameters_of(plugin.factory))
        entries.append(
            CatalogEntry("scheduler", plugin.name, (*own, *start), plugin.source, plugin.package)
        )
    for plugin in trackers:
        if _kind(plugin.name) != "tracker":
            continue
        own = specs.spelled(specs.parameters_of(plugin.factory))
        entries.append(CatalogEntry("tracker", plugin.name, own, plugin.source, plugin.package))
    for plugin in normalizations:
        entries.append(
            CatalogEntry("normalization", plugin.name, (), plugin.source, plugin.package)
        )
    return tuple(entries)


def as_tracker(tracker: Tracker | str, name: str = "tracker") -> Tracker:
    """The tracker itself, or the one that a text names; see `make_tracker`.

    Every function that takes a tracker takes a text as well, by this function.

    Parameters
    ----------
    tracker : Tracker or str
    name : str
        Name of the argument, for messages.

    Raises
    ------
    TypeError
        If it is neither.
    ValueError, RuleBaseError
        As for `make_tracker`.
    """
    if isinstance(tracker, str):
        return make_tracker(tracker)
    if isinstance(tracker, Tracker) and not isinstance(tracker, type):
        return tracker
    # A mistake that is easily made: a scheduler only chooses the gains of a tracker.
    wrap = isinstance(tracker, GainScheduler)
    raise TypeError(
        f"{name} must be a Tracker, or a text such as 'fixed:alpha=0.5:beta=0.2', "
        f"got {specs.kind_of(tracker)}"
        f"{'; wrap it: AlphaBetaTracker(...)' if wrap else ''}"
    )


def as_lane_tracker(tracker: Tracker | str) -> LaneTracker:
    """As `as_tracker`, for a recording that is tracked piece by piece.

    Raises
    ------
    ValueError
        If the tracker has no state with which it can continue from piece to piece.
    """
    found = as_tracker(tracker)
    if not isinstance(found, LaneTracker):
        raise ValueError(
            f"tracker: {type(found).__name__} cannot go on from piece to piece; it needs a "
            "file that is tracked as a whole"
        )
    return found


def as_trackers(trackers: Trackers) -> dict[str, Tracker]:
    """Trackers by name.

    Every function that takes several trackers takes them by this function.

    Parameters
    ----------
    trackers : mapping of str to Tracker or str, or sequence of str
        Each as for `as_tracker`. Trackers in a sequence of texts, or a text alone, are named by
        their texts.

    Raises
    ------
    TypeError
        If it is something else; names the entry.
    ValueError, RuleBaseError
        If there is no tracker, or a text stands there twice; as for `make_tracker`.
    """
    named: Mapping[str, Tracker | str]
    if isinstance(trackers, Mapping):
        named = trackers
    else:
        texts = [trackers] if isinstance(trackers, str) else _texts(trackers)
        named = {text: text for text in texts}
        doubled = [text for text in texts if texts.count(text) > 1]
        if doubled:
            raise ValueError(f"trackers: {doubled[0]!r} is given twice")
    if not named:
        raise ValueError("trackers: at least one is needed")
    return {name: as_tracker(each, f"trackers: {name!r}") for name, each in named.items()}


def _texts(trackers: object) -> list[str]:
    allowed = "trackers must be a mapping from names to trackers, or a sequence of texts"
    if not isinstance(trackers, Sequence):
        raise TypeError(f"{allowed}, got {specs.kind_of(trackers)}")
    for each in trackers:
        if not isinstance(each, str):
            raise TypeError(f"{allowed}; the sequence holds {specs.kind_of(each)}")
    return list(trackers)


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
        lists what is allowed.
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
    name, options = specs.split(spec, "tracker")
    try:
        tracker = _make(name, options)
    except RuleBaseError:
        raise  # its message has the place in the file
    except (TypeError, ValueError) as error:
        raise ValueError(f"tracker {spec!r}: {error}") from error
    if not isinstance(tracker, Tracker):
        raise ValueError(
            f"tracker {spec!r}: its plug-in made no tracker, but {specs.kind_of(tracker)}"
        )
    if isinstance(tracker, LaneTracker):
        tracker.remember_text(spec)
    return tracker


def tracker_of_rules(rules: RuleBase, options: Mapping[str, str]) -> Tracker:
    """Make a tracker of a rule base, with parameters as a user writes them after its name.

    Parameters
    ----------
    rules : RuleBase
    options : mapping of str to str
        Parameters of the scheduler and of `fuzzytrack.AlphaBetaTracker`.

    Raises
    ------
    ValueError
        If there is no such parameter, or a value does not fit; lists what is allowed.
    RuleBaseError
        If the rule base cannot schedule gains.
    """
    start, given = _start_parameters(), dict(options)
    scheduler = scheduler_of_rules(rules, given, start)
    made: Tracker = specs.call_with(AlphaBetaTracker, given, READERS, {"scheduler": scheduler})
    return made


def _make(name: str, options: dict[str, str]) -> Any:
    if not name:
        raise ValueError("a name is missing; for example stiffness-damping")
    kind = _kind(name)
    if kind == "tracker":
        factory = trackers.get(name)
        specs.check_options(options, specs.parameters_of(factory))
        return specs.call_with(factory, options, READERS)
    if kind is None and not specs.is_file(name):
        refuse_other_files(name)
        names = (*scheduling_rulebases(), *schedulers.names(), *trackers.names())
        raise ValueError(
            f"no such tracker{suggestion(name, names)}; or a file that ends in .yaml, .fis or .fll"
        )
    scheduler = take_scheduler(name, options, _start_parameters())
    return specs.call_with(AlphaBetaTracker, options, READERS, {"scheduler": scheduler})


def tracker_parameters(name: str) -> dict[str, inspect.Parameter]:
    """Parameters that a user may write after the name of a scheduler or tracker.

    Raises
    ------
    ValueError
        If there is no such scheduler or tracker; lists those that there are.
    """
    kind = _kind(name)
    if kind == "tracker":
        return specs.parameters_of(trackers.get(name))
    if kind == "scheduler":
        return {**specs.parameters_of(schedulers.get(name)), **_start_parameters()}
    names = (*schedulers.names(), *trackers.names())
    raise ValueError(f"no such tracker{suggestion(name, names)}; or a rule base, by name or file")


def _used(rules: RuleBase) -> tuple[str, ...]:
    """Parameters of the fuzzy scheduler that a rule base uses, spelled."""
    used = ("method", *read_settings(rules).outputs.parameters)
    parameters = specs.parameters_of(FuzzyScheduler)
    return specs.spelled({name: parameters[name] for name in used})


def _start_parameters() -> dict[str, inspect.Parameter]:
    return specs.parameters_of(AlphaBetaTracker, without="scheduler")


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
