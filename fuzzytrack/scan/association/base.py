"""Role: which plot is that of which track."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzytrack.plugins import Registry
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.setting import Setting

__all__ = ["Association", "AssociationKernels", "associations"]


class AssociationKernels(NamedTuple):
    """Kernels of an association.

    Attributes
    ----------
    cost : callable
        ``cost(tracks, i, plots, j, distance, log_likelihood) -> cost``, < 0: what it costs to give
        plot j to track i, where a track without a plot costs 0. `distance` is that of the gate.
    assign : callable
        ``assign(rows, count, first, plot, cost, plot_of, track_of, integers, numbers)``: chooses
        pairs. Edges of track i are those from ``first[i]`` to ``first[i + 1] - 1``; `plot` and
        `cost` are theirs. Writes the plot of each of the `rows` tracks to `plot_of`, and the track
        of each of the `count` plots to `track_of`; both are -1 before.
    """

    cost: Callable[[Any, int, Any, int, float, float], float]
    assign: Callable[[int, int, Any, Any, Any, Any, Any, Any, Any], None]


class Association(Part):
    """Gives each plot to one track at most, and each track one plot at most."""

    def integers(self, rows: int, plots: int, edges: int) -> int:
        """How many whole numbers it needs for so many tracks, plots and edges."""
        return 0

    def numbers(self, rows: int, plots: int, edges: int) -> int:
        """How many numbers it needs for so many tracks, plots and edges."""
        return 0

    @abstractmethod
    def kernels(self, setting: Setting) -> AssociationKernels:
        """Kernels of this part."""


associations: Registry[type[Association]] = Registry(
    "association", "fuzzytrack.scan.association", Association
)
