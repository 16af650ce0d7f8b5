"""Interacting multiple models: a quiet and a maneuvering Kalman filter that share their states."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import nonnegative_deviation, number, positive_deviation, within
from fuzzytrack.lanes.plots import PlotLayout
from fuzzytrack.lanes.program import LaneProgram
from fuzzytrack.trackers.base import trackers
from fuzzytrack.trackers.imm_step import (
    FAR,
    MODEL,
    PROBABILITIES,
    ModelPair,
    imm_rows,
    mixed,
    moved,
    step_function,
    switched,
)
from fuzzytrack.trackers.lane_tracker import LaneTracker, check_missed
from fuzzytrack.trackers.state import TrackState, check_origin

__all__ = ["MANEUVERS", "InteractingPair"]


MANEUVERS = ("ca", "cv")

#: Least probability of a model that a new track can have.
_FLOOR = 1e-12


@trackers.register("imm")
@dataclass(frozen=True, repr=False)
class InteractingPair(LaneTracker):
    """Two Kalman filters, for a quiet and for a maneuvering target, and their probabilities.

    The quiet model is `fuzzytrack.schedulers.KalmanCV`, the maneuvering one the same with more
    noise, or `fuzzytrack.schedulers.KalmanCA`. From one step to the next, the target stays in its
    model with a given probability. Each filter starts a step from a mixture of both estimates. Each
    plot raises the probability of the model that predicted it better. Estimates are means over the
    models.

    Parameters
    ----------
    quiet_sigma : float
        Standard deviation of the acceleration of a quiet target (m/s²), drawn anew for each step,
        >= 0.
    maneuver_sigma : float
        The same of a maneuvering target, > 0; with `maneuver` "ca" that of the change of its
        acceleration at a step (m/s²).
    quiet_stay, maneuver_stay : float
        Probability, 0 to 1, that a target stays in its model for a step of any length.
    maneuver : {"ca", "cv"}
        Nearly constant acceleration, or nearly constant velocity.
    joint : bool
        Whether the axes of a track share their probabilities: the likelihood of a plot is then the
        product over its axes. Otherwise each axis has its own.
    sigma_w : float, optional
        Standard deviation of all plots (m), > 0. Unless given, the `sigma` of each plot is used.
    velocity_sigma : float, optional
        Standard deviation of a new track's velocity (m/s), > 0, with mean 0. Unless given, the
        velocity comes from the first two plots alone.
    acceleration_sigma : float, optional
        Standard deviation of a new track's acceleration (m/s²) if it maneuvers, >= 0, with mean 0;
        `maneuver_sigma` unless given. Only with `maneuver` "ca".
    maneuver_start : float, optional
        Probability, 0 to 1, that a new track maneuvers; unless given, the stationary probability of
        the two models, or ½ if both of them are kept forever.
    missed : {"elapsed", "step"}
        As for `fuzzytrack.AlphaBetaTracker`.

    Raises
    ------
    ValueError
        If a parameter is out of its range, unknown, or does not go with `maneuver`.

    Notes
    -----
    Bar-Shalom, Li & Kirubarajan (2001), section 11.6.6. Where a plot is missed the models mix and
    coast, and the probabilities change by the transitions between the models only: once over the
    whole gap, or with ``missed="step"`` at every step. Irregular times
    and a noise that varies from plot to plot are exact. Covariances are in Joseph form, one for
    each axis: the correlation between joint axes that mixing would cause is neglected. Before
    velocity is known, the models are neither mixed nor compared. No plot makes a probability less
    than 1e-12, unless those of a new track are 0 and 1.

    With `maneuver` "ca" the acceleration of the quiet model is 0 with variance 0. This is mixed
    into the maneuvering model; an acceleration that mixing gives to the quiet model is set to 0 by
    its prediction.

    The gains of a result are means over the models with the probabilities after the plot, and over
    axes if joint: α = Σμ K₁, β = Σμ K₂T, γ = 2 Σμ K₃T². They describe the response of the tracker.
    An `fuzzytrack.AlphaBetaTracker` with these gains gives a somewhat different track, since each
    model has an innovation of its own.

    The memory of a lane holds the probabilities of the quiet and of the maneuvering model and then,
    axis by axis, (x, v, a, P₁₁, P₁₂, P₁₃, P₂₂, P₂₃, P₃₃) of the one and of the other.

    Examples
    --------
    >>> from fuzzytrack.trackers.imm import InteractingPair
    >>> tracker = InteractingPair(0.1, 2.0, sigma_w=1.0)
    >>> result = tracker.run([0, 1, 2, 3, 4, 5], [0, 10, 20, 30, 43, 59])
    >>> result.predicted.round(2)
    array([  nan,   nan, 20.  , 30.  , 40.  , 53.67])
    >>> round(float(tracker.maneuver_probability(result.state)), 2)
    0.99
    """

    source: ClassVar[str] = "Bar-Shalom, Li & Kirubarajan (2001), section 11.6.6"
    one_recursion = False  # its gains are means over the models

    quiet_sigma: float
    maneuver_sigma: float
    quiet_stay: float = 0.95
    maneuver_stay: float = 0.9
    maneuver: str = "ca"
    joint: bool = True
    sigma_w: float | None = None
    velocity_sigma: float | None = None
    acceleration_sigma: float | None = None
    maneuver_start: float | None = None
    missed: str = "elapsed"

    def __post_init__(self) -> None:
        check_missed(self.missed)
        if self.maneuver not in MANEUVERS:
            raise ValueError(f"maneuver: unknown {self.maneuver!r}; one of {', '.join(MANEUVERS)}")
        if self.acceleration_sigma is not None and self.maneuver != "ca":
            raise ValueError("acceleration_sigma: only a model 'ca' has an acceleration to start")
        for check, names in (
            (nonnegative_deviation, ("quiet_sigma", "acceleration_sigma")),
            (positive_deviation, ("maneuver_sigma", "sigma_w", "velocity_sigma")),
            (_probability, ("quiet_stay", "maneuver_stay", "maneuver_start")),
        ):
            for name in names:
                if (value := getattr(self, name)) is not None:
                    object.__setattr__(self, name, number(name, check(name, value)))

    @property
    def uses_acceleration(self) -> bool:  # type: ignore[override]
        """Whether the maneuvering model has an acceleration."""
        return self.maneuver == "ca"

    @property
    def coupled(self) -> bool:  # type: ignore[override]
        """Whether a lane is a whole track: if joint."""
        return self.joint

    @property
    def needs_sigma(self) -> bool:  # type: ignore[override]
        """Whether plots need a standard deviation: unless `sigma_w` is given."""
        return self.sigma_w is None

    @property
    def start_probability(self) -> float:
        """Probability that a new track maneuvers: `maneuver_start`, or its default."""
        if self.maneuver_start is not None:
            return self.maneuver_start
        leave, settle = 1.0 - self.quiet_stay, 1.0 - self.maneuver_stay
        return leave / (leave + settle) if leave + settle > 0.0 else 0.5

    def program(self, n_axes: int) -> LaneProgram:
        """Memory and step of a lane; see `LaneTracker.program`."""
        rows = imm_rows(n_axes)
        start = self.start_probability
        memory = (1.0 - start, start, *(0.0,) * (rows.n_memory - PROBABILITIES))
        pair = self._models
        return LaneProgram(rows, memory, lambda stride: step_function(pair, rows, stride))

    @property
    def _models(self) -> ModelPair:
        accelerates, sigma = self.maneuver == "ca", self.acceleration_sigma
        start = self.maneuver_sigma if sigma is None else sigma
        return ModelPair(
            quiet_variance=self.quiet_sigma**2,
            maneuver_variance=self.maneuver_sigma**2,
            quiet_stay=self.quiet_stay,
            maneuver_stay=self.maneuver_stay,
            accelerates=accelerates,
            floor=_FLOOR if 0.0 < self.start_probability < 1.0 else 0.0,
            plot_variance=None if self.sigma_w is None else self.sigma_w**2,
            start_velocity=None if self.velocity_sigma is None else self.velocity_sigma**2,
            start_acceleration=start**2 if accelerates else 0.0,
        )

    def maneuver_probability(self, state: TrackState) -> Array:
        """Probability that the target maneuvers.

        Parameters
        ----------
        state : TrackState
            From this tracker.

        Returns
        -------
        ndarray
            Shape (...batch), () for a track alone; of a tracker that is not joint, shape of a plot.

        Raises
        ------
        ValueError
            If the state is that of another kind of tracker.
        """
        self._check(state)
        shape = state.shape[:-1] if self.joint else state.shape
        probability: Array = state.lanes[state.rows.memory + 1].reshape(shape)
        return probability

    def position_variance(self, state: TrackState) -> Array:
        """Variance of the position after the last step; that of a prediction is in `predict`.

        Parameters
        ----------
        state : TrackState
            From this tracker.

        Returns
        -------
        ndarray
            Variance (m²), shaped as a plot: that of the models, and the spread between them. NaN
            before the first plot, and where a track coasts before its velocity is known.

        Raises
        ------
        ValueError
            If the state is that of another kind of tracker.
        """
        self._check(state)
        rows = state.rows
        memory = state.lanes[rows.memory : rows.state]
        (times,) = PlotLayout.of((0, *state.shape), self.joint).times_to_lanes(
            np.asarray(state.time)[None]
        )
        elapsed = times - state.lanes[rows.last_time]
        variance: Array = np.where(
            elapsed > 0.0, self.prediction_variance(memory, elapsed), _variance(*_unpacked(memory))
        )
        seen = ~np.isnan(state.lanes[: rows.n_axes])
        coasting = (state.lanes[rows.gap] > 0.0) | (elapsed > 0.0)
        running = state.lanes[rows.plots] >= 2.0
        known = seen & (running | ~coasting)
        return np.where(known, variance, np.nan).T.reshape(state.shape)

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of a predicted position; see `LaneTracker.prediction_variance`.

        The models switch, mix and move as in a step with a missed plot.
        """
        was_quiet, was_maneuver, one, two = _unpacked(memory)
        quiet, maneuver, to_quiet, to_maneuver = switched(
            was_quiet, was_maneuver, self.quiet_stay, self.maneuver_stay
        )
        quiet_share: Any = to_quiet / np.where(quiet > 0.0, quiet, 1.0)
        maneuver_share: Any = to_maneuver / np.where(maneuver > 0.0, maneuver, 1.0)
        mixed_one = mixed(one, two, quiet_share, _bounded)
        mixed_two = mixed(two, one, maneuver_share, _bounded)
        one = moved(mixed_one, dt, self.quiet_sigma**2, False)
        two = moved(mixed_two, dt, self.maneuver_sigma**2, self.maneuver == "ca")
        return _variance(quiet, maneuver, one, two)

    def _check(self, state: TrackState) -> None:
        n_axes = state.rows.n_axes if self.joint else 1
        check_origin(state, imm_rows(n_axes), self._origin)


