"""Covariance of a track's errors, and how well its innovations agree with it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.gains.checks import nonnegative_deviation, number, within
from fuzzytrack.reprs import summary
from fuzzytrack.trackers.lane_tracker import check_missed
from fuzzytrack.trackers.result import TrackResult

__all__ = ["TrackCovariance", "track_covariance"]


@dataclass(frozen=True, eq=False)
class TrackCovariance:
    """Covariances of a track over time, each axis of space by itself.

    The last two axes are those of (position, velocity), or with γ (position, velocity,
    acceleration): variances in m², m²/s² and m²/s⁴.

    Attributes
    ----------
    predicted, filtered : ndarray, shape (n_steps, ...batch, n_axes, n, n)
        Covariance of the error before and after the plot is used; NaN until velocity is known.
    innovation_variance : ndarray, shape (n_steps, ...batch, n_axes)
        S (m²), shaped as the plots; NaN where there is no innovation or its variance is unknown.
    nis : ndarray, shape (n_steps, ...batch)
        Normalized innovation squared, the sum of e²/S over the axes that have one; NaN where none
        has. If model and noise are right, its mean is `axes`. Plots of one axis without an axis of
        space, shape (n_steps,), have it in that shape.
    axes : ndarray of int, shape (n_steps, ...batch)
        Degrees of freedom of `nis`: how many axes were summed.
    """

    predicted: Array
    filtered: Array
    innovation_variance: Array
    nis: Array
    axes: NDArray[np.int_]

    def __repr__(self) -> str:
        return summary(self, "predicted", "innovation_variance")


def track_covariance(
    result: TrackResult,
    sigma: ArrayLike,
    sigma_v: float,
    *,
    velocity_sigma: float | None = None,
    acceleration_sigma: float | None = None,
    missed: str = "elapsed",
) -> TrackCovariance:
    """Exact covariance of the estimates of a tracker, for any gains.

    Parameters
    ----------
    result : TrackResult
        Whole tracks, from their first plots on.
    sigma : array_like
        Standard deviation of the plots (m), > 0, broadcast against them.
    sigma_v : float
        Standard deviation, >= 0, of the target's acceleration, drawn anew for each step (m/s²);
        for a tracker with γ of the change of acceleration at each step.
    velocity_sigma : float, optional
        Standard deviation of a new track's velocity (m/s), >= 0. Needed after a one-point start,
        unless the first correction replaces the velocity altogether; a two-point start does not use
        it.
    acceleration_sigma : float, optional
        Standard deviation of a new track's acceleration (m/s²), >= 0. Needed by a tracker with γ;
        if given for a tracker without γ, the target is modeled with acceleration too.
    missed : {"elapsed", "step"}
        That of the tracker, see `fuzzytrack.trackers.lane_tracker.LaneTracker`: the steps of the
        model go from plot to plot, or from time to time.

    Returns
    -------
    TrackCovariance

    Raises
    ------
    ValueError
        If `missed` is unknown, a standard deviation is out of its range, does not broadcast or is
        missing, the result continues from a state or is in single precision, or its states do not
        follow from its gains.

    Notes
    -----
    The models are those of `fuzzytrack.schedulers.KalmanCV` and, with acceleration,
    `fuzzytrack.schedulers.KalmanCA`: noise G Gᵀσ_v² a step, with G = (T²/2, T) or (T²/2, T, 1). The
    update is the Joseph form P = (I - KH)P⁻(I - KH)ᵀ + K Kᵀσ², K = (α, β/T, γ/(2T²)), which holds
    for any gains that do not depend on the noise; gains chosen by the innovations themselves make
    it an approximation. A two-point start over a gap T₀ is the update with K = (1, 1/T₀, 0), from
    which the unknown velocity drops out: P₂₂ is then (σ₁² + σ₂²)/T₀² + σ_v²T₀²/4 after a single
    step.

    Examples
    --------
    >>> from fuzzytrack import AlphaBetaTracker, FixedGains
    >>> from fuzzytrack.trackers.covariance import track_covariance
    >>> result = AlphaBetaTracker(FixedGains(0.75, 0.5)).run([0, 1, 2, 3], [0, 1, 2, 4])
    >>> found = track_covariance(result, sigma=1, sigma_v=1)
    >>> found.filtered[1]
    array([[1.  , 1.  ],
           [1.  , 2.25]])
    >>> found.nis.round(3)
    array([  nan,   nan, 0.   , 0.221])
    """
    check_missed(missed)
    plots = result.measured
    if plots.dtype != np.float64:
        raise ValueError(f"result: its dtype must be float64, got {plots.dtype}; run in float64")
    order = _order(result, acceleration_sigma)
    noise = number("sigma_v", nonnegative_deviation("sigma_v", sigma_v))
    prior = _prior(velocity_sigma, acceleration_sigma, order)
    variances = _plot_variances(sigma, plots)
    seen = _seen(result)
    before, dts = _intervals(result, seen if missed == "elapsed" else np.ones_like(seen))
    used = ~np.isnan(result.innovation)
    gains = _gain_vectors(result, dts, used, order)
    _check_recursion(result, before, dts, gains)
    first, known = _begin(result, seen, used, velocity_sigma, gains)

    predicted = np.full((*plots.shape, order, order), np.nan)
    filtered = predicted.copy()
    p = np.zeros((*plots.shape[1:], order, order))
    measures = np.eye(order)[0]
    for k in range(len(plots)):
        move, push = _model(dts[k], order)
        last = p
        p = move @ p @ _turned(move) + noise**2 * _outer(push)
        predicted[k] = np.where(_wide(k > known), p, np.nan)
        rest = np.eye(order) - gains[k][..., :, None] * measures
        r = _wide(variances[k])
        p = rest @ p @ _turned(rest) + r * _outer(gains[k])
        p = np.where(_wide(first == k), prior + r * _outer(measures), p)
        # The unknown velocity counts as 0 until two plots replace it: it drops out of what follows.
        p[..., 1, 1] = np.where((first == k) & (known > k), 0.0, p[..., 1, 1])
        filtered[k] = np.where(_wide(k >= known), p, np.nan)
        if missed == "elapsed":
            p = np.where(_wide(seen[k]), p, last)

    s = np.where(used, predicted[..., 0, 0] + variances, np.nan)
    nis, axes = _agreement(result.innovation, s)
    return TrackCovariance(predicted, filtered, s, nis, axes)


def _order(result: TrackResult, acceleration_sigma: float | None) -> int:
    with_gamma = bool((np.nan_to_num(result.gains.gamma) != 0).any())
    if with_gamma and acceleration_sigma is None:
        raise ValueError(
            "acceleration_sigma: a tracker with gamma starts from an acceleration of 0; needed is "
            "the standard deviation of a new track's acceleration (m/s²)"
        )
    return 2 if acceleration_sigma is None else 3


def _prior(velocity_sigma: float | None, acceleration_sigma: float | None, order: int) -> Array:
    """Covariance of a new track without its plot."""
    variances = [0.0, 0.0, 0.0]
    names = ("", "velocity_sigma", "acceleration_sigma")
    for place, value in (1, velocity_sigma), (2, acceleration_sigma):
        if value is not None:
            name = names[place]
            variances[place] = number(name, nonnegative_deviation(name, value)) ** 2
    return np.diag(variances[:order])


def _plot_variances(sigma: ArrayLike, plots: Array) -> Array:
    """σ² shaped as the plots, 0 where there is none."""
    values = np.asarray(sigma, dtype=np.float64)
    try:
        full = np.broadcast_to(values, plots.shape)
    except ValueError:
        raise ValueError(
            f"sigma: shape {values.shape} does not broadcast with the plots' {plots.shape}"
        ) from None
    missed = np.isnan(plots)
    good = missed | (np.isfinite(full) & (full > 0))
    within("sigma", full, good, "finite and > 0 where there is a plot")
    return np.where(missed, 0.0, full) ** 2


def _times(result: TrackResult) -> Array:
    """Times (s), shaped as the plots."""
    t = result.time
    return np.broadcast_to(
        t.reshape(t.shape + (1,) * (result.measured.ndim - t.ndim)), result.measured.shape
    )


def _intervals(result: TrackResult, counts: Mask) -> tuple[NDArray[np.int_], Array]:
    """Index of the last step before each that counts, the first one if none does, and T since."""
    index = np.arange(len(counts)).reshape(-1, *(1,) * (counts.ndim - 1))
    last = np.maximum.accumulate(np.where(counts, index, 0), axis=0)
    before = np.concatenate([np.zeros_like(last[:1]), last[:-1]])
    times = _times(result)
    return before, times - np.take_along_axis(times, before, axis=0)


def _gain_vectors(result: TrackResult, dts: Array, used: Mask, order: int) -> Array:
    """K of every plot, 0 where it was not used; shape (n_steps, ...batch, n_axes, n)."""
    t = np.where(dts > 0, dts, 1.0)
    gains = result.gains
    parts = (gains.alpha, gains.beta / t, gains.gamma / (2 * t * t))
    return np.where(used[..., None], np.stack(parts[:order], axis=-1), 0.0)


def _check_recursion(
    result: TrackResult, before: NDArray[np.int_], dts: Array, gains: Array
) -> None:
    """Raise ValueError unless the states follow from the gains by the α-β(-γ) recursion."""
    t = dts[1:]
    x, v, a = (
        np.take_along_axis(s, before[1:], axis=0)
        for s in (result.filtered, result.velocity, result.acceleration)
    )
    running = ~np.isnan(result.predicted[1:])
    e = np.nan_to_num(result.innovation[1:])
    k = np.concatenate([gains[1:], np.zeros((*gains[1:].shape[:-1], 1))], axis=-1)
    expected = (
        (result.predicted[1:], x + v * t + a * t * t / 2),
        (result.filtered[1:], result.predicted[1:] + k[..., 0] * e),
        (result.velocity[1:], v + a * t + k[..., 1] * e),
        (result.acceleration[1:], a + k[..., 2] * e),
    )
    for actual, wanted in expected:
        if not np.allclose(actual[running], wanted[running], rtol=1e-6, atol=1e-9):
            raise ValueError(
                "result: its states do not follow from its gains; covariances can be computed only "
                "for an alpha-beta(-gamma) recursion that keeps its acceleration"
            )


def _begin(
    result: TrackResult, seen: Mask, used: Mask, velocity_sigma: float | None, gains: Array
) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Steps of the first plot, and of that from which on velocity is known, for every axis.

    Where velocity comes from a second plot, its gain is written into `gains`. A step that never
    comes is n_steps.
    """
    steps = len(seen)
    first = _first(seen)
    index = np.arange(steps).reshape(-1, *(1,) * (seen.ndim - 1))
    _check_whole(result, first, index)

    # A one-point start predicts from the step after the first plot on.
    one_point = ((index == first + 1) & ~np.isnan(result.predicted)).any(axis=0)
    second = _first(seen & (index > first))
    times, last = _times(result), max(steps - 1, 0)
    ends = (np.take_along_axis(times, np.minimum(k, last)[None], axis=0) for k in (first, second))
    span = np.subtract(*reversed([*ends]))[0] if steps else np.zeros(first.shape)
    meeting = (index == second) & (second < steps)
    # In a one-point start the second plot is the first correction.
    rate = gains[..., 1] * span
    replaced = np.isclose(gains[..., 0], 1.0) & np.isclose(rate, 1.0)
    if velocity_sigma is None and (meeting & one_point & used & ~replaced).any():
        raise ValueError(
            "velocity_sigma: a one-point start needs the standard deviation of a new track's "
            "velocity (m/s)"
        )
    take = meeting & ~one_point
    slope = np.divide(1.0, span, out=np.zeros(span.shape), where=span > 0)
    gains[..., 0] = np.where(take, 1.0, gains[..., 0])
    gains[..., 1] = np.where(take, slope, gains[..., 1])
    presumed = one_point & (velocity_sigma is not None)
    return first, np.where(presumed, first, second)


