"""Columns of the array of reported tracks: one row a track, float64."""

from __future__ import annotations

__all__ = [
    "REPORT_DEVIATION", "REPORT_EXISTENCE", "REPORT_ID", "REPORT_KIND", "REPORT_PLOT",
    "REPORT_POSITION", "REPORT_SINCE", "REPORT_STATUS", "REPORT_TIME", "REPORT_VELOCITY",
    "REPORT_WIDTH",
]  # fmt: skip

#: Columns of numbers; positions and velocities have two, deviations four.
REPORT_TIME, REPORT_POSITION, REPORT_VELOCITY, REPORT_DEVIATION = 0, 1, 3, 5
REPORT_EXISTENCE, REPORT_SINCE = 9, 10
#: Columns of whole numbers.
REPORT_ID, REPORT_STATUS, REPORT_KIND, REPORT_PLOT = 11, 12, 13, 14
REPORT_WIDTH = 16
