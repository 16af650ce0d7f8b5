"""Rows of a feed tracked as they come, scan by scan or sector by sector."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from fuzzytrack.recordings.scan_gathering import GatheringRules
from fuzzytrack.recordings.scan_order import RowOrder
from fuzzytrack.recordings.scan_plots import ScanPlots
from fuzzytrack.recordings.scan_rows import ScanRows
from fuzzytrack.recordings.scan_run import Scanner, SectorRun
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.track_reports import TrackReports

__all__ = ["ScanStream"]

Answer = tuple[Scan, TrackReports]


class ScanStream:
    """A scan tracker that gets rows as they come; it holds one scan, and the tracks.

    Parameters
    ----------
    plots : ScanPlots
        How rows become scans, from the first of them. Late plots are counted and left out.
    scanner : ScanTracker
        The scan tracker.
    tentative : bool
        Whether tentative tracks are reported, too.
    """

    def __init__(self, plots: ScanPlots, scanner: Scanner, *, tentative: bool = False) -> None:
        plots = plots.live()
        self.plots, self._tentative = plots, tentative
        self._clock = plots.clock()
        self._order: RowOrder | None = None
        if plots.lateness is not None:
            self._order = RowOrder(plots.lateness, plots.files.decoder, plots.findings)
        self._gathering = plots.gathering(drop_late=True)
        self._session: Any = None
        self._sectors: SectorRun | None = None
        if plots.sectors is None:
            self._session = scanner.start()
        else:
            self._sectors = SectorRun(
                scanner,
                plots.sectors,
                plots.cut.period,
                tentative=tentative,
                radar=plots.radar_place(),
            )

    @property
    def session(self) -> Any:
        """The session of the scan tracker; None where the antenna is not known yet."""
        return self._session if self._sectors is None else self._sectors.session

    @property
    def rules(self) -> GatheringRules:
        """What is done with rows."""
        return self._gathering.rules

    def advance(self, rows: ScanRows) -> Iterator[Answer]:
        """Take in rows, in the order in which they came.

        Yields
        ------
        scan : Scan
            One that has ended.
        reports : TrackReports
            The tracks after it.

        Raises
        ------
        DataError
            If a plot cannot be used.
        """
        rows = replace(rows, time=self._clock.advance(rows.time))
        if self._order is not None:
            rows = self._order.advance(rows)
        yield from self._answers(rows)

    def pause(self) -> Iterator[Answer]:
        """Answer the scan so far, since nothing has come for a while.

        Plots of it that come afterwards are late. Sectors end by the time of plots alone.
        """
        if self._sectors is None:
            yield from self._stepped(self._gathering.pause())

    def finish(self) -> Iterator[Answer]:
        """Answer what is still held, at the end."""
        rest = None if self._order is None else self._order.finish()
        if rest is not None:
            yield from self._answers(rest)
        if self._sectors is not None:
            yield from self._sectors.finish()
        else:
            yield from self._stepped(self._gathering.finish())

    def _answers(self, rows: ScanRows) -> Iterator[Answer]:
        if self._sectors is not None:
            yield from self._sectors.advance(rows)
        else:
            yield from self._stepped(self._gathering.advance(rows))

    def _stepped(self, scans: Iterator[Scan]) -> Iterator[Answer]:
        for scan in scans:
            yield scan, self._session.step(scan, tentative=self._tentative)
