"""Plots tracked as they come, late ones put in their place.

The answers are those of the recording: what `Cleaner`, `OpenTracks` and `TrackRows` make of a
file's pieces, they make of the plots that have come. What is known of a track stands in one row of
numbers, which can be kept, put back, and saved.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.cleaning_rules import Cleaning
from fuzzytrack.io.cleaning_step import BEFORE, SEGMENT, TIME
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.table import Words
from fuzzytrack.recordings.last_plots import KNOWN
from fuzzytrack.recordings.live_answers import (
    REVISION,
    AnswerPart,
    Answers,
    digests,
    joined_answers,
    taken,
)
from fuzzytrack.recordings.live_faults import FAR_AHEAD, LiveFaults
from fuzzytrack.recordings.preparation import PreparedPlots
from fuzzytrack.recordings.recent_rows import RecentRows, Row, piece_of_rows, row_of
from fuzzytrack.recordings.restarts import Restarts
from fuzzytrack.recordings.streaming import OpenTracks
from fuzzytrack.recordings.track_table import TrackRows
from fuzzytrack.trackers.catalog import as_lane_tracker
from fuzzytrack.trackers.compilation import announce

__all__ = ["LiveTracks", "check_rules"]

# Rows of the feed after which tracks that were silent for long are looked for; a fixed number, so
# that answers do not depend on how the rows come.
_SWEEP = 4096
# Coordinates of a feed that never ends.
_MANY = 1 << 62


class LiveTracks:
    """Tracks of a feed of plots.

    Parameters
    ----------
    prepared : PreparedPlots
        How plots are cleaned, judged and tracked.
    lateness : float
        A plot that is older than the newest one of its track by at most so much (s) is put in its
        place, and the answers after it are given again where they change. Older ones, and with 0
        all that are out of order, are counted and not used. If two of these follow each other in
        time, are later than all plots of their track but the newest, and are before that one by
        more than the lateness and a minute, its time is taken as wrong: the track begins anew with
        the second of them.
    forget : float, optional
        A track without a row for longer than this (s) is forgotten: nothing of it is kept, and a
        later plot of its identity begins a new track, in segment 0. It is looked for every 4096
        lines. Unless given, all tracks are kept.
    faults : LiveFaults, optional
        Gets what is wrong with plots.

    Attributes
    ----------
    names : tuple of str
        Columns of the answers.
    counts : dict of str to int
        Number of answers, of revisions among them, of late plots that were put in their place, of
        copies of earlier plots, and of tracks that were forgotten.
    recent : dict of str to RecentRows
        With `lateness`, the last rows of each identity.
    too_late : dict of str to float
        Time (s) of the last plot of a track, if that was too late.

    Raises
    ------
    ValueError
        If a number is out of its range, or an option needs rows to come.
    DataError
        If two columns of the answers would have one name.

    Notes
    -----
    Holds about 1.5 kB for each track, and with `lateness` 0.3 kB for each plot that is not older,
    for eight more, and the numbers of a track once in eight plots.

    Examples
    --------
    >>> import numpy as np
    >>> from fuzzytrack.io import Reading
    >>> from fuzzytrack.io.piece import Piece
    >>> from fuzzytrack.io.table import Words
    >>> from fuzzytrack.recordings.preparation import prepare
    >>> first = ([0.0], [[0.0, 0.0]])  # tells how many axes there are
    >>> tracks = LiveTracks(prepare(first, "fixed:alpha=0.5:beta=0.2", Reading()))
    >>> names = Words(("a",), np.array([0, 0]))
    >>> plots = np.array([[0.0, 0.0], [10.0, 5.0]])
    >>> piece = Piece(names, np.array([0.0, 1.0]), plots, rows=np.arange(2))
    >>> answers = tracks.push(piece)
    >>> answers.columns["x"].tolist(), len(tracks)
    ([0.0, 10.0], 1)
    """

    def __init__(
        self,
        prepared: PreparedPlots,
        *,
        lateness: float = 0.0,
        forget: float | None = None,
        faults: LiveFaults | None = None,
    ) -> None:
        check_rules(prepared.files.reading.cleaning, lateness, forget)
        self.prepared, self.lateness, self._forget = prepared, lateness, forget
        self.faults = LiveFaults() if faults is None else faults
        table = prepared.table
        self.names = (*table.names, REVISION)
        if REVISION in table.names:
            raise DataError(f"two columns of the output would be {REVISION!r}")
        self._axes = len(table.axes)
        self._cleaner = prepared.files.cleaner()
        sigma, tracker = prepared.files.decoder.sigma, as_lane_tracker(prepared.tracker)
        self._tracks = OpenTracks(tracker, sigma, table.outputs, prepared.judge)
        self._restarts, self._rows = Restarts(), TrackRows(table)
        self._rejected: Counter[str] = Counter()
        self.recent: dict[str, RecentRows] = {}
        self.too_late: dict[str, float] = {}
        self._swept = _SWEEP
        # Lines and times (s) of the last two rows; those that are put in their place come later.
        self._last = [(0, -math.inf)] * 2
        self.counts = dict.fromkeys(("answers", "revisions", "late", "copies", "forgotten"), 0)
        self._gone = np.zeros(2, dtype=np.int64)

    def __len__(self) -> int:
        """Number of tracks that are known."""
        return len(self._cleaner)

    def push(self, piece: Piece) -> Answers:
        """Take plots, and give the answers to them.

        Parameters
        ----------
        piece : Piece
            Plots in the order in which they came, whatever their times; `Piece.rows` are lines of
            the feed, and increase from piece to piece. Any cut into pieces gives the same answers.

        Raises
        ------
        DataError
            If a number is infinite, or a track cannot be followed with floating-point numbers.
        """
        parts: list[AnswerPart] = []
        for some in self._between_sweeps(piece):
            while len(some):
                some = self._take(some, parts)
        answers = joined_answers(parts, self.names)
        self.counts["answers"] += len(answers)
        return answers

    def warm_up(self) -> None:
        """Compile what a feed needs, so that no plot waits for it.

        Takes a second, and where nothing is kept on disk from an earlier run much longer. Without
        it a plot is tracked in plain Python, until there were so many that compiled code is worth
        its making.
        """
        announce(self.prepared.tracker, self._axes, _MANY)
        other = LiveTracks(self.prepared, lateness=max(self.lateness, 5.0))
        steps = np.arange(6.0)
        late = np.repeat([0.0, 1.0, 3.0, 4.0, 2.0, 5.0], 2)
        plots = np.repeat(steps[:, None], self._axes, axis=1)
        plots[3] = math.nan
        piece = Piece(
            Words(("a", "b"), np.tile([0, 1], 6)),
            late,
            np.repeat(plots, 2, axis=0),
            np.arange(1, 13),
            sigma=np.ones((12, self._axes)),
        )
        for cut in piece.take(np.arange(4)), piece.take(np.arange(4, 12)):
            other.push(cut)

    def findings(self) -> Findings:
        """What was put right so far."""
        rejected, restarts = self._gone.tolist()
        counts = self._cleaner.counts
        return Findings(
            cleaning=replace(counts, copies=counts.copies + self.counts["copies"]),
            rejected=rejected + self._rejected.total(),
            restarts=restarts + self._restarts.total(),
        )

    # ---------------------------------------------------------------- rows

    def _between_sweeps(self, piece: Piece) -> Iterable[Piece]:
        """Parts of a piece, between which silent tracks are forgotten."""
        if self._forget is None:
            yield piece
            return
        while len(piece):
            before = piece.rows < self._swept
            if before.any():
                yield piece.take(before)
            if before.all():
                return
            self._sweep(self._forget)
            piece = piece.take(~before)
            self._swept = (int(piece.rows[0]) // _SWEEP + 1) * _SWEEP

    def _take(self, piece: Piece, parts: list[AnswerPart]) -> Piece:
        """Take the rows of each track up to one that is out of order; those that still wait."""
        before = self._due(piece) if self.lateness else {}
        judged = self._cleaner.advance_live(piece)
        cleaned = judged.cleaned
        self._see(judged.seen)
        if self.too_late:
            for id in set(_ids(judged.seen)) & set(self.too_late):
                del self.too_late[id]
        if len(cleaned):
            columns = self._tracked(cleaned)
            if self.lateness:
                self._remember(judged.seen, digests(columns, self.names), before)
            columns[REVISION] = np.zeros(len(cleaned), dtype=np.int64)
            parts.append(AnswerPart(columns, cleaned.rows, np.zeros(len(cleaned), dtype=np.int64)))
        waiting = judged.waiting
        if not len(waiting):
            return waiting
        late = np.zeros(len(waiting), dtype=np.bool_)
        late[np.unique(waiting.ids.codes, return_index=True)[1]] = True
        self._see(waiting.take(late))
        begins = self._place(waiting.take(late), parts)
        # The first row of a track that begins anew is taken once more.
        late[np.flatnonzero(late)[begins]] = False
        return waiting.take(~late)

    def _see(self, rows: Piece) -> None:
        """Keep the times of the last two lines, in whatever order lines are taken."""
        newest = np.argsort(rows.rows)[-2:]
        seen = zip(rows.rows[newest].tolist(), rows.time[newest].tolist(), strict=True)
        self._last = sorted([*self._last, *seen])[-2:]

    def _tracked(self, cleaned: Piece) -> dict[str, Any]:
        """Columns of the answers to rows that are in order."""
        tracked = self._tracks.advance(cleaned)
        rows = tracked.piece
        if tracked.begins is not None and tracked.rejected is not None:
            rows = self._restarts.advance(rows, tracked.begins)
            if tracked.rejected.any():
                self._rejected.update(
                    rows.ids[k] for k in np.flatnonzero(tracked.rejected).tolist()
                )
        segments = cleaned.segments
        if segments is not None and segments.any():
            # Nothing comes back to a segment that has ended, unless its track is put back.
            later = {(cleaned.ids[k], int(segments[k])) for k in np.flatnonzero(segments).tolist()}
            self._tracks.end([_name(id, segment - 1) for id, segment in later])
        return self._rows.values(rows, tracked.outputs)

    # ---------------------------------------------------------------- late rows

    def _due(self, piece: Piece) -> dict[str, bytes]:
        """Numbers of the tracks of some rows, where they have to be kept."""
        names, codes = piece.ids.names, np.unique(piece.ids.codes)
        ids = [names[code] for code in codes.tolist()]
        recent = self.recent
        due = [id for id in ids if id not in recent or recent[id].is_due]
        if not due:
            return {}
        numbers = self.numbers(due)
        return {id: row.tobytes() for id, row in zip(due, numbers, strict=True)}

    def _remember(self, seen: Piece, answers: list[bytes], before: dict[str, bytes]) -> None:
        plots, times = seen.plots.tolist(), seen.time.tolist()
        sigmas = [None] * len(times) if seen.sigma is None else map(tuple, seen.sigma.tolist())
        cells = [None] * len(times) if seen.time_cells is None else seen.time_cells
        parts = zip(times, plots, sigmas, cells, seen.rows.tolist(), answers, strict=True)
        names = seen.ids.names
        for code, (time, plot, sigma, cell, line, answer) in zip(
            seen.ids.codes.tolist(), parts, strict=True
        ):
            id = names[code]
            recent = self.recent.get(id)
            if recent is None:
                recent = self.recent[id] = RecentRows()
            row = Row(time, tuple(plot), sigma, cell, line, answer, 0, before.pop(id, None))
            recent.add(row)
            if row.before is not None:
                recent.prune(time - self.lateness)

    def _place(self, rows: Piece, parts: list[AnswerPart]) -> list[int]:
        """Put late rows in their place, at most one of each track, and run the tracks again.

        Gives the places of rows with which a track begins anew.
        """
        again, begins = {}, []
        newest = self._cleaner.numbers(_ids(rows), self._axes)[:, [TIME, BEFORE]].tolist()
        for k, (last, before) in enumerate(newest):
            id, time = rows.ids[k], float(rows.time[k])
            recent = self.recent.get(id, RecentRows())
            # Older rows may still be there, but must not decide: it depends on how rows come.
            in_reach = bool(self.lateness) and time >= last - self.lateness
            same = recent.at(time) if in_reach else None
            if same is not None and _equal(same.plot, rows.plots[k].tolist()):
                self.counts["copies"] += 1
            elif same is not None or time == last:
                self._fault(
                    "repeated", rows, k, "its track has a plot at this time already; not used"
                )
            elif in_reach:
                self.too_late.pop(id, None)
                again[id] = recent.insert(row_of(rows, k))
            elif before < self.too_late.get(id, math.inf) < time < last - self.lateness - FAR_AHEAD:
                begins.append(k)
            else:
                self.too_late[id] = time
                self._fault(
                    "too_late", rows, k, f"{last - time:.6g} s older than its track; not used"
                )
        if again:
            self.counts["late"] += len(again)
            parts.append(self._again(again))
        for k in begins:
            self._begin_anew(rows, k)
        return begins

    def _begin_anew(self, rows: Piece, k: int) -> None:
        """Forget what is known of the track of a row, and go on with its next segment."""
        id = rows.ids[k]
        newest, segment = self._cleaner.numbers([id], self._axes)[0, [TIME, SEGMENT]].tolist()
        ahead = f"{newest - float(rows.time[k]):.6g} s"
        self._fault("ahead", rows, k, f"its track begins anew; the newest plot was {ahead} ahead")
        self._drop([id])
        fresh = self._cleaner.numbers([id], self._axes)
        fresh[:, SEGMENT] = segment + 1
        self._cleaner.put([id], fresh)

    def _again(self, again: dict[str, tuple[int, int]]) -> AnswerPart:
        """Run tracks again from a row on, for a late one; answers to that, and those changed."""
        ids = list(again)
        befores = [self.recent[id].rows[first].before or b"" for id, (first, _) in again.items()]
        self.put(ids, np.frombuffer(b"".join(befores)).reshape(len(ids), -1), turned=True)
        rows = [self.recent[id].rows[first:] for id, (first, _) in again.items()]
        flat = [row for some in rows for row in some]
        counts = [len(some) for some in rows]
        piece = piece_of_rows(ids, counts, flat, self.prepared.files.names[0])
        columns = self._tracked(self._cleaner.replay(piece).cleaned)
        answers = digests(columns, self.names)
        chosen, lines, order = [], [], []
        start = 0
        for (first, place), count in zip(again.values(), counts, strict=True):
            late = start + place - first
            for k in range(late, start + count):
                row = flat[k]
                if row.answer != answers[k]:
                    row.revision += bool(row.answer)
                    row.answer = answers[k]
                    chosen.append(k)
                    lines.append(flat[late].line)
                    order.append(k - late)
            start += count
        self.counts["revisions"] += sum(flat[k].revision > 0 for k in chosen)
        places = np.array(chosen, dtype=np.intp)
        changed = {name: taken(columns[name], places) for name in self.names if name != REVISION}
        changed[REVISION] = np.array([flat[k].revision for k in chosen], dtype=np.int64)
        return AnswerPart(changed, np.array(lines, dtype=np.int64), np.array(order, dtype=np.int64))

    def _fault(self, kind: str, rows: Piece, k: int, what: str) -> None:
        id, cells = rows.ids[k], rows.time_cells
        time = rows.time[k] if cells is None else cells[k]
        whose = f" (id {id!r})" if id else ""
        self.faults.add(kind, f"line {rows.rows[k]}: time {time}{whose}: {what}")

    # ---------------------------------------------------------------- tracks as numbers

    @property
    def ids(self) -> tuple[str, ...]:
        """Identities of the tracks that are known."""
        return self._cleaner.ids

    def common(self) -> dict[str, NDArray[Any]]:
        """What is known beside the tracks, as arrays."""
        return {
            "clock": np.array(self._cleaner.clock),
            "past": self._cleaner.past.copy(),
            "gone": np.array([*self._gone, self._swept]),
            "last": np.array(self._last),
            "too_late": np.array([self.too_late.get(id, math.nan) for id in self.ids]),
        }

    def set_common(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Set back what `common` gave."""
        period, now, fills = arrays["clock"].tolist()
        self._cleaner.clock = period, now, int(fills)
        self._cleaner.past[:] = arrays["past"]
        *self._gone[:], self._swept = arrays["gone"].tolist()
        self._last = [(int(line), time) for line, time in arrays["last"].tolist()]
        late = zip(self.ids, arrays["too_late"].tolist(), strict=True)
        self.too_late = {id: time for id, time in late if not math.isnan(time)}

    def numbers(self, ids: Sequence[str]) -> Array:
        """All that is known of tracks, shape (n_tracks, n_numbers); unknown ones are begun."""
        cleaning = self._cleaner.numbers(ids, self._axes)
        names = [_name(*each) for each in zip(ids, cleaning[:, SEGMENT].tolist(), strict=True)]
        judged = [self._restarts.of(ids), [self._rejected[id] for id in ids]]
        return np.column_stack(
            [
                cleaning,
                np.transpose(judged),
                self._rows.last.numbers(ids),
                self._tracks.numbers(names, self._axes),
            ]
        )

    def put(self, ids: Sequence[str], numbers: Array, *, turned: bool = False) -> None:
        """Set tracks back to what `numbers` gave of them.

        Parameters
        ----------
        ids : sequence of str
        numbers : ndarray, shape (n_tracks, n_numbers)
        turned : bool
            Whether to leave alone how often the clock of each has started again.
        """
        width = self._cleaner.width(self._axes)
        ends = np.cumsum([width, 1, 1, KNOWN])
        cleaning, restarts, rejected, last, track = np.split(numbers, ends, axis=1)
        now = self._cleaner.numbers(ids, self._axes)[:, SEGMENT].tolist()
        self._tracks.end([_name(*each) for each in zip(ids, now, strict=True)])
        names = [_name(*each) for each in zip(ids, cleaning[:, SEGMENT].tolist(), strict=True)]
        self._cleaner.put(ids, cleaning, turned=turned)
        self._tracks.put(names, track, self._axes)
        self._restarts.put(ids, restarts[:, 0].astype(np.int64).tolist())
        self._rows.last.put(ids, last)
        for id, count in zip(ids, rejected[:, 0].astype(np.int64).tolist(), strict=True):
            if count:
                self._rejected[id] = count
            else:
                self._rejected.pop(id, None)

    def _sweep(self, silent: float) -> None:
        """Forget tracks that were silent for so long (s)."""
        # Of two lines one has no wrong time, so not all tracks seem to be silent.
        ids, now = self._cleaner.ids, min(time for _, time in self._last)
        if not ids:
            return
        known = self._cleaner.numbers(ids, self._axes)
        old = known[:, TIME] < now - silent
        gone = [id for id, is_old in zip(ids, old.tolist(), strict=True) if is_old]
        self._drop(gone)
        self.counts["forgotten"] += len(gone)

    def _drop(self, gone: list[str]) -> None:
        """Keep nothing of tracks."""
        segments = self._cleaner.numbers(gone, self._axes)[:, SEGMENT].tolist()
        self._tracks.end([_name(*each) for each in zip(gone, segments, strict=True)])
        self._cleaner.forget(gone)
        self._gone += [sum(self._rejected.pop(id, 0) for id in gone), sum(self._restarts.of(gone))]
        self._restarts.put(gone, [0] * len(gone))
        self._rows.last.forget(gone)
        for id in gone:
            self.recent.pop(id, None)
            self.too_late.pop(id, None)


