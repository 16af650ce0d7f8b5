"""Role: which plots may be those of a track."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzytrack.plugins import Registry
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.setting import Setting

__all__ = ["Candidates", "CandidatesKernels", "candidates"]


class CandidatesKernels(NamedTuple):
    """Kernels of a search for candidates.

    `integers` and `numbers` are arrays of the session for the part's own use, see
    `Candidates.integers` and `Candidates.numbers`; `clock` has the places of
    `fuzzytrack.scan.clock`.

    Attributes
    ----------
    arrange : callable
        ``arrange(plots, count, clock, order, integers, numbers)``: makes an index of the plots of a
        scan, and writes the order in which they shall lie in memory to `order`: row numbers, each
        once. The plots are put in that order afterwards.
    near : callable
        ``near(x, y, reach, plots, count, clock, integers, numbers, found) -> n``: writes the rows
        of plots, in the new order, of which some may be within `reach` (m) of a place to `found`,
        each once, and returns how many. None that is within reach may be missing, but where the
        part says so. ``found[0]`` comes with the row of the track: a part that may not look at all
        plots can choose by it, and chooses the same when it is asked again.
    """

    arrange: Callable[[Any, int, Any, Any, Any, Any], None]
    near: Callable[[float, float, float, Any, int, Any, Any, Any, Any], int]


class Candidates(Part):
    """Finds the plots near a track."""

    @property
    def may_miss(self) -> bool:
        """Whether `near` may leave out plots that are within reach."""
        return False

    def integers(self, plots: int) -> int:
        """How many whole numbers it needs for a scan with so many plots."""
        return 0

    def numbers(self, plots: int) -> int:
        """How many numbers it needs for a scan with so many plots."""
        return 0

    @abstractmethod
    def kernels(self, setting: Setting) -> CandidatesKernels:
        """Kernels of this part."""


candidates: Registry[type[Candidates]] = Registry(
    "search for candidates", "fuzzytrack.scan.candidates", Candidates
)
