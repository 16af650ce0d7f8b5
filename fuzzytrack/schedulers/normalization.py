"""Normalisations: from an innovation in metres to the inputs of a rule base.

A normalisation is written like a scheduler's kernel: one scalar function with its own memory.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.gains.checks import finite
from fuzzytrack.plugins import Registry
from fuzzytrack.schedulers.base import Memory

__all__ = [
    "Chan",
    "ChanMagnitude",
    "ChanSigned",
    "Normalization",
    "Normalize",
    "Scale",
    "Smoothed",
    "SmoothedMagnitude",
    "normalizations",
]

#: ``normalize(innovation, change, dt, sigma, memory) -> (signals, memory)``
Normalize = Callable[[Any, Any, float, Any, Memory], tuple[tuple[float, ...], Memory]]


class Normalization(ABC):
    """Turns innovation and change of observation into dimensionless signals.

    Attributes
    ----------
    source : str
        Paper, or other origin.
    signals : tuple of str
        What the kernel returns, in order; a rule base takes its inputs from them, first to first.
    coupled, needs_sigma : bool
        As for a `fuzzytrack.schedulers.base.GainScheduler`.
    """

    source: ClassVar[str] = ""
    signals: ClassVar[tuple[str, ...]] = ()
    coupled: ClassVar[bool] = False
    needs_sigma: ClassVar[bool] = False

    @abstractmethod
    def kernel(self, n_axes: int) -> Normalize:
        """Scalar function to signals and new memory; arguments as of a scheduler's kernel."""

    @abstractmethod
    def initial_memory(self, n_axes: int) -> Memory:
        """Memory of a new track."""


normalizations: Registry[type[Normalization]] = Registry(
    "normalization", "fuzzytrack.normalizations"
)


def relative(part: float, whole: float) -> float:
    """``part`` over the larger magnitude of the two, in [-1, 1]; 0 if both are 0."""
    largest = max(abs(part), abs(whole))
    return part / largest if largest > 0.0 else 0.0


@normalizations.register("chan")
@dataclass(frozen=True)
class Chan(Normalization):
    """Chan's normalisation with absolute denominators, axis by axis.

    E is e over the larger of abs(e) and abs(Δx), and ΔE is E - E′ over the larger of abs(E - E′)
    and abs(E′), where Δx is the change of observation and E′ the previous E (0 at first); 0 where
    both are 0. Both lie in [-1, 1], and E has the sign of the innovation.

    Notes
    -----
    Llinas et al. (1998), Eqs. 3.16 to 3.19, with absolute denominators: read with their signs, E
    would turn round with the direction of travel, against the report's own Fig. 3.6 (see
    `ChanSigned`).
    """

    source: ClassVar[str] = "Llinas et al. (1998), Eqs. 3.16-3.19, absolute denominators"
    signals: ClassVar[tuple[str, ...]] = ("normalised error", "normalised error rate")

    def initial_memory(self, n_axes: int) -> Memory:
        """Previous normalised error, 0."""
        return (0.0,)

    def kernel(self, n_axes: int) -> Normalize:
        """See `Normalization.kernel`."""

        def chan(
            innovation: float, change: float, dt: float, sigma: float, memory: Memory
        ) -> tuple[tuple[float, ...], Memory]:
            error = relative(innovation, change)
            rate = relative(error - memory[0], memory[0])
            return (error, rate), (error,)

        return chan


def relative_signed(part: float, whole: float) -> float:
    """As `relative`, but over the signed ``whole`` where that is the larger one."""
    if abs(part) < abs(whole):
        return part / whole
    return part / abs(part) if part != 0.0 else 0.0


@normalizations.register("chan-signed")
@dataclass(frozen=True)
class ChanSigned(Normalization):
    """Chan's normalisation as the report prints it, with signed denominators.

    E is e/Δx where abs(e) < abs(Δx), else the sign of e; likewise ΔE over E′. For comparison only:
    E has the wrong sign whenever the target moves in the negative direction, and jumps by 2 at
    abs(e) = abs(Δx) there. Where Eq. 3.19 leaves equality open, the sign is taken.

    Notes
    -----
    Llinas et al. (1998), Eqs. 3.16 to 3.19, literally.
    """

    source: ClassVar[str] = "Llinas et al. (1998), Eqs. 3.16-3.19, literally"
    signals: ClassVar[tuple[str, ...]] = ("normalised error", "normalised error rate")

    def initial_memory(self, n_axes: int) -> Memory:
        """Previous normalised error, 0."""
        return (0.0,)

    def kernel(self, n_axes: int) -> Normalize:
        """See `Normalization.kernel`."""

        def chan_signed(
            innovation: float, change: float, dt: float, sigma: float, memory: Memory
        ) -> tuple[tuple[float, ...], Memory]:
            error = relative_signed(innovation, change)
            rate = relative_signed(error - memory[0], memory[0])
            return (error, rate), (error,)

        return chan_signed


Squares = Callable[[Any, Any, Memory], tuple[float, float, Memory]]


def _sum_of_squares(n_axes: int) -> Squares:
    """ΣE² and ΣΔE² over the first axes, with their new memory.

    Built up axis by axis because compiled code can append to a tuple, but not fill one in a loop.
    """
    if n_axes == 0:

        def nothing(innovation: Any, change: Any, memory: Memory) -> tuple[float, float, Memory]:
            return 0.0, 0.0, ()

        return nothing

    before = _sum_of_squares(n_axes - 1)
    last = n_axes - 1

    def one_more(innovation: Any, change: Any, memory: Memory) -> tuple[float, float, Memory]:
        errors, rates, errors_so_far = before(innovation, change, memory)
        error = relative(innovation[last], change[last])
        rate = relative(error - memory[last], memory[last])
        return errors + error * error, rates + rate * rate, (*errors_so_far, error)

    return one_more


@normalizations.register("chan-magnitude")
@dataclass(frozen=True)
class ChanMagnitude(Normalization):
    """Root mean square of Chan's normalised errors over the axes of a track.

    Ẽ² = ΣEᵢ²/n and ΔẼ² = ΣΔEᵢ²/n, both in [0, 1]; Eᵢ and ΔEᵢ as in `Chan`. Coupled: one set of
    gains for all axes.

    Notes
    -----
    Llinas et al. (1998), Eqs. 3.20 and 3.21.
    """

    source: ClassVar[str] = "Llinas et al. (1998), Eqs. 3.20-3.21, after Chan"
    signals: ClassVar[tuple[str, ...]] = ("error magnitude", "error-rate magnitude")
    coupled: ClassVar[bool] = True

    def initial_memory(self, n_axes: int) -> Memory:
        """Previous normalised error of each axis, 0."""
        return (0.0,) * n_axes

    def kernel(self, n_axes: int) -> Normalize:
        """See `Normalization.kernel`."""
        sum_of_squares = _sum_of_squares(n_axes)

        def chan_magnitude(
            innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
        ) -> tuple[tuple[float, ...], Memory]:
            errors, rates, new_memory = sum_of_squares(innovation, change, memory)
            return (math.sqrt(errors / n_axes), math.sqrt(rates / n_axes)), new_memory

        return chan_magnitude


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
        ρ, from 0 (no smoothing) to below 1. A rule base names the normalisation and so has the
        default; for another ρ register a function that makes it under a name of your own.

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


def _sum_of_smoothed(n_axes: int, rho: float) -> Squares:
    """Σs² and Σ(e/σ)² over the first axes, with the new s; built up as `_sum_of_squares`."""
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
