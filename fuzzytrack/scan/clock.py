"""Numbers of a session that hold for a whole scan, and counts: places in two small arrays."""

from __future__ import annotations

__all__ = [
    "CLOCK_WIDTH",
    "COUNTS_WIDTH",
    "EARLIEST",
    "EDGES",
    "FREE",
    "HAS_COVARIANCES",
    "HAS_DUE",
    "HAS_ROWS",
    "HAS_STARTS",
    "HAS_TIMES",
    "LAST_TIME",
    "LATEST",
    "NEW_SCAN",
    "NEXT_ID",
    "OWN_X",
    "OWN_Y",
    "PLOTS",
    "REPORTS",
    "ROWS",
    "SCAN",
    "SCAN_TIME",
    "TENTATIVE_TOO",
    "WHERE",
    "WIDEST",
]  # fmt: skip

# ---------------------------------------------------------------- clock: float64

#: Time of the scan (s), of the one before, and of the earliest and the latest plot.
SCAN_TIME, LAST_TIME, EARLIEST, LATEST = 0, 1, 2, 3
#: Position of the radar (m).
OWN_X, OWN_Y = 4, 5
#: Largest variance of a plot of this scan in any direction (m²).
WIDEST = 6
#: Number of this scan, from 0 on.
SCAN = 7
CLOCK_WIDTH = 8

# ---------------------------------------------------------------- counts: int64

#: Rows of the array of tracks that may hold one; rows without a track among the first of them.
ROWS, FREE = 0, 1
#: Plots of this scan after extraction, and edges between tracks and plots.
PLOTS, EDGES = 2, 3
#: Identity of the next track.
NEXT_ID = 4
#: Rows reported of this scan.
REPORTS = 5
#: Whether they include tentative tracks.
TENTATIVE_TOO = 6
#: Which of the optional arrays of a scan are given.
HAS_COVARIANCES, HAS_TIMES, HAS_DUE, HAS_STARTS = 7, 8, 9, 10
#: Whether a scan begins, or plots are more of the one before.
NEW_SCAN = 11
#: Plot at which a stage had to stop.
WHERE = 12
#: Whether rows of the recording are given.
HAS_ROWS = 13
COUNTS_WIDTH = 14
