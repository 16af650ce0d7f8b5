"""Covariance of a target that maneuvers as rules say, and the gains that follow from it.

::

    predict   P⁻ = FPFᵀ          with φ = fade(dt/τ), τ from the rules at the last plot
    expect    S = P⁻₁₁ + b·σ²·G₁² + r   with the noise σ of the rules at inputs of 0
    correct   P = P⁻ + b·σ²·GGᵀ   with the noise σ of the rules at this plot
              K = P(·, 1)/(P₁₁ + r)     α = K₁   β = dt·K₂   γ = 2dt²·K₃

F, b and G are those of `fuzzytrack.gains.singer`. Accelerations are measured in a₀ = level/3, and
times in τ₀ = √(σ₀/a₀), with σ₀ the standard deviation of the first plot. Without a level τ₀ is the
mean interval between the plots so far, and a₀ = σ₀/τ₀².
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzytrack.gains.checks import nonnegative, positive, positive_deviation
from fuzzytrack.gains.joseph import Covariance3
from fuzzytrack.gains.singer import add_onset, correct_optimally, fade, onset, predict_singer
from fuzzytrack.kernels.language import Memory
from fuzzytrack.schedulers.converter import Convert, Converter, Expect, seen_by

__all__ = ["AXES", "ManeuverCovariance"]

AXES = ("shared", "own")

# Numbers of the memory before the covariances, and of each covariance.
_HEAD, _SIX = 5, 6


@dataclass(frozen=True)
class ManeuverCovariance(Converter):
    """Gains of a Kalman filter for a target whose acceleration decays, with noise from rules.

    Parameters
    ----------
    places : (int, int)
        Where noise and retention are among the outputs.
    quiet : (float, float)
        Noise and retention at inputs of 0.
    delay : float
        Time by which a maneuver is older than the plot before it is noticed (τ₀), >= 0.
    gap : float
        Interval between plots at which the noise is halved (τ₀), > 0.
    start : float
        Standard deviation of the acceleration of a new track (a₀), > 0.
    level : float, optional
        Strongest maneuver expected (m/s²), > 0.
    velocity_sigma : float, optional
        Standard deviation of the velocity of a new track (m/s), > 0, about 0: for the tracker's
        start ``one-point``. Without it, velocity is unknown until the second plot.
    axes : {"shared", "own"}
        One covariance for all axes, with the mean variance of a plot; or one for each axis.

    Raises
    ------
    ValueError
        If a parameter is out of range, or there is a `velocity_sigma` without a `level`.

    Notes
    -----
    Model of the acceleration: Singer (1970). The memory is (plots so far; time since the first one
    (s); τ₀ (s), without a level σ₀ (m); variance of the acceleration at the last plot ((m/s²)²);
    retention time from there on (s); P₁₁, P₁₂, P₁₃, P₂₂, P₂₃, P₃₃ of each covariance).
    """

    needs_sigma = True
    sees_starts = True
    uses_retention = True

    places: tuple[int, int]
    quiet: tuple[float, float]
    delay: float = 1.0
    gap: float = 0.6
    start: float = 0.65
    level: float | None = None
    velocity_sigma: float | None = None
    axes: str = "shared"

    def __post_init__(self) -> None:
        object.__setattr__(self, "delay", float(nonnegative("delay", self.delay)))
        for name in ("gap", "start", "level", "velocity_sigma"):
            value = getattr(self, name)
            if value is not None:
                check = positive if name == "gap" else positive_deviation
                object.__setattr__(self, name, float(check(name, value)))
        if self.axes not in AXES:
            raise ValueError(f"axes: unknown {self.axes!r}; one of {', '.join(AXES)}")
        if self.velocity_sigma is not None and self.level is None:
            raise ValueError(
                "velocity_sigma needs a level: without one, the accelerations that are possible "
                "are known from the second plot on"
            )

    @property
    def own_gains(self) -> bool:  # type: ignore[override]
        """Whether each axis has its own gains: with covariances of their own."""
        return self.axes == "own"

    @property
    def variance_start(self) -> str | None:  # type: ignore[override]
        """Start after which the covariance is that of the track: with `velocity_sigma`, one."""
        return None if self.velocity_sigma is None else "one-point"

    def initial_memory(self, n_axes: int) -> Memory:
        """No plot yet."""
        return (0.0, 0.0, 1.0, 0.0, 1.0, *(0.0,) * (_SIX * self._covariances(n_axes)))

    def _covariances(self, n_axes: int) -> int:
        return n_axes if self.axes == "own" else 1

    def _scale(self) -> Callable[[float], float]:
        """Function from the standard deviation of the first plot to the third number of memory."""
        if self.level is None:
            return lambda sigma: sigma
        acceleration = self.level / 3.0
        return lambda sigma: math.sqrt(sigma / acceleration)

    def _units(self) -> Callable[[Any, Any, Any], tuple[Any, Any]]:
        """Function from the third number of memory, a span of time and the intervals in it.

        It returns τ₀ (s) and a₀ (m/s²).
        """
        if self.level is None:

            def of_intervals(sigma: Any, span: Any, intervals: Any) -> tuple[Any, Any]:
                time = span / intervals
                return time, sigma / (time * time)

            return of_intervals

        acceleration = self.level / 3.0
        # As a product it goes into a tuple of numbers, also in code that reads constants from
        # memory (`fuzzytrack.kernels.slots`).
        return lambda time, span, intervals: (time, 1.0 * acceleration)

    def expect(self, n_axes: int, coupled: bool) -> Expect:
        """Predict the covariances; see `Converter.expect`."""
        first_scale, units = self._scale(), self._units()
        delay, gap_rate, quiet_noise = self.delay, 1.0 / self.gap, self.quiet[0]
        own = self.axes == "own"
        mean, variances = _mean(n_axes), _squares(n_axes) if own else _mean_square(n_axes)
        predict = _predict(self._covariances(n_axes))
        spread = _same if own else _repeat(n_axes)
        unknown_below = 2.0 if self.velocity_sigma is None else 1.0

        def expect(dt: float, sigma: Any, memory: Memory) -> tuple[float, Any, Memory]:
            plots, span = memory[0], memory[1] + dt
            scale = memory[2] if plots > 0.0 else first_scale(mean(sigma))
            time, acceleration = units(scale, span, plots if plots > 1.0 else 1.0)
            steps = dt / time
            phi = fade(dt / memory[4])
            b, g1, g2 = onset(dt, phi, delay * time, gap_rate * steps)
            quiet = quiet_noise * acceleration * g1
            # A plot that gives the velocity cannot surprise.
            least = math.inf if plots < unknown_below else b * quiet * quiet
            variance, predicted = predict(dt, phi, least, variances(sigma), memory)
            head = (plots, span, scale, memory[3], memory[4], time, acceleration, b, g1, g2)
            return steps, spread(variance), (*head, *predicted)

        return expect if coupled else _of_one_axis(expect)

    def convert(self, n_axes: int, coupled: bool) -> Convert:
        """Correct the covariances, and take the gains; see `Converter.convert`."""
        noise_at, retention_at = self.places
        start, unknown_below = self.start, 2.0 if self.velocity_sigma is None else 1.0
        correct = _correct(self._covariances(n_axes), _first_covariance(self.velocity_sigma))
        is_seen = seen_by(coupled)
        shaped = _same if coupled and self.axes == "own" else _first

        def convert(
            outputs: tuple[float, ...], dt: float, sigma: Any, kept: Memory
        ) -> tuple[Any, Any, Any, float, Memory]:
            plots, span, scale, last_q, last_tau = kept[0], kept[1], kept[2], kept[3], kept[4]
            time, acceleration, b, g1, g2 = kept[5], kept[6], kept[7], kept[8], kept[9]
            seen, starts = is_seen(sigma), plots < unknown_below
            noise, first = outputs[noise_at] * acceleration, start * acceleration
            q = noise * noise if seen else last_q
            tau = outputs[retention_at] * time if seen else last_tau
            alpha, beta, gamma, covariances = correct(
                kept, dt, b * q, g1, g2, starts, span, first * first
            )
            head = (
                plots + 1.0 if seen else plots,
                span if plots > 0.0 else 0.0,
                scale,
                first * first if starts else q,
                tau,
            )
            return shaped(alpha), shaped(beta), shaped(gamma), tau, (*head, *covariances)

        return convert

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of a predicted position; see `Converter.prediction_variance`."""
        plots, span, scale, q, tau, *numbers = memory
        time, _ = self._units()(scale, span + dt, np.maximum(plots, 1.0))
        phi = fade(dt / tau)
        b, g1, _ = onset(dt, phi, self.delay * time, dt / (self.gap * time))
        variances = []
        for k in range(0, len(numbers), _SIX):
            p11, p12, p13, p22, p23, p33 = numbers[k : k + _SIX]
            predicted = predict_singer(p11, p12, p13, p22, p23, p33, dt, phi)
            variances.append(predicted[0] + b * q * g1 * g1)
        known = plots >= (2.0 if self.velocity_sigma is None else 1.0)
        found = np.where(known, variances, np.nan)
        return found if self.axes == "own" else found[0]


