"""The recursion of a tracker over memories: start, prediction, plot."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

import numpy as np
from stonesoup.types.array import CovarianceMatrix

from fuzzytrack.arrays import Array
from fuzzytrack.interop.stonesoup.layout import StateLayout
from fuzzytrack.interop.stonesoup.memory import TrackMemory
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.origin import Origin
from fuzzytrack.trackers.state import TrackState

__all__ = ["Recursion"]


@dataclass(frozen=True, eq=False)
class Recursion:
    """An alpha-beta(-gamma) tracker on state vectors of a layout.

    Attributes
    ----------
    text : str
        What names the tracker.
    tracker : AlphaBetaTracker
    layout : StateLayout
    empty : TrackState
        Its state of no track, which has the layout of its numbers.
    """

    text: str
    tracker: AlphaBetaTracker
    layout: StateLayout
    empty: TrackState

    @classmethod
    def of(cls, tracker: Any, position: Any, velocity: Any, acceleration: Any) -> Recursion:
        """Recursion of the properties of a component of Stone Soup.

        Parameters
        ----------
        tracker : str
            Names the tracker, see `fuzzytrack.trackers.catalog.make_tracker`.
        position, velocity, acceleration : sequence of int
            Mappings; see `StateLayout`.

        Raises
        ------
        ValueError, RuleBaseError
            If the text names no alpha-beta tracker, or the mappings do not fit it.
        """
        if not isinstance(tracker, str):
            raise ValueError(
                "tracker: must be a text such as 'omega-schedule' or 'fixed:alpha=0.5:beta=0.2', "
                f"so that it can be written to YAML, got {type(tracker).__name__}"
            )
        made = make_tracker(tracker)
        if not isinstance(made, AlphaBetaTracker):
            raise ValueError(
                f"tracker: {tracker!r} is no alpha-beta tracker, and its covariance does not "
                "follow from gains; give a rule base or a scheduler"
            )
        layout = StateLayout.of(position, velocity, acceleration)
        if layout.acceleration and not made.uses_acceleration:
            raise ValueError(f"acceleration_mapping: {tracker!r} has no acceleration; leave it out")
        if made.uses_acceleration and not layout.acceleration:
            raise ValueError(
                f"acceleration_mapping: {tracker!r} has an acceleration; give its place for each "
                "axis"
            )
        empty = made.start(np.empty((0, layout.n_axes)), 0.0, 1.0)
        return cls(tracker, made, layout, empty)

    @property
    def _origin(self) -> Origin:
        assert self.empty.made_by is not None
        return self.empty.made_by

    @property
    def noise(self) -> float | None:
        """Standard deviation of the acceleration (m/s²) that the tracker has of its own, if any."""
        if self.tracker.covariance is not None:
            return self.tracker.covariance
        found = getattr(self.tracker.scheduler, "sigma_v", None)
        return None if found is None else float(found)

    @property
    def first_acceleration(self) -> float | None:
        """Standard deviation of the acceleration of a new track (m/s²) of the tracker's own."""
        found = getattr(self.tracker.scheduler, "acceleration_sigma", None)
        return None if found is None else float(found)

    def check(self, memory: TrackMemory) -> None:
        """Raise ValueError for the memory of another tracker."""
        if memory.digest != self._origin.digest:
            raise ValueError(
                f"tracker: a state of {memory.tracker!r} cannot be continued by {self.text!r}; "
                "give initiator, predictor and updater the same tracker"
            )

    def started(
        self, plot: Array, covar: Array, when: datetime, velocity: float, acceleration: float
    ) -> TrackMemory:
        """Memory of a new track.

        Parameters
        ----------
        plot : ndarray, shape (n_axes,)
            Position (m).
        covar : ndarray, shape (n_axes, n_axes)
            Its covariance (m²).
        when : datetime
            Its time.
        velocity, acceleration : float
            Standard deviations of velocity (m/s) and acceleration (m/s²) on each axis.
        """
        after = self.tracker.start(plot, 0.0, np.sqrt(np.diag(covar)))
        first = self.layout.first_covariance(covar, velocity, acceleration)
        return self._memory(after, when, 0.0, 1, first)

    def coasted(self, memory: TrackMemory, when: datetime, noise: float) -> TrackMemory:
        """Memory after a time without a plot, see `predicted`; the time is later."""
        time = self._time(memory, when)
        # Of a missed plot the standard deviation has no meaning.
        missed = np.full(self.layout.n_axes, np.nan)
        after = self.tracker.step(self._state(memory), missed, time, 1.0)
        covar = memory.covar
        if not self._elapsed:
            covar = self.predicted(memory, when, noise)
        return self._memory(after, memory.epoch, memory.plot_time, memory.plots, covar)

    def predicted(self, memory: TrackMemory, when: datetime, noise: float) -> Array:
        """Covariance of a track without a plot up to a time, see `StateLayout.predicted`."""
        since = memory.plot_time if self._elapsed else memory.time
        dt = self._time(memory, when) - since
        retention = self.tracker.retention_time(self._state(memory))
        return self.layout.predicted(np.asarray(memory.covar), dt, noise, retention)

    def corrected(
        self, memory: TrackMemory, predicted: Array, plot: Array, covar: Array, when: datetime
    ) -> TrackMemory:
        """Memory after one more plot.

        Parameters
        ----------
        memory : TrackMemory
            Before it, at an earlier time.
        predicted : ndarray, shape (ndim, ndim)
            Covariance of the prediction.
        plot, covar, when
            As for `started`.
        """
        time = self._time(memory, when)
        after = self.tracker.step(self._state(memory), plot, time, np.sqrt(np.diag(covar)))
        if memory.plots == 1 and self.tracker.start_mode == "two-point":
            # Position is that of the plot, and velocity the difference of both plots.
            gains = np.tile([1.0, 1.0 / (time - memory.plot_time), 0.0], (self.layout.n_axes, 1))
        else:
            dt = time - (memory.plot_time if self._elapsed else memory.time)
            used = after.gains
            gains = np.stack([used.alpha, used.beta / dt, used.gamma / (2 * dt * dt)], axis=-1)
        found = self.layout.corrected(predicted, gains, covar)
        return self._memory(after, memory.epoch, time, 2, found)

    def is_at(self, memory: TrackMemory, when: datetime) -> bool:
        """Whether a track has its last plot at this time already."""
        return self._time(memory, when) == memory.plot_time

    def vector(self, memory: TrackMemory) -> Any:
        """State vector of a memory."""
        state = self._state(memory)
        return self.layout.vector(state.position, state.velocity, state.acceleration)

    @property
    def _elapsed(self) -> bool:
        """Whether time counts from the last plot."""
        return self.tracker.missed == "elapsed"

    def _time(self, memory: TrackMemory, when: datetime) -> float:
        return (when - memory.epoch).total_seconds()

    def _state(self, memory: TrackMemory) -> TrackState:
        shape = (self.layout.n_axes,)
        return TrackState(
            np.float64(memory.time), shape, memory.numbers, self.empty.rows, self._origin
        )

    def _memory(
        self, state: TrackState, epoch: datetime, plot_time: float, plots: int, covar: Array
    ) -> TrackMemory:
        return TrackMemory(
            tracker=self.text,
            digest=self._origin.digest,
            epoch=epoch,
            time=float(state.time),
            plot_time=plot_time,
            plots=plots,
            numbers=state.lanes,
            covar=CovarianceMatrix(covar),
        )
