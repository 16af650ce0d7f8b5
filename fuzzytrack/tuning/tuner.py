"""Tuning a tracker on data: searches on every fold, of the family and of its rivals."""

from __future__ import annotations

import datetime
import hashlib
import os
from collections.abc import Collection, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Any

import numpy as np

from fuzzytrack import specs
from fuzzytrack.fuzzy.loading import rulebase_path, shipped_rulebases
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.saving import dumps_rulebase
from fuzzytrack.io.reading import Reading
from fuzzytrack.recordings.judging import GateWidth
from fuzzytrack.recordings.preparation import shares_covariance, suited
from fuzzytrack.simulation.scenario import Scenario
from fuzzytrack.simulation.scenario_files import load_scenario, shipped_scenarios
from fuzzytrack.tasks import Progress, part
from fuzzytrack.trackers.catalog import as_tracker, tracker_of_rules
from fuzzytrack.tuning.candidates import Candidates
from fuzzytrack.tuning.criteria import CRITERIA, Criterion, Likelihood
from fuzzytrack.tuning.data import TuningData, joined, recorded, simulated
from fuzzytrack.tuning.folds import make_folds
from fuzzytrack.tuning.journal import Journal
from fuzzytrack.tuning.parameters import Numbers
from fuzzytrack.tuning.rulebase_numbers import RuleBaseNumbers, rulebase_numbers
from fuzzytrack.tuning.search import Search, run_searches, search_seed
from fuzzytrack.tuning.specifications import specification
from fuzzytrack.tuning.trial import Trials
from fuzzytrack.tuning.tuned import Row, Tuned, with_head
from fuzzytrack.version import __version__

__all__ = ["Source", "tune"]

#: What data come from; see `tune`.
Source = TuningData | Scenario | str | os.PathLike[str] | Mapping[str, Any]

# Trials of a search: so many, and so many more for each free number.
_TRIALS, _TRIALS_EACH = 60, 40
# Coordinates of all trials above which compiling saves time.
_COMPILE_ABOVE = 3_000_000
# All data are trained on.
_ALL = -1


