"""Rows in order of time: clocks that start again, and rows that come late."""

from __future__ import annotations

import math

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.cleaning_step import PERIODS
from fuzzytrack.io.decoder import PlotDecoder
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

    Parameters
    ----------
    lateness : float or None
        How late a row may come (s); later ones are left out. None: none may, and one that does is
        an error.
    decoder : PlotDecoder
        For messages.
    findings : ScanFindings
        Counts late rows.
    """

    def __init__(
        self, lateness: float | None, decoder: PlotDecoder, findings: ScanFindings
    ) -> None:
        self._lateness, self._decoder, self._findings = lateness, decoder, findings
        self._held: list[ScanRows] = []
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
        newest = np.maximum.accumulate(np.append(self._newest, rows.time))
        if self._lateness is None:
            late = rows.time < newest[:-1]
            if late.any():
                raise self._error(rows, int(np.argmax(late)), float(newest[int(np.argmax(late))]))
            self._newest = float(newest[-1])
            return rows
        # What has been given on when a row comes: all up to the newest before it, less the time
        # that is allowed.
        late = rows.time < newest[:-1] - self._lateness
        self._findings.late += int(late.sum())
        self._newest = float(newest[-1])
        held = ScanRows.joined([*self._held, rows.take(~late)])
        held = held.take(np.argsort(held.time, kind="stable"))
        ready = int(np.searchsorted(held.time, self._newest - self._lateness, side="right"))
        self._held = [held.take(slice(ready, len(held)))]
        return held.take(slice(0, ready))

    def finish(self) -> ScanRows | None:
        """Rows that are still held; None if there are none."""
        held, self._held, self._newest = self._held, [], -math.inf
        return held[0] if held and len(held[0]) else None

    def _error(self, rows: ScanRows, place: int, newest: float) -> DataError:
        clock = self._decoder.clock
        return DataError(
            f"{rows.file}: row {rows.rows[place]}, column {self._decoder.columns.time}: "
            f"{clock.as_cell(float(rows.time[place]))} is earlier than {clock.as_cell(newest)} "
            "before it; `sort` puts plots in order of time, `lateness` leaves out late ones, and "
            "if the clock starts again, `wrap` is its period"
        )
