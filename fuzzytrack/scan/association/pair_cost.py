"""The cost of a pair by its distance or its likelihood, confirmed tracks first or not."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fuzzytrack.scan.association.likelihood_cost import likelihood_cost
from fuzzytrack.scan.sensor import Sensor
from fuzzytrack.scan.track_columns import STATUS

__all__ = ["pair_cost"]

#: More than any gain by likelihood (nats).
_FIRST = 1e6


def pair_cost(
    sensor: Sensor, by: str, first: str
) -> Callable[[Any, int, Any, int, float, float], float]:
    """Cost of a pair as a kernel.

    By distance it is ``-1/(1 + distance)``, else that of
    `fuzzytrack.scan.association.likelihood_cost`. Where confirmed tracks come first, all their
    pairs cost less than those of tentative ones.
    """
    by_distance, confirmed_first = by == "distance", first == "confirmed"
    by_likelihood = likelihood_cost(sensor, 0.0)

    def cost(
        tracks: Any, i: int, plots: Any, j: int, distance: float, log_likelihood: float
    ) -> float:
        if by_distance:
            price = -1.0 / (1.0 + distance)
        else:
            price = by_likelihood(tracks, i, plots, j, distance, log_likelihood)
        if confirmed_first and tracks[i, STATUS] == 2.0:
            price -= 1.0 if by_distance else _FIRST
        return price

    return cost
