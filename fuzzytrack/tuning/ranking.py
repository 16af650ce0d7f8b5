"""Trackers ranked on random tracks, each tuned for every set of them and for all sets at once.

A tracker with numbers in it can only be judged when they are tuned; `tune` does that, and `rank`
measures tuned trackers on fresh tracks.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fuzzytrack.arrays import Array
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
from fuzzytrack.simulation.published import TRACK_SETS, TrackSet, track_set
from fuzzytrack.tasks import Progress
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.bank import ParallelBank
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.imm import InteractingModels
from fuzzytrack.trackers.window_search import WindowSearch

__all__ = ["FAMILIES", "Family", "Ranked", "prediction_mse", "rank", "stretched", "tune"]

Numbers = Sequence[float]


@dataclass(frozen=True)
class Family:
    """Trackers of one kind, told apart by numbers.

    Attributes
    ----------
    make : callable
        Tracker with these numbers; a ValueError if there is none.
    start : tuple of float
        Numbers to start tuning at; empty if there is nothing to tune.
    low, high : tuple of float
        Limits of the numbers.
    """

    make: Callable[[Numbers], Tracker]
    start: tuple[float, ...] = ()
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()


def stretched(rules: RuleBase, limits: Mapping[str, tuple[float, float]]) -> RuleBase:
    """Rule base with the universes of some outputs stretched to new limits, and their sets along.

    Parameters
    ----------
    rules : RuleBase
    limits : mapping of str to (low, high)
        New limits of outputs, by name.

    Raises
    ------
    RuleBaseError
        If a limit is not below the other.
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
    # Both ends are met exactly.
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
    """The shipped schedule with other numbers: ρ, scale, and four levels of stiffness."""
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
        return InteractingModels(quiet, hard, quiet_stay, hard_stay, maneuver, sigma_w=1.0)

    return make


#: Families that are ranked. The noise has a standard deviation of 1, the time between scans is 1.
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


def prediction_mse(tracker: Tracker, tracks: TrackSet, seed: int) -> Array:
    """Mean squared error of the predictions of each track, with noise of standard deviation 1.

    Parameters
    ----------
    tracker : Tracker
    tracks : TrackSet
    seed : int
        Seed of the noise; the same noise for every tracker.

    Returns
    -------
    ndarray, shape (n_tracks,)
        Mean over the scored scans of the squared distance, in units of the noise's variance.
    """
    noise = np.random.default_rng([seed, TRACK_SETS.index(tracks.name)])
    plots = tracks.position + noise.standard_normal(tracks.position.shape)
    predicted = tracker.run(tracks.time, plots, 1.0).predicted
    error = (predicted - tracks.position)[tracks.first_scored :]
    return np.asarray((error**2).sum(axis=-1).mean(axis=0))


def tune(
    family: Family,
    sets: Sequence[TrackSet],
    seed: int,
    evaluations: int = 200,
    progress: Progress | None = None,
) -> tuple[float, ...]:
    """Numbers with the least geometric mean of the RMSE over some sets of tracks.

    Parameters
    ----------
    family : Family
        With one number to tune at least.
    sets : sequence of TrackSet
    seed : int
        Seed of the noise.
    evaluations : int
        Number of trackers to try.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    tuple of float

    Notes
    -----
    Nelder and Mead's simplex in the logarithms of the numbers: it finds a local optimum.
    """
    from scipy.optimize import minimize

    low, high = np.log(family.low), np.log(family.high)
    tried = 0

    def numbers(place: Array) -> tuple[float, ...]:
        inside = np.clip(place, 0.0, 1.0)
        return tuple(float(x) for x in np.exp(low + inside * (high - low)))

    def loss(place: Array) -> float:
        nonlocal tried
        tried += 1
        if progress is not None:
            progress(min(1.0, tried / evaluations))
        try:
            tracker = family.make(numbers(place))
        except ValueError:
            return math.inf
        means = [prediction_mse(tracker, tracks, seed).mean() for tracks in sets]
        # What lies outside is as good as the edge, but a little worse the farther out.
        outside = np.abs(place - np.clip(place, 0.0, 1.0)).sum()
        return float(np.log(means).mean() / 2 + outside)

    start = (np.log(family.start) - low) / (high - low)
    simplex = np.vstack([start, *(start + 0.15 * row for row in np.eye(len(start)))])
    found = minimize(
        loss,
        start,
        method="Nelder-Mead",
        options={"maxfev": evaluations, "initial_simplex": simplex, "xatol": 1e-3, "fatol": 1e-5},
    )
    return numbers(found.x)


