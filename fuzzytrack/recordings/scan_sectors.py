"""Plots of a turning antenna, tracked sector by sector behind the beam.

A turn has N sectors, counted on from turn to turn. When the beam has passed the end of sector
q + 1, the confirmed tracks in sector q are due, and the tentative ones half a sector behind them:
they get the plots of the sectors q - 1 to q + 1 that no track has used. Then all tracks that could
use a plot of sector q - 1 have been due, and a plot there that is left starts a track. So the
report of a track comes at most two sectors after the beam has passed it, and a start one sector
later; scan by scan it is up to a turn.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.recordings.antenna_turn import AntennaTurn
from fuzzytrack.recordings.radar_place import RadarPlace
from fuzzytrack.recordings.scan_findings import ScanFindings
from fuzzytrack.recordings.scan_rows import ScanRows
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.track_reports import STATUSES, TrackReports

__all__ = ["Beam", "SectorPass"]

# How fast the beam follows the bearings, for each sector that had plots: its angle, and its rate
# for each turn.
_ANGLE_GAIN, _RATE_GAIN = 0.1, 0.02
# A longer silence is so many turns without a plot, and then a gap.
_MOST_SILENT = 100
# How much later a tentative track is due than a confirmed one, in sectors.
_LATER = 0.5
_TENTATIVE = STATUSES.index("tentative")
_FULL = 2 * math.pi


@dataclass(frozen=True)
class Beam:
    """Where the antenna points, followed by the bearings of plots.

    Attributes
    ----------
    time : float
        A time (s).
    turns : float
        Turns at that time, counted in the sense in which it turns; whole where it points along the
        second axis.
    rate : float
        Turns in a second.
    clockwise : bool
        Whether bearings, from the second axis to the first, grow.
    """

    time: float
    turns: float
    rate: float
    clockwise: bool = True

    @classmethod
    def of(cls, antenna: AntennaTurn, time: float) -> Beam:
        """Beam of an antenna at a time."""
        turns = float(antenna.phase(time)) / _FULL
        return cls(
            time, turns if antenna.clockwise else -turns, 1 / antenna.period, antenna.clockwise
        )

    def turns_at(self, time: float) -> float:
        """Turns at a time."""
        return self.turns + self.rate * (time - self.time)

    def time_at(self, turns: float) -> float:
        """Time of some turns."""
        return self.time + (turns - self.turns) / self.rate

    def places(self, offset: Array, time: Array) -> Array:
        """Turns at which the beam points to plots that were made at about some times.

        Parameters
        ----------
        offset : ndarray, shape (n, 2)
            From the radar to the plots.
        time : ndarray, shape (n,)
        """
        share = np.arctan2(offset[:, 0], offset[:, 1]) / _FULL
        share = share if self.clockwise else -share
        about = self.turns + self.rate * (time - self.time)
        return share + np.round(about - share)

    def followed(self, places: Array, time: Array, sectors: int) -> Beam:
        """Beam corrected by plots of one sector, at which it pointed at their times."""
        if not len(places):
            return self
        middle = float(time.mean())
        error = float(np.mean(places - (self.turns + self.rate * (time - self.time))))
        return Beam(
            middle,
            self.turns_at(middle) + _ANGLE_GAIN * error,
            self.rate * (1 + _RATE_GAIN * error / sectors),
            self.clockwise,
        )


class SectorPass:
    """A session that gets the plots of a turning antenna sector by sector.

    Parameters
    ----------
    session : ScanSession
        The scan tracker; its scans are the turns.
    beam : Beam
        Where the antenna points at the first plot.
    sectors : int
        Sectors of a turn, at least 4.
    tentative : bool
        Whether tentative tracks are reported, too.
    radar : RadarPlace, optional
        Position of the radar, and what counts plots; the origin before one is known.
    """

    def __init__(
        self,
        session: Any,
        beam: Beam,
        sectors: int,
        *,
        tentative: bool = False,
        radar: RadarPlace | None = None,
    ) -> None:
        self._radar = radar or RadarPlace(ScanFindings(), (0.0, 0.0))
        self.session, self._beam, self._sectors = session, beam, sectors
        self._tentative = tentative
        # The sector in which the beam is, and the plots of the last ones that nobody has used.
        self._sector = math.floor(beam.turns_at(beam.time) * sectors)
        self._turn = math.floor(beam.turns_at(beam.time)) - 1
        # Plots of the sector in which the beam is; together, so that pieces of any size are equal.
        self._fresh: list[ScanRows] = []
        self._pool: ScanRows | None = None
        self._pool_sectors = np.empty(0, dtype=np.int64)
        self._time = -math.inf
        # The sector in which each track was due last.
        self._done: dict[int, int] = {}

    @property
    def latency(self) -> float:
        """Longest time from a plot to the report of the track that has used it (s)."""
        return 2 / (self._sectors * self._beam.rate)

    def advance(self, rows: ScanRows) -> Iterator[tuple[Scan, TrackReports]]:
        """Take in rows in order of time.

        Yields
        ------
        scan : Scan
            Plots that were used in a sector, or start tracks there; each plot is in one of them.
        reports : TrackReports
            Of tracks that were due, and of new ones.
        """
        while len(rows):
            until = self._beam.time_at((self._sector + 1) / self._sectors)
            ready = int(np.searchsorted(rows.time, until))
            if ready:
                self._fresh.append(rows.take(slice(0, ready)))
            if ready == len(rows):
                return
            rows = rows.take(slice(ready, len(rows)))
            yield from self._next_sector(float(rows.time[0]))

    def finish(self) -> Iterator[tuple[Scan, TrackReports]]:
        """The sectors that the last plots were still waited for."""
        for _ in range(3):
            yield from self._next_sector(math.nan)

    # ---------------------------------------------------------------- one sector

    def _leave_sector(self) -> None:
        """Put the plots of a sector into the pool, and follow the beam by them."""
        if not self._fresh:
            return
        rows, self._fresh = ScanRows.joined(self._fresh), []
        known = np.flatnonzero(np.isfinite(rows.own.sum(axis=1)))
        last = int(known[-1]) if len(known) else -1
        own = self._radar.move(rows.own[last], float(rows.time[last]))
        good = np.isfinite(rows.positions.sum(axis=1))
        self._radar.findings.missed += int(len(rows) - good.sum())
        rows = rows.take(good)
        if not len(rows):
            return
        places = self._beam.places(rows.positions - own, rows.time)
        self._beam = self._beam.followed(places, rows.time, self._sectors)
        sectors = np.floor(places * self._sectors).astype(np.int64)
        self._pool = rows if self._pool is None else ScanRows.joined([self._pool, rows])
        self._pool_sectors = np.append(self._pool_sectors, sectors)

    def _next_sector(self, next_time: float) -> Iterator[tuple[Scan, TrackReports]]:
        """The beam enters the next sector: the one before the last is due."""
        self._leave_sector()
        self._sector += 1
        silent = self._beam.turns_at(next_time) - self._sector / self._sectors
        if silent > _MOST_SILENT:
            # No track lives through so many turns.
            skipped = math.floor(silent - _MOST_SILENT)
            self._sector += skipped * self._sectors
            self._turn += skipped
        yield from self._process(self._sector - 2)

    def _process(self, sector: int) -> Iterator[tuple[Scan, TrackReports]]:
        turn = sector // self._sectors
        begins = turn > self._turn
        self._turn = turn
        time = self._beam.time_at((sector + 2) / self._sectors)
        pool, sectors = self._pool, self._pool_sectors
        near = sectors <= sector + 1
        given, its = None if pool is None else pool.take(near), sectors[near]
        if given is not None and len(given):
            time = max(time, float(given.time.max()))
        if time <= self._time:
            time = math.nextafter(self._time, math.inf)
        self._time = time
        scan = _scan(given, time, self._radar.place)
        starts = its < sector
        ids, due = self._due(sector, time)
        reports, unused = self.session.advance(
            scan,
            tentative=self._tentative,
            due=due,
            may_start=starts,
            new_scan=begins,
        )
        for id in ids[due].tolist():
            self._done[id] = sector
        waits = np.asarray(unused & ~starts)
        if pool is not None:
            # What no track has used yet may be used by one that is due next.
            keep = np.ones(len(pool), dtype=bool)
            keep[np.flatnonzero(near)] = waits
            self._pool, self._pool_sectors = pool.take(keep), sectors[keep]
        done = _scan(None if given is None else given.take(~waits), time, self._radar.place)
        self._radar.findings.count(len(done))
        yield done, reports

    def _due(self, sector: int, time: float) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """All tracks, and which are due: those in this sector, or passed, and not yet in this turn.

        A track whose sector was passed while it was still expected in the next one is due late
        rather than not at all.
        """
        tracks, n = self.session.tracks(), self._sectors
        ids = tracks.track_id
        ahead = (time - tracks.time)[:, None]
        offset = tracks.position + ahead * tracks.velocity - self._radar.place
        share = np.arctan2(offset[:, 0], offset[:, 1]) / _FULL
        # Tentative tracks come half a sector later, so that none on the other side of a border
        # takes the plot of a confirmed one.
        late = np.where(tracks.status == _TENTATIVE, _LATER, 0.0)
        turned = (share if self._beam.clockwise else -share) * n
        place = np.floor(turned + late).astype(np.int64)
        behind = np.mod(sector - place, n)
        # A new track was made by a plot that is two sectors back.
        live = {id: self._done.get(id, sector - 2) for id in ids.tolist()}
        self._done = live
        since = sector - np.array(list(live.values()), dtype=np.int64)
        return ids, (behind < n // 2) & (since > n // 2)


def _scan(rows: ScanRows | None, time: float, own: tuple[float, float]) -> Scan:
    if rows is None:
        return Scan(time, np.empty((0, 2)), own=own, rows=np.empty(0, dtype=np.int64))
    return Scan(time, rows.positions, rows.covariances, rows.time, own, rows.rows)