def _check_whole(result: TrackResult, first: NDArray[np.int_], index: NDArray[np.int_]) -> None:
    early = ~np.isnan(result.filtered) & (index < first)
    early |= ~np.isnan(result.predicted) & (index <= first)
    early |= (result.velocity != 0) & (index == first)
    if early.any():
        raise ValueError("result: it continues from a state; give tracks from their first plot on")


def _seen(result: TrackResult) -> Mask:
    """Where a plot counted: for a coupled tracker, with all its coordinates."""
    seen = ~np.isnan(result.measured)
    whole = seen.all(axis=-1, keepdims=True) if seen.ndim > 1 else seen
    if result.state is None and (seen != whole).any():
        raise ValueError(
            "result: a plot lacks a coordinate, and without its state (as from run_tracks) "
            "it is unknown whether the others counted; run that track by itself"
        )
    coupled = result.state is not None and result.state.rows.n_axes > 1
    return seen & whole if coupled else seen


def _first(mask: Mask) -> NDArray[np.int_]:
    """Index of the first True along axis 0; its length where there is none."""
    if not len(mask):
        return np.zeros(mask.shape[1:], dtype=np.int_)
    return np.where(mask.any(axis=0), mask.argmax(axis=0), len(mask))


def _model(dt: Array, order: int) -> tuple[Array, Array]:
    """Φ and G of one step."""
    one, zero = np.ones_like(dt), np.zeros_like(dt)
    half = dt * dt / 2
    rows = ((one, dt, half), (zero, one, dt), (zero, zero, one))
    move = np.stack([np.stack(row[:order], axis=-1) for row in rows[:order]], axis=-2)
    return move, np.stack((half, dt, one)[:order], axis=-1)


def _agreement(innovation: Array, s: Array) -> tuple[Array, NDArray[np.int_]]:
    terms = innovation**2 / s
    if terms.ndim == 1:
        terms = terms[:, None]
    axes = np.count_nonzero(~np.isnan(terms), axis=-1)
    return np.where(axes > 0, np.nansum(terms, axis=-1), np.nan), np.asarray(axes)


def _wide(values: ArrayLike) -> Array:
    return np.asarray(values)[..., None, None]


def _outer(vector: Array) -> Array:
    return vector[..., :, None] * vector[..., None, :]


def _turned(matrix: Array) -> Array:
    return np.swapaxes(matrix, -1, -2)