def tune(
    data: Source | Sequence[Source],
    tracker: str | RuleBase,
    *,
    free: Collection[str] | None = None,
    truth: str | os.PathLike[str] | None = None,
    gate: GateWidth = "auto",
    reading: Reading | None = None,
    runs: int = 60,
    seed: int = 0,
    trials: int | None = None,
    folds: int = 5,
    criterion: str = "rms",
    executor: Executor | None = None,
    state: str | os.PathLike[str] | None = None,
    resume: bool = False,
    progress: Progress | None = None,
    **options: Any,
) -> Tuned:
    """Tune the numbers of a tracker on data, and judge it on data that it was not tuned on.

    Parameters
    ----------
    data : TuningData, Scenario, str or path, or sequence of these
        The name of a shipped scenario or a YAML file, whose runs are simulated with their truth; or
        recorded plots, as a file or a folder of them, or as columns in memory (a data frame or a
        mapping). Of several each counts alike: the RMS error is then the geometric mean of theirs.
    tracker : str or RuleBase
        A rule base, by its name or file, or a scheduler or tracker, as
        `fuzzytrack.trackers.catalog.make_tracker` reads it (``imm``,
        ``kalman-cv:sigma_w=10``), or ``kalata``: fixed gains by their tracking index. Numbers that
        it gives are where the search begins.
    free : collection of str, optional
        Which numbers are free. Of a rule base ``outputs`` (the levels of all outputs), ``sets``
        (the corners of the sets of inputs), ``normalization`` (the numbers of the scheduler
        settings), one variable, ``lag.ps`` or ``rho``; all of them unless given. Of a scheduler or
        tracker the names of its parameters; unless given, those of its family.
    truth : str or path, optional
        True positions of recorded plots: a file with the same columns and identities, or columns of
        the file of plots with commas between them; see `fuzzytrack.recordings.truth.read_truth`.
        Without them predictions are compared with the plots.
    gate : float, "auto" or None
        Recorded plots that the gate of `fuzzytrack.track` rejects are left out.
    reading : Reading, optional
        How recorded plots are read; in place of `options`.
    runs : int
        Number of runs of a scenario.
    seed : int
        Seed of the noise of a scenario, of the folds and of the searches. The same seed gives the
        same numbers, however many workers there are.
    trials : int, optional
        Trackers that each search tries; 60 and 40 more for each free number unless given.
    folds : int
        Number of folds. Each holds out some tracks or, of fewer than three tracks, some blocks of
        time.
    criterion : {"rms", "likelihood"}
        What is minimized: the RMS error of predictions, or the negative logarithm of the likelihood
        of the plots, for trackers that keep the variance of their innovations.
    executor : concurrent.futures.Executor, optional
        Runs the trials; in this process unless given.
    state : str or path, optional
        File in which the losses are kept, so that an interrupted search can be continued.
    resume : bool
        Whether to continue the searches whose losses `state` holds, if any.
    progress : callable, optional
        Called with the share of the trials that are done.
    **options
        How recorded plots are read, as for `fuzzytrack.track`: time, id, axes, polar, geodetic,
        sigma… Without `sigma` the standard deviation of the plots is estimated from them.

    Returns
    -------
    Tuned

    Raises
    ------
    DataError, RuleBaseError
        If the data hold too few plots, or the rule base cannot be read or schedule gains.
    ValueError
        If there is no such tracker, number or criterion, nothing is free or has an effect, the
        tracker needs `sigma` and there is none, `state` is of another search, or there is none to
        resume.
    TypeError
        If there is no such option.
    OSError
        If a file cannot be read or written.

    Notes
    -----
    On every fold, and on all data, the numbers are searched by CMA-ES (Hansen 2016) for the least
    value at the plots from the third of a track on, and so are those of two rivals: a fixed pair of
    gains (which has no likelihood), and a Kalman filter of nearly constant velocity. What is
    returned was tuned on all data; held-out errors are those of trackers that did not see them.
    """
    judged = _criterion(criterion)
    reading = Reading.of(**options) if reading is None else reading
    found = _data(data, runs, seed, reading=reading, truth=truth, gate=gate)
    candidates = _candidates(tracker, free, found)
    divided = make_folds(found, folds, seed)
    families = [candidates, *_rivals(candidates, found, judged)]
    planned = sum(_planned(family, trials) for family in families) * (divided.number + 1)
    compiled = planned * found.coordinates > _COMPILE_ABOVE
    run = Trials(found, divided, judged, compiled)
    _check_start(candidates, run)
    plans = tuple(
        _Plan(number, held)
        for held in (*range(divided.number), _ALL)
        for number in range(len(families))
    )
    journal = Journal.open(state, _job(run, families, plans, trials, seed), resume)
    # Trials that find out which numbers have an effect, one family after the other.
    ends = [0, *accumulate(1 + 2 * len(family.space.parameters) for family in families)]
    watch = progress or (lambda share: None)
    shares = [end / (ends[-1] + planned) for end in ends]
    (candidates, unused), *rivals = (
        _with_effect(family, run, part(watch, *between))
        for family, between in zip(families, pairwise(shares), strict=True)
    )
    families = [candidates, *(rival for rival, _ in rivals)]
    searches = [
        Search(families[p.family].space, search_seed(seed, k), _planned(families[p.family], trials))
        for k, p in enumerate(plans)
    ]
    work = _Work(run, tuple(families), plans)
    run_searches(searches, work.losses, executor, journal, part(watch, shares[-1], 1.0))
    best = {plan: search.best for plan, search in zip(plans, searches, strict=True)}
    rows = _rows(families, best, run)
    numbers = best[_Plan(0, _ALL)]
    tuned = Tuned(
        tracker=candidates.tracker(numbers),
        text=candidates.text(numbers),
        is_rulebase=isinstance(candidates, RuleBaseNumbers),
        parameters=_parameters(candidates),
        numbers=_named(candidates, numbers),
        start=_named(candidates, candidates.space.start),
        unused=unused,
        rows=rows,
        data=found.name,
        objective=_objective(run),
        folds=divided.number,
        units=divided.kind,
        plots=int(divided.plots.sum()),
        trials=sum(len(search.losses) for search in searches),
        seed=seed,
        notes=found.notes,
    )
    return replace(tuned, text=with_head(tuned.text, _head(tuned))) if tuned.is_rulebase else tuned


# -------------------------------------------------------------------- what is tuned