def check_rules(rules: Cleaning, lateness: float, forget: float | None) -> None:
    """Raise ValueError for numbers out of range, and for rules that need rows to come."""
    if not 0 <= lateness < math.inf:
        raise ValueError(f"lateness: must be a finite number of seconds >= 0, got {lateness:g}")
    if forget is not None and not lateness < forget < math.inf:
        raise ValueError(
            f"forget: must be a finite number of seconds above that of `lateness`, got {forget:g}"
        )
    if rules.duplicates != "error":
        raise ValueError(
            f"duplicates: {rules.duplicates} needs the rows to come; of a live feed the first plot "
            "of equal times stands, and the others are counted"
        )
    if lateness and rules.max_coast is not None:
        raise ValueError(
            "max_coast: a late plot may change which rows are left out, and an answer cannot be "
            "called back; leave it out, or `lateness`"
        )


def _name(id: str, segment: float) -> str:
    """Name of a track as `Piece.tracks` has it."""
    return f"{id}\0{int(segment)}" if segment else id


def _ids(piece: Piece) -> list[str]:
    names = piece.ids.names
    return [names[code] for code in piece.ids.codes.tolist()]


def _equal(one: Iterable[float], other: Iterable[float]) -> bool:
    """Whether positions are equal, with NaN in the same axes."""
    return all(a == b or (a != a and b != b) for a, b in zip(one, other, strict=True))
