"""Chan's normalizations: the innovation over the larger of itself and the change of observation."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.kernels.language import Memory
from fuzzytrack.normalizations.base import Normalization, Normalize, normalizations

__all__ = ["Chan", "ChanMagnitude", "ChanSigned"]

#: Least denominator; single precision can represent it, too.
_LEAST = 1e-30


def relative(part: float, whole: float) -> float:
    """``part`` over the larger magnitude of the two, in [-1, 1]; 0 if both are 0."""
    size, other = abs(part), abs(whole)
    largest = size if size > other else other
    # The denominator is never 0; a maximum takes less time than a branch.
    return part / (largest if largest > _LEAST else _LEAST)


@normalizations.register("chan")
@dataclass(frozen=True, repr=False)
class Chan(Normalization):
    """Chan's normalization with absolute denominators, axis by axis.

    E is e over the larger of abs(e) and abs(Δx), and ΔE is E - E′ over the larger of abs(E - E′)
    and abs(E′), where Δx is the change of observation and E′ the previous E (0 at first); 0 where
    both are 0. Both lie in [-1, 1], and E has the sign of the innovation.

    Notes
    -----
    Llinas et al. (1998), Eqs. 3.16 to 3.19, with absolute denominators: with signed ones the sign
    of E would depend on the direction of travel, contrary to the report's own Fig. 3.6 (see
    `ChanSigned`).
    """

    source: ClassVar[str] = "Llinas et al. (1998), Eqs. 3.16-3.19, absolute denominators"
    signals: ClassVar[tuple[str, ...]] = ("normalized error", "normalized error rate")

    def initial_memory(self, n_axes: int) -> Memory:
        """Previous normalized error, 0."""
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
@dataclass(frozen=True, repr=False)
class ChanSigned(Normalization):
    """Chan's normalization as the report prints it, with signed denominators.

    E is e/Δx where abs(e) < abs(Δx), else the sign of e; likewise ΔE over E′. For comparison only:
    E has the wrong sign when the target moves in the negative direction, and jumps by 2 at
    abs(e) = abs(Δx) there. Where Eq. 3.19 leaves equality open, the sign is taken.

    Notes
    -----
    Llinas et al. (1998), Eqs. 3.16 to 3.19, literally.
    """

    source: ClassVar[str] = "Llinas et al. (1998), Eqs. 3.16-3.19, literally"
    signals: ClassVar[tuple[str, ...]] = ("normalized error", "normalized error rate")

    def initial_memory(self, n_axes: int) -> Memory:
        """Previous normalized error, 0."""
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
@dataclass(frozen=True, repr=False)
class ChanMagnitude(Normalization):
    """Root mean square of Chan's normalized errors over the axes of a track.

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
        """Previous normalized error of each axis, 0."""
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