def _data(data: Source | Sequence[Source], runs: int, seed: int, **recording: Any) -> TuningData:
    if isinstance(data, Sequence) and not isinstance(data, str):
        if len(data) == 0:
            raise ValueError("data: at least one file or scenario is needed")
        return joined([_data(each, runs, seed, **recording) for each in data])
    if isinstance(data, TuningData):
        return data
    if isinstance(data, str) and (data in shipped_scenarios() or specs.is_file(data)):
        data = load_scenario(data)
    return (
        simulated(data, runs, seed) if isinstance(data, Scenario) else recorded(data, **recording)
    )


def _candidates(
    tracker: str | RuleBase, free: Collection[str] | None, data: TuningData
) -> Candidates:
    if isinstance(tracker, RuleBase):
        own = data.axes_differ and shares_covariance("", tracker_of_rules(tracker, {}))
        options = {"axes": "own"} if own else {}
        return rulebase_numbers(dumps_rulebase(tracker), tracker.name, options, free)
    name, options = specs.split(tracker, "tracker")
    if specs.is_file(name) or name in shipped_rulebases():
        # As it will be run on such plots.
        spec, _ = suited(tracker, as_tracker(tracker), axes_differ=data.axes_differ)
        _, options = specs.split(spec, "tracker")
        path = rulebase_path(Path(name) if specs.is_file(name) else name)
        with open(path, encoding="utf-8", newline="") as stream:
            text = stream.read()
        return rulebase_numbers(text, name, options, free)
    return specification(tracker, free, data.noise / data.interval**2)


def _parameters(candidates: Candidates) -> str:
    """Parameters that a rule base is given with, which its text does not hold."""
    options = candidates.options if isinstance(candidates, RuleBaseNumbers) else ()
    return ":".join(f"{name}={value}" for name, value in options)


def _rivals(candidates: Candidates, data: TuningData, criterion: Criterion) -> list[Candidates]:
    """The best fixed pair and the Kalman filter, unless they are what is tuned."""
    unit, likely = data.noise / data.interval**2, isinstance(criterion, Likelihood)
    kalman, free = "kalman-cv", ["sigma_v"]
    if not data.has_sigma:
        kalman += f":sigma_w={data.noise:.6g}"
        # Errors depend on the ratio of both only.
        free += ["sigma_w"] * likely
    rivals = {"Kalman filter (CV)": specification(kalman, free, unit)}
    if not likely:
        rivals = {"best fixed pair": specification("fixed", None, unit), **rivals}
    return [
        replace(rival, title=title)
        for title, rival in rivals.items()
        if candidates.title.partition(":")[0] != rival.name
    ]


def _criterion(name: str) -> Criterion:
    if name not in CRITERIA:
        raise ValueError(f"criterion: unknown {name!r}; one of {', '.join(CRITERIA)}")
    return CRITERIA[name]


def _objective(run: Trials) -> str:
    """What is minimized, in words."""
    if isinstance(run.criterion, Likelihood):
        return "negative log likelihood of the plots"
    return f"RMS of {'predictions, against the truth' if run.data.has_truth else 'innovations'}"


def _check_start(candidates: Candidates, run: Trials) -> None:
    """Raise ValueError if the tracker where the search begins cannot be judged."""
    tracker: Any = candidates.tracker(candidates.space.start)
    if getattr(tracker, "needs_sigma", False) and not run.data.has_sigma:
        reasons = "; ".join(run.data.notes)
        raise ValueError(
            f"sigma: {candidates.title} needs the standard deviation of the plots, which the data "
            f"do not have{f' ({reasons})' if reasons else ''}"
        )
    # In plain Python: code for all that a search varies is compiled with the first numbers that do.
    (sums,) = replace(run, compiled=False).sums(candidates, [candidates.space.start])
    if isinstance(run.criterion, Likelihood) and not np.isfinite(sums).all():
        raise ValueError(
            f"criterion: {candidates.title} does not keep the variance of its innovations, which "
            "a likelihood needs; use rms"
        )


def _with_effect(
    candidates: Candidates, run: Trials, progress: Progress
) -> tuple[Candidates, tuple[str, ...]]:
    """The same with those numbers free that have an effect, and the names of the others."""
    space = candidates.space
    places = [[0.0] * len(space.parameters)]
    for k in range(len(space.parameters)):
        for step in (-1.0, 1.0):
            places.append([step * (j == k) for j in range(len(space.parameters))])
    bounds = space.bounds
    trials = [space.numbers(np.clip(place, bounds[:, 0], bounds[:, 1])) for place in places]
    start, *moved = run.sums(candidates, trials, progress)
    used = [
        k
        for k in range(len(space.parameters))
        if any(not np.array_equal(start, moved[2 * k + j]) for j in (0, 1))
    ]
    names = [p.name for p in space.parameters]
    if not used:
        raise ValueError(
            f"free: {', '.join(names)}: without an effect on these data; there is nothing to tune"
        )
    unused = tuple(name for k, name in enumerate(names) if k not in used)
    return candidates.restricted(used), unused