def _same(values: Any) -> Any:
    return values


def _first(values: Any) -> Any:
    return values[0]


def _of_one_axis(expect: Expect) -> Expect:
    """`expect` for an axis whose numbers do not come as tuples."""

    def expect_one(dt: float, sigma: Any, memory: Memory) -> tuple[float, Any, Memory]:
        steps, variance, kept = expect(dt, (sigma,), memory)
        return steps, variance[0], kept

    return expect_one


# What follows is built up axis by axis, since compiled code cannot fill a tuple in a loop.
def _sum(count: int) -> Callable[[Any], float]:
    if count == 1:
        return lambda values: values[0]
    before, last = _sum(count - 1), count - 1
    return lambda values: before(values) + values[last]


def _squares(count: int) -> Callable[[Any], tuple[float, ...]]:
    if count == 0:
        return lambda values: ()
    before, last = _squares(count - 1), count - 1
    return lambda values: (*before(values), values[last] * values[last])


def _repeat(count: int) -> Callable[[Any], tuple[float, ...]]:
    """The first number of a tuple, so many times."""
    if count == 0:
        return lambda values: ()
    before = _repeat(count - 1)
    return lambda values: (*before(values), values[0])


def _mean(n_axes: int) -> Callable[[Any], float]:
    total, share = _sum(n_axes), 1.0 / n_axes
    return lambda values: share * total(values)


