"""The nearest pair first, then the nearest of those that are left."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.association.base import Association, AssociationKernels, associations
from fuzzytrack.scan.association.pair_cost import pair_cost
from fuzzytrack.scan.part import word
from fuzzytrack.scan.setting import Setting

__all__ = ["GreedyAssociation"]


@associations.register("greedy")
@dataclass(frozen=True, repr=False)
class GreedyAssociation(Association):
    """Of all pairs of tracks and plots the nearest first, then the nearest of those that are left.

    Confirmed tracks can choose first; then tentative ones get the plots that these leave, so a
    tentative track beside a confirmed one does not take its plots.
    """

    source: ClassVar[str] = "global nearest neighbor, suboptimal"

    by: str = word("distance", "what near means: distance of the gate, or likelihood against "
                   "clutter", "distance", "likelihood")  # fmt: skip
    first: str = word("confirmed", "which tracks choose first", "confirmed", "all")

    def integers(self, rows: int, plots: int, edges: int) -> int:
        """A heap of edges, and the track of each."""
        return 2 * edges

    def kernels(self, setting: Setting) -> AssociationKernels:
        """Kernels of this part."""
        return AssociationKernels(pair_cost(setting.sensor, self.by, self.first), _assign)


def _comes_before(a: int, b: int, cost: Any) -> bool:
    """Whether an edge is taken before another: of the same cost, that of the first track."""
    return bool(cost[a] < cost[b] or (cost[a] == cost[b] and a < b))


def _sink(top: int, size: int, heap: Any, cost: Any) -> None:
    """Let an edge sink in a heap of `size` until none below it comes before it."""
    edge = heap[top]
    while 2 * top + 1 < size:
        child = 2 * top + 1
        if child + 1 < size and _comes_before(heap[child + 1], heap[child], cost):
            child += 1
        if not _comes_before(heap[child], edge, cost):
            break
        heap[top] = heap[child]
        top = child
    heap[top] = edge


def _assign(
    rows: int, count: int, first: Any, plot: Any, cost: Any, plot_of: Any, track_of: Any,
    integers: Any, numbers: Any,
) -> None:  # fmt: skip
    size = first[rows]
    for i in range(rows):
        for e in range(first[i], first[i + 1]):
            integers[e] = e
            integers[size + e] = i
    for top in range(size // 2 - 1, -1, -1):
        _sink(top, size, integers, cost)
    left = size
    while left > 0:
        e = integers[0]
        i, j = integers[size + e], plot[e]
        if plot_of[i] < 0 and track_of[j] < 0:
            plot_of[i], track_of[j] = j, i
        left -= 1
        integers[0] = integers[left]
        _sink(0, left, integers, cost)
