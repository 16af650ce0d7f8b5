"""Rows put together as scans, while they are read."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fuzzytrack.errors import DataError
from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.recordings.live_faults import FAR_AHEAD
from fuzzytrack.recordings.radar_place import RadarPlace
from fuzzytrack.recordings.scan_cut import Cutter, ScanCut
from fuzzytrack.recordings.scan_findings import ScanFindings
from fuzzytrack.recordings.scan_list import ScanList
from fuzzytrack.recordings.scan_rows import ScanRows
from fuzzytrack.scan.scan import UNKNOWN_PLACE, Scan

__all__ = ["GatheringRules", "ScanGathering"]

# A longer silence of the radar is one of these scans without a plot, and then a gap: no track lives
# through so many.
_MOST_EMPTY = 100
# So many scans back a word must not come again.
_REMEMBERED = 8


@dataclass(frozen=True)
class GatheringRules:
    """What is done with rows, the same for all groups of a recording.

    Attributes
    ----------
    cut : ScanCut
        Where scans begin.
    decoder : PlotDecoder
        For the texts of times in messages.
    scan_column : str
        Column of the scans; empty if there is none.
    moved : bool
        Whether plots are relative to the positions of the list of scans.
    drop_late : bool
        Whether scans that are not later than the one before, and one that is far ahead of both its
        neighbors, are left out; else they are an error.
    radar : tuple of float
        Position of the radar before one is found in the rows or in the list of scans (m).
    has_own : bool
        Whether rows have the position of the radar.
    """

    cut: ScanCut
    decoder: PlotDecoder
    scan_column: str = ""
    moved: bool = False
    drop_late: bool = False
    radar: tuple[float, float] = UNKNOWN_PLACE
    has_own: bool = False


class ScanGathering:
    """Makes scans of the rows of one recording.

    Parameters
    ----------
    rules : GatheringRules
    findings : ScanFindings
        Counts scans, plots and faults.
    scans : ScanList, optional
        All scans, with their times.
    group : str
        Which recording of the list it is.
    """

    def __init__(
        self,
        rules: GatheringRules,
        findings: ScanFindings,
        scans: ScanList | None = None,
        group: str = "",
    ) -> None:
        self.rules, self._findings, self._list, self._group = rules, findings, scans, group
        self._cutter = Cutter(rules.cut)
        self._open: list[ScanRows] = []
        self._time = math.nan
        told = rules.has_own or (scans is not None and scans.has_own)
        self._radar = RadarPlace(findings, rules.radar, told=told)
        self._recent: list[str] = []
        words = scans.scans.get(group, ()) if scans is not None else ()
        self._place = {word: place for place, word in enumerate(words)}
        self._next = 0

    def advance(self, rows: ScanRows) -> Iterator[Scan]:
        """Scans that have ended with these rows.

        Raises
        ------
        DataError
            If a scan is not later than the one before, comes twice, or is not in the list.
        """
        begins = np.flatnonzero(self._cutter.starts(rows))
        before = 0
        for begin in begins.tolist():
            if begin > before:
                self._open.append(rows.take(slice(before, begin)))
            yield from self._close(float(rows.time[begin]))
            before = begin
        if before < len(rows):
            self._open.append(rows.take(slice(before, len(rows))))

    def pause(self) -> Iterator[Scan]:
        """The scan so far, which is taken for whole; what comes of it afterwards is late."""
        yield from self._close()

    def finish(self) -> Iterator[Scan]:
        """The last scan, and those of the list after it."""
        yield from self._close()
        if self._list is not None and self._group in self._list.times:
            yield from self._listed_until(len(self._list.times[self._group]))

    # ---------------------------------------------------------------- one scan

    def _close(self, following: float = math.nan) -> Iterator[Scan]:
        """The scan so far; `following` is the time of the first row of the next (s)."""
        if not self._open:
            return
        rows = ScanRows.joined(self._open)
        self._open = []
        time, place = float(rows.time.max()), -1
        # Otherwise all scans that come until then would be late.
        if self.rules.drop_late and self._is_far_ahead(time, following):
            self._findings.ahead += len(rows)
            return
        if self._list is not None:
            place = self._place_in_list(rows)
            yield from self._listed_until(place)
            time = max(time, float(self._list.times[self._group][place]))
            self._next = place + 1
        again = self.rules.cut.rule == "column" and str(rows.scans[0]) in self._recent
        if time <= self._time or (again and self.rules.drop_late):
            if not self.rules.drop_late:
                raise self._out_of_order(rows, time)
            self._findings.late += len(rows)
            return
        if self._list is None:
            yield from self._silent_until(rows, time)
        self._remember(rows)
        yield self._scan(rows, time, place)

    def _is_far_ahead(self, time: float, following: float) -> bool:
        """Whether a scan ends far after the one before, and after the next has begun."""
        return time - following > FAR_AHEAD and not time - self._time <= FAR_AHEAD

    def _scan(self, rows: ScanRows, time: float, place: int) -> Scan:
        own = self._own_at(rows, time, place)
        good = np.isfinite(rows.positions.sum(axis=1))
        self._findings.missed += int(len(rows) - good.sum())
        kept = rows if good.all() else rows.take(good)
        kept = self._without_copies(kept)
        positions = kept.positions
        if self.rules.moved:
            positions = positions + own
        self._time = time
        self._findings.count(len(kept))
        times = None if (kept.time == time).all() else kept.time
        return Scan(time, positions, kept.covariances, times, own, kept.rows)

    def _own_at(self, rows: ScanRows, time: float, place: int) -> tuple[float, float]:
        """Position of the radar in the scan: that of the list, of its middle row, or the last."""
        if self._list is not None and self._list.has_own and place >= 0:
            return self._radar.move(self._list.own[self._group][place], time)
        known = np.flatnonzero(np.isfinite(rows.own).all(axis=1))
        if not len(known):
            return self._radar.move(rows.own[0], time)
        middle = int(known[len(known) // 2])
        return self._radar.move(rows.own[middle], float(rows.time[middle]))

    def _without_copies(self, rows: ScanRows) -> ScanRows:
        """Without plots that equal another one of the scan in time and position."""
        keys = np.stack([rows.time, *rows.positions.T])
        # Stable: of equal ones the first is kept.
        order = np.lexsort(keys)
        keys = keys[:, order]
        copies = order[1:][(keys[:, 1:] == keys[:, :-1]).all(axis=0)]
        if not len(copies):
            return rows
        self._findings.copies += len(copies)
        kept = np.ones(len(rows), dtype=bool)
        kept[copies] = False
        return rows.take(kept)

    # ---------------------------------------------------------------- scans without a plot

    def _empty(self, time: float) -> Scan:
        self._time = time
        self._findings.count(0)
        own = self._radar.place
        return Scan(time, np.empty((0, 2)), own=own, rows=np.empty(0, dtype=np.int64))

    def _listed_until(self, place: int) -> Iterator[Scan]:
        """Scans of the list before a place that have no plots."""
        assert self._list is not None
        times, own = self._list.times[self._group], self._list.own[self._group]
        for k in range(self._next, place):
            # After a scan whose last plot is later than the list says.
            if times[k] > self._time or math.isnan(self._time):
                self._radar.move(own[k], float(times[k]))
                yield self._empty(float(times[k]))
        self._next = max(self._next, place)

    def _silent_until(self, rows: ScanRows, time: float) -> Iterator[Scan]:
        """Scans without a plot between the last one and this one."""
        if math.isnan(self._time):
            return
        before, wait = self._time, time - self._time
        missing = self._skipped_numbers(rows)
        if missing > 0:
            step = wait / (missing + 1)
        elif self.rules.cut.rule != "column" and self.rules.cut.period > 0:
            step = self.rules.cut.period
            missing = round(min(wait / step, 1e9)) - 1
        for k in range(1, min(missing, _MOST_EMPTY) + 1):
            at = before + k * step
            if before < at < time:
                yield self._empty(at)

    def _skipped_numbers(self, rows: ScanRows) -> int:
        """How many numbers of scans there are between the last one and this one."""
        if not self._recent or self.rules.cut.rule != "column":
            return 0
        before, now = self._recent[-1], str(rows.scans[0])
        if not (before.isdecimal() and now.isdecimal()):
            return 0
        skipped = int(now) - int(before) - 1
        return skipped if 0 < skipped <= _MOST_EMPTY else 0

    # ---------------------------------------------------------------- what may be wrong

    def _place_in_list(self, rows: ScanRows) -> int:
        word = str(rows.scans[0])
        place = self._place.get(word)
        assert self._list is not None
        where = f"{rows.file}: row {rows.rows[0]}"
        if place is None:
            group = f" of {self._group!r}" if self._group else ""
            raise DataError(f"{where}: scan {word!r}{group} is not in {self._list.file}")
        if place < self._next:
            raise DataError(
                f"{where}: scan {word!r} comes after {self._recent[-1:] and self._recent[-1]!r}, "
                f"before it in {self._list.file}; expected their order there"
            )
        return place

    def _remember(self, rows: ScanRows) -> None:
        if self.rules.cut.rule != "column":
            return
        word = str(rows.scans[0])
        if word in self._recent:
            raise DataError(
                f"{rows.file}: row {rows.rows[0]}, column {self.rules.scan_column}: scan {word!r} "
                f"comes again after {self._recent[-1]!r}; expected the rows of a scan one after "
                "the other (`sort` puts them in order of time)"
            )
        self._recent = [*self._recent[1 - _REMEMBERED :], word]

    def _out_of_order(self, rows: ScanRows, time: float) -> DataError:
        clock, named = self.rules.decoder.clock, ""
        if self.rules.cut.rule == "column":
            named = f" {str(rows.scans[0])!r} of column {self.rules.scan_column}"
        return DataError(
            f"{rows.file}: row {rows.rows[0]}, column {self.rules.decoder.columns.time}: the scan"
            f"{named} ends at {clock.as_cell(time)}, not later than {clock.as_cell(self._time)} of "
            "the one before; `sort` puts plots in order of time, `lateness` leaves out late ones"
        )