def _mean_square(n_axes: int) -> Callable[[Any], tuple[float, ...]]:
    mean, squares = _mean(n_axes), _squares(n_axes)
    return lambda values: (mean(squares(values)),)


def _predict(count: int) -> Callable[..., tuple[tuple[float, ...], tuple[float, ...]]]:
    """Function that predicts so many covariances.

    It returns the variance of the innovation for each, and for each eight numbers: the variance of
    the plot, P₁₁ before, and the covariance predicted without process noise.
    """
    if count == 0:
        return lambda dt, phi, least, variances, memory: ((), ())
    before, last, at = _predict(count - 1), count - 1, _HEAD + _SIX * (count - 1)

    def one_more(
        dt: float, phi: float, least: float, variances: tuple[float, ...], memory: Memory
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        expected, predicted = before(dt, phi, least, variances, memory)
        p11, p12, p13, p22, p23, p33 = predict_singer(
            memory[at], memory[at + 1], memory[at + 2],
            memory[at + 3], memory[at + 4], memory[at + 5], dt, phi,
        )  # fmt: skip
        p11 = p11 if p11 > 0.0 else 0.0
        r = variances[last]
        six = (p11, p12, p13, p22, p23, p33)
        return (*expected, p11 + least + r), (*predicted, r, memory[at], *six)

    return one_more


def _first_covariance(velocity_sigma: float | None) -> Callable[..., Covariance3]:
    """Function from r, P₁₁ before, time since the first plot and the variance of acceleration.

    It returns the covariance after the first plot or, where that left the velocity unknown, after
    the second one.
    """
    if velocity_sigma is not None:
        variance = velocity_sigma * velocity_sigma
        return lambda r, before, span, q: (r, 0.0, 0.0, variance, 0.0, q)

    def of_two_plots(r: float, before: float, span: float, q: float) -> Covariance3:
        rate = 1.0 / span
        r = r if r < math.inf else before
        velocity = (before + r) * rate * rate + 0.25 * q * span * span
        return r, r * rate, 0.0, velocity, 0.5 * q * span, q

    return of_two_plots


def _correct(
    count: int, first_covariance: Callable[..., Covariance3]
) -> Callable[..., tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...], Memory]]:
    """Function that adds process noise to so many covariances, and corrects them.

    It returns α, β and γ for each, and the covariances.
    """
    if count == 0:
        return lambda kept, dt, q, g1, g2, starts, span, first: ((), (), (), ())
    before, at = _correct(count - 1, first_covariance), 2 * _HEAD + (_SIX + 2) * (count - 1)

    def one_more(
        kept: Memory, dt: float, q: float, g1: float, g2: float, starts: bool, span: float,
        first: float,
    ) -> tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...], Memory]:  # fmt: skip
        alpha, beta, gamma, covariances = before(kept, dt, q, g1, g2, starts, span, first)
        r = kept[at]
        noisy = add_onset(
            kept[at + 2], kept[at + 3], kept[at + 4], kept[at + 5], kept[at + 6], kept[at + 7],
            q, g1, g2,
        )  # fmt: skip
        k1, k2, k3, p = correct_optimally(
            noisy[0], noisy[1], noisy[2], noisy[3], noisy[4], noisy[5], r
        )
        k1 = 1.0 if starts else k1
        k2 = 1.0 / span if starts else k2
        k3 = 0.0 if starts else k3
        p = first_covariance(r, kept[at + 1], span, first) if starts else p
        return (
            (*alpha, k1),
            (*beta, k2 * dt),
            (*gamma, 2.0 * k3 * dt * dt),
            (*covariances, *p),
        )

    return one_more