def _probability(name: str, value: float) -> Array:
    array = np.asarray(value, dtype=np.float64)
    return within(name, array, np.asarray((array >= 0) & (array <= 1)), "a probability, 0 to 1")


def _unpacked(memory: Array) -> tuple[Any, Any, Any, Any]:
    """Probabilities of both models, shape (lanes,), and the models of all axes, (n_axes, lanes)."""
    n_axes = (len(memory) - PROBABILITIES) // (2 * MODEL)
    models = memory[PROBABILITIES:].reshape(n_axes, 2, MODEL, memory.shape[1])
    quiet, maneuver = memory[:PROBABILITIES]
    one, two = (tuple(models[:, k].swapaxes(0, 1)) for k in (0, 1))
    return quiet, maneuver, one, two


def _bounded(apart: Any) -> Any:
    """Differences whose squares are finite."""
    return np.clip(apart, -FAR, FAR)


def _variance(quiet: Any, maneuver: Any, one: Any, two: Any) -> Any:
    """Variance of the position: that of the models, and the spread between them."""
    # No variance is negative by rounding.
    variances = (np.maximum(model[3], 0.0) for model in (one, two))
    apart = _bounded(two[0] - one[0])
    quiet_variance, maneuver_variance = variances
    return quiet * quiet_variance + maneuver * (maneuver_variance + quiet * apart**2)
