"""Role: how dense clutter is at a plot."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzytrack.plugins import Registry
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.setting import Setting

__all__ = ["Clutter", "ClutterKernels", "clutters"]


class ClutterKernels(NamedTuple):
    """Kernels of a clutter model.

    `cells` is the array of numbers that the session keeps for it, see `Clutter.numbers`; `tracks`
    and `plots` are arrays with the columns of `fuzzytrack.scan.track_columns` and
    `fuzzytrack.scan.plot_columns`, ``i`` and ``j`` rows of them; `clock` has the places of
    `fuzzytrack.scan.clock`.

    Attributes
    ----------
    begin : callable
        ``begin(clock, cells)``: a new scan.
    put : callable
        ``put(plots, j, clock, cells)``: a plot of this scan, before any is read.
    read : callable
        ``read(plots, j, clock, cells) -> density``: clutter at this plot (plots/m² and scan), > 0.
    density : callable
        ``density(x, y, clock, cells) -> density``: the same at any place.
    start : callable
        ``start(tracks, i, plots, j, clock, cells)``: the plot has started a track.
    hit : callable
        ``hit(tracks, i, plots, j, status, clock, cells)``: the plot is that of a track, which is
        updated; its status was `status` before.
    miss : callable
        ``miss(tracks, i, clock, cells)``: a track has no plot in this scan.
    end : callable
        ``end(tracks, i, clock, cells)``: a track is deleted; after `hit` or `miss`.
    leave : callable
        ``leave(plots, j, clock, cells)``: a plot without a track, which will be given again.
    drop : callable
        ``drop(plots, j, clock, cells)``: a plot without a track that starts none.
    """

    begin: Callable[[Any, Any], None]
    put: Callable[[Any, int, Any, Any], None]
    read: Callable[[Any, int, Any, Any], float]
    density: Callable[[float, float, Any, Any], float]
    start: Callable[[Any, int, Any, int, Any, Any], None]
    hit: Callable[[Any, int, Any, int, float, Any, Any], None]
    miss: Callable[[Any, int, Any, Any], None]
    end: Callable[[Any, int, Any, Any], None]
    leave: Callable[[Any, int, Any, Any], None]
    drop: Callable[[Any, int, Any, Any], None]


class Clutter(Part):
    """Says how dense clutter is at each plot."""

    @property
    def numbers(self) -> int:
        """How many numbers a session keeps for it, 0 at first."""
        return 0

    @abstractmethod
    def kernels(self, setting: Setting, at: int) -> ClutterKernels:
        """Kernels of this part; its memory of a track begins at column `at`."""


clutters: Registry[type[Clutter]] = Registry("clutter model", "fuzzytrack.scan.clutter", Clutter)
