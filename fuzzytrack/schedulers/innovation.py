"""Gains from the variance of the last innovations."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from fuzzytrack.gains.checks import positive, positive_deviation
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory, schedulers

__all__ = ["InnovationScheduler"]

FLOORS = ("max", "negative")
LONGEST_WINDOW = 64

# Squares of a noise of 1e-15 m and of a step of 3e-8 s; with less, a divisor could become 0.
_LEAST_VARIANCE, _LEAST_SQUARE = 1e-30, 1e-15
_LARGEST_INDEX = 10.0


def kalata_gains(index: float) -> tuple[float, float]:
    """α and β at a tracking index >= 0, 10 at most; see `fuzzytrack.gains.kalata`."""
    index = index if index < _LARGEST_INDEX else _LARGEST_INDEX
    root = math.sqrt(index)
    q = 2.0 * root / (root + math.sqrt(index + 8.0))
    return q * (2.0 - q), 2.0 * q * q


@schedulers.register("innovation")
@dataclass(frozen=True, repr=False)
class InnovationScheduler(GainScheduler):
    """Gains from the mean square of the last innovations, after Kim & Lee.

    The part of that mean square S that the noise of the plots does not explain is attributed to
    maneuvers. It gives a variance of the target's acceleration, this gives the tracking index
    λ = σ_v T²/σ_w, and λ gives the gains of the steady Kalman filter.

    By default (``q_scale=None``) the state's covariance is the one that belongs to the new gains;
    then S = σ_w²/(1 - α), and simply α = 1 - σ_w²/S. `as_published` is the paper's form.

    Parameters
    ----------
    sigma_d : float
        Standard deviation σ_D of the acceleration (m/s²), > 0: the least one that is assumed, or
        the one where the innovations give none, see `floor`. With `q_scale` also the one of the
        paper's steady covariance P₀.
    window : int
        Number N of innovations, from 1 to 64.
    q_scale : float, optional
        Standard deviation σ_Q (m/s²), > 0, of the paper's process covariance Q = GGᵀσ_Q²:
        σ_v² is then the factor φ = (4/(T⁴σ_Q²))·(S - σ_w²/(1 - α₀)) + (σ_D/σ_Q)², with α₀ the
        gain at σ_D. **With q_scale=1, the text with consistent units, gains stay large long after
        a maneuver**: large gains make large innovations, and these large gains.
    extra_term : bool
        Whether N + 1 squares are added up and divided by N, as Eq. 16 is printed.
    partial : bool
        Whether the innovations so far count while the window is not full; otherwise the gains are
        those of σ_D until then.
    floor : {"max", "negative"}
        ``max``: σ_v is at least σ_D. ``negative``: σ_v is σ_D only where the noise alone explains
        more than S, as Eq. 17 is printed; the gains may then come near 0.

    Raises
    ------
    ValueError
        If a parameter is out of its range or unknown.

    Notes
    -----
    Kim & Lee, Eqs. 5 to 17. The default assumes nothing about the size of a maneuver except the
    floor, does not depend on units, and its gains become small again after a maneuver. Where the
    target's acceleration is known, fixed gains for it are as good.

    T is the time since the last plot that was seen, and β is for a step of that length; the paper
    has no missed plots. With the last time step instead, the larger innovations after a gap would
    be taken for a maneuver, the gains would be too large for the gap, and some tracks would
    oscillate without bound. λ is at most 10 (α 0.979, β 1.459), which is not in the paper: with a
    larger λ a pole comes near -1, and after one plot far off, the track would oscillate for as long
    as S is large.

    The memory is the number of squares kept, the number of plots up to 2, the time since the last
    one (s), and the squares, the newest first. The first two plots start a track and have no
    innovation.

    Examples
    --------
    >>> from fuzzytrack.schedulers.innovation import InnovationScheduler
    >>> InnovationScheduler.as_published().window
    12
    """

    source: ClassVar[str] = "Kim & Lee, adaptive alpha-beta tracker, Eqs. 5-17"
    needs_sigma = True
    sees_starts = True
    uses_acceleration = False

    sigma_d: float = 15.0
    window: int = 8
    q_scale: float | None = None
    extra_term: bool = False
    partial: bool = True
    floor: str = "max"

    def __post_init__(self) -> None:
        object.__setattr__(self, "sigma_d", float(positive_deviation("sigma_d", self.sigma_d)))
        if self.q_scale is not None:
            object.__setattr__(self, "q_scale", float(positive("q_scale", self.q_scale)))
        if int(self.window) != self.window or not 1 <= self.window <= LONGEST_WINDOW:
            raise ValueError(
                f"window must be a whole number from 1 to {LONGEST_WINDOW}, got {self.window}"
            )
        object.__setattr__(self, "window", int(self.window))
        if self.floor not in FLOORS:
            raise ValueError(f"floor must be one of {', '.join(FLOORS)}, got {self.floor!r}")

    @classmethod
    def as_published(
        cls, sigma_d: float = 5.0, q_scale: float = 5.0, window: int = 12
    ) -> InnovationScheduler:
        """The paper's form: Eqs. 14 to 17 as printed, adapting once the window is full.

        Parameters
        ----------
        sigma_d, q_scale : float
            As above. The paper states neither; with 5 m/s² its claims hold. With ``q_scale=1``
            gains stay large after a maneuver.
        window : int
            N; 12 in the paper.
        """
        return cls(sigma_d, window, q_scale, extra_term=True, partial=False, floor="negative")

    def initial_memory(self, n_axes: int) -> Memory:
        """No plots, no innovations."""
        return (0.0,) * (3 + self.window + self.extra_term)

    def kernel(self, n_axes: int) -> Kernel:
        """Mean square to tracking index to gains; see `GainScheduler.kernel`."""
        terms = self.window + int(self.extra_term)
        full = float(terms)
        least = 1.0 if self.partial else full
        divisor = float(self.window)
        variance_d = self.sigma_d**2
        literal = self.q_scale is not None
        variance_q = 1.0 if self.q_scale is None else self.q_scale**2
        at_least = self.floor == "max"

        def acceleration_variance(s: float, r: float, square: float) -> float:
            """σ_v² from S and T²; negative where the noise alone explains it."""
            if literal:
                alpha, _ = kalata_gains(math.sqrt(variance_d / r) * square)
                excess = 4.0 * (s - r / (1.0 - alpha)) / (square * square)
                return (excess + variance_d) / variance_q
            if s <= r:
                return -1.0
            # λ² = β²/(1 - α) with 1 - α = r/s and β = 2(1 - √(1 - α))²
            rest = 1.0 - math.sqrt(r / s)
            beta = 2.0 * rest * rest
            return beta * beta * s / (square * square)

        def innovation_variance(
            innovation: float, change: float, dt: float, sigma: float, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            seen = sigma != math.inf
            count, plots, span = memory[0], memory[1], memory[2] + dt
            counts = seen & (plots > 1.0)
            one_more = count + 1.0 if count < full else full
            count = one_more if counts else count
            squares = (innovation * innovation, *memory[3:-1]) if counts else memory[3:]
            total = 0.0
            for square in squares:
                total = total + square
            # While the window is not full, the divisor is smaller in the same proportion.
            s = total / (divisor * ((count if count > 0.0 else 1.0) / full))
            r = sigma * sigma if seen else 1.0
            r = r if r > _LEAST_VARIANCE else _LEAST_VARIANCE
            span_squared = span * span
            span_squared = span_squared if span_squared > _LEAST_SQUARE else _LEAST_SQUARE
            variance = acceleration_variance(s, r, span_squared)
            low = variance < variance_d if at_least else variance < 0.0
            variance = variance_d if low or count < least else variance
            index = math.sqrt(variance / r) * span_squared
            alpha, beta = kalata_gains(index)
            plots = plots + 1.0 if seen & (plots < 2.0) else plots
            after = (count, plots, 0.0 if seen else span, *squares)
            # The tracker divides by the last time step.
            return alpha, beta * (dt / span), 0.0, 1.0, after

        return innovation_variance
