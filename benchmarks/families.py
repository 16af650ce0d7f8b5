"""Families of trackers that are tuned for the ranking, with the limits of their parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.loading import load_rulebase
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.variable import Universe
from fuzzytrack.schedulers import (
    FadingMemory,
    FixedGains,
    FuzzyScheduler,
    InnovationScheduler,
    KalmanCA,
    KalmanCV,
    QualityGains,
)
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.bank import ParallelBank
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.imm import InteractingPair
from fuzzytrack.trackers.window_search import WindowSearch

__all__ = ["FAMILIES", "Family", "Numbers", "stretched"]

#: Parameters of a tracker.
Numbers = Sequence[float]


@dataclass(frozen=True)
class Family:
    """Trackers of one kind that differ in their parameters only.

    Attributes
    ----------
    make : callable
        Tracker with these parameters; a ValueError if they make none.
    start : tuple of float
        Parameters to start tuning at; empty if there is nothing to tune.
    low, high : tuple of float
        Limits of the parameters.
    """

    make: Callable[[Numbers], Tracker]
    start: tuple[float, ...] = ()
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()


def stretched(rules: RuleBase, limits: Mapping[str, tuple[float, float]]) -> RuleBase:
    """Rule base whose outputs have new limits, their universes and sets stretched to them.

    Parameters
    ----------
    rules : RuleBase
    limits : mapping of str to (low, high)
        New limits of outputs, by name.

    Raises
    ------
    RuleBaseError
        If a lower limit is not below the upper one.
    """
    outputs = []
    for variable in rules.outputs:
        universe = variable.universe
        if variable.name not in limits:
            outputs.append(variable)
            continue
        low, high = limits[variable.name]
        if not low < high:
            raise RuleBaseError(f"limits of {variable.name} must rise, got {low:g} to {high:g}")
        sets = tuple(
            replace(s, parameters=tuple(_moved(p, universe, low, high) for p in s.parameters))
            for s in variable.sets
        )
        outputs.append(replace(variable, universe=replace(universe, low=low, high=high), sets=sets))
    return replace(rules, outputs=tuple(outputs))


def _moved(value: float, universe: Universe, low: float, high: float) -> float:
    part = (value - universe.low) / (universe.high - universe.low)
    # Gives both ends exactly.
    return (1 - part) * low + part * high


def _fuzzy(name: str) -> Callable[[Numbers], Tracker]:
    return lambda numbers: AlphaBetaTracker(FuzzyScheduler(load_rulebase(name)))


def _limits(name: str, *outputs: str) -> Callable[[Numbers], Tracker]:
    def make(numbers: Numbers) -> Tracker:
        pairs = zip(numbers[::2], numbers[1::2], strict=True)
        rules = stretched(load_rulebase(name), dict(zip(outputs, pairs, strict=True)))
        return AlphaBetaTracker(FuzzyScheduler(rules))

    return make


def _omega(numbers: Numbers) -> Tracker:
    """The shipped omega-schedule with other ρ, scale and four levels of stiffness."""
    rho, scale, *levels = numbers
    if sorted(levels) != levels:
        raise ValueError(f"levels must rise, got {levels}")
    rules = load_rulebase("omega-schedule")
    (lag,) = rules.inputs
    factor = scale / lag.universe.high
    sets = [replace(s, parameters=tuple(factor * p for p in s.parameters)) for s in lag.sets]
    universe = replace(lag.universe, low=-scale, high=scale)
    rules = stretched(rules, {"stiffness": (levels[0], levels[-1])})
    (stiffness,) = rules.outputs
    peaks = zip(stiffness.sets, levels, strict=True)
    found = replace(
        rules,
        inputs=(replace(lag, universe=universe, sets=tuple(sets)),),
        outputs=(replace(stiffness, sets=tuple(replace(s, parameters=(p,)) for s, p in peaks)),),
        scheduler=tuple({**dict(rules.scheduler), "rho": str(rho)}.items()),
    )
    return AlphaBetaTracker(FuzzyScheduler(found))


def _imm(maneuver: str) -> Callable[[Numbers], Tracker]:
    def make(numbers: Numbers) -> Tracker:
        quiet, hard, quiet_stay, hard_stay = numbers
        return InteractingPair(quiet, hard, quiet_stay, hard_stay, maneuver, sigma_w=1.0)

    return make


#: Families that are ranked, for noise with a standard deviation of 1 and a time between scans of 1.
FAMILIES: dict[str, Family] = {
    "fixed α-β, published": Family(lambda n: AlphaBetaTracker(FixedGains(0.5377, 0.2018))),
    "stiffness-damping": Family(_fuzzy("stiffness-damping")),
    "stiffness-damping-wide": Family(_fuzzy("stiffness-damping-wide")),
    "chan-style": Family(_fuzzy("chan-style")),
    "omega-schedule": Family(_fuzzy("omega-schedule")),
    "fixed α-β": Family(
        lambda n: AlphaBetaTracker(FixedGains(*n)), (0.54, 0.4), (0.1, 0.02), (1.0, 1.6)
    ),
    "fading memory": Family(
        lambda n: AlphaBetaTracker(FadingMemory(n[0])), (0.5,), (0.05,), (0.95,)
    ),
    "Kalman CV": Family(
        lambda n: AlphaBetaTracker(KalmanCV(n[0], sigma_w=1.0)), (0.5,), (0.01,), (5.0,)
    ),
    "Kalman CA": Family(
        lambda n: AlphaBetaTracker(KalmanCA(n[0], n[1], sigma_w=1.0)),
        (0.2, 0.5), (0.005, 0.005), (3.0, 5.0),
    ),
    "innovation variance": Family(
        lambda n: AlphaBetaTracker(InnovationScheduler(n[0], window=round(n[1]))),
        (0.3, 8.0), (0.02, 2.0), (5.0, 24.0),
    ),
    "track quality": Family(
        lambda n: AlphaBetaTracker(QualityGains(cap=n[0])), (5.0,), (1.0,), (30.0,)
    ),
    "stiffness-damping, limits": Family(
        _limits("stiffness-damping", "stiffness", "damping"),
        (0.3, 0.6, 0.6, 0.9), (0.02, 0.03, 0.02, 0.03), (1.2, 1.5, 1.5, 1.8),
    ),
    "bank, soft": Family(
        lambda n: ParallelBank(n[0], n[1], forget=n[2]),
        (0.2, 0.9, 0.9), (0.02, 0.1, 0.3), (0.9, 1.15, 0.999),
    ),
    "window search": Family(
        lambda n: WindowSearch(window=12, alpha=n[0]), (0.5,), (0.05,), (1.0,)
    ),
    "omega-schedule, tuned": Family(
        _omega, (0.774, 2.06, 0.29, 0.308, 0.556, 0.778),
        (0.3, 0.5, 0.05, 0.06, 0.07, 0.08), (0.95, 6.0, 1.2, 1.3, 1.5, 2.0),
    ),
    "IMM CV/CV": Family(
        _imm("cv"), (0.05, 1.0, 0.95, 0.9), (0.002, 0.05, 0.5, 0.3), (1.0, 6.0, 0.999, 0.999)
    ),
    "IMM CV/CA": Family(
        _imm("ca"), (0.05, 0.4, 0.95, 0.9), (0.002, 0.02, 0.5, 0.3), (1.0, 4.0, 0.999, 0.999)
    ),
}  # fmt: skip
