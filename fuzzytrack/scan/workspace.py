"""The arrays of a session, and how they grow."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.scan.clock import CLOCK_WIDTH, COUNTS_WIDTH, NEXT_ID, REPORTS
from fuzzytrack.scan.plot_columns import PLOT_WIDTH
from fuzzytrack.scan.report_columns import (
    REPORT_DEVIATION,
    REPORT_EXISTENCE,
    REPORT_ID,
    REPORT_KIND,
    REPORT_NUMBERS,
    REPORT_PLOT,
    REPORT_POSITION,
    REPORT_SCAN,
    REPORT_SINCE,
    REPORT_STATUS,
    REPORT_TIME,
    REPORT_VELOCITY,
    REPORT_WHOLE,
    REPORT_WORDS,
)
from fuzzytrack.scan.scan_parts import ScanParts
from fuzzytrack.scan.stages.lookahead import LINE
from fuzzytrack.scan.track_reports import TrackReports

__all__ = ["Workspace", "new_workspace", "reported", "with_edges", "with_room"]

Integers = NDArray[np.int64]


class Workspace(NamedTuple):
    """All arrays that the stages of a scan read and write.

    Attributes
    ----------
    tracks : ndarray, shape (room, width)
        See `fuzzytrack.scan.track_columns`.
    free : ndarray of int, shape (room,)
        Rows without a track among those in use, a stack.
    clock, counts : ndarray
        See `fuzzytrack.scan.clock`.
    cells, kept : ndarray
        Numbers of the clutter model and of the identity.
    given, plots : ndarray, shape (plot room, PLOT_WIDTH)
        Plots in their order, and as the candidates arrange them; see
        `fuzzytrack.scan.plot_columns`.
    order, found, track_of : ndarray of int, shape (plot room,)
        Row in `given` of each plot; candidates of one track; track of each plot, or -1.
    due : ndarray of uint8, shape (room,)
        Tracks that this step is about, where not all are.
    plot_of, first : ndarray of int, shape (room + 1,)
        Plot of each track, or -1; its first edge.
    edge_plot, edge_cost : ndarray, shape (edge room,)
        Edges between tracks and plots.
    integers, numbers : ndarray
        Scratch of the parts.
    report, report_whole, report_words : ndarray
        Reported tracks: numbers, whole numbers and words, see `fuzzytrack.scan.report_columns`.
    """

    tracks: Array
    free: Integers
    clock: Array
    counts: Integers
    cells: Array
    kept: Array
    given: Array
    plots: Array
    order: Integers
    found: Integers
    track_of: Integers
    due: NDArray[np.uint8]
    plot_of: Integers
    first: Integers
    edge_plot: Integers
    edge_cost: Array
    integers: Integers
    numbers: Array
    report: Array
    report_whole: Integers
    report_words: NDArray[np.uint8]


#: Arrays of which the content lives from scan to scan; the others are scratch.
LASTING = ("tracks", "clock", "counts", "cells", "kept")
_ROOM, _PLOTS, _EDGES = 64, 64, 256


def new_workspace(tracker: ScanParts) -> Workspace:
    """Arrays of a session that has seen nothing."""
    counts = np.zeros(COUNTS_WIDTH, np.int64)
    counts[NEXT_ID] = 1
    clock = np.zeros(CLOCK_WIDTH)
    cells, kept = np.zeros(tracker.clutter.numbers + 1), np.zeros(tracker.identity.numbers + 1)
    empty = _scratch(tracker, _ROOM, _PLOTS, _EDGES)
    return Workspace(
        tracks=_aligned(_ROOM, tracker.width), clock=clock, counts=counts,
        cells=cells, kept=kept, **empty,
    )  # fmt: skip


def _aligned(rows: int, width: int, flat: Array | None = None) -> Array:
    """Numbers of which the first begins a line of the cache; in a flat array if one is given."""
    flat = np.empty(rows * width + LINE) if flat is None else flat
    begin = -flat.ctypes.data // flat.itemsize % LINE
    return flat[begin : begin + rows * width].reshape(rows, width)


def _with_rows(tracks: Array, room: int) -> Array:
    """The same tracks with room for more."""
    used, width = tracks.shape
    flat = tracks.base
    if flat is None:
        more = _aligned(room, width)
        more[:used] = tracks
        return more
    # In place where the system can move pages, so that memory is never needed twice.
    begin = (tracks.ctypes.data - flat.ctypes.data) // flat.itemsize
    flat.resize(room * width + LINE, refcheck=False)
    more = _aligned(room, width, flat)
    moved = flat[begin : begin + used * width].reshape(used, width)
    if moved.ctypes.data != more.ctypes.data:
        more[:used] = moved
    return more


def _scratch(tracker: ScanParts, room: int, plots: int, edges: int) -> dict[str, Any]:
    """Arrays without a content that lasts."""
    candidates, association = tracker.candidates, tracker.association
    whole = max(
        4 * plots, candidates.integers(plots), association.integers(room, plots, edges)
    )  # fmt: skip
    floats = max(candidates.numbers(plots), association.numbers(room, plots, edges))
    return {
        **{name: _aligned(plots, PLOT_WIDTH) for name in ("given", "plots")},
        **{name: np.empty(plots, np.int64) for name in ("order", "found", "track_of")},
        "due": np.empty(room, np.uint8),
        "free": np.empty(room, np.int64),
        **{name: np.empty(room + 1, np.int64) for name in ("plot_of", "first")},
        "edge_plot": np.empty(edges, np.int64),
        "edge_cost": np.empty(edges),
        "integers": np.empty(whole + 1, np.int64),
        "numbers": np.empty(floats + 1),
        "report": np.empty((room, REPORT_NUMBERS)),
        "report_whole": np.empty((room, REPORT_WHOLE), np.int64),
        "report_words": np.empty((room, REPORT_WORDS), np.uint8),
    }


def with_room(work: Workspace, tracker: ScanParts, rows: int, plots: int, edges: int) -> Workspace:
    """Arrays with room for so many tracks, plots and edges; the same ones if there is enough.

    What lasts is moved; scratch that grows is new.
    """
    room, have_plots, have_edges = len(work.tracks), len(work.plots), len(work.edge_plot)
    if rows <= room and plots <= have_plots and edges <= have_edges:
        return work
    more = work._asdict()
    if rows > room:
        room = rows + rows // 4
        more["tracks"] = _with_rows(work.tracks, room)
    have_plots = plots + plots // 4 if plots > have_plots else have_plots
    have_edges = edges + edges // 4 if edges > have_edges else have_edges
    for name in set(more) - set(LASTING):
        more[name] = None
    return Workspace(**{**more, **_scratch(tracker, room, have_plots, have_edges)})


def with_edges(work: Workspace, tracker: ScanParts) -> Workspace:
    """The same arrays with room for twice the edges; what was found of the plots stays."""
    rows, plots = len(work.tracks), len(work.plots)
    more = with_room(work, tracker, rows, plots, 2 * len(work.edge_plot))
    for name in ("plots", "order", "track_of", "due"):
        getattr(more, name)[:] = getattr(work, name)
    # The index of the candidates is in the scratch of the parts.
    more.integers[: len(work.integers)] = work.integers
    more.numbers[: len(work.numbers)] = work.numbers
    return more


def reported(work: Workspace) -> TrackReports:
    """What the last stage has written, copied."""
    n = work.counts[REPORTS]
    numbers, whole, words = work.report[:n], work.report_whole[:n], work.report_words[:n]
    numbers, whole, words = numbers.copy(), whole.copy(), words.copy()
    return TrackReports(
        whole[:, REPORT_SCAN],
        numbers[:, REPORT_TIME],
        whole[:, REPORT_ID],
        numbers[:, REPORT_POSITION : REPORT_POSITION + 2],
        numbers[:, REPORT_VELOCITY : REPORT_VELOCITY + 2],
        numbers[:, REPORT_DEVIATION : REPORT_DEVIATION + 4],
        words[:, REPORT_STATUS],
        words[:, REPORT_KIND],
        numbers[:, REPORT_EXISTENCE],
        numbers[:, REPORT_SINCE],
        whole[:, REPORT_PLOT],
    )
