"""The α-β(-γ) tracker."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import nonnegative_deviation, number
from fuzzytrack.lanes.layout import Rows
from fuzzytrack.lanes.program import LaneProgram
from fuzzytrack.reprs import constructor_code
from fuzzytrack.schedulers.base import GainScheduler
from fuzzytrack.schedulers.catalog import as_scheduler
from fuzzytrack.schedulers.form import check_answer, checked_kernel, checked_memory
from fuzzytrack.trackers.alpha_beta_step import StepWay, steady_function, step_function
from fuzzytrack.trackers.base import trackers
from fuzzytrack.trackers.carried_covariance import CarriedCovariance
from fuzzytrack.trackers.lane_tracker import LaneTracker, check_missed
from fuzzytrack.trackers.state import TrackState

__all__ = ["STARTS", "AlphaBetaTracker"]

STARTS = ("two-point", "one-point")


@trackers.register("alpha-beta")
@dataclass(frozen=True, repr=False)
class AlphaBetaTracker(LaneTracker):
    """An α-β(-γ) tracker whose gains a scheduler chooses.

    Parameters
    ----------
    scheduler : GainScheduler or str
        Chooses the gains; a text names one, as ``"fixed:alpha=0.5:beta=0.2"`` or a rule base, see
        `fuzzytrack.schedulers.catalog.make_scheduler`. An ordinary one chooses gains for each axis
        separately; a coupled one uses all axes of a track and gives them one set of gains.
    start : {"two-point", "one-point"}
        ``two-point`` takes position from the second plot and velocity from the first two (as in the
        papers: predictions begin with the third plot). ``one-point`` takes position from the first
        plot with velocity 0, and uses the scheduler from the second plot on.
    missed : {"elapsed", "step"}
        What T is after missed plots: the time since the last plot, or since the last step, see
        `fuzzytrack.trackers.lane_tracker.LaneTracker`.
    covariance : float, optional
        Standard deviation σ_v of the target's acceleration from plot to plot (m/s²), >= 0; for a
        scheduler with γ that of its change. Given, the covariance that the gains lead to goes along
        with a track, whatever the scheduler, and `predict` returns its variances: for gates,
        ellipses and the NIS. It needs the standard deviation of the plots and a two-point start.

    Raises
    ------
    TypeError
        If `scheduler` is neither.
    ValueError
        If `start` or `missed` is unknown, the text names no scheduler, or `covariance` is negative
        or comes with a one-point start.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.1 to 2.6 and 2.35 to 2.39. A plot that is NaN was missed: the
    results there are the prediction. The velocity correction is (β/T)·e with the time T since the
    last plot, so that steps without a plot, and steps left out, give the same track. With
    ``missed="step"``, as in the papers, T is that of the step, also after missed plots; the change
    of observation that a scheduler sees spans the whole gap in any case. Times may be irregular.
    For a coupled scheduler a plot with any coordinate missing is missed.

    Examples
    --------
    >>> from fuzzytrack import AlphaBetaTracker, FixedGains
    >>> result = AlphaBetaTracker(FixedGains(0.5, 0.2)).run([0, 1, 2, 3], [0, 10, 19, 31])
    >>> result.predicted
    array([ nan,  nan, 20. , 29.3])
    """

    source: ClassVar[str] = "Llinas et al. (1998), Eqs. 2.1-2.6 and 2.35-2.39"

    scheduler: GainScheduler
    start_mode: str = "two-point"
    missed: str = "elapsed"
    covariance: float | None = None

    def __init__(
        self,
        scheduler: GainScheduler | str,
        start: str = "two-point",
        missed: str = "elapsed",
        covariance: float | None = None,
    ) -> None:
        if start not in STARTS:
            raise ValueError(f"start: unknown {start!r}; one of {', '.join(STARTS)}")
        check_missed(missed)
        if covariance is not None:
            covariance = number("covariance", nonnegative_deviation("covariance", covariance))
            if start != "two-point":
                raise ValueError(
                    f"covariance: needs start 'two-point', got {start!r}: after one plot the "
                    "variance of the velocity is not known"
                )
        object.__setattr__(self, "scheduler", as_scheduler(scheduler))
        if covariance is not None and self.scheduler.own_gains:
            raise ValueError(
                "covariance: a scheduler with gains of its own for each axis has covariances too; "
                "remove it"
            )
        object.__setattr__(self, "start_mode", start)
        object.__setattr__(self, "missed", missed)
        object.__setattr__(self, "covariance", covariance)

    def __repr__(self) -> str:
        return constructor_code(self, start_mode="start")

    @property
    def coupled(self) -> bool:  # type: ignore[override]
        """Whether all axes share one set of gains; from the scheduler."""
        return self.scheduler.coupled

    @property
    def needs_sigma(self) -> bool:  # type: ignore[override]
        """Whether plots need a standard deviation; from the scheduler."""
        return self._gains.needs_sigma

    @property
    def sees_misses(self) -> bool:  # type: ignore[override]
        """Whether missed plots change the memory; from the scheduler."""
        return self.scheduler.sees_misses

    @property
    def sigma_w(self) -> float | None:  # type: ignore[override]
        """Standard deviation of all plots (m), if the scheduler has one."""
        return self.scheduler.sigma_w

    @property
    def uses_acceleration(self) -> bool:  # type: ignore[override]
        """Whether there is a gain γ; from the scheduler."""
        return self.scheduler.uses_acceleration

    @property
    def one_recursion(self) -> bool:  # type: ignore[override]
        """Whether all that a track becomes follows from its gains: without a retention time."""
        return not self.scheduler.uses_retention

    @property
    def name(self) -> str:
        """Name for messages: that of the scheduler."""
        return type(self.scheduler).__name__

    def program(self, n_axes: int) -> LaneProgram:
        """The α-β-γ recursion with the scheduler's gains; see `LaneTracker.program`."""
        checked_kernel(self.scheduler, n_axes)
        checked_memory(self.scheduler, n_axes)
        scheduler = self._gains
        memory = scheduler.initial_memory(n_axes)
        if scheduler.uses_retention:
            memory = (*memory, math.inf)
        rows = Rows(n_axes, len(memory), gain_sets=n_axes if scheduler.own_gains else 1)
        way = StepWay(scheduler, self.start_mode == "two-point", self.missed == "elapsed")
        return LaneProgram(
            rows,
            memory,
            lambda stride: step_function(way, rows, stride),
            lambda stride, *kind: steady_function(way, rows, stride, *kind),
            keeps_state=way.elapsed,
        )

    def _check_form(self, n_axes: int) -> None:
        """Raise PluginError if what the scheduler's kernel returns lacks the form."""
        check_answer(self.scheduler, n_axes)

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of a predicted position; see `LaneTracker.prediction_variance`."""
        scheduler = self._gains
        if scheduler.variance_start not in (None, self.start_mode):
            # The scheduler's covariance is that of a track which started otherwise.
            return math.nan
        own = memory[:-1] if scheduler.uses_retention else memory
        return scheduler.prediction_variance(own, dt)

    def retention_time(self, state: TrackState) -> Array:
        """Time for which the acceleration of a track lasts, in its next prediction (s).

        Parameters
        ----------
        state : TrackState
            From `start`, `step` or a result.

        Returns
        -------
        ndarray
            Shaped as a plot; infinite unless the scheduler sets it.
        """
        rows, n_axes = state.rows, state.rows.n_axes
        if not self._gains.uses_retention:
            return np.full(state.shape, math.inf)
        lanes = state.lanes[rows.memory + rows.n_memory - 1]
        return np.repeat(lanes, n_axes).reshape(state.shape)

    @property
    def _gains(self) -> GainScheduler:
        """The scheduler, with a covariance if there is to be one."""
        if self.covariance is None:
            return self.scheduler
        return CarriedCovariance(self.scheduler, self.covariance, self.missed == "elapsed")
