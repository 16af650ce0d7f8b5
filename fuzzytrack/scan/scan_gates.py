"""The gates of a scan: which places each track accepts, and which plot it took."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.scan.clock import CLOCK_WIDTH, OWN_X, OWN_Y, SCAN_TIME
from fuzzytrack.scan.plot_columns import (
    NOISE,
    PLOT_TIME,
    PLOT_WIDTH,
    PLOT_X,
    PLOT_Y,
    R11,
    R12,
    R22,
)
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scan_session import ScanSession
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import TIME
from fuzzytrack.scan.track_reports import TrackReports

__all__ = ["ScanGates", "scan_gates"]

# Halvings of the distance at which a gate ends: to a thousandth of its reach.
_HALVINGS = 12


@dataclass(frozen=True, eq=False)
class ScanGates:
    """Gates of the tracks that a session had before a scan.

    Attributes
    ----------
    tracks : TrackReports
        The tracks before the scan, in the order of their identities.
    predicted : ndarray, shape (n, 2)
        Where they are expected at the time of the scan (m).
    outlines : ndarray, shape (n, n_directions, 2)
        Places around these up to which a plot is accepted (m).
    taken : ndarray of int, shape (n,)
        Which of the scan's plots each track took; -1 if none.
    """

    tracks: TrackReports
    predicted: Array
    outlines: Array
    taken: NDArray[np.int64]

    def __repr__(self) -> str:
        return summary(self, tracks=len(self.predicted), taken=int((self.taken >= 0).sum()))


def scan_gates(session: ScanSession, scan: Scan, *, directions: int = 96) -> ScanGates:
    """Gates of all tracks of a session, which stays as it is before the scan.

    Parameters
    ----------
    session : ScanSession
    scan : Scan
        The next one. Times of single plots are not regarded.
    directions : int
        Corners of an outline.

    Raises
    ------
    DataError
        If a plot cannot be used, or times go backwards.

    Notes
    -----
    An outline is found from the gate itself, by halving in each direction the distance at which a
    plot is still accepted; so it is right for a gate of any part, if that has no hole. The noise of
    a plot is that at its place, or that of the nearest plot if the scan has covariances.
    """
    middles, outlines = _outlines(session, scan, directions)
    copy = pickle.loads(pickle.dumps(session))
    before = copy.tracks()
    after = copy.step(scan, tentative=True)
    return ScanGates(before, middles, outlines, _taken(before, after, scan))


def _taken(before: TrackReports, after: TrackReports, scan: Scan) -> NDArray[np.int64]:
    """Which plot of a scan each track took."""
    place = np.searchsorted(after.track_id, before.track_id)
    place = np.minimum(place, max(len(after) - 1, 0))
    row = np.full(len(before), -1, np.int64)
    if len(after):
        row = np.where(after.track_id[place] == before.track_id, after.plot[place], -1)
    if scan.rows is None or not len(scan):
        return row
    order = np.argsort(scan.rows, kind="stable")
    found = order[np.minimum(np.searchsorted(scan.rows[order], row), len(scan) - 1)]
    return np.where(row >= 0, found, -1)


def _outlines(session: ScanSession, scan: Scan, directions: int) -> tuple[Array, Array]:
    """Predicted positions, and places around them."""
    tracker, tracks = session.tracker, session._work.tracks
    setting, at = Setting(tracker.sensor), tracker.places()
    update = tracker.update.kernels(setting, at["update"])
    gate = tracker.gate.kernels(setting, at["gate"])
    accept = tracker.initiation.kernels(setting, at["initiation"]).accept
    noise = _noise(session, scan)
    clock = np.zeros(CLOCK_WIDTH)
    clock[SCAN_TIME], (clock[OWN_X], clock[OWN_Y]) = scan.time, scan.own
    plots = np.zeros((1, PLOT_WIDTH))
    plots[0, PLOT_TIME] = scan.time
    turns = 2 * np.pi * np.arange(directions) / directions
    live = session._live()
    middles = np.empty((len(live), 2))
    outlines = np.empty((len(live), directions, 2))
    for number, i in enumerate(live.tolist()):
        dt = scan.time - float(tracks[i, TIME])
        x, y, _, _, p11, p12, p22 = update.predict(tracks, i, dt)
        middles[number] = x, y

        def accepted(
            dx: float, dy: float, i: int = i, dt: float = dt, x: float = x, y: float = y,
            p11: float = p11, p12: float = p12, p22: float = p22,
        ) -> bool:  # fmt: skip
            r11, r12, r22 = noise(x + dx, y + dy)
            plots[0, PLOT_X], plots[0, PLOT_Y] = x + dx, y + dy
            plots[0, R11], plots[0, R12], plots[0, R22] = r11, r12, r22
            plots[0, NOISE] = math.sqrt(max(r11 * r22 - r12 * r12, 0.0))
            s11, s12, s22 = p11 + r11, p12 + r12, p22 + r22
            away = gate.distance(tracks, i, plots, 0, clock, dx, dy, s11, s12, s22)
            return away >= 0.0 and bool(accept(tracks, i, plots, 0, dt, dx, dy))

        widest = _largest(p11, p12, p22) + _largest(*noise(x, y))
        reach = gate.reach(tracks, i, x, y, clock, widest)
        for k, turn in enumerate(turns.tolist()):
            far = _edge(accepted, 1.5 * reach, math.cos(turn), math.sin(turn))
            outlines[number, k] = x + far * math.cos(turn), y + far * math.sin(turn)
    return middles, outlines


def _noise(session: ScanSession, scan: Scan) -> Callable[[float, float], tuple[float, ...]]:
    """Covariance of a plot by its place."""
    noise, covariances = session.tracker.sensor.noise(), scan.covariances
    if covariances is None or not len(scan):
        return lambda x, y: noise(x, y, *scan.own)

    def nearest(x: float, y: float) -> tuple[float, ...]:
        away = np.hypot(scan.positions[:, 0] - x, scan.positions[:, 1] - y)
        return tuple(covariances[int(np.argmin(away))].tolist())

    return nearest


def _largest(xx: float, xy: float, yy: float) -> float:
    """Largest variance of a covariance in any direction."""
    half = 0.5 * (xx - yy)
    return 0.5 * (xx + yy) + math.sqrt(half * half + xy * xy)


def _edge(accepted: Callable[[float, float], bool], far: float, dx: float, dy: float) -> float:
    """Largest distance in a direction at which a plot is accepted."""
    low, high = 0.0, far
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if accepted(middle * dx, middle * dy):
            low = middle
        else:
            high = middle
    return low
