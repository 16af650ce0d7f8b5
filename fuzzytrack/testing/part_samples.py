"""Tracks, plots and scans with which the parts of a scan tracker are checked."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.scan import clock as c
from fuzzytrack.scan import plot_columns as p
from fuzzytrack.scan import track_columns as t
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.sensor import Sensor
from fuzzytrack.scan.setting import Setting

__all__ = ["PERIOD", "World", "sample_scans"]

#: Time between two scans (s): not that for which the rates of parts are declared.
PERIOD = 2.5
#: Largest coordinate (m).
_REACH = 500.0


@dataclass
class World:
    """One track and some plots, as the kernels of a part see them.

    Parameters
    ----------
    part : Part
    seed : int
        Seed of the plots.
    """

    part: Part
    seed: int = 0
    setting: Setting = field(default_factory=lambda: Setting(Sensor()))

    def __post_init__(self) -> None:
        self.random = np.random.default_rng(self.seed)
        self.clock = np.zeros(c.CLOCK_WIDTH)
        self.tracks = np.zeros((4, t.FIXED + self.part.memory))
        self.plots = self.sample_plots(40)

    @property
    def kernels(self) -> Any:
        """Kernels of the part."""
        return self.part.kernels(self.setting, t.FIXED)  # type: ignore[attr-defined]

    def sample_plots(self, count: int) -> Array:
        """Plots anywhere, with the noise of the sensor."""
        plots = np.zeros((count, p.PLOT_WIDTH))
        plots[:, p.PLOT_X : p.PLOT_Y + 1] = self.random.uniform(-_REACH, _REACH, (count, 2))
        noise = self.setting.sensor.noise()
        for j in range(count):
            r11, r12, r22 = noise(plots[j, p.PLOT_X], plots[j, p.PLOT_Y], 0.0, 0.0)
            plots[j, p.R11], plots[j, p.R12], plots[j, p.R22] = r11, r12, r22
            plots[j, p.NOISE] = math.sqrt(r11 * r22 - r12 * r12)
        plots[:, p.DENSITY] = 10 ** self.random.uniform(-7, -4, count)
        plots[:, p.LOG_DENSITY] = np.log(plots[:, p.DENSITY])
        plots[:, p.PLOT_ROW] = np.arange(count)
        plots[:, p.STARTS] = 1.0
        return plots

    def begin_scan(self, number: int) -> None:
        """Set the clock to a scan; its plots are made at its time."""
        self.clock[c.LAST_TIME] = self.clock[c.SCAN_TIME]
        self.clock[c.SCAN], self.clock[c.SCAN_TIME] = number, PERIOD * number
        self.clock[c.EARLIEST] = self.clock[c.LATEST] = self.clock[c.SCAN_TIME]
        self.plots[:, p.PLOT_TIME] = self.clock[c.SCAN_TIME]

    def begin_track(self, j: int = 0) -> None:
        """Track 0 as it is after it has started at plot j."""
        row = self.tracks[0]
        row[:] = 0.0
        row[t.STATUS], row[t.TIME], row[t.LOOKED] = 1.0, self.clock[c.SCAN_TIME], row[t.LOOKED]
        row[t.LOOKED] = self.clock[c.SCAN_TIME]
        row[t.X], row[t.Y] = self.plots[j, p.PLOT_X], self.plots[j, p.PLOT_Y]
        row[t.P11], row[t.P12], row[t.P22] = self.plots[j, p.NOISE], 0.0, 4.0
        row[t.HITS], row[t.PLOT], row[t.ID] = 1.0, self.plots[j, p.PLOT_ROW], 1.0

    def put_plot(self, j: int, dx: float, dy: float, strength: float = 5.0) -> None:
        """Put plot j so far from track 0, with a likelihood as of a good one."""
        row = self.tracks[0]
        self.plots[j, p.PLOT_X], self.plots[j, p.PLOT_Y] = row[t.X] + dx, row[t.Y] + dy
        self.plots[j, p.INNOVATION_X], self.plots[j, p.INNOVATION_Y] = dx, dy
        self.plots[j, p.STRENGTH] = strength
        self.plots[j, p.LOG_LIKELIHOOD] = (
            strength + self.plots[j, p.LOG_DENSITY] - math.log(self.setting.sensor.detection)
        )

    def count_hit(self, j: int) -> None:
        """Count a plot of track 0, before the part sees it."""
        self.tracks[0, t.HITS] += 1.0
        self.tracks[0, t.MISSES] = 0.0

    def end_hit(self, j: int) -> None:
        """The times of track 0 after its plot j."""
        row = self.tracks[0]
        row[t.TIME] = row[t.LOOKED] = self.plots[j, p.PLOT_TIME]
        row[t.X], row[t.Y] = self.plots[j, p.PLOT_X], self.plots[j, p.PLOT_Y]

    def end_miss(self) -> None:
        """The time at which track 0 was last looked for, after a scan without a plot."""
        self.tracks[0, t.LOOKED] = self.clock[c.SCAN_TIME]


def sample_scans(seed: int, count: int = 24) -> list[Scan]:
    """Scans of targets that cross, turn, stand and are missed, with clutter, twins and none at all.

    Parameters
    ----------
    seed : int
    count : int
        Number of scans.
    """
    random = np.random.default_rng(seed)
    start = random.uniform(-150, 150, (6, 2))
    velocity = random.normal(0.0, 3.0, (6, 2))
    velocity[0] = 0.0
    scans, time, row = [], 0.0, 0
    for k in range(count):
        time += PERIOD * (1.0 + 0.2 * random.random()) + (10.0 if k == 15 else 0.0)
        angle = 0.02 * time
        turned = velocity.copy()
        turned[1] = [
            velocity[1, 0] * math.cos(angle) - velocity[1, 1] * math.sin(angle),
            velocity[1, 0] * math.sin(angle) + velocity[1, 1] * math.cos(angle),
        ]
        targets = start + time * turned + random.normal(0.0, 1.0, (6, 2))
        seen = targets[random.random(6) < 0.9]
        clutter = random.uniform(-_REACH, _REACH, (random.poisson(8), 2))
        twin = seen[:1] + random.normal(0.0, 1.0, seen[:1].shape)
        plots = random.permutation(np.concatenate([seen, clutter, twin]))
        if k in (9, 10):
            plots = plots[:0]
        rows = np.arange(row, row + len(plots))
        row += len(plots)
        scans.append(Scan(time, plots, own=(0.5 * time, 0.0), rows=rows))
    return scans
