"""Plug-ins of all kinds, found by fuzzytrack by entry points."""

from dataclasses import dataclass
from typing import ClassVar

from fuzzytrack.normalizations import Normalization
from fuzzytrack.schedulers import GainScheduler
from fuzzytrack_two_speed.averaged import Averaged
from fuzzytrack_two_speed.first_come import FirstCome
from fuzzytrack_two_speed.sonar_log import SonarLog

__all__ = ["Averaged", "FirstCome", "SoftSign", "SonarLog", "TwoSpeed"]


@dataclass(frozen=True)
class TwoSpeed(GainScheduler):
    """Quiet gains while innovations look like noise, agile ones after a surprise.

    Parameters
    ----------
    threshold : float
        Innovation, in standard deviations of the plot, that counts as a surprise.
    hold : int
        Updates for which the agile gains stay.
    """

    source: ClassVar[str] = "example plug-in"
    needs_sigma: ClassVar[bool] = True
    uses_acceleration: ClassVar[bool] = False

    threshold: float = 3.0
    hold: int = 4

    def initial_memory(self, n_axes):
        """Updates left with agile gains."""
        return (0.0,)

    def kernel(self, n_axes):
        """See `GainScheduler.kernel`."""
        threshold, hold = self.threshold, float(self.hold)

        def two_speed(innovation, change, dt, sigma, memory):
            surprised = abs(innovation) > threshold * sigma
            left = hold if surprised else max(memory[0] - 1.0, 0.0)
            agile = left > 0.0
            alpha = 0.8 if agile else 0.4
            beta = 0.6 if agile else 0.1
            return alpha, beta, 0.0, 1.0, (left,)

        return two_speed


@dataclass(frozen=True)
class SoftSign(Normalization):
    """Innovation as e/(|e| + σ), and its change since the last update over 2: both in [-1, 1]."""

    source: ClassVar[str] = "example plug-in"
    signals: ClassVar[tuple[str, ...]] = ("soft sign of innovation", "half its change")
    needs_sigma: ClassVar[bool] = True

    def initial_memory(self, n_axes):
        """Previous value."""
        return (0.0,)

    def kernel(self, n_axes):
        """See `Normalization.kernel`."""

        def soft_sign(innovation, change, dt, sigma, memory):
            error = innovation / (abs(innovation) + sigma)
            return (error, (error - memory[0]) / 2.0), (error,)

        return soft_sign
