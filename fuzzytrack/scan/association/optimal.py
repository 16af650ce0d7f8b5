"""The pairs of tracks and plots with the least sum of costs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.association.base import Association, AssociationKernels, associations
from fuzzytrack.scan.association.likelihood_cost import likelihood_cost
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.setting import Setting

__all__ = ["OptimalAssociation"]

#: Plots that one search settles at most.
_MOST_SETTLED = 64


@associations.register("optimal")
@dataclass(frozen=True, repr=False)
class OptimalAssociation(Association):
    """The pairs with the least sum of costs, where a track without a plot costs 0.

    Shortest augmenting paths on the edges between tracks and plots (Jonker & Volgenant), with
    prices of plots only. A search cannot leave the tracks and plots that are connected with its
    track, so these parts are solved one by one without being formed. A track and a plot that have
    no other edge are paired at once.

    One search settles at most 64 plots, then its track gets none: a bound for thousands of plots at
    one spot; on radar data the largest search settles some 20.
    """

    source: ClassVar[str] = "Jonker & Volgenant 1987, doi:10.1007/BF02278710"

    bonus: float = parameter(10.1, "added to the gain of a confirmed track", "nats", least=0)

    def integers(self, rows: int, plots: int, edges: int) -> int:
        """Degree, mark and predecessor of plots, a heap, and the plots that are settled."""
        return 3 * plots + (edges + 1) + _MOST_SETTLED + 1

    def numbers(self, rows: int, plots: int, edges: int) -> int:
        """Price, distance, cost of arrival and cost of the pair of plots, and a heap."""
        return 4 * plots + edges + 1

    def kernels(self, setting: Setting) -> AssociationKernels:
        """Kernels of this part."""
        return AssociationKernels(likelihood_cost(setting.sensor, self.bonus), _assign)


def _push(key: float, plot: int, size: int, keys: Any, keys_at: int, heap: Any, at: int) -> None:
    """Add a plot to a heap of `size` others."""
    child = size
    while child > 0:
        parent = (child - 1) // 2
        if keys[keys_at + parent] <= key:
            break
        keys[keys_at + child] = keys[keys_at + parent]
        heap[at + child] = heap[at + parent]
        child = parent
    keys[keys_at + child] = key
    heap[at + child] = plot


def _pop(size: int, keys: Any, keys_at: int, heap: Any, at: int) -> None:
    """Remove the first plot from a heap of `size`."""
    key, plot = keys[keys_at + size - 1], heap[at + size - 1]
    size -= 1
    parent = 0
    while 2 * parent + 1 < size:
        child = 2 * parent + 1
        if child + 1 < size and keys[keys_at + child + 1] < keys[keys_at + child]:
            child += 1
        if key <= keys[keys_at + child]:
            break
        keys[keys_at + parent] = keys[keys_at + child]
        heap[at + parent] = heap[at + child]
        parent = child
    keys[keys_at + parent] = key
    heap[at + parent] = plot


def _pair_alone(
    rows: int, count: int, first: Any, plot: Any, cost: Any, plot_of: Any, track_of: Any,
    integers: Any, numbers: Any,
) -> None:  # fmt: skip
    """Pair tracks and plots that have one edge each, and set all prices to 0."""
    for j in range(count):
        integers[j] = 0
        integers[count + j] = -1
        numbers[j] = 0.0
    for e in range(first[rows]):
        integers[plot[e]] += 1
    for i in range(rows):
        if first[i + 1] - first[i] == 1 and integers[plot[first[i]]] == 1:
            plot_of[i] = plot[first[i]]
            track_of[plot[first[i]]] = i


def _search(
    start: int, count: int, first: Any, plot: Any, cost: Any, plot_of: Any, track_of: Any,
    integers: Any, numbers: Any,
) -> tuple[int, int, float, int]:  # fmt: skip
    """Shortest way from a track to a plot without a track, or to a track that gives its plot up.

    Returns the plot or -1, the track or -1, the length, and how many plots were settled. Marks of
    plots are ``2·start`` when they are reached, and one more when they are settled.
    """
    mark, before, heap = count, 2 * count, 3 * count
    settled_at = len(integers) - _MOST_SETTLED - 1
    distance, arrival, paid, keys = count, 2 * count, 3 * count, 4 * count
    row, base, price, size, settled = start, 0.0, 0.0, 0, 0
    free_at, free_row = math.inf, -1
    while True:
        if base - price < free_at:
            free_at, free_row = base - price, row
        for e in range(first[row], first[row + 1]):
            j = plot[e]
            length = base + cost[e] - price - numbers[j]
            new = integers[mark + j] < 2 * start
            if new or (integers[mark + j] == 2 * start and length < numbers[distance + j]):
                integers[mark + j] = 2 * start
                integers[before + j] = row
                numbers[distance + j], numbers[arrival + j] = length, cost[e]
                _push(length, j, size, numbers, keys, integers, heap)
                size += 1
        # A plot that was reached again by a shorter way is still there with the longer one.
        while size > 0 and integers[mark + integers[heap]] != 2 * start:
            _pop(size, numbers, keys, integers, heap)
            size -= 1
        if size == 0 or numbers[keys] >= free_at:
            return -1, free_row, free_at, settled
        j = integers[heap]
        base = numbers[distance + j]
        if track_of[j] < 0:
            return j, -1, base, settled
        if settled == _MOST_SETTLED:
            return -1, start, 0.0, 0
        integers[mark + j] = 2 * start + 1
        integers[settled_at + settled] = j
        settled += 1
        row = track_of[j]
        price = numbers[paid + j] - numbers[j]


def _augment(
    start: int, end_plot: int, end_row: int, count: int, plot_of: Any, track_of: Any,
    integers: Any, numbers: Any,
) -> None:  # fmt: skip
    """Change pairs along a way that was found."""
    before, arrival, paid = 2 * count, 2 * count, 3 * count
    j = end_plot
    if end_row >= 0:
        j = plot_of[end_row]
        plot_of[end_row] = -1
        if end_row == start:
            return
    while True:
        row = integers[before + j]
        given_up = plot_of[row]
        plot_of[row], track_of[j] = j, row
        numbers[paid + j] = numbers[arrival + j]
        if row == start:
            return
        j = given_up


def _best_is_free(
    row: int, count: int, first: Any, plot: Any, cost: Any, plot_of: Any, track_of: Any,
    numbers: Any,
) -> bool:  # fmt: skip
    """Whether the search from a track ends at its first plot, or at none; the pair is then made."""
    best, at = 0.0, -1
    for e in range(first[row], first[row + 1]):
        length = cost[e] - numbers[plot[e]]
        if length < best:
            best, at = length, e
    if at < 0:
        return True
    j = plot[at]
    if track_of[j] >= 0:
        return False
    plot_of[row], track_of[j] = j, row
    numbers[3 * count + j] = cost[at]
    return True


def _assign(
    rows: int, count: int, first: Any, plot: Any, cost: Any, plot_of: Any, track_of: Any,
    integers: Any, numbers: Any,
) -> None:  # fmt: skip
    _pair_alone(rows, count, first, plot, cost, plot_of, track_of, integers, numbers)
    settled_at = len(integers) - _MOST_SETTLED - 1
    for i in range(rows):
        if plot_of[i] >= 0 or first[i + 1] == first[i]:
            continue
        # Most tracks compete with none, and need no search.
        if _best_is_free(i, count, first, plot, cost, plot_of, track_of, numbers):
            continue
        end_plot, end_row, length, settled = _search(
            i, count, first, plot, cost, plot_of, track_of, integers, numbers
        )
        for k in range(settled):
            j = integers[settled_at + k]
            numbers[j] += numbers[count + j] - length
        _augment(i, end_plot, end_row, count, plot_of, track_of, integers, numbers)
