"""Trackers run over plots that are judged by their own predictions.

`run_judged` gives, to the last bit, what judging and using one plot after the other gives. It is
as fast as a run, since it guesses what will happen to many plots, runs over all of them, looks
where the guess was wrong first, and runs again from there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.lanes.layout import GAINS
from fuzzytrack.lanes.plots import as_plots, as_times, infinite_plot, plot_sigmas, time_steps
from fuzzytrack.recordings.judge import Judge, JudgeMemory, Verdict, guessed, judged, used
from fuzzytrack.reprs import summary
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import as_tracker
from fuzzytrack.trackers.compilation import announce
from fuzzytrack.trackers.lane_tracker import LaneTracker
from fuzzytrack.trackers.result import TrackResult, checked_keep
from fuzzytrack.trackers.state import Gains, TrackState

__all__ = ["Judged", "run_judged"]


# Steps of a block at first and at least; coordinates of a block at most.
_FIRST, _LEAST, _MOST = 512, 32, 500_000


@dataclass(frozen=True, eq=False)
class Judged:
    """Result of a run over judged plots.

    Attributes
    ----------
    result : TrackResult
        As of a run over the plots that were used; its `measured` are these, NaN where a plot was
        rejected, and angles in the turn of their prediction. The state is None after a tracker
        that is no `LaneTracker`.
    rejected : ndarray of bool, shape (n_steps, ...batch)
        Plots that were not used.
    begins : ndarray of bool, shape (n_steps, ...batch)
        Plots that started their track again.
    memory : JudgeMemory
        With which to continue, beside the state.
    """

    result: TrackResult
    rejected: Mask
    begins: Mask
    memory: JudgeMemory

    def __repr__(self) -> str:
        return summary(
            self, "result", rejected=int(self.rejected.sum()), begins=int(self.begins.sum())
        )


def run_judged(
    tracker: Tracker | str,
    t: ArrayLike,
    z: ArrayLike,
    sigma: ArrayLike | None,
    judge: Judge,
    *,
    state: TrackState | None = None,
    memory: JudgeMemory | None = None,
    keep: Sequence[str] | None = None,
) -> Judged:
    """Track plots over time, each judged by its prediction before it is used.

    Parameters
    ----------
    tracker : Tracker or str
        The tracker, or what names it, see `fuzzytrack.trackers.catalog.make_tracker`.
    t, z, sigma
        As for `fuzzytrack.AlphaBetaTracker.run`; a gate needs `sigma`, unless the tracker has a
        `sigma_w`.
    judge : Judge
        What happens to plots.
    state, memory
        Of an earlier result, to continue it; new tracks unless given.
    keep : sequence of str, optional
        Outputs to keep in the result, as for `fuzzytrack.AlphaBetaTracker.run`.

    Returns
    -------
    Judged
        Equal, to the last bit, to steps of one plot at a time.

    Raises
    ------
    DataError, ValueError
        As `fuzzytrack.AlphaBetaTracker.run`; and if a gate has no `sigma`, a tracker that is no
        `LaneTracker` is to continue, or `memory` is that of other tracks.

    Examples
    --------
    >>> from fuzzytrack.recordings.judge import Circle, Gate, Judge
    >>> fixed, times = "fixed:alpha=0.5:beta=0.2", [0, 1, 2, 3]
    >>> run_judged(fixed, times, [0.51, 0.52, 0.07, 0.54], 0.01, Judge(Gate())).rejected
    array([False, False,  True, False])
    >>> found = run_judged(fixed, times, [358.0, 359.0, 0.0, 1.1], None, Judge(circle=Circle()))
    >>> print(Circle().wrapped(found.result.filtered).round(2))
    [358.   359.     0.     1.05]
    """
    tracker = as_tracker(tracker)
    plots = as_plots(z, np.float64)
    before = None if state is None else state.time
    times = as_times(t, before)
    time_steps(times, plots.shape, before)
    if np.isinf(plots).any():
        raise infinite_plot(plots)
    given = getattr(tracker, "sigma_w", None) if sigma is None else sigma
    if given is None and judge.gate is not None:
        raise ValueError("sigma: a gate needs the standard deviation of the plots (m)")
    if state is not None:
        if not isinstance(tracker, LaneTracker):
            raise ValueError(f"state: {type(tracker).__name__} is no LaneTracker, cannot continue")
        # Checks that the state fits.
        tracker.run(times[:0], plots[:0], 1.0, state=state, keep=())
    kept = checked_keep(keep)
    run = _Run(tracker, judge, times, plots, sigma, plot_sigmas(given, plots, None), kept)
    run.begin(state, memory)
    run.advance()
    return run.result(state)


class _Run:
    """Tracks that are run block by block.

    All arrays are over steps, tracks and axes, whatever the shape of the plots.
    """

    def __init__(
        self,
        tracker: Tracker,
        judge: Judge,
        times: Array,
        plots: Array,
        sigma: ArrayLike | None,
        deviation: Array,
        keep: tuple[str, ...],
    ) -> None:
        self.tracker, self.judge, self.keep = tracker, judge, keep
        self.measured, self.given_times = plots, times
        steps, self.n_axes = len(plots), plots.shape[-1] if plots.ndim > 1 else 1
        self.n_tracks = math.prod(plots.shape[1:-1])
        shape = (steps, self.n_tracks, self.n_axes)
        self.plots = plots.reshape(shape)
        each = times if times.ndim > 1 else times[:, None]
        self.times = np.broadcast_to(each.reshape(steps, math.prod(each.shape[1:])), shape[:2])
        self.told = sigma is not None
        self.common_sigma = deviation.size == 1
        if self.common_sigma:
            self.sigma = deviation.reshape(1, 1, 1)
        else:
            self.sigma = np.broadcast_to(deviation, plots.shape).reshape(shape)
        names = [name for each in keep for name in (GAINS if each == "gains" else (each,))]
        self.outputs = {name: np.empty(shape) for name in names}
        self.used = np.empty(shape)
        self.rejected = np.zeros(shape[:2], dtype=np.bool_)
        self.begins = np.zeros(shape[:2], dtype=np.bool_)
        self.memory = JudgeMemory.fresh(self.n_tracks, self.n_axes).numbers
        # States of lanes, shape (rows.kept, tracks, lanes of a track); None before the first plot.
        self.lanes: Array | None = None
        # A state whose other attributes are those of all.
        self.like: TrackState | None = None
        self.last = np.full(self.n_tracks, math.nan)

    def begin(self, state: TrackState | None, memory: JudgeMemory | None) -> None:
        """Continue from a state and a memory, if there are any."""
        if memory is not None:
            if memory.numbers.shape != self.memory.shape:
                raise ValueError(
                    f"memory: numbers of shape {memory.numbers.shape} do not fit plots of shape "
                    f"{self.measured.shape}; {self.memory.shape} does"
                )
            self.memory = memory.numbers.copy()
        if state is not None:
            self.last[:] = np.reshape(np.broadcast_to(state.time, state.shape[:-1]), -1)
            self._put(np.arange(self.n_tracks), state.lanes, state)

    def advance(self) -> None:
        """Run over all steps."""
        steps, room = len(self.plots), max(1, self.n_tracks * self.n_axes)
        lanes = isinstance(self.tracker, LaneTracker)
        announce(self.tracker, self.n_axes, self.plots.size)
        most = max(_LEAST, _MOST // room)
        length, begin = min(_FIRST, most) if lanes else steps, 0
        while begin < steps and self.n_tracks:
            end = min(steps, begin + length)
            again = self._block(begin, end)
            # Guesses that are wrong in many tracks cost less in short blocks.
            if again > (end - begin) * self.n_tracks:
                length = max(_LEAST, length // 2)
            elif again < (end - begin) * self.n_tracks / 4:
                length = min(most, 2 * length)
            begin = end

    def _block(self, begin: int, end: int) -> int:
        """Run all tracks over the steps of a block; number of plots that were run again."""
        again = 0
        waiting = [(begin, np.arange(self.n_tracks), self.lanes is None)]
        while waiting:
            first, tracks, new = waiting.pop()
            part = _Part(self, first, end, tracks, new)
            again += part.advance()
            for step in np.unique(part.begins):
                # In order, since all tracks in order are taken without a copy.
                restarted = np.sort(part.restarted[part.begins == step])
                self.begins[step, restarted] = True
                waiting.append((int(step), restarted, True))
        self.last = self.times[end - 1].copy()
        return again

    def run(
        self, first: int, end: int, tracks: NDArray[np.intp], plots: Array, state: TrackState | None
    ) -> TrackResult:
        """Run some tracks over some steps."""
        shape = (end - first, *self._shape(len(tracks)))
        times: Array = self.given_times[first:end]
        if times.ndim > 1:
            times = self.times[first:end, tracks].reshape(shape[:-1])
        sigma: Any = None
        if self.told:
            if self.common_sigma:
                sigma = float(self.sigma[0, 0, 0])
            else:
                sigma = self.sigma[first:end, tracks].reshape(shape)
        z = plots.reshape(shape)
        if isinstance(self.tracker, LaneTracker):
            keep = {*self.keep, "predicted"}
            return self.tracker.run(times, z, sigma, state=state, keep=tuple(keep))
        return self.tracker.run(times, z, sigma)

    def _shape(self, n_tracks: int) -> tuple[int, ...]:
        """Shape of the plots of some tracks at one time."""
        alone = self.measured.ndim < 3
        return self.measured.shape[1:] if alone else (n_tracks, self.n_axes)

    def state(self, tracks: NDArray[np.intp]) -> TrackState:
        """State of some tracks."""
        assert self.lanes is not None
        assert self.like is not None
        lanes = self.lanes[:, tracks].reshape(len(self.lanes), -1)
        shape, time = self._shape(len(tracks)), self.last[tracks]
        own = time if len(shape) > 1 else time[0]
        return replace(self.like, time=own, shape=shape, lanes=lanes)

    def _put(self, tracks: NDArray[np.intp], lanes: Array, like: TrackState) -> None:
        """Put the numbers of some tracks into place."""
        each = lanes.reshape(len(lanes), len(tracks), -1)
        if self.lanes is None:
            self.like = like
            self.lanes = np.empty((len(lanes), self.n_tracks, each.shape[2]))
        self.lanes[:, tracks] = each

    def take(
        self,
        first: int,
        count: int,
        tracks: NDArray[np.intp],
        chosen: Mask,
        result: TrackResult,
        used_plots: Array,
        rejected: Mask,
    ) -> None:
        """Take the first steps of some of the tracks of a run as they are."""
        whole = len(tracks) == self.n_tracks and bool(chosen.all())
        to: Any = np.s_[first : first + count]
        to = to if whole else (to, tracks[chosen])
        part: Any = np.s_[:count] if whole else np.s_[:count, chosen]
        for name, values in self.outputs.items():
            found = np.asarray(getattr(result.gains if name in GAINS else result, name))
            values[to] = found.reshape(used_plots.shape)[part]
        self.used[to], self.rejected[to] = used_plots[part], rejected[part]

    def end(
        self, tracks: NDArray[np.intp], chosen: Mask, state: TrackState | None, memory: Array
    ) -> None:
        """Take the states and memories of some of the tracks of a run."""
        self.memory[tracks[chosen]] = memory[chosen]
        if isinstance(state, TrackState) and isinstance(self.tracker, LaneTracker):
            lanes = state.lanes.reshape(len(state.lanes), len(tracks), -1)[:, chosen]
            self._put(tracks[chosen], lanes, state)

    def result(self, state: TrackState | None) -> Judged:
        """What the run gives."""
        shape = self.measured.shape
        batch = shape[:-1] if len(shape) > 1 else shape
        outputs: dict[str, Any] = {
            name: values.reshape(shape) for name, values in self.outputs.items()
        }
        if "gains" in self.keep:
            outputs["gains"] = Gains(*(outputs.pop(name) for name in GAINS))
        if self.lanes is not None and self.like is not None and len(self.measured):
            lanes = self.lanes.reshape(len(self.lanes), -1)
            time = self.given_times[-1].copy()
            state = replace(self.like, time=time, shape=shape[1:], lanes=lanes)
        result = TrackResult.of(self.given_times, self.used.reshape(shape), state, outputs)
        return Judged(
            result,
            self.rejected.reshape(batch),
            self.begins.reshape(batch),
            JudgeMemory(self.memory),
        )


class _Part:
    """Some tracks from the same step to the end of a block."""

    def __init__(
        self, run: _Run, first: int, end: int, tracks: NDArray[np.intp], new: bool
    ) -> None:
        self.run, self.first, self.end, self.new = run, first, end, new
        self._choose(tracks)
        n_axes = run.n_axes
        self.memory = JudgeMemory.fresh(len(tracks), n_axes).numbers if new else run.memory[tracks]
        self.position = np.full((len(tracks), n_axes), math.nan)
        if not new:
            self.position = run.state(tracks).position.reshape(self.position.shape)
        self.rejected, turns = guessed(run.judge, self.times, self.plots, self.sigma, self.position)
        self.turns = np.broadcast_to(turns, self.plots.shape) if run.judge.circle else turns
        # Tracks that start again, and when.
        self.restarted, self.begins = tracks[:0], np.empty(0, dtype=np.int64)

    def _choose(self, tracks: NDArray[np.intp]) -> None:
        run, block = self.run, slice(self.first, self.end)
        self.tracks = tracks
        every = len(tracks) == run.n_tracks
        self.times = run.times[block] if every else run.times[block, tracks]
        self.plots = run.plots[block] if every else run.plots[block, tracks]
        self.sigma = run.sigma if run.common_sigma else run.sigma[block][:, tracks]

    def advance(self) -> int:
        """Run until no guess is wrong; number of plots that were run again."""
        run, steps, again = self.run, self.end - self.first, 0
        while len(self.tracks):
            state = None if self.new else run.state(self.tracks)
            plots = used(run.judge, self.plots, self.rejected, self.turns)
            result = run.run(self.first, self.end, self.tracks, plots, state)
            predicted = np.asarray(result.predicted).reshape(plots.shape)
            verdict = judged(
                run.judge, self.times, self.plots, self.sigma, plots, self.rejected, predicted,
                self.position, self.memory,
            )  # fmt: skip
            wrong = self._wrong(verdict)
            done: Mask = np.asarray(~wrong.any(axis=0))
            if done.any():
                run.take(self.first, steps, self.tracks, done, result, plots, self.rejected)
                run.end(self.tracks, done, result.state, verdict.numbers[-1])
            if done.all():
                break
            where = np.where(done, steps - 1, np.argmax(wrong, axis=0))
            restart = ~done & verdict.begins[where, np.arange(len(where))]
            for count in np.unique(where[restart]):
                chosen = restart & (where == count)
                run.take(self.first, count, self.tracks, chosen, result, plots, self.rejected)
            self.restarted = np.concatenate([self.restarted, self.tracks[restart]])
            self.begins = np.concatenate([self.begins, self.first + where[restart]])
            self._correct(verdict, where, ~done & ~restart)
            again += steps * len(self.tracks)
        return again

    def _wrong(self, verdict: Verdict) -> Mask:
        wrong = (verdict.rejected != self.rejected) | verdict.begins
        if self.run.judge.circle is not None:
            other = (verdict.turns != self.turns) & ~np.isnan(self.plots)
            wrong |= other.any(axis=2) & ~self.rejected
        return np.asarray(wrong)

    def _correct(self, verdict: Verdict, where: NDArray[np.intp], chosen: Mask) -> None:
        """Go on with some of the tracks, and correct the first wrong guess of each."""
        where, columns = where[chosen], np.flatnonzero(chosen)
        across = np.arange(len(columns))
        self.rejected = self.rejected[:, chosen]
        self.rejected[where, across] = verdict.rejected[where, columns]
        if self.run.judge.circle is not None:
            right = verdict.turns[where, columns]
            # The plots after it lie in the same turn.
            shift = right - self.turns[where, columns]
            later = np.arange(len(self.plots))[:, None] >= where
            self.turns = self.turns[:, chosen] + later[..., None] * shift
        self.memory, self.position = self.memory[chosen], self.position[chosen]
        self._choose(self.tracks[chosen])
