"""Reports of a scan tracker made by hand, and sessions that report what they are given."""

import numpy as np

from fuzzytrack.scan.track_reports import TrackReports


def reports(rows):
    """Reports of (scan, time, id, x, y, vx, vy, status, kind, since_last, plot)."""
    columns = [np.array(column) for column in zip(*rows, strict=True)]
    scan, time, id, x, y, vx, vy, status, kind, since, plot = columns
    n = len(rows)
    return TrackReports(
        scan,
        time.astype(float),
        id,
        np.column_stack([x, y]).astype(float),
        np.column_stack([vx, vy]).astype(float),
        np.tile([1.0, 2.0, 0.25, 0.5], (n, 1)),
        status.astype(np.uint8),
        kind.astype(np.uint8),
        np.where(np.arange(n) % 2, np.nan, 0.75),
        since.astype(float),
        plot,
    )


class EveryPlot:
    """A scan tracker that reports every plot as a new track, the first of a scan as tentative."""

    name = "every-plot"

    def start(self):
        return EveryPlotSession()


class EveryPlotSession:
    def __init__(self):
        self.scans = self.last = 0

    def step(self, scan, *, tentative=False):
        rows = []
        for k, (x, y) in enumerate(scan.positions.tolist()):
            self.last += 1
            if k or tentative:
                row = (self.scans, scan.time, self.last, x, y, 1.0, 0.0, int(k > 0), 1, 0.0)
                rows.append((*row, int(scan.rows[k])))
        self.scans += 1
        return reports(rows) if rows else TrackReports.none()
