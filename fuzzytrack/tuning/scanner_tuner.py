"""Tuning a configuration of a scan tracker on scans with truth."""

from __future__ import annotations

import datetime
import hashlib
import math
import os
from collections.abc import Collection, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.kernels.shared_code import SharedCode
from fuzzytrack.scan.scan_pass import learn_code, sharing_code
from fuzzytrack.scan.scan_tracker import ScanTracker
from fuzzytrack.scan.scanners.catalog import as_scanner, configuration_of, scanner_of
from fuzzytrack.scan.scanners.loading import dumps, shipped_scanners
from fuzzytrack.scan.scanners.reader import Configuration
from fuzzytrack.tasks import Progress
from fuzzytrack.tuning.journal import Journal
from fuzzytrack.tuning.parameters import Numbers
from fuzzytrack.tuning.scan_criteria import ScanCriterion, scan_criterion
from fuzzytrack.tuning.scan_recordings import ScanRecording
from fuzzytrack.tuning.scanner_numbers import ScannerNumbers, scanner_numbers
from fuzzytrack.tuning.search import Search, run_searches, search_seed
from fuzzytrack.tuning.trial import REFUSED
from fuzzytrack.tuning.tuned import with_head
from fuzzytrack.tuning.tuned_scanner import GroupRow, TunedScanner
from fuzzytrack.version import __version__

__all__ = ["tune_scanner"]

# Trials of a search: so many, and so many more for each free number.
_TRIALS, _TRIALS_EACH = 60, 40


def tune_scanner(
    recordings: Sequence[ScanRecording],
    scanner: ScanTracker | str | os.PathLike[str],
    *,
    free: Collection[str] | None = None,
    metric: str = "ospa",
    trials: int | None = None,
    seed: int = 0,
    leave_one_out: bool = False,
    executor: Executor | None = None,
    state: str | os.PathLike[str] | None = None,
    resume: bool = False,
    progress: Progress | None = None,
    name: str | None = None,
) -> TunedScanner:
    """Tune numbers of a configuration on scans with their truth.

    Parameters
    ----------
    recordings : sequence of ScanRecording
        Each group counts alike, and in it each recording.
    scanner : ScanTracker, str or path
        A configuration, by its name or file; its numbers are where the search begins.
    free : collection of str, optional
        Which numbers are free: ``clutter.cell``, or ``clutter`` for all of a part; all of them
        unless given. Their limits are those that the parts declare, within a factor of 30.
    metric : str
        What is minimized: ``ospa``, any other of `fuzzytrack.scoring.METRICS` (of which the most is
        taken where that is best), or ``study``, the weighted sum
        OSPA + .5 switches + .05 moving false + .01 false (s/min) + .2 breaks.
    trials : int, optional
        Configurations that a search tries; 60 and 40 more for each free number unless given.
    seed : int
        The same seed gives the same numbers, however many workers there are.
    leave_one_out : bool
        Whether there is also a search for each group that does not see it, by which it is judged.
    executor : concurrent.futures.Executor, optional
        Runs the trials; in this process unless given.
    state : str or path, optional
        File in which the losses are kept, so that an interrupted search can be continued.
    resume : bool
        Whether to continue the searches whose losses `state` holds.
    progress : callable, optional
        Called with the share of the trials that are done.
    name : str, optional
        Name of the tuned configuration; that of the one it begins with and ``-tuned`` unless given.

    Returns
    -------
    TunedScanner

    Raises
    ------
    ScannerError
        If there is no such configuration.
    ValueError
        If there is no such number or metric, nothing is free, there is no recording, or one group
        only where one is to be left out.

    Notes
    -----
    Searches are by CMA-ES (Hansen 2016), in the logarithm of positive numbers and the odds of
    probabilities. Trackers that differ in numbers only share compiled code.
    """
    if not recordings:
        raise ValueError("recordings: at least one is needed")
    criterion = scan_criterion(metric)
    start = configuration_of(as_scanner(scanner))
    numbers = scanner_numbers(start, free)
    groups = tuple(dict.fromkeys(each.group for each in recordings))
    if leave_one_out and len(groups) < 2:
        raise ValueError(f"leave_one_out: needs two groups of recordings, got {groups[0]!r} only")
    run = _Trials(_with_lags(recordings, start), groups, criterion)
    before = run.values(numbers, [numbers.space.start])[0]
    if not np.isfinite(before).all():
        worst = groups[int(np.flatnonzero(~np.isfinite(before))[0])]
        raise DataError(
            f"{worst}: {criterion.text} of {start.name} is not a number; is the truth at the times "
            "of the scans?"
        )
    planned = trials or _TRIALS + _TRIALS_EACH * len(numbers.space.parameters)
    held = [None, *(range(len(groups)) if leave_one_out else ())]
    searches = [Search(numbers.space, search_seed(seed, k), planned) for k in range(len(held))]
    journal = Journal.open(state, _job(run, numbers, planned, seed, len(held)), resume)
    run_searches(searches, _Work(run, numbers, tuple(held)).losses, executor, journal, progress)
    best = searches[0].best
    after = run.values(numbers, [best])[0]
    out = [run.values(numbers, [s.best])[0][k] for k, s in enumerate(searches[1:])]
    configuration = numbers.configuration(best)
    based_on = start.name if start.name in shipped_scanners() else ""
    tuned = replace(configuration, name=name or f"{start.name}-tuned", based_on=based_on)
    rows = tuple(
        GroupRow(group, float(before[k]), float(after[k]), float(out[k]) if leave_one_out else None)
        for k, group in enumerate(groups)
    )
    found = TunedScanner(
        tracker=scanner_of(tuned),
        text=dumps(tuned),
        start_name=start.name,
        numbers=numbers.named(best),
        start=numbers.named(numbers.space.start),
        rows=rows,
        metric=metric,
        objective=criterion.text,
        recordings=len(recordings),
        trials=sum(len(search.losses) for search in searches),
        seed=seed,
    )
    return replace(found, text=with_head(found.text, _head(found)))


