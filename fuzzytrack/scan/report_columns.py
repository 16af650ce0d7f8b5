"""Columns of the three arrays of reported tracks: one row a track.

Numbers, whole numbers and words are apart, so that what a scan reports is copied as it is.
"""

from __future__ import annotations

__all__ = [
    "REPORT_DEVIATION", "REPORT_EXISTENCE", "REPORT_ID", "REPORT_KIND", "REPORT_NUMBERS",
    "REPORT_PLOT", "REPORT_POSITION", "REPORT_SCAN", "REPORT_SINCE", "REPORT_STATUS",
    "REPORT_TIME", "REPORT_VELOCITY", "REPORT_WHOLE", "REPORT_WORDS",
]  # fmt: skip

#: Of the numbers; positions and velocities have two columns, deviations four.
REPORT_TIME, REPORT_POSITION, REPORT_VELOCITY, REPORT_DEVIATION = 0, 1, 3, 5
REPORT_EXISTENCE, REPORT_SINCE, REPORT_NUMBERS = 9, 10, 11
#: Of the whole numbers.
REPORT_SCAN, REPORT_ID, REPORT_PLOT, REPORT_WHOLE = 0, 1, 2, 3
#: Of the words.
REPORT_STATUS, REPORT_KIND, REPORT_WORDS = 0, 1, 2
