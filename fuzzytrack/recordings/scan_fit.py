"""Whether plots suit the configuration of a scan tracker: how far apart and how exact they are."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.plurals import counted
from fuzzytrack.recordings.scan_run import ScannedScan
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scan_tracker import ScanTracker
from fuzzytrack.scan.scanners import load_scanner
from fuzzytrack.scan.sensor import Sensor
from fuzzytrack.scan.track_reports import STATUSES

__all__ = ["ScanFit"]

# Configurations for other radars, from slow targets and exact plots to fast ones and wide plots.
_OTHERS = ("vessels", "air")
# Plots of a recording that are looked at: those of so many scans, so many of each, in all.
_SCANS, _OF_SCAN, _PLOTS = 200, 1_000, 20_000
# A plot and its nearest one of the next scan are neighbors if the nearest one of the same scan is
# so many times farther: plots that are independent of each other are so in one case of 17.
_NEARER = 4.0
# Neighbors that are needed, as a number and as a share of the plots, and the share of them that
# must be too far apart.
_NEIGHBORS, _OF_PLOTS, _TOO_FAR = 20, 0.2, 0.75
# Ratios of given standard deviations to those of the configuration that are far off.
_WIDER, _NARROWER = 5.0, 0.05
# Time from scan to scan, in those of the configuration, that no radar of its kind has; size of all
# plots, in standard deviations of one, that is none of a region with several plots a scan.
_OTHER_TIME, _SMALL, _SEVERAL = 100.0, 10.0, 3
# Scans and plots of which a track is expected.
_SCANS_OF_TRACK, _PLOTS_OF_TRACK = 8, 20
# Plots of a scan that has any, below which most have one.
_ALONE = 1.5

_TENTATIVE = STATUSES.index("tentative")


@dataclass(frozen=True)
class _Neighbors:
    """Plots of a scan, each with its neighbor in the next one.

    Attributes
    ----------
    distance : ndarray, shape (n,)
        Of the two (m).
    speed : ndarray, shape (n,)
        At which the one gets to the other (m/s).
    limit : ndarray, shape (n,)
        Largest distance at which they could begin a track (m).
    """

    distance: Array
    speed: Array
    limit: Array


class ScanFit:
    """What the plots of a recording say against a configuration; it grows while they are tracked.

    Parameters
    ----------
    scanner : ScanTracker
        The configuration.
    whole : bool
        Whether scans are whole turns, whose plots can be compared with those of the next one.
    turn : float, optional
        Time of a turn of the antenna (s), where scans are made of it.
    """

    def __init__(
        self, scanner: ScanTracker, *, whole: bool = True, turn: float | None = None
    ) -> None:
        self._scanner, self._turn = scanner, turn if whole else None
        greatest = getattr(scanner.initiation, "greatest_speed", 0.0)
        # Some configurations leave the way to the second plot to the gate.
        self._greatest, self._whole = float(greatest) if whole else 0.0, whole
        self._last: tuple[str, Scan] | None = None
        self._scans = self._empty = self._plots = self._seen = self._compared = 0
        self._confirmed = False
        self._neighbors: list[_Neighbors] = []
        self._noise: list[tuple[Array, Array]] = []
        self._times: list[float] = []
        self._early = 0
        self._low, self._high = np.full(2, math.inf), np.full(2, -math.inf)

    def add(self, each: ScannedScan) -> None:
        """Look at a scan, and at the tracks after it."""
        scan = each.scan
        self._scans += 1
        self._plots += len(scan)
        self._empty += not len(scan)
        self._confirmed |= bool((each.reports.status != _TENTATIVE).any())
        if self._scans > _SCANS or self._seen > _PLOTS:
            return
        self._seen += len(scan)
        if scan.covariances is not None and len(scan):
            self._noise.append(_given(scan))
        self._measure(each)
        last, self._last = self._last, (each.group, scan)
        if self._greatest and last is not None and last[0] == each.group:
            before = last[1]
            if len(before) and len(scan):
                self._compared += min(len(before), _OF_SCAN)
                found = _neighbors(before, scan, self._scanner.sensor, self._greatest)
                self._neighbors.append(found)

    def _measure(self, each: ScannedScan) -> None:
        """Note when a scan was, and where its plots are."""
        scan = each.scan
        if self._last is not None and self._last[0] != each.group:
            self._times.append(math.nan)
        if scan.times is not None and len(self._times) > 1:
            # Scans of a turning antenna may overlap a little.
            self._early += int(np.count_nonzero(scan.times < self._times[-2]))
        self._times.append(scan.time)
        if len(scan):
            self._low = np.minimum(self._low, scan.positions.min(axis=0))
            self._high = np.maximum(self._high, scan.positions.max(axis=0))

    def notes(self) -> Iterator[str]:
        """What a user should know, in sentences; nothing if the plots suit."""
        wrong = self._of_turns()
        if wrong:
            yield wrong
            return
        if self._early:
            yield (
                f"earlier than the scan two before theirs, and so used for no track: "
                f"{counted(self._early, 'plot')}; look at their times"
            )
        told = False
        missing = (
            not self._confirmed
            and self._scans >= _SCANS_OF_TRACK
            and self._plots >= _PLOTS_OF_TRACK
        )
        # With another unit, distances and noise say nothing more.
        units = [self._of_times(), self._of_size()]
        others = [] if any(units) else [self._of_distances(), self._of_noise()]
        for sentence in filter(None, units + others):
            told = True
            yield sentence
        if missing:
            yield f"no track was confirmed in {counted(self._scans, 'scan')}" + (
                "" if told else f": {self._expected()}"
            )

    # ---------------------------------------------------------------- sentences

    def _of_turns(self) -> str:
        """What says that no turn of the antenna takes so long, or that it takes longer."""
        if self._turn is None or self._confirmed or self._plots < _PLOTS_OF_TRACK:
            return ""
        turn, right = f"{self._turn:.4g} s", "`period` is the time of one turn"
        if self._scans < _SCANS_OF_TRACK:
            return (
                f"{self._plots} plots are only {counted(self._scans, 'scan')} of {turn}, too few "
                f"for a track; {right}"
            )
        filled = self._scans - self._empty
        if self._empty > filled and self._plots < _ALONE * filled:
            return (
                f"{self._empty} of {self._scans} scans of {turn} have no plot, and most of the "
                f"others one; {right}: is it longer? Otherwise the radar sees hardly anything"
            )
        return ""

    def _of_times(self) -> str:
        """What says that times have another unit."""
        steps = np.diff(self._times)
        steps = steps[steps > 0]
        if not self._whole or len(steps) < _SCANS_OF_TRACK:
            return ""
        usual, period = float(np.median(steps)), self._scanner.sensor.period
        if period / _OTHER_TIME < usual < _OTHER_TIME * period:
            return ""
        return (
            f"scans are typically {usual:.4g} s apart; {self._name} is made for {period:.4g} s "
            "(sensor.period): are times in another unit than s?"
        )

    def _of_size(self) -> str:
        """What says that positions have another unit."""
        size = float(np.hypot(*(self._high - self._low)))
        noise = math.hypot(self._scanner.sensor.range_noise, self._scanner.sensor.extra_noise)
        several = self._plots >= max(_PLOTS_OF_TRACK, _SEVERAL * self._scans)
        if not several or size > _SMALL * noise:
            return ""
        return (
            f"all plots are within {size:.3g} m, where one is exact to {_shown(noise)} m "
            "(sensor.range_noise): are positions in another unit than m?"
        )

    def _of_distances(self) -> str:
        if not self._neighbors:
            return ""
        distance, speed, limit = (
            np.concatenate([getattr(each, name) for each in self._neighbors])
            for name in ("distance", "speed", "limit")
        )
        few = len(distance) < max(_NEIGHBORS, _OF_PLOTS * self._compared)
        if few or np.mean(distance > limit) < _TOO_FAR:
            return ""
        usual, typical = float(np.median(speed)), float(np.median(distance))
        return (
            f"neighboring plots of successive scans are typically {_shown(typical)} m apart, as at "
            f"{_shown(usual)} m/s; {self._name} lets a new track have at most "
            f"{_shown(self._greatest)} m/s: {self._faster(usual)}raise initiation.greatest_speed"
        )

    def _faster(self, speed: float) -> str:
        """Advice of a configuration for targets of this speed, if there is one."""
        for name in _OTHERS:
            greatest = getattr(load_scanner(name).initiation, "greatest_speed", 0.0)
            if greatest >= speed and name != self._scanner.name:
                return f"use config {name} (at most {_shown(greatest)} m/s), or "
        return ""

    def _of_noise(self) -> str:
        if not self._noise:
            return ""
        sensor = self._scanner.sensor
        given, ranges = (np.concatenate(each) for each in zip(*self._noise, strict=True))
        for way, along, key in (
            ("range", 0, "range_noise"),
            ("bearing", 1, "bearing_noise"),
        ):
            own = float(np.median(_of_sensor(sensor, ranges)[:, along]))
            usual = float(np.median(given[:, along]))
            if usual > _WIDER * own or (along == 0 and usual < _NARROWER * own):
                return (
                    f"given standard deviations of plots are {_shown(usual)} m in {way} (median); "
                    f"{self._name} is made for {_shown(own)} m (sensor.{key}): "
                    f"{self._wider(usual, along, ranges)}or change the lengths (m) of clutter and "
                    "kind in proportion"
                )
        return ""

    def _wider(self, usual: float, along: int, ranges: Array) -> str:
        """Advice of the configuration for such standard deviations, if there is one."""
        found = {
            name: float(np.median(_of_sensor(load_scanner(name).sensor, ranges)[:, along]))
            for name in _OTHERS
            if name != self._scanner.name
        }
        name = min(found, key=lambda name: abs(math.log(found[name] / usual)))
        if usual / _WIDER < found[name] < usual * _WIDER:
            return f"use config {name} ({_shown(found[name])} m), "
        return ""

    def _expected(self) -> str:
        """What a configuration expects of targets and plots."""
        sensor = self._scanner.sensor
        said = [
            f"plots exact to {_shown(math.hypot(sensor.range_noise, sensor.extra_noise))} m in "
            f"range (sensor.range_noise)",
            f"seen in {100 * sensor.detection:.0f} of 100 scans (sensor.detection)",
        ]
        if self._greatest:
            said.append(f"at most {_shown(self._greatest)} m/s (initiation.greatest_speed)")
        others = [name for name in _OTHERS if name != self._scanner.name]
        return (
            f"{self._name} expects {', '.join(said)}; if yours differ, use config "
            f"{' or '.join(others)}, or change these numbers"
        )

    @property
    def _name(self) -> str:
        return self._scanner.name


def _shown(value: float) -> str:
    """A number of two digits before or after the point, without an exponent."""
    digits = max(0, 1 - math.floor(math.log10(value))) if 0 < value < 10 else 0
    return f"{float(f'{value:.2g}'):.{digits}f}"


# -------------------------------------------------------------------- noise


def _of_sensor(sensor: Sensor, ranges: Array) -> Array:
    """Standard deviations along and across the line of sight (m), shape (n, 2).

    Ranges are NaN where the position of the radar is not known, as in :class:`Sensor`.
    """
    along = np.full(len(ranges), math.hypot(sensor.range_noise, sensor.extra_noise))
    across = np.hypot(sensor.bearing_noise * ranges, sensor.extra_noise)
    across = np.where(np.isnan(ranges), along, across)
    return np.stack([along, across], axis=1)


def _given(scan: Scan) -> tuple[Array, Array]:
    """Standard deviations that a scan gives, shape (n, 2), and ranges of its plots (m)."""
    assert scan.covariances is not None
    offset = (scan.positions - np.array(scan.own))[:_OF_SCAN]
    ranges = np.hypot(*offset.T)
    x, y = np.where(ranges > 0, offset.T / np.where(ranges > 0, ranges, 1.0), [[1.0], [0.0]])
    r11, r12, r22 = scan.covariances[:_OF_SCAN].T
    along = x * x * r11 + 2 * x * y * r12 + y * y * r22
    across = y * y * r11 - 2 * x * y * r12 + x * x * r22
    return np.sqrt(np.maximum(np.stack([along, across], axis=1), 0.0)), ranges


# -------------------------------------------------------------------- neighbors


def _neighbors(before: Scan, scan: Scan, sensor: Sensor, greatest: float) -> _Neighbors:
    """Plots of a scan with their neighbors in the next one."""
    there = scan.positions
    here = before.positions[:_OF_SCAN]
    distance, nearest = _nearest(here, there)
    alone, _ = _nearest(there[nearest], there, 2)
    interval = _times(scan)[nearest] - _times(before)[: len(here)]
    kept = (_NEARER * distance < alone) & (interval > 0)
    distance, interval, nearest = distance[kept], interval[kept], nearest[kept]
    if scan.covariances is None:
        ranges = np.hypot(*(there[nearest] - np.array(scan.own)).T)
        noise = _of_sensor(sensor, ranges).prod(axis=1)
    else:
        r11, r12, r22 = scan.covariances[nearest].T
        noise = np.sqrt(np.maximum(r11 * r22 - r12 * r12, 0.0))
    # What `fuzzytrack.scan.initiation.one_point` lets through.
    limit = greatest * interval + 3.0 * np.sqrt(noise)
    return _Neighbors(distance, distance / interval, limit)


def _nearest(here: Array, there: Array, number: int = 1) -> tuple[Array, NDArray[np.intp]]:
    """Distance and row of the nearest of `there`, or of a later one; infinite if there is none."""
    # Here, since it takes long.
    from scipy.spatial import KDTree

    distance, row = KDTree(there).query(here, k=[number])
    return distance[:, 0], row[:, 0]


def _times(scan: Scan) -> Array:
    return np.full(len(scan), scan.time) if scan.times is None else scan.times