# -------------------------------------------------------------------- the searches


@dataclass(frozen=True)
class _Plan:
    """A search: which family, and which fold it does not see."""

    family: int
    held: int


@dataclass(frozen=True, eq=False)
class _Work:
    """What a worker needs for a generation of any search."""

    run: Trials
    families: tuple[Candidates, ...]
    plans: tuple[_Plan, ...]

    def losses(self, task: tuple[int, tuple[Numbers, ...]]) -> list[float]:
        number, trials = task
        plan = self.plans[number]
        return self.run.losses(self.families[plan.family], trials, plan.held)


def _planned(family: Candidates, trials: int | None) -> int:
    return trials or _TRIALS + _TRIALS_EACH * len(family.space.parameters)


def _job(
    run: Trials,
    families: Sequence[Candidates],
    plans: Sequence[_Plan],
    trials: int | None,
    seed: int,
) -> dict[str, str]:
    """Everything that the losses depend on, as text."""
    digest = hashlib.sha256()
    for track in run.data.tracks:
        for values in (track.time, track.plots, track.truth, track.sigma):
            digest.update(b"-" if values is None else np.ascontiguousarray(values).tobytes())
    start = families[0].space.start
    return {
        "fuzzytrack": __version__,
        "seed": str(seed),
        "criterion": type(run.criterion).__name__,
        "data": f"{run.data.name} {digest.hexdigest()[:16]}",
        "tracker": hashlib.sha256(families[0].text(start).encode()).hexdigest()[:16],
        "parameters": _parameters(families[0]) or "none",
        "free numbers": ", ".join(p.name for p in families[0].space.parameters),
        "searches": str(len(plans)),
        "trials": str(trials),
    }


# -------------------------------------------------------------------- what is reported


def _rows(
    families: Sequence[Candidates], best: dict[_Plan, Numbers], run: Trials
) -> tuple[Row, ...]:
    folds = run.folds
    named: list[tuple[str, int, bool]] = [("start", 0, False)]
    named += [(family.title, k, True) for k, family in enumerate(families[1:], 1)]
    named.append(("tuned", 0, True))
    held, training = {}, {}
    for name, number, is_tuned in named:
        family = families[number]
        tried = [
            best[_Plan(number, k)] if is_tuned else family.space.start for k in range(folds.number)
        ]
        sums = run.sums(family, tried)
        held[name] = np.array([sums[k][unit] for unit, k in enumerate(folds.fold)])
        levels = [run.criterion.levels(s, folds, folds.fold != k) for k, s in enumerate(sums)]
        training[name] = run.criterion.value(sum(levels) / len(levels))
    rows, every = [], np.ones(len(folds.fold), dtype=np.bool_)
    for name, number, is_tuned in named:
        value = run.criterion.value(run.criterion.levels(held[name], folds, every))
        change = run.criterion.compare(held["tuned"], held[name], folds)
        last = name == "tuned"
        text = "" if last else run.criterion.written(change)
        family = families[number]
        numbers = best[_Plan(number, _ALL)] if is_tuned else family.space.start
        own = _named(family, numbers)
        rows.append(Row(name, training[name], value, None if last else change, text, own))
    return tuple(rows)


def _named(family: Candidates, numbers: Numbers) -> dict[str, float]:
    return {p.name: n for p, n in zip(family.space.parameters, numbers, strict=True)}


def _head(tuned: Tuned) -> list[str]:
    """What the head of a tuned rule base says."""
    given = [f"Give the same parameters with it: {tuned.parameters}."] if tuned.parameters else []
    return [
        f"Tuned on {tuned.data} with seed {tuned.seed} by fuzzytrack {__version__}, "
        f"{datetime.date.today().isoformat()}.",
        f"Objective: {tuned.objective}, {tuned.plots} plots; {tuned.folds} folds by {tuned.units}.",
        f"Held-out change against the start: {tuned.rows[0].change_text}; "
        f"free: {', '.join(tuned.numbers)}.",
        *given,
    ]