def _with_lags(
    recordings: Sequence[ScanRecording], start: Configuration
) -> tuple[tuple[ScanRecording, float | None], ...]:
    """Recordings with the lag of their clocks, fitted once: a search must not fit it to itself."""
    found = []
    tracker = scanner_of(start)
    for each in recordings:
        lag = each.lag
        if lag == "auto":
            lag = each.scores(tracker.run(each.scans), "auto").lag
        found.append((each, None if lag is None else float(lag)))
    return tuple(found)


@dataclass(frozen=True, eq=False)
class _Trials:
    """Runs configurations on all recordings; can be sent to another process."""

    recordings: tuple[tuple[ScanRecording, float | None], ...]
    groups: tuple[str, ...]
    criterion: ScanCriterion

    def values(self, numbers: ScannerNumbers, trials: Sequence[Numbers]) -> list[Array]:
        """Mean of the criterion in each group, for configurations with some numbers."""
        trackers = [_tracker(numbers, each) for each in trials]
        code = _shared_code(numbers.start.parts)
        for tracker in trackers:
            if tracker is not None:
                learn_code(tracker, code)
        with sharing_code(code):
            return [self._values(tracker) for tracker in trackers]

    def _values(self, tracker: ScanTracker | None) -> Array:
        found: dict[str, list[float]] = {group: [] for group in self.groups}
        for recording, lag in self.recordings:
            value = math.inf
            if tracker is not None:
                metrics = recording.metrics(tracker.run(recording.scans), lag)
                value = self.criterion.value(metrics)
            found[recording.group].append(value)
        return np.array([float(np.mean(each)) for each in found.values()])


@dataclass(frozen=True, eq=False)
class _Work:
    """What a worker needs for a generation of any search."""

    run: _Trials
    numbers: ScannerNumbers
    held: tuple[int | None, ...]

    def losses(self, task: tuple[int, tuple[Numbers, ...]]) -> list[float]:
        number, trials = task
        kept = [k for k in range(len(self.run.groups)) if k != self.held[number]]
        means = [float(values[kept].mean()) for values in self.run.values(self.numbers, trials)]
        return [mean if math.isfinite(mean) else REFUSED for mean in means]


def _tracker(numbers: ScannerNumbers, trial: Numbers) -> ScanTracker | None:
    try:
        return scanner_of(numbers.configuration(trial))
    except ValueError:
        return None


@cache
def _shared_code(parts: object) -> SharedCode:
    """Compiled code of this process, for all configurations of the same parts."""
    return SharedCode()


def _job(
    run: _Trials, numbers: ScannerNumbers, trials: int, seed: int, searches: int
) -> dict[str, str]:
    """Everything that the losses depend on, as text."""
    digest = hashlib.sha256("".join(each.digest for each, _ in run.recordings).encode())
    return {
        "fuzzytrack": __version__,
        "seed": str(seed),
        "metric": run.criterion.text,
        "recordings": f"{len(run.recordings)}, {digest.hexdigest()[:16]}",
        "configuration": hashlib.sha256(repr(numbers.start.parts).encode()).hexdigest()[:16],
        "free numbers": ", ".join(p.name for p in numbers.space.parameters),
        "searches": str(searches),
        "trials": str(trials),
    }


def _head(found: TunedScanner) -> list[str]:
    """What the head of a tuned configuration says."""
    return [
        f"Tuned from {found.start_name} on {found.recordings} recordings with seed {found.seed} by "
        f"fuzzytrack {__version__}, {datetime.date.today().isoformat()}.",
        f"Objective: {found.objective}; {found.verdict}.",
        f"Free: {', '.join(found.numbers)}.",
    ]
