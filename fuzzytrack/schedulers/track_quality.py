"""Gains from the quality of a track, which plots raise and missed plots lower."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.gains.checks import finite
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory, schedulers
from fuzzytrack.schedulers.growing_memory import least_squares_gains

__all__ = ["QualityGains"]


def quality_gains(quality: float) -> tuple[float, float]:
    """α and β at a quality >= 1; see `fuzzytrack.gains.quality`."""
    alpha, _ = least_squares_gains(quality + 2.0)
    root = math.sqrt(quality * (quality + 1.0) / ((quality + 2.0) * (quality + 3.0)))
    q = alpha / (1.0 + root)
    return alpha, 2.0 * q * q


@schedulers.register("track-quality")
@dataclass(frozen=True, repr=False)
class QualityGains(GainScheduler):
    """Gains from the quality factor N of a track, as Zhang & Jiang track vessels.

    α is that of a line fitted to N + 2 plots, β Kalata's with it. N is 1 after the first two plots,
    rises by 1 with each plot up to a cap, and falls with each miss, not below 1.

    Parameters
    ----------
    cap : float
        Highest quality, >= 1. With 10 the gains fall to those of α = 0.295, which is enough for a
        vessel that turns. The paper's table has 30 entries, see `as_published`.
    drop : float
        Loss of quality by a miss, >= 0.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    Notes
    -----
    Zhang & Jiang, formulas of the gate and of the smoothing filter. The paper states only that a
    miss lowers the quality by more than 1; 3 is our choice. From an N of about 12 on, the gains are
    too small for a vessel that turns: with the cap of 30, tracks of turning vessels lag and are
    lost, unless `drop` is 10 or more. The memory is the quality, -1 before the first plot and 0
    after it; a gate can use it. With a one-point start the gains at a quality of 0 are those of 1.

    Examples
    --------
    >>> from fuzzytrack.schedulers.track_quality import QualityGains
    >>> QualityGains.as_published()
    QualityGains(cap=30.0)
    """

    source: ClassVar[str] = "Zhang & Jiang, quality factor; cap 10 (published: 30)"
    sees_starts = True
    sees_misses = True
    uses_acceleration = False

    cap: float = 10.0
    drop: float = 3.0

    def __post_init__(self) -> None:
        for name, least in (("cap", 1), ("drop", 0)):
            value = float(finite(name, getattr(self, name)))
            if value < least:
                raise ValueError(f"{name} must be >= {least}, got {value:g}")
            object.__setattr__(self, name, value)

    @classmethod
    def as_published(cls) -> QualityGains:
        """With the cap of 30 of the paper's table."""
        return cls(cap=30.0, drop=3.0)

    def initial_memory(self, n_axes: int) -> Memory:
        """No plot yet."""
        return (-1.0,)

    def kernel(self, n_axes: int) -> Kernel:
        """Gains of the quality so far, then the new one; see `GainScheduler.kernel`."""
        cap, drop = self.cap, self.drop

        def track_quality(
            innovation: Any, change: Any, dt: float, sigma: float, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            before = memory[0]
            used = before if before > 1.0 else 1.0
            alpha, beta = quality_gains(used)
            hit = before + 1.0 if before + 1.0 < cap else cap
            fallen = used - drop if used - drop > 1.0 else 1.0
            miss = fallen if fallen < before else before
            after = hit if sigma != math.inf else miss
            return alpha, beta, 0.0, 1.0, (after,)

        return track_quality
