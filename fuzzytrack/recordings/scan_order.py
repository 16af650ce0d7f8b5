"""Rows in order of time: clocks that start again, and rows that come late."""

from __future__ import annotations

import math

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.cleaning_step import PERIODS
from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.recordings.live_faults import FAR_AHEAD
from fuzzytrack.recordings.scan_findings import ScanFindings
from fuzzytrack.recordings.scan_rows import ScanRows

__all__ = ["CountedOn", "RowOrder"]

# A clock that has started again goes on within so many mean steps.
_PLAUSIBLE = 20.0
# Times that fall by less than the rest of this part of the period are out of order.
_DISORDER = 0.25


class CountedOn:
    """Counts times on where their clock starts again at 0.

    Parameters
    ----------
    period : float or None
        Period of the clock (s); None if it is not known.
    recognize : bool
        Whether midnight, the end of the week and counters of 32 bits are recognized.
    findings : ScanFindings
        Counts how often it has started again.
    """

    def __init__(self, period: float | None, recognize: bool, findings: ScanFindings) -> None:
        self._period, self._recognize, self._findings = period, recognize, findings
        self.begin()

    def begin(self) -> None:
        """Begin another recording."""
        self._last, self._turns = math.nan, 0.0
        self._steps, self._sum = 0, 0.0

    def advance(self, time: Array) -> Array:
        """Times of the next rows, counted on."""
        if not len(time):
            return time
        steps = np.diff(time, prepend=self._last if not math.isnan(self._last) else time[0])
        rises = steps[steps > 0]
        self._steps, self._sum = self._steps + len(rises), self._sum + float(rises.sum())
        self._last = float(time[-1])
        if self._period is None and self._recognize:
            self._period = self._recognized(steps)
        if self._period is None:
            return time
        turns = self._turns + np.cumsum(-np.floor(steps / self._period + _DISORDER))
        self._findings.wraps += max(0, int(turns[-1] - self._turns))
        self._turns = float(turns[-1])
        return time + turns * self._period

    def _recognized(self, steps: Array) -> float | None:
        falls = -steps[steps < 0]
        if not len(falls) or not self._steps:
            return None
        plausible = _PLAUSIBLE * self._sum / self._steps
        return next((p for p in PERIODS if ((falls < p) & (falls >= p - plausible)).any()), None)


class RowOrder:
    """Puts rows in order of time, as far as they are not too late.

    One row whose time is far ahead of the row before it and of the one after it is left out:
    otherwise all that come until then would be too late.

    Parameters
    ----------
    lateness : float or None
        How late a row may come (s); later ones are left out. None: none may, and one that does is
        an error.
    decoder : PlotDecoder
        For messages.
    findings : ScanFindings
        Counts rows that are late or far ahead.
    """

    def __init__(
        self, lateness: float | None, decoder: PlotDecoder, findings: ScanFindings
    ) -> None:
        self._lateness, self._decoder, self._findings = lateness, decoder, findings
        self._held: list[ScanRows] = []
        # The last row, if it is far ahead of the one before, whose time stands below.
        self._apart: ScanRows | None = None
        self._before = -math.inf
        self._newest = -math.inf

    def advance(self, rows: ScanRows) -> ScanRows:
        """Rows that no later one can come before.

        Raises
        ------
        DataError
            If a row is earlier than the one before, and no lateness is allowed for.
        """
        if not len(rows):
            return rows
        if self._lateness is not None:
            return self._in_order(self._without_far(rows, self._lateness), self._lateness)
        newest = np.maximum.accumulate(np.append(self._newest, rows.time))
        late = rows.time < newest[:-1]
        if late.any():
            raise self._error(rows, int(np.argmax(late)), float(newest[int(np.argmax(late))]))
        self._newest = float(newest[-1])
        return rows

    def _without_far(self, rows: ScanRows, lateness: float) -> ScanRows:
        """Rows without those far ahead; one at the end that may be so waits for the next."""
        if self._apart is not None:
            rows = ScanRows.joined([self._apart, rows])
        rises = np.diff(rows.time, prepend=self._before) > lateness + FAR_AHEAD
        falls = np.diff(rows.time) < -lateness - FAR_AHEAD
        kept = ~(rises & np.append(falls, True))
        self._findings.ahead += int((~kept[:-1]).sum())
        waits = int(not kept[-1])
        self._apart = rows.take(slice(len(rows) - 1, None)) if waits else None
        self._before = float(np.append(self._before, rows.time)[len(rows) - waits])
        return rows.take(kept)

    def _in_order(self, rows: ScanRows, lateness: float) -> ScanRows:
        newest = np.maximum.accumulate(np.append(self._newest, rows.time))
        # What has been given on when a row comes: all up to the newest before it, less the time
        # that is allowed.
        late = rows.time < newest[:-1] - lateness
        self._findings.late += int(late.sum())
        self._newest = float(newest[-1])
        held = ScanRows.joined([*self._held, rows.take(~late)])
        held = held.take(np.argsort(held.time, kind="stable"))
        ready = int(np.searchsorted(held.time, self._newest - lateness, side="right"))
        self._held = [held.take(slice(ready, len(held)))]
        return held.take(slice(0, ready))

    def finish(self) -> ScanRows | None:
        """Rows that are still held; None if there are none."""
        parts = self._held
        if self._apart is not None and self._lateness is not None:
            parts = [self._in_order(self._apart, self._lateness), *self._held]
        self._held, self._apart, self._before, self._newest = [], None, -math.inf, -math.inf
        rest = ScanRows.joined(parts) if parts else None
        return rest if rest is not None and len(rest) else None

    def _error(self, rows: ScanRows, place: int, newest: float) -> DataError:
        clock = self._decoder.clock
        return DataError(
            f"{rows.file}: row {rows.rows[place]}, column {self._decoder.columns.time}: "
            f"{clock.as_cell(float(rows.time[place]))} is earlier than {clock.as_cell(newest)} "
            "before it; `sort` puts plots in order of time, `lateness` leaves out late ones, and "
            "if the clock starts again, `wrap` is its period"
        )