@dataclass(frozen=True, eq=False)
class Ranked:
    """One family, measured.

    Attributes
    ----------
    name : str
        Of the family.
    own : dict of str to float
        RMSE in each set, tuned for it, in standard deviations of the noise.
    single : dict of str to float
        RMSE in each set, tuned once for all of them.
    own_change, single_change : float
        Change of the geometric mean over the sets against the family held as reference.
    single_error : float
        Standard error of `single_change`, from track to track.
    """

    name: str
    own: dict[str, float]
    single: dict[str, float]
    own_change: float
    single_change: float
    single_error: float


def rank(
    tuned: Mapping[str, Mapping[str, Numbers]],
    tracks: int,
    seed: int,
    reference: str = "fixed α-β",
    progress: Progress | None = None,
) -> list[Ranked]:
    """Measure families of trackers on fresh tracks.

    Parameters
    ----------
    tuned : mapping of str to mapping of str to numbers
        For each family, by name, its numbers for ``report``, ``mixed``, ``strong`` and ``all``; an
        empty mapping for one without numbers.
    tracks : int
        Number of tracks in each set.
    seed : int
        Seed of tracks and noise: another than that of the tuning.
    reference : str
        Family whose error the others' are held against.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    list of Ranked
        The best with a single tuning first.

    Raises
    ------
    ValueError
        If a family is unknown, or the reference is none of them.
    """
    for name in (reference, *tuned):
        if name not in FAMILIES or name not in tuned:
            raise ValueError(f"tuned: needs families out of {', '.join(FAMILIES)}; got {name!r}")
    sets = [track_set(name, tracks, seed) for name in TRACK_SETS]
    errors: dict[tuple[str, str], list[Array]] = {}
    for number, (name, numbers) in enumerate(tuned.items(), 1):
        for kind in ("own", "single"):
            errors[name, kind] = [
                prediction_mse(_made(name, numbers, kind, s.name), s, seed) for s in sets
            ]
        if progress is not None:
            progress(number / len(tuned))
    found = [_ranked(name, errors, reference) for name in tuned]
    return sorted(found, key=lambda each: each.single_change)


def _made(name: str, numbers: Mapping[str, Numbers], kind: str, set_name: str) -> Tracker:
    family = FAMILIES[name]
    return family.make(numbers[set_name if kind == "own" else "all"] if family.start else ())


def _ranked(name: str, errors: dict[tuple[str, str], list[Array]], reference: str) -> Ranked:
    def change(kind: str) -> tuple[float, float]:
        logs, variance = 0.0, 0.0
        for mine, theirs in zip(errors[name, kind], errors[reference, kind], strict=True):
            logs += math.log(mine.mean() / theirs.mean()) / 2
            # To first order; the tracks are the same, so their differences count.
            spread = mine / mine.mean() - theirs / theirs.mean()
            variance += spread.var() / (4 * len(spread))
        sets = len(errors[name, kind])
        return math.exp(logs / sets) - 1, math.sqrt(variance) / sets

    def roots(kind: str) -> dict[str, float]:
        means = (math.sqrt(each.mean()) for each in errors[name, kind])
        return dict(zip(TRACK_SETS, means, strict=True))

    return Ranked(name, roots("own"), roots("single"), change("own")[0], *change("single"))
