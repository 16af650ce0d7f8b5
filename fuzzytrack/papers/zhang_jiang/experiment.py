"""The paper's tracker and others on the same vessels: errors, breaks, and what sectors save."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.papers.reproduction import Row, row
from fuzzytrack.papers.zhang_jiang.vessels import (
    BEARING_NOISE,
    PERIOD,
    RANGE_NOISE,
    Recording,
    Traffic,
)
from fuzzytrack.scan.association.greedy import GreedyAssociation
from fuzzytrack.scan.candidates.all_pairs import AllPairs
from fuzzytrack.scan.candidates.sectors import SectorCandidates
from fuzzytrack.scan.clutter.constant import ConstantClutter
from fuzzytrack.scan.confirmation.count import Count
from fuzzytrack.scan.gate.box import BoxGate
from fuzzytrack.scan.initiation.two_point import TwoPoint
from fuzzytrack.scan.kind.none import NoKind
from fuzzytrack.scan.quality.zhang_jiang import QualityFactor
from fuzzytrack.scan.scan_result import ScanResult
from fuzzytrack.scan.scan_tracker import ScanTracker
from fuzzytrack.scan.sensor import Sensor
from fuzzytrack.scan.track_reports import STATUSES, TrackReports
from fuzzytrack.scan.update.quality_gains import QualityGains
from fuzzytrack.scan.update.transient import Transient
from fuzzytrack.tasks import Progress, part

__all__ = ["experiment_rows", "published", "safe", "savings", "track_errors"]

TABLE = "Vessels"
#: Scans before the evaluation, least range (m), and how far a track may be off to count (m).
_FIRST, _NEAREST, _FARTHEST = 20, 1000.0, 200.0
_CONFIRMED = STATUSES.index("confirmed")


def published(cap: float = 30.0) -> ScanTracker:
    """The tracker as published: whole length of the gate F(N)(2σ + L), plots of two sectors."""
    return ScanTracker(
        sensor=Sensor(RANGE_NOISE, float(BEARING_NOISE), 0.01, 0.95, PERIOD),
        clutter=ConstantClutter(),
        candidates=SectorCandidates(32, "adjacent"),
        gate=BoxGate("published", 100.0, math.radians(1.0)),
        association=GreedyAssociation(),
        update=QualityGains(),
        quality=QualityFactor(cap),
        kind=NoKind(),
        initiation=TwoPoint(0.0),
        confirmation=Count(),
        name="zhang-jiang",
    )


def safe(cap: float = 10.0, drop: float = 3.0) -> ScanTracker:
    """The same with a gate that has room for the noise of a plot."""
    return replace(
        published(),
        candidates=SectorCandidates(),
        gate=BoxGate("safe", 100.0, math.radians(1.0)),
        quality=QualityFactor(cap, drop),
        name="zhang-jiang-safe",
    )


#: α = 0.5 is that of a line through N + 2 plots for this N.
_HALF = 0.5 * (3.0 + math.sqrt(33.0))

Figures = tuple[float, float, float]
#: What is run: name, tracker, rate of turn (degrees/s), and figures of the reconstruction with the
#: differences that are allowed: error of range (m), of bearing (degrees), breaks a vessel.
CASES: tuple[tuple[str, Callable[[], ScanTracker], float, dict[str, tuple[float, float]]], ...] = (
    ("as published, straight", published, 0.0,
     {"range": (5.9, 0.2), "bearing": (0.036, 0.002), "breaks": (0.22, 0.1)}),
    ("as published, turns of 1°/s", published, 1.0,
     {"range": (15.6, 0.8), "breaks": (4.4, 0.5)}),
    ("as published, cap 10, turns of 1°/s", lambda: published(10.0), 1.0,
     {"range": (9.8, 0.5), "breaks": (0.30, 0.12)}),
    ("safe, cap 10, straight", safe, 0.0, {"range": (7.6, 0.2), "breaks": (0.125, 0.125)}),
    ("safe, cap 10, turns of 1°/s", safe, 1.0, {"range": (9.1, 0.3), "breaks": (0.125, 0.125)}),
    ("fixed α = 0.5, straight", lambda: safe(_HALF, 0.0), 0.0, {"range": (9.9, 0.2)}),
    ("Kalman filter with 0.1 m/s², straight",
     lambda: replace(safe(), update=Transient(0.1)), 0.0, {"range": (7.4, 0.2)}),
)  # fmt: skip

_UNITS = {"range": "error of range (m)", "bearing": "error of bearing (°)",
          "breaks": "breaks a vessel"}  # fmt: skip
_WHY = {
    "safe": "breaks: the reconstruction says less than 0.25",
    "fixed": "gains of the quality 4.37, which does not fall",
}


def experiment_rows(traffic: Traffic, runs: int, seed: int, progress: Progress) -> list[Row]:
    """All figures of the experiment."""
    rows, each = [], 0.8 / len(CASES)
    for number, (name, made, turn, expected) in enumerate(CASES):
        watch = part(progress, number * each, (number + 1) * each)
        figures = _figures(made(), traffic, turn, runs, seed, watch)
        why = _WHY.get(name.split(",")[0].split(" ")[0], "")
        for (quantity, unit), values in zip(_UNITS.items(), figures.T, strict=True):
            known, within = expected.get(quantity, (None, 0.0))
            error = float(np.std(values, ddof=1) / math.sqrt(runs)) if runs > 1 else None
            rows.append(
                row(TABLE, f"{name}: {unit}", float(np.mean(values)), published=known,
                    within=within, se=error, runs=runs, why=why if known is not None else "")
            )  # fmt: skip
    return [*rows, *_sector_rows(traffic, seed, part(progress, 0.8, 1.0))]


def _figures(
    tracker: ScanTracker, traffic: Traffic, turn: float, runs: int, seed: int, progress: Progress
) -> Array:
    """Errors and breaks of each run."""
    figures = []
    for run in range(runs):
        recording = traffic.record(turn, seed + run)
        figures.append(track_errors(recording, tracker.run(recording.scans)))
        progress((run + 1) / runs)
    return np.array(figures)


def track_errors(recording: Recording, result: ScanResult) -> Figures:
    """Error of range (m) and of bearing (degrees), and changes of the track of a vessel.

    The track of a vessel is a confirmed one whose last plot was that of the vessel, and that is no
    farther than 200 m: the one that it had, as long as this holds, else the nearest. Vessels nearer
    than 1 km, and the first 20 scans, do not count.
    """
    reports, scans = result.reports, len(recording.scans)
    n = recording.truth.shape[1]
    begin = np.searchsorted(reports.scan, np.arange(scans + 1))
    owner: dict[int, int] = {}
    kept = np.full(n, -1)
    squares, count, breaks = np.zeros(2), 0, 0
    for k in range(scans):
        rows = np.arange(begin[k], begin[k + 1])
        for i, plot in zip(reports.track_id[rows], reports.plot[rows], strict=True):
            if plot >= 0:
                owner[i] = int(recording.vessel[k][plot])
        if k < _FIRST:
            continue
        for vessel, found in _by_vessel(recording.truth[k], reports, rows, owner).items():
            chosen = next((r for r in found if reports.track_id[r] == kept[vessel]), found[0])
            breaks += int(kept[vessel] not in (-1, reports.track_id[chosen]))
            kept[vessel] = reports.track_id[chosen]
            squares += _polar_error(reports.position[chosen], recording.truth[k, vessel]) ** 2
            count += 1
    r, bearing = np.sqrt(squares / max(count, 1))
    return float(r), math.degrees(bearing), breaks / n


def _by_vessel(
    truth: Array, reports: TrackReports, rows: NDArray[np.intp], owner: dict[int, int]
) -> dict[int, list[int]]:
    """Rows of the tracks that follow each vessel, the nearest first."""
    found: dict[int, list[tuple[float, int]]] = {}
    for r in rows:
        vessel = owner.get(reports.track_id[r], -1)
        if vessel < 0 or math.hypot(*truth[vessel]) <= _NEAREST:
            continue
        away = math.dist(reports.position[r], truth[vessel])
        if away < _FARTHEST:
            found.setdefault(vessel, []).append((away, int(r)))
    return {vessel: [r for _, r in sorted(each)] for vessel, each in found.items()}


def _polar_error(position: Array, truth: Array) -> Array:
    (x, y), (a, b) = position, truth
    turn = math.atan2(a * y - b * x, a * x + b * y)
    return np.array([math.hypot(x, y) - math.hypot(a, b), turn])


# ------------------------------------------------------------ sectors


def _sector_rows(traffic: Traffic, seed: int, progress: Progress) -> list[Row]:
    recording = traffic.record(0.0, seed)
    saved = savings(recording, published(), (32, 360))
    progress(0.4)
    rows = [
        row(TABLE, f"pairs that {n} sectors save, times fewer", saved[n], published=known,
            within=within)
        for n, known, within in ((32, 15.2, 0.4), (360, 114.0, 6.0))
    ]  # fmt: skip
    every = replace(published(), candidates=AllPairs()).run(recording.scans).reports
    for n in (8, 16):
        sectors = replace(published(), candidates=SectorCandidates(n, "adjacent"))
        found = sectors.run(recording.scans).reports
        same = all(
            np.array_equal(getattr(found, each.name), getattr(every, each.name), equal_nan=True)
            for each in fields(TrackReports)
        )
        rows.append(row(TABLE, f"tracks of {n} sectors are those of all pairs, 1 if so",
                        float(same), published=1.0))  # fmt: skip
        progress(0.4 + 0.3 * n / 8)
    return rows


def savings(
    recording: Recording, tracker: ScanTracker, sectors: tuple[int, ...]
) -> dict[int, float]:
    """How many times fewer pairs two of so many sectors give than all tracks with all plots.

    Confirmed tracks come first, so tentative ones meet only the plots that these leave.
    """
    session = tracker.start()
    every, some = 0, dict.fromkeys(sectors, 0)
    for scan in recording.scans:
        before, last = session.tracks(), session.time
        reports = session.step(scan, tentative=True)
        if not len(before):
            continue
        place = before.position + before.velocity * (scan.time - last)
        confirmed = before.status >= _CONFIRMED
        used = reports.plot[np.isin(reports.track_id, before.track_id[confirmed])]
        left = np.ones(len(scan), np.bool_)
        left[used[used >= 0]] = False
        plots = np.arctan2(scan.positions[:, 1], scan.positions[:, 0])
        tracks = np.arctan2(place[:, 1], place[:, 0])
        meets = left[None, :] | confirmed[:, None]
        every += int(meets.sum())
        for n in sectors:
            width = 2 * np.pi / n
            sector = np.floor(tracks / width + 0.5)[:, None]
            offset = (sector - np.floor(plots / width)[None, :]) % n
            some[n] += int((meets & (offset <= 1)).sum())
    return {n: every / max(some[n], 1) for n in sectors}
