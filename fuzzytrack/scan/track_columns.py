"""Columns of the array of tracks: one row a track, float64.

The columns here are those that parts of several roles read; after them each part has its own
memory, see `fuzzytrack.scan.part.Part.memory`.
"""

from __future__ import annotations

__all__ = [
    "FIXED", "HITS", "ID", "KIND", "LOOKED", "MISSES", "MOTION", "P11", "P12", "P22", "PLOT",
    "SCORE", "STATUS", "TIME", "VX", "VY", "X", "Y",
]  # fmt: skip

#: 0 where there is no track, 1 of a tentative one, 2 of a confirmed one.
STATUS = 0
#: Time of the last plot (s): the state is that at this time.
TIME = 1
#: Position (m) and velocity (m/s) at that time.
X, Y, VX, VY = 2, 3, 4, 5
#: Covariance common to both axes, of position (m²), of both (m²/s), and of velocity (m²/s²).
P11, P12, P22 = 6, 7, 8
#: Plots of the track, and scans without a plot since the last one.
HITS, MISSES = 9, 10
#: The number that the quality keeps: log-odds of existence (nats), or what else it is.
SCORE = 11
#: Number of the word in `fuzzytrack.scan.track_reports.KINDS`.
KIND = 12
#: Time at which the track was last looked for (s): of its plot, or of a scan without one.
LOOKED = 13
#: Evidence that the track moves (nats), from the kind; 0 if it says nothing.
MOTION = 14
#: Row of the plot of this scan in the recording, -1 without one.
PLOT = 15
#: Identity, from 1 on.
ID = 16
#: How many columns these are.
FIXED = 17
