"""Each track takes the plot nearest to it, unless that is nearer to another track."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.association.base import Association, AssociationKernels, associations
from fuzzytrack.scan.association.pair_cost import pair_cost
from fuzzytrack.scan.part import word
from fuzzytrack.scan.setting import Setting

__all__ = ["NearestAssociation"]


@associations.register("nearest")
@dataclass(frozen=True, repr=False)
class NearestAssociation(Association):
    """Each track asks for the plot nearest to it; a plot goes to the nearest of those that ask.

    A track whose plot goes to another gets none, even if there is a second one in its gate.
    """

    source: ClassVar[str] = "nearest neighbor"

    by: str = word("distance", "what near means: distance of the gate, or likelihood against "
                   "clutter", "distance", "likelihood")  # fmt: skip
    first: str = word("confirmed", "which tracks come first", "confirmed", "all")

    def numbers(self, rows: int, plots: int, edges: int) -> int:
        """Cost of the pair of each plot."""
        return plots

    def kernels(self, setting: Setting) -> AssociationKernels:
        """Kernels of this part."""
        return AssociationKernels(pair_cost(setting.sensor, self.by, self.first), _assign)


def _assign(
    rows: int, count: int, first: Any, plot: Any, cost: Any, plot_of: Any, track_of: Any,
    integers: Any, numbers: Any,
) -> None:  # fmt: skip
    for i in range(rows):
        best = first[i]
        for e in range(first[i], first[i + 1]):
            if cost[e] < cost[best]:
                best = e
        if first[i] == first[i + 1]:
            continue
        j = plot[best]
        if track_of[j] < 0 or cost[best] < numbers[j]:
            if track_of[j] >= 0:
                plot_of[track_of[j]] = -1
            plot_of[i], track_of[j] = j, i
            numbers[j] = cost[best]
