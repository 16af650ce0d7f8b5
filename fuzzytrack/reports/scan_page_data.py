"""What the page of a scan tracker's result holds: columns of its tracks and plots, bounded."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.io.map_axes import map_axes
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.track_reports import KINDS, TrackReports
from fuzzytrack.scoring.object_paths import ObjectPaths

__all__ = ["Shown", "as_script", "page_data"]

_MOVING = KINDS.index("moving")
# Existence that is not known.
_UNKNOWN = 255


@dataclass(frozen=True, eq=False)
class Shown:
    """Reports and plots of a page, and what was left out of them.

    Attributes
    ----------
    times : ndarray, shape (n_scans,)
        Times of the scans (s).
    own : ndarray, shape (n_scans, 2)
        Positions of the own ship (m).
    reports : TrackReports
        By scan; whole tracks.
    plots : ndarray, shape (n_plots, 2)
        By scan.
    plot_scan : ndarray of int, shape (n_plots,)
        Scan of each plot.
    notes : tuple of str
        What was left out, a sentence each.
    """

    times: Array
    own: Array
    reports: TrackReports
    plots: Array
    plot_scan: NDArray[np.int64]
    notes: tuple[str, ...]

    @classmethod
    def of(
        cls, result: Any, scans: Sequence[Scan] | None, most_rows: int, most_plots: int
    ) -> Shown:
        """What is shown of a result, or of reports, with the plots of some scans.

        Raises
        ------
        ValueError
            If there are no reports, or reports of scans that are not there.
        """
        reports = result if isinstance(result, TrackReports) else getattr(result, "reports", None)
        if not isinstance(reports, TrackReports):
            raise ValueError(
                "result: must be the result of a scan tracker, or TrackReports; "
                f"got {type(result).__name__}"
            )
        times, own = _scans_of(result, reports, scans)
        if len(reports) and not 0 <= reports.scan.min() <= reports.scan.max() < len(times):
            raise ValueError(
                f"result: has reports of scans {reports.scan.min()} to {reports.scan.max()}, "
                f"and there are {len(times)} scans"
            )
        kept, note = _whole_tracks(reports, most_rows)
        plots, plot_scan = _plots_of(scans)
        every = max(1, -(-len(plots) // most_plots))
        notes = [note] if note else []
        if every > 1:
            notes.append(f"One of {every} plots is shown, out of {len(plots):,}.")
        return cls(times, own, kept, plots[::every], plot_scan[::every], tuple(notes))


def _scans_of(
    result: Any, reports: TrackReports, scans: Sequence[Scan] | None
) -> tuple[Array, Array]:
    """Times of the scans and positions of the own ship."""
    if scans is not None:
        times = np.array([scan.time for scan in scans], np.float64)
        return times, np.array([scan.own for scan in scans], np.float64).reshape(-1, 2)
    known = getattr(result, "times", None)
    if known is None:
        # Of a scan without reports, that of the one before.
        count = int(reports.scan.max()) + 1 if len(reports) else 0
        times = np.full(count, -np.inf)
        np.maximum.at(times, reports.scan, reports.time)
        times = np.maximum.accumulate(times)
        times[np.isneginf(times)] = reports.time.min() if len(reports) else 0.0
    else:
        times = np.asarray(known, np.float64)
    own = getattr(result, "own", None)
    path = np.zeros((len(times), 2)) if own is None else np.asarray(own, np.float64)
    return times, np.broadcast_to(path, (len(times), 2))


def _plots_of(scans: Sequence[Scan] | None) -> tuple[Array, NDArray[np.int64]]:
    if not scans:
        return np.empty((0, 2)), np.empty(0, np.int64)
    places = [np.asarray(scan.positions, np.float64).reshape(-1, 2) for scan in scans]
    return np.concatenate(places), np.repeat(np.arange(len(places)), [len(p) for p in places])


def _whole_tracks(reports: TrackReports, most: int) -> tuple[TrackReports, str]:
    """Rows by scan; of too many, those of the longest tracks, moving ones before all others."""
    rows = reports.where(np.argsort(reports.scan, kind="stable"))
    if len(rows) <= most:
        return rows, ""
    ids, which, lengths = np.unique(rows.track_id, return_inverse=True, return_counts=True)
    moved = np.bincount(which, rows.kind == _MOVING) > 0
    order = np.lexsort((-lengths, ~moved))
    kept = np.zeros(len(ids), bool)
    kept[order[np.cumsum(lengths[order]) <= most]] = True
    note = (
        f"{int(kept.sum()):,} of {len(ids):,} tracks are shown: the longest ones, moving ones "
        "before all others."
    )
    return rows.where(kept[which]), note


def page_data(
    shown: Shown, truth: Any, axes_names: Sequence[str], scan: int | None
) -> Mapping[str, Any]:
    """Values of the page as JSON has them, arrays as base64 of little-endian numbers.

    Parameters
    ----------
    shown : Shown
    truth : tuple, mapping, Positions or None
    axes_names : sequence of str
        Names of the two axes; north is drawn upwards.
    scan : int or None
        Number of the scan that is shown first; None is the last one.
    """
    names, order = map_axes(axes_names)
    reports, count = shown.reports, len(shown.times)
    everything = np.concatenate([reports.position, shown.plots])[:, order]
    known = everything[np.isfinite(everything).all(axis=1)]
    # About the middle, so that 32 bits are exact to a millimeter within 10 km.
    origin = np.round(np.median(known, axis=0), 1) if len(known) else np.zeros(2)

    def place(positions: Array) -> str:
        return _text(positions[:, order] - origin, "<f4")

    ids, track = np.unique(reports.track_id, return_inverse=True)
    chance = np.where(
        np.isfinite(reports.existence), np.round(100 * reports.existence), float(_UNKNOWN)
    )
    radial = np.sqrt(0.5 * (reports.deviation[:, :2] ** 2).sum(axis=1))
    return {
        "axes": list(names),
        "origin": origin.tolist(),
        "scan": max(0, count - 1) if scan is None else scan,
        "times": _text(shown.times, "<f8"),
        "own": place(shown.own),
        "reports": {
            "ids": [str(each) for each in ids.tolist()],
            "from": _text(np.searchsorted(reports.scan, np.arange(count + 1)), "<u4"),
            "track": _text(track, "<u4"),
            "place": place(reports.position),
            "velocity": _text(reports.velocity[:, order], "<f4"),
            "deviation": _text(radial, "<f4"),
            "since": _text(reports.since_last, "<f4"),
            "status": _text(reports.status, "u1"),
            "kind": _text(reports.kind, "u1"),
            "existence": _text(np.clip(chance, 0, _UNKNOWN), "u1"),
        },
        "plots": {
            "from": _text(np.searchsorted(shown.plot_scan, np.arange(count + 1)), "<u4"),
            "place": place(shown.plots),
        },
        "truth": _truth_data(truth, order, origin),
    }


def _truth_data(truth: Any, order: tuple[int, int], origin: Array) -> dict[str, Any]:
    paths = ObjectPaths.of(truth)
    return {
        "names": list(paths.names),
        "from": _text(paths.edges, "<u4"),
        "time": _text(paths.time, "<f8"),
        "place": _text(paths.position[:, order] - origin, "<f4"),
    }


def _text(values: ArrayLike, kind: str) -> str:
    """Numbers as base64."""
    return base64.b64encode(np.asarray(values).astype(kind).tobytes()).decode("ascii")


def as_script(data: Mapping[str, Any]) -> str:
    """JSON that may stand in a script element: no tag can begin or end in it."""
    text = json.dumps(data, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
