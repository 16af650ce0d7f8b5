"""A scan tracker run over the scans of a recording, as they are read."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from itertools import chain, groupby
from typing import Any, Protocol

import numpy as np

from fuzzytrack.errors import DataError
from fuzzytrack.recordings.antenna_turn import antenna_of
from fuzzytrack.recordings.radar_place import RadarPlace
from fuzzytrack.recordings.scan_rows import ScanRows
from fuzzytrack.recordings.scan_sectors import Beam, SectorPass
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.track_reports import KINDS, STATUSES, TrackReports

__all__ = ["ScanTotals", "ScannedScan", "Scanner", "Session", "run_scans", "run_sectors"]


# Rows and turns by which the beam of an antenna is found.
_HELD, _TURNS = 50, 5


class Session(Protocol):
    """The state of a scan tracker; see `fuzzytrack.scan.scan_session`."""

    def step(self, scan: Scan, *, tentative: bool = False) -> TrackReports:
        """Take in the plots of the next scan."""


class Scanner(Protocol):
    """What starts a session; see `fuzzytrack.scan.scan_tracker`."""

    @property
    def name(self) -> str:
        """Name of the configuration."""

    @property
    def merges_plots(self) -> bool:
        """Whether it makes one plot of several."""

    def start(self) -> Any:
        """Begin a session that has seen nothing."""


@dataclass(frozen=True, eq=False)
class ScannedScan:
    """A scan, and the tracks after it.

    Attributes
    ----------
    group : str
        Which recording it is of; empty if there is one only.
    scan : Scan
    reports : TrackReports
        Identities differ between recordings, too.
    """

    group: str
    scan: Scan
    reports: TrackReports


@dataclass
class ScanTotals:
    """Counts of a run, of one recording or of all.

    Attributes
    ----------
    scans, empty, plots : int
        Scans, those without a plot, and plots.
    used : int
        Rows of reports with a plot.
    rows : int
        Rows of reports.
    kinds : dict of int to int
        Kind of each track that was confirmed, as it was reported last.
    tentative : set of int
        Tracks that were reported, but never as confirmed.
    """

    scans: int = 0
    empty: int = 0
    plots: int = 0
    used: int = 0
    rows: int = 0
    kinds: dict[int, int] = field(default_factory=dict)
    tentative: set[int] = field(default_factory=set)

    def add(self, each: ScannedScan) -> None:
        """Count one more scan."""
        reports = each.reports
        self.scans += 1
        self.plots += len(each.scan)
        self.empty += not len(each.scan)
        self.rows += len(reports)
        self.used += int((reports.plot >= 0).sum())
        for id, status, kind in zip(
            reports.track_id.tolist(), reports.status.tolist(), reports.kind.tolist(), strict=True
        ):
            if status != STATUSES.index("tentative"):
                self.kinds[id] = kind
                self.tentative.discard(id)
            elif id not in self.kinds:
                self.tentative.add(id)

    def merge(self, other: ScanTotals) -> None:
        """Add the counts of another recording."""
        for name in ("scans", "empty", "plots", "used", "rows"):
            setattr(self, name, getattr(self, name) + getattr(other, name))
        self.kinds |= other.kinds
        self.tentative |= other.tentative

    @property
    def summary(self) -> dict[str, int]:
        """The counts by name: tracks that were confirmed, and how many of each kind."""
        kinds = list(self.kinds.values())
        return {
            "scans": self.scans,
            "empty_scans": self.empty,
            "plots": self.plots,
            "rows": self.rows,
            "rows_with_plot": self.used,
            "tracks": len(kinds),
            **{word: kinds.count(k) for k, word in enumerate(KINDS)},
            "tentative": len(self.tentative),
        }


def run_scans(
    scanner: Scanner, scans: Iterable[tuple[str, Scan]], *, tentative: bool = False
) -> Iterator[ScannedScan]:
    """Track the scans of recordings, each recording by itself.

    Parameters
    ----------
    scanner : ScanTracker
        The scan tracker.
    scans : iterable of (str, Scan)
        Those of each group one after the other.
    tentative : bool
        Whether tentative tracks are reported, too.

    Yields
    ------
    ScannedScan
        Identities of a later group follow those that were reported of the one before.
    """
    session: Any = None
    group, before, last = "", 0, 0
    for word, scan in scans:
        if session is None or word != group:
            session, group, before = scanner.start(), word, last
        reports = session.step(scan, tentative=tentative)
        reports = with_ids_after(reports, before)
        if len(reports):
            last = max(last, int(reports.track_id.max()))
        yield ScannedScan(group, scan, reports)


def with_ids_after(reports: TrackReports, before: int) -> TrackReports:
    """Reports whose identities are larger by a number."""
    if not before:
        return reports
    return replace(reports, track_id=np.asarray(reports.track_id + before))


def run_sectors(
    scanner: Scanner,
    plots: Iterable[tuple[str, ScanRows]],
    sectors: int,
    period: float,
    *,
    tentative: bool = False,
    radar: Callable[[], RadarPlace] | None = None,
) -> Iterator[ScannedScan]:
    """Track the plots of a turning antenna sector by sector, each recording by itself.

    Parameters
    ----------
    scanner : ScanTracker
        The scan tracker; its scans are the turns.
    plots : iterable of (str, ScanRows)
        Rows in order of time, those of each group one after the other.
    sectors : int
        Sectors of a turn.
    period : float
        About the time of a turn (s).
    tentative : bool
        Whether tentative tracks are reported, too.
    radar : callable, optional
        Makes the `radar` of each recording, see `SectorPass`.

    Yields
    ------
    ScannedScan
        Of a sector, which counts as a scan: the plots that were used or start tracks, and reports
        of the tracks that were due. Where the antenna points is found out by the plots of the first
        turns, which are held until then.

    Raises
    ------
    DataError
        If the bearings of the first turns do not follow an antenna, or if the scan tracker merges
        plots.
    """
    before = last = 0
    for group, parts in groupby(plots, key=lambda pair: pair[0]):
        before = last
        place = None if radar is None else radar()
        run = SectorRun(scanner, sectors, period, tentative=tentative, radar=place)
        steps = chain((run.advance(part) for _, part in parts), [_later(run.finish)])
        done = chain.from_iterable(steps)
        for number, (scan, reports) in enumerate(done):
            reports = with_ids_after(reports, before)
            reports = replace(reports, scan=np.full(len(reports), number, dtype=np.int64))
            if len(reports):
                last = max(last, int(reports.track_id.max()))
            yield ScannedScan(group, scan, reports)


class SectorRun:
    """One recording, tracked sector by sector once its first turns show where the antenna points.

    Parameters
    ----------
    scanner, sectors, period, tentative
        As for `run_sectors`.
    radar : RadarPlace, optional
        See `SectorPass`.
    """

    def __init__(
        self,
        scanner: Scanner,
        sectors: int,
        period: float,
        *,
        tentative: bool = False,
        radar: RadarPlace | None = None,
    ) -> None:
        if scanner.merges_plots:
            raise DataError(
                f"`sectors`: configuration {scanner.name} merges plots, which needs whole scans; "
                "leave `sectors` out, or take part none for extraction"
            )
        self._scanner, self._sectors, self._period = scanner, sectors, period
        self._tentative, self._radar = tentative, radar
        self._held: list[ScanRows] = []
        self._pass: SectorPass | None = None

    @property
    def session(self) -> Any:
        """The session of the scan tracker; None before the first turns are known."""
        return None if self._pass is None else self._pass.session

    def advance(self, rows: ScanRows) -> Iterator[tuple[Scan, TrackReports]]:
        """Take in rows in order of time; see `SectorPass.advance`."""
        if self._pass is not None:
            yield from self._pass.advance(rows)
        elif len(rows):
            self._held.append(rows)
            span = float(self._held[-1].time[-1] - self._held[0].time[0])
            if sum(map(len, self._held)) >= _HELD and span >= _TURNS * self._period:
                yield from self._begun()

    def finish(self) -> Iterator[tuple[Scan, TrackReports]]:
        """The last sectors."""
        if self._pass is None and self._held:
            yield from self._begun()
        if self._pass is not None:
            yield from self._pass.finish()

    def _begun(self) -> Iterator[tuple[Scan, TrackReports]]:
        first, self._held = ScanRows.joined(self._held), []
        antenna = antenna_of(first, self._period, first.file)
        beam = Beam.of(antenna, float(first.time[0]))
        session = self._scanner.start()
        self._pass = SectorPass(
            session, beam, self._sectors, tentative=self._tentative, radar=self._radar
        )
        yield from self._pass.advance(first)


def _later(made: Callable[[], Iterator[Any]]) -> Iterator[Any]:
    """An iterator that is made when it is needed."""
    yield from made()
