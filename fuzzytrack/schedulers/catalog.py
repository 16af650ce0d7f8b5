"""Schedulers by name: the texts that name one."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from fuzzytrack import specs
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.loading import load_rulebase, shipped_rulebases
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.schedulers.base import GainScheduler, schedulers
from fuzzytrack.schedulers.fuzzy import FuzzyScheduler
from fuzzytrack.yamltree import suggestion

__all__ = [
    "READERS",
    "as_scheduler",
    "make_scheduler",
    "scheduler_of_rules",
    "scheduling_rulebases",
    "take_scheduler",
]


def as_scheduler(scheduler: GainScheduler | str) -> GainScheduler:
    """The scheduler itself, or the one that a text names; see `make_scheduler`.

    Raises
    ------
    TypeError
        If it is neither.
    """
    if isinstance(scheduler, str):
        return make_scheduler(scheduler)
    if not isinstance(scheduler, GainScheduler):
        raise TypeError(
            "scheduler must be a GainScheduler, or a text such as 'fixed:alpha=0.5:beta=0.2', "
            f"got {type(scheduler).__name__}"
        )
    return scheduler


def make_scheduler(spec: str) -> GainScheduler:
    """Make a scheduler of what a user wrote.

    Parameters
    ----------
    spec : str
        A rule-base file (``my.yaml``), the name of a shipped rule base (``stiffness-damping``) or
        of a scheduler (``fixed``), and its parameters after it, each as ``:name=value``.

    Raises
    ------
    ValueError
        If there is no such name or parameter, a parameter is missing, or a value does not fit;
        lists what is allowed.
    RuleBaseError
        If a rule base cannot be read, or cannot schedule gains.

    Examples
    --------
    >>> from fuzzytrack.schedulers.catalog import make_scheduler
    >>> make_scheduler("fixed:alpha=0.5:beta=0.2")
    FixedGains(0.5, 0.2)
    """
    name, options = specs.split(spec, "scheduler")
    try:
        return take_scheduler(name, options)
    except RuleBaseError:
        raise  # its message has the place in the file
    except (TypeError, ValueError) as error:
        raise ValueError(f"scheduler {spec!r}: {error}") from error


def take_scheduler(
    name: str, options: dict[str, str], others: Mapping[str, inspect.Parameter] | None = None
) -> GainScheduler:
    """Make a scheduler by name or file, of its own options, which are taken from `options`.

    Parameters
    ----------
    name : str
    options : dict of str to str
        Parameters as words.
    others : mapping, optional
        Parameters that may be among the options too, and stay there.
    """
    if specs.is_file(name) or name in shipped_rulebases():
        rules = load_rulebase(Path(name) if specs.is_file(name) else name)
        return scheduler_of_rules(rules, options, others)
    if name not in schedulers.names():
        names = (*scheduling_rulebases(), *schedulers.names())
        raise ValueError(
            f"no such scheduler{suggestion(name, names)}; or a file that ends in .yaml, .fis "
            "or .fll"
        )
    return _take(schedulers.get(name), {}, options, others)


def scheduler_of_rules(
    rules: RuleBase, options: dict[str, str], others: Mapping[str, inspect.Parameter] | None = None
) -> GainScheduler:
    """Make a scheduler of a rule base, of its own options, which are taken from `options`.

    Parameters
    ----------
    rules : RuleBase
    options, others
        As for `take_scheduler`.
    """
    return _take(FuzzyScheduler, {"rules": rules}, options, others)


def _take(
    factory: Callable[..., Any],
    given: dict[str, Any],
    options: dict[str, str],
    others: Mapping[str, inspect.Parameter] | None,
) -> GainScheduler:
    parameters = {k: p for k, p in specs.parameters_of(factory).items() if k not in given}
    specs.check_options(options, {**parameters, **(others or {})})
    own = {key: options.pop(key) for key in tuple(options) if key in parameters}
    made: GainScheduler = specs.call_with(factory, own, READERS, given, others)
    return made


def scheduling_rulebases() -> tuple[str, ...]:
    """Shipped rule bases that schedule gains."""
    return tuple(name for name in shipped_rulebases() if load_rulebase(name).scheduler)


#: How parameters that are rule bases or schedulers are read.
READERS: specs.Readers = {RuleBase: load_rulebase, GainScheduler: make_scheduler}
