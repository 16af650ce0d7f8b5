"""The cost of a pair by its likelihood."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fuzzytrack.scan.plot_columns import LOG_DENSITY
from fuzzytrack.scan.sensor import Sensor
from fuzzytrack.scan.track_columns import STATUS

__all__ = ["likelihood_cost"]


def likelihood_cost(
    sensor: Sensor, bonus: float
) -> Callable[[Any, int, Any, int, float, float], float]:
    """Cost of a pair as a kernel: less the more likely a plot is of the track than clutter.

    It is minus the gain ``ln(PD/(1 - PD)) + ln N(ν; 0, S) - ln λ + bonus`` (the last one for
    confirmed tracks). Gains below 0.001 are taken for ``0.001·exp(gain - 0.001)``, so a plot in the
    gate is better than none, and the likelier of two unlikely ones better than the other.
    """
    found = math.log(sensor.detection / (1.0 - sensor.detection))

    def cost(
        tracks: Any, i: int, plots: Any, j: int, distance: float, log_likelihood: float
    ) -> float:
        gain = found + log_likelihood - plots[j, LOG_DENSITY]
        if tracks[i, STATUS] == 2.0:
            gain += bonus
        return -gain if gain > 0.001 else -0.001 * math.exp(gain - 0.001)

    return cost
