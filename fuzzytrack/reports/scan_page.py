"""The tracks of a scan tracker as an animated page: one HTML file that loads nothing."""

from __future__ import annotations

import os
from collections.abc import Sequence
from html import escape
from importlib import resources
from pathlib import Path
from string import Template
from typing import Any

import numpy as np

from fuzzytrack.io.files import check_output, whole_file
from fuzzytrack.plurals import counted
from fuzzytrack.reports.scan_page_data import Shown, as_script, page_data
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.track_reports import KINDS
from fuzzytrack.version import __version__

__all__ = ["write_scan_page"]

# Times as fast as the radar.
_SPEEDS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 5000)
_SCRIPTS = ("scan_page_run.js", "scan_page_marks.js", "scan_page_map.js", "scan_page.js")


def write_scan_page(
    path: str | os.PathLike[str],
    result: Any,
    scans: Sequence[Scan] | None = None,
    truth: Any = None,
    axes_names: Sequence[str] = ("x", "y"),
    *,
    title: str = "Tracks of a scan tracker",
    scan: int | None = None,
    most_rows: int = 200_000,
    most_plots: int = 200_000,
) -> Path:
    """Write tracks as an animated page, with a slider of time.

    Parameters
    ----------
    path : str or path
        The file; replaced if it exists, written whole or not at all.
    result : ScanResult or TrackReports
        What was reported.
    scans : sequence of Scan, optional
        The scans, for the plots and the path of the own ship.
    truth : tuple, mapping or Positions, optional
        True positions as `fuzzytrack.score` takes them: (time, id, position), for example.
    axes_names : sequence of str
        Names of the two axes. North, or what begins with it, is drawn upwards.
    title : str
        Of the page.
    scan : int, optional
        Number of the scan that is shown first; the last one unless given.
    most_rows, most_plots : int
        Rows of reports and plots that the page holds, at most. Of more, the longest tracks are
        kept, moving ones before all others, and every second, third … plot; the page says so. A
        row takes about 41 bytes, a plot 11.

    Returns
    -------
    Path
        The file, with symbolic links followed.

    Raises
    ------
    OSError
        If the file cannot be written.
    TypeError, ValueError
        If `result` has no reports, `scan` is out of range, or shapes do not fit.

    Notes
    -----
    The page needs no network, and follows the light or dark mode of the reader. The space bar
    plays, the arrows go from scan to scan; a track that is clicked shows its numbers.
    """
    target = check_output(path)
    shown = Shown.of(result, scans, most_rows, most_plots)
    count = len(shown.times)
    if scan is not None and not 0 <= scan < count:
        raise ValueError(f"scan: must be from 0 to {count - 1}, got {scan}")
    data = page_data(shown, truth, axes_names, scan)
    page = Template(_part("scan_page.html")).substitute(
        title=escape(title),
        style=_part("scan_page.css"),
        facts=escape(_facts(result, shown)),
        notes="".join(f"<p>{escape(note)}</p>\n" for note in shown.notes),
        speeds="\n".join(f'<option value="{s}">{s}×</option>' for s in _SPEEDS),
        data=as_script(data),
        script="\n".join(map(_part, _SCRIPTS)),
    )
    with whole_file(target) as draft:
        draft.write_text(page, encoding="utf-8", newline="\n")
    return target


def _part(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


def _facts(result: Any, shown: Shown) -> str:
    """One line of numbers."""
    reports = shown.reports
    last = np.unique(reports.track_id[::-1], return_index=True)[1]
    kinds = np.bincount(reports.kind[::-1][last], minlength=len(KINDS)).tolist()
    # Moving ones first.
    order = sorted(range(len(KINDS)), key=lambda kind: (kind == 0, kind))
    tracks = ", ".join(f"{kinds[k]:,} {KINDS[k]}" for k in order if kinds[k])
    facts = [
        counted(len(shown.times), "scan"),
        f"tracks: {tracks}" if tracks else "no track",
        f"{len(shown.plots):,} plot{'' if len(shown.plots) == 1 else 's'}",
    ]
    if isinstance(name := getattr(result, "tracker", None), str):
        facts.append(f"scan tracker {name}")
    return " · ".join([*facts, f"fuzzytrack {__version__}"])
