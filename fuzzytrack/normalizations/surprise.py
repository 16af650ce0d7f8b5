"""Size and agreement of the innovations, over the standard deviation that is expected of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.gains.checks import positive
from fuzzytrack.gains.singer import fade
from fuzzytrack.kernels.language import Memory
from fuzzytrack.normalizations.base import Normalization, Normalize, normalizations

__all__ = ["Surprise"]

SIGNALS = ("surprise", "agreement of successive innovations")


@normalizations.register("surprise")
@dataclass(frozen=True, repr=False)
class Surprise(Normalization):
    """Size of the smoothed normalized innovation over all axes, and agreement of successive ones.

    The innovation is divided by the standard deviation that the conversion ``covariance`` expects
    of it on a straight run, and shortened to the length `clip`: ν. With r = fade(dt/time), the
    signals are the length of s = r s′ + √(1 - r²) ν and, with r = fade(dt/agreement_time),
    c = r c′ + √(1 - r²) ν·ν′, where s′, c′ and ν′ are those of the update before (0 at first).
    White innovations give s and c the same variances at any sampling.

    Parameters
    ----------
    time : float
        Time of the smoothing of ν, in units of the conversion, > 0.
    clip : float
        Longest ν, > 0: a single plot cannot weigh more.
    agreement_time : float, optional
        Time of the smoothing of ν·ν′, in units of the conversion, > 0; without it the only signal
        is the surprise.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    Notes
    -----
    `fade` is `fuzzytrack.gains.singer.fade`. The memory is s of each axis and, with agreement, ν′
    of each axis and c.
    """

    source: ClassVar[str] = "innovation over its standard deviation, smoothed, and its correlation"
    # Without an agreement time, of the first alone.
    signals: ClassVar[tuple[str, ...]] = SIGNALS
    numbers: ClassVar[Mapping[str, str]] = {
        "time": "Time over which the normalized innovation is smoothed, in τ₀.",
        "clip": "Greatest length of a normalized innovation.",
        "agreement_time": "Time over which their agreement is smoothed, in τ₀.",
    }
    coupled: ClassVar[bool] = True
    needs_sigma: ClassVar[bool] = True
    uses_expectation: ClassVar[bool] = True

    time: float = 6.5
    clip: float = 4.0
    agreement_time: float | None = None

    def __post_init__(self) -> None:
        for name in ("time", "clip", "agreement_time"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, float(positive(name, value)))
        if self.agreement_time is None:
            object.__setattr__(self, "signals", SIGNALS[:1])

    def initial_memory(self, n_axes: int) -> Memory:
        """Nothing smoothed yet."""
        return (0.0,) * (n_axes if self.agreement_time is None else 2 * n_axes + 1)

    def kernel(self, n_axes: int) -> Normalize:
        """See `Normalization.kernel`."""
        squared_length = _squared_length(n_axes)
        smooth = _smooth(n_axes)
        rate, least = 1.0 / self.time, 1.0 / (self.clip * self.clip)

        def sizes(
            innovation: Any, dt: float, variance: Any, memory: Memory
        ) -> tuple[float, Memory, Memory]:
            excess = least * squared_length(innovation, variance)
            excess = excess if excess > 1.0 else 1.0
            r = fade(rate * dt)
            return smooth(innovation, variance, memory, excess, r, math.sqrt(1.0 - r * r))

        if self.agreement_time is None:

            def surprise(
                innovation: Any, change: Any, dt: float, variance: Any, memory: Memory
            ) -> tuple[tuple[float, ...], Memory]:
                squares, smoothed, _ = sizes(innovation, dt, variance, memory)
                return (math.sqrt(squares),), smoothed

            return surprise

        dot, last = _dot(n_axes, n_axes), 2 * n_axes
        agreement_rate = 1.0 / self.agreement_time

        def surprise_and_agreement(
            innovation: Any, change: Any, dt: float, variance: Any, memory: Memory
        ) -> tuple[tuple[float, ...], Memory]:
            squares, smoothed, normalized = sizes(innovation, dt, variance, memory)
            r = fade(agreement_rate * dt)
            product = dot(normalized, memory)
            agreement = r * memory[last] + math.sqrt(1.0 - r * r) * product
            return (math.sqrt(squares), agreement), (*smoothed, *normalized, agreement)

        return surprise_and_agreement


# Built up axis by axis, since compiled code cannot fill a tuple in a loop.
def _squared_length(n_axes: int) -> Callable[[Any, Any], float]:
    """Σe²/S over the first axes."""
    if n_axes == 0:
        return lambda innovation, variance: 0.0
    before, last = _squared_length(n_axes - 1), n_axes - 1

    def one_more(innovation: Any, variance: Any) -> float:
        e = innovation[last]
        squares: float = before(innovation, variance) + e * e * (1.0 / variance[last])
        return squares

    return one_more


def _smooth(n_axes: int) -> Callable[..., tuple[float, Memory, Memory]]:
    """Σs² over the first axes, s and ν of each, for ν = e/√(S·excess).

    Axes of one variance share the divisions and the root in compiled code.
    """
    if n_axes == 0:
        return lambda innovation, variance, memory, excess, r, weight: (0.0, (), ())
    before, last = _smooth(n_axes - 1), n_axes - 1

    def one_more(
        innovation: Any, variance: Any, memory: Memory, excess: float, r: float, weight: float
    ) -> tuple[float, Memory, Memory]:
        squares, smoothed, normalized = before(innovation, variance, memory, excess, r, weight)
        nu = innovation[last] * math.sqrt((1.0 / variance[last]) / excess)
        s = r * memory[last] + weight * nu
        return squares + s * s, (*smoothed, s), (*normalized, nu)

    return one_more


def _dot(n_axes: int, offset: int) -> Callable[[Memory, Memory], float]:
    """Inner product of a vector and the one that lies in a memory from `offset` on."""
    if n_axes == 0:
        return lambda vector, memory: 0.0
    before, last = _dot(n_axes - 1, offset), n_axes - 1

    def one_more(vector: Memory, memory: Memory) -> float:
        return before(vector, memory) + vector[last] * memory[offset + last]

    return one_more
