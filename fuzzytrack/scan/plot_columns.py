"""Columns of the array of the plots of a scan: one row a plot, float64."""

from __future__ import annotations

__all__ = [
    "DENSITY", "INNOVATION_X", "INNOVATION_Y", "LOG_DENSITY", "LOG_LIKELIHOOD", "NOISE",
    "PLOT_ROW", "PLOT_TIME", "PLOT_WIDTH", "PLOT_X", "PLOT_Y", "R11", "R12", "R22", "RECORDED",
    "STARTS", "STRENGTH",
]  # fmt: skip

#: Position (m).
PLOT_X, PLOT_Y = 0, 1
#: When it was made (s).
PLOT_TIME = 2
#: Covariance of its error (m²).
R11, R12, R22 = 3, 4, 5
#: Variance that one axis would have, the square root of the determinant (m²).
NOISE = 6
#: Density of clutter there (plots/m² and scan), and its logarithm.
DENSITY, LOG_DENSITY = 7, 8
#: Row of the plot among those of the scan.
PLOT_ROW = 9
#: 1 if the plot may start a track.
STARTS = 10
#: Plot minus predicted position of its track (m); the logarithm of its likelihood there (1/m²),
#: and that of detection probability times likelihood by density (nats). Set before a track is
#: updated by the plot.
INNOVATION_X, INNOVATION_Y = 11, 12
LOG_LIKELIHOOD, STRENGTH = 13, 14
#: Row of the plot in the recording.
RECORDED = 15
#: How many columns these are.
PLOT_WIDTH = 16
