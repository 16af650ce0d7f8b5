"""All checks of a scheduler, a tracker or a part: by name, or in one call."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from fuzzytrack.errors import PluginError, in_one_sentence
from fuzzytrack.scan.part import Part
from fuzzytrack.schedulers.base import GainScheduler
from fuzzytrack.testing.part_checks import part_checks, role_of
from fuzzytrack.testing.samples import expect
from fuzzytrack.testing.scheduler_checks import SCHEDULER_CHECKS
from fuzzytrack.testing.tracker_checks import LANE_CHECKS, TRACKER_CHECKS
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker

__all__ = ["Check", "check_part", "check_scheduler", "check_tracker", "checks_for"]

#: What every tracker has.
_METHODS = ("run", "start", "step", "predict")


@dataclass(frozen=True)
class Check:
    """One promise of the contract, for one object; called without arguments, it is checked.

    Attributes
    ----------
    name : str
        Name of the promise, such as ``batch-equals-single``. It does not change from version to
        version.
    subject : GainScheduler, Tracker or Part
        What is checked.
    promise : callable
        ``promise(subject, seed)`` raises AssertionError if the promise is broken.
    seed : int
        Seed of the random plots.
    """

    name: str
    subject: Any
    promise: Callable[[Any, int], None]
    seed: int = 0

    def __call__(self) -> None:
        """Check the promise.

        Raises
        ------
        AssertionError
            If it is broken, or anything else is raised; begins with the name of the check.
        """
        try:
            self.promise(self.subject, self.seed)
        except AssertionError as error:
            raise AssertionError(f"{self.name}: {error}") from error
        except PluginError as error:
            raise AssertionError(f"{self.name}: {error.message}") from error
        except Exception as error:
            raise AssertionError(
                f"{self.name}: {type(self.subject).__name__} raises {in_one_sentence(error)}"
            ) from error


def checks_for(subject: GainScheduler | Tracker | Part, seed: int = 0) -> Iterator[Check]:
    """All checks that a scheduler, a tracker, or a part of a scan tracker has to pass.

    Parameters
    ----------
    subject : GainScheduler, Tracker or Part
    seed : int
        Seed of the random plots.

    Yields
    ------
    Check
        In the order in which a mistake is found best: the form of a kernel before its behavior.

    Raises
    ------
    AssertionError
        If `subject` is none of these.

    Examples
    --------
    >>> from fuzzytrack import FixedGains
    >>> from fuzzytrack.testing import checks_for
    >>> [check.name for check in checks_for(FixedGains(0.5, 0.2))][:3]
    ['hashable', 'equals-pickled-copy', 'kernel-takes-five-arguments']
    """
    if isinstance(subject, GainScheduler):
        named = SCHEDULER_CHECKS
    elif isinstance(subject, Part):
        _expect_a_part(subject)
        named = part_checks(subject)
    else:
        _expect_a_tracker(subject)
        named = LANE_CHECKS if isinstance(subject, LaneTracker) else TRACKER_CHECKS
    for name, promise in named.items():
        yield Check(name, subject, promise, seed)


def check_scheduler(scheduler: GainScheduler, seed: int = 0) -> None:
    """Check that a scheduler keeps the contract of `fuzzytrack.schedulers.base.GainScheduler`.

    Checked are: immutability (equal hash and answers after pickling), what the kernel is written
    with, memory and gains of the right form at ordinary and extreme innovations, gains that keep
    the filter stable, and, through an `fuzzytrack.AlphaBetaTracker` with either start, all that
    `check_tracker` checks; compiled, and with rows left out, with one start, since a kernel is
    compiled in the same way for the other.

    Parameters
    ----------
    scheduler : GainScheduler
    seed : int
        Seed of the random plots.

    Raises
    ------
    AssertionError
        If a promise is broken; says which, after the name of the check.
    """
    expect(
        isinstance(scheduler, GainScheduler), f"must be a GainScheduler, got {_spelt(scheduler)}"
    )
    for check in checks_for(scheduler, seed):
        check()


def check_tracker(tracker: Tracker, seed: int = 0) -> None:
    """Check that a tracker keeps the contract of `fuzzytrack.trackers.base.Tracker`.

    Checked are: shapes of one track and of batches, coasting on missed plots, irregular times,
    that a batch equals its tracks one by one, that streaming equals `run` to the last bit, that
    `predict` equals a step with a missed plot and returns the innovation variance of
    `fuzzytrack.trackers.covariance.track_covariance` where that has the same model, pickling of the
    state in the middle of a track, determinism, that inputs are left alone, that bad input raises
    ValueError, and of a `fuzzytrack.trackers.LaneTracker` that it is a value, what its step is
    written with, that it gives the same to the last bit when compiled, and that rows without a plot
    give the same as rows left out, unless it counts them or has ``missed="step"``.

    Parameters
    ----------
    tracker : Tracker
    seed : int
        Seed of the random plots.

    Raises
    ------
    AssertionError
        If a promise is broken; says which, after the name of the check.
    """
    _expect_a_tracker(tracker)
    for check in checks_for(tracker, seed):
        check()


def check_part(part: Part, seed: int = 0) -> None:
    """Check that a part of a scan tracker keeps the contract of its role.

    Checked are: numbers and words that are declared, with limits that hold; that it is a value;
    kernels of the form of the role, which can be compiled unless it sets ``plain = True``; what the
    role promises, such as an association that is one to one along the edges that are given; and,
    in the default tracker in the place of its own part, that scans give the same tracks again, also
    where a session is resumed, and compiled as in plain Python.

    Parameters
    ----------
    part : Part
    seed : int
        Seed of plots and tracks.

    Raises
    ------
    AssertionError
        If a promise is broken; says which, after the name of the check.
    """
    _expect_a_part(part)
    for check in checks_for(part, seed):
        check()


def _expect_a_part(subject: Any) -> None:
    expect(
        isinstance(subject, Part) and role_of(subject) is not None,
        f"must be a part of a role of a scan tracker, got {_spelt(subject)}",
    )


def _expect_a_tracker(subject: Any) -> None:
    complete = not isinstance(subject, type) and all(hasattr(subject, m) for m in _METHODS)
    methods = f"{', '.join(_METHODS[:-1])} and {_METHODS[-1]}"
    expect(complete, f"a tracker must have {methods}, got {_spelt(subject)}")


def _spelt(subject: Any) -> str:
    if isinstance(subject, type):
        return f"the class {subject.__name__}; give an object, as {subject.__name__}() makes it"
    return type(subject).__name__
