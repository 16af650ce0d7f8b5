"""When trackers are compiled: for large jobs, and once for trackers that differ in numbers only."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from fuzzytrack.kernels.rebuild import fingerprint
from fuzzytrack.kernels.shared_code import SharedCode
from fuzzytrack.lanes.layout import BLOCK
from fuzzytrack.trackers.lane_tracker import LaneTracker
from fuzzytrack.trackers.runners import runner

__all__ = ["announce", "code_form", "learn_code", "sharing_code"]


def announce(tracker: object, n_axes: int, coordinates: int) -> None:
    """Announce a job in many parts to a tracker, so that it is compiled for the first of them.

    Parameters
    ----------
    tracker : object
        A tracker; nothing is done unless it is a `LaneTracker`.
    n_axes : int
        Axes of the plots.
    coordinates : int
        Number of coordinates in all.
    """
    if isinstance(tracker, LaneTracker):
        core = runner(tracker, n_axes if tracker.coupled else 1)
        core.horizon = max(core.horizon, core.work + coordinates)


def code_form(tracker: object, n_axes: int) -> str | None:
    """What trackers have in common that `sharing_code` serves alike.

    Returns
    -------
    str or None
        None if the tracker shares code with no other one.
    """
    if not isinstance(tracker, LaneTracker):
        return None
    program = runner(tracker, n_axes if tracker.coupled else 1).program
    return fingerprint(program.step(BLOCK), numbers=False)


def learn_code(tracker: object, n_axes: int, code: SharedCode) -> None:
    """Note the numbers of a tracker, before `sharing_code` compiles; arguments as there."""
    if isinstance(tracker, LaneTracker):
        program = runner(tracker, n_axes if tracker.coupled else 1).program
        code.learn(program.step(BLOCK))
        if program.steady is not None:
            for common in (True, False):
                code.learn(program.steady(BLOCK, False, common))


@contextmanager
def sharing_code(tracker: object, n_axes: int, code: SharedCode) -> Iterator[None]:
    """Let a tracker run through code that it shares with trackers which differ in numbers only.

    Parameters
    ----------
    tracker : object
        A tracker; nothing is done unless it is a `LaneTracker`. It must not run elsewhere at the
        same time.
    n_axes : int
        Axes of the plots.
    code : SharedCode
    """
    if not isinstance(tracker, LaneTracker):
        yield
        return
    with runner(tracker, n_axes if tracker.coupled else 1).compiled_by(code.entry_point):
        yield
