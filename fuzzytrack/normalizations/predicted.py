"""Normalisations that measure the innovation against noise: the plot's, or the prediction's too."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.gains.checks import finite
from fuzzytrack.kernels.language import Memory
from fuzzytrack.normalizations.chan import (
    Feedback,
    Normalization,
    Normalize,
    normalizations,
)

__all__ = ["Predicted", "Scale", "Smoothed", "SmoothedMagnitude"]


@normalizations.register("scale")
@dataclass(frozen=True)
class Scale(Normalization):
    """Innovation over the standard deviation of the plot, and its change since the last update.

    E = e/σ and ΔE = E - E′ (E′ = 0 at first). Unbounded: a rule base takes values outside its
    universe at the nearest end.
    """

    source: ClassVar[str] = "innovation scaled by measurement noise"
    signals: ClassVar[tuple[str, ...]] = ("scaled innovation", "change of scaled innovation")
    needs_sigma: ClassVar[bool] = True

    def initial_memory(self, n_axes: int) -> Memory:
        """Previous scaled innovation, 0."""
        return (0.0,)

    def kernel(self, n_axes: int) -> Normalize:
        """See `Normalization.kernel`."""

        def scale(
            innovation: float, change: float, dt: float, sigma: float, memory: Memory
        ) -> tuple[tuple[float, ...], Memory]:
            error = innovation / sigma
            return (error, error - memory[0]), (error,)

        return scale


def _check_rho(rho: float) -> float:
    value = float(finite("rho", rho))
    if not 0 <= value < 1:
        raise ValueError(f"rho must be >= 0 and < 1, got {value:g}")
    return value


@normalizations.register("smoothed")
@dataclass(frozen=True)
class Smoothed(Normalization):
    """Exponentially smoothed innovation over the standard deviation of the plot, axis by axis.

    s = ρs′ + (1 - ρ)e/σ, with s′ the s of the update before (0 at first), and e/σ itself as the
    second signal. Noise averages out of s and a lag behind the target does not, so s tells a
    manoeuvre from noise, which the single innovation cannot. Unbounded: a rule base takes values
    outside its universe at the nearest end.

    Parameters
    ----------
    rho : float
        ρ, from 0 (no smoothing) to below 1.

    Raises
    ------
    ValueError
        If `rho` is out of range.
    """

    source: ClassVar[str] = "innovation scaled by measurement noise, exponentially smoothed"
    signals: ClassVar[tuple[str, ...]] = ("smoothed scaled innovation", "scaled innovation")
    needs_sigma: ClassVar[bool] = True

    rho: float = 0.774

    def __post_init__(self) -> None:
        object.__setattr__(self, "rho", _check_rho(self.rho))

    def initial_memory(self, n_axes: int) -> Memory:
        """Smoothed innovation, 0."""
        return (0.0,)

    def kernel(self, n_axes: int) -> Normalize:
        """See `Normalization.kernel`."""
        rho, new = self.rho, 1.0 - self.rho

        def smoothed(
            innovation: float, change: float, dt: float, sigma: float, memory: Memory
        ) -> tuple[tuple[float, ...], Memory]:
            error = innovation / sigma
            mean = rho * memory[0] + new * error
            return (mean, error), (mean,)

        return smoothed


Squares = Callable[[Any, Any, Memory], tuple[float, float, Memory]]


def _sum_of_smoothed(n_axes: int, rho: float) -> Squares:
    """Σs² and Σ(e/σ)² over the first axes, with the new s.

    Built up axis by axis, since compiled code cannot fill a tuple in a loop.
    """
    if n_axes == 0:

        def nothing(innovation: Any, sigma: Any, memory: Memory) -> tuple[float, float, Memory]:
            return 0.0, 0.0, ()

        return nothing

    before = _sum_of_smoothed(n_axes - 1, rho)
    last, new = n_axes - 1, 1.0 - rho

    def one_more(innovation: Any, sigma: Any, memory: Memory) -> tuple[float, float, Memory]:
        means, errors, means_so_far = before(innovation, sigma, memory)
        error = innovation[last] / sigma[last]
        mean = rho * memory[last] + new * error
        return means + mean * mean, errors + error * error, (*means_so_far, mean)

    return one_more


@normalizations.register("smoothed-magnitude")
@dataclass(frozen=True)
class SmoothedMagnitude(Normalization):
    """Root mean square of the smoothed scaled innovations over the axes of a track.

    The root of Σsᵢ²/n, with sᵢ as in `Smoothed`, and that of Σ(eᵢ/σᵢ)²/n. Coupled: one set of gains
    for all axes.

    Parameters
    ----------
    rho : float
        As for `Smoothed`.

    Raises
    ------
    ValueError
        If `rho` is out of range.
    """

    source: ClassVar[str] = "innovation scaled by measurement noise, exponentially smoothed"
    signals: ClassVar[tuple[str, ...]] = (
        "magnitude of smoothed scaled innovation",
        "magnitude of scaled innovation",
    )
    coupled: ClassVar[bool] = True
    needs_sigma: ClassVar[bool] = True

    rho: float = 0.774

    def __post_init__(self) -> None:
        object.__setattr__(self, "rho", _check_rho(self.rho))

    def initial_memory(self, n_axes: int) -> Memory:
        """Smoothed innovation of each axis, 0."""
        return (0.0,) * n_axes

    def kernel(self, n_axes: int) -> Normalize:
        """See `Normalization.kernel`."""
        sum_of_smoothed = _sum_of_smoothed(n_axes, self.rho)

        def smoothed_magnitude(
            innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
        ) -> tuple[tuple[float, ...], Memory]:
            means, errors, new_memory = sum_of_smoothed(innovation, sigma, memory)
            return (math.sqrt(means / n_axes), math.sqrt(errors / n_axes)), new_memory

        return smoothed_magnitude


# What the first number of the memory of `Predicted` says about the track.
_NEW, _ONE_PLOT, _RUNNING = 0.0, 1.0, 2.0


@normalizations.register("predicted")
@dataclass(frozen=True)
class Predicted(Normalization):
    """Innovation over the standard deviation that noise alone gives it, and its change.

    E = e/√S and ΔE = E - E′ (E′ = 0 at first). S = P₁₁ + σ² is the variance of the innovation of a
    target that does not manoeuvre, with P the covariance that the noise of the plots has left in
    the prediction by way of the gains that were in use. So E has variance 1 on a straight run
    whatever the gains: after large ones, and after missed plots, the same innovation counts for
    less than with `Scale`. Unbounded: a rule base takes values outside its universe at the nearest
    end.

    Notes
    -----
    Prediction P⁻ = ΦPΦᵀ without process noise; correction in Joseph form,
    P = (I - KH)P⁻(I - KH)ᵀ + Kσ²Kᵀ with K = (α, β/T, γ/(2T²)), which holds for any gains. At
    constant gains, T and σ, S settles at σ²(1 + ρ²), ρ² as in `fuzzytrack.gains.noise_ratio`.
    The track is taken to start from two plots, as trackers do unless told otherwise; until then
    E = 0. The memory is (phase, P₁₁, P₁₂, P₁₃, P₂₂, P₂₃, P₃₃, time since the first plot (s), E),
    with a phase of 0 before the first plot, 1 before the second and 2 from then on.
    """

    source: ClassVar[str] = "innovation scaled by its standard deviation for the gains in use"
    signals: ClassVar[tuple[str, ...]] = (
        "innovation over its predicted standard deviation",
        "change of that",
    )
    needs_sigma: ClassVar[bool] = True
    sees_every_step: ClassVar[bool] = True

    def initial_memory(self, n_axes: int) -> Memory:
        """No plot yet."""
        return (_NEW, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    def kernel(self, n_axes: int) -> Normalize:
        """Predict the covariance and divide; see `Normalization.kernel`."""

        def predicted(
            innovation: float, change: float, dt: float, sigma: float, memory: Memory
        ) -> tuple[tuple[float, ...], Memory]:
            phase, p11, p12, p13, p22, p23, p33, span, before = memory
            g = 0.5 * dt * dt
            a11 = p11 + dt * p12 + g * p13
            a12 = p12 + dt * p22 + g * p23
            a13 = p13 + dt * p23 + g * p33
            a22 = p22 + dt * p23
            a23 = p23 + dt * p33
            p11 = a11 + dt * a12 + g * a13

            seen = sigma != math.inf
            known = seen & (phase == _RUNNING)
            s = p11 + (sigma * sigma if seen else 1.0)
            error = innovation / math.sqrt(s) if known else 0.0
            signals = (error, error - before if known else 0.0)
            last = error if known else before
            return signals, (
                phase, p11, a12 + dt * a13, a13, a22 + dt * a23, a23, p33, span + dt, last
            )  # fmt: skip

        return predicted

    def feedback(self, n_axes: int) -> Feedback:
        """Correct the covariance for the gains; see `Normalization.feedback`."""

        def corrected(
            memory: Memory, alpha: float, beta: float, gamma: float, dt: float, sigma: float
        ) -> Memory:
            phase, p11, p12, p13, p22, p23, p33, span, last = memory
            seen = sigma != math.inf
            r = sigma * sigma if seen else 1.0
            # The second plot gives position and, by its distance from the first, velocity.
            second = phase == _ONE_PLOT
            k1 = 1.0 if second else alpha
            k2 = 1.0 / span if second else beta / dt
            k3 = 0.0 if second else gamma / (2.0 * dt * dt)
            k1 = k1 if seen else 0.0
            k2 = k2 if seen else 0.0
            k3 = k3 if seen else 0.0

            s = p11 + r
            rest = 1.0 - k1
            n11 = rest * rest * p11 + k1 * k1 * r
            n12 = rest * (p12 - k2 * p11) + k1 * k2 * r
            n13 = rest * (p13 - k3 * p11) + k1 * k3 * r
            n22 = p22 - k2 * (2.0 * p12 - k2 * s)
            n23 = p23 - k2 * p13 - k3 * (p12 - k2 * s)
            n33 = p33 - k3 * (2.0 * p13 - k3 * s)

            new = phase == _NEW
            after = _RUNNING if seen else phase
            after = _ONE_PLOT if new else after
            return (
                after,
                r if new else n11,
                0.0 if new else n12,
                0.0 if new else n13,
                0.0 if new else n22,
                0.0 if new else n23,
                0.0 if new else n33,
                0.0 if new else span,
                last,
            )

        return corrected
