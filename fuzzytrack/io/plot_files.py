"""Files of plots: what they hold is found out once, then they are read piece by piece."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from fuzzytrack.errors import DataError
from fuzzytrack.io.angles import unwrapped
from fuzzytrack.io.cleaning import Cleaner
from fuzzytrack.io.columns import Columns, choose_columns, looks_like_identity
from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.first_rows import decoder_of, notes_of
from fuzzytrack.io.formats import open_table
from fuzzytrack.io.noise_estimate import NoiseEstimate, estimate_noise
from fuzzytrack.io.piece import Piece, joined
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.source import Source
from fuzzytrack.io.table import Kind, Table, no_rows
from fuzzytrack.reprs import summary
from fuzzytrack.tasks import Progress

__all__ = ["ROWS", "Input", "PlotFiles", "Survey", "opened"]

#: Rows of a piece: many enough for compiled code, few enough to be small beside a process.
ROWS = 250_000

#: A file by its name, or columns that are in memory.
Input = str | Source


@dataclass(frozen=True, eq=False)
class Survey:
    """What the first rows of a recording show.

    Attributes
    ----------
    interval : float
        Usual time between plots of a track (s): three quarters are shorter. NaN if no track has two
        plots.
    noise : NoiseEstimate or None
        Standard deviations of what is measured: of range (m) and angles (deg) of polar plots; None
        if it was given, or cannot be estimated.
    missing : str
        Why there is no estimate, where one was wanted.
    """

    interval: float = math.nan
    noise: NoiseEstimate | None = None
    missing: str = ""

    def __repr__(self) -> str:
        return summary(self, "interval", "noise")


@dataclass(frozen=True)
class PlotFiles:
    """Files of plots that are read in one way.

    Attributes
    ----------
    inputs : tuple of str or Source
        Names of files, in the order in which they are read, or columns in memory.
    reading : Reading
        What a user says about them.
    decoder : PlotDecoder
        How rows become plots.
    notes : tuple of str
        What was guessed, and what a user might want to know, each in a sentence.
    """

    inputs: tuple[Input, ...]
    reading: Reading
    decoder: PlotDecoder
    notes: tuple[str, ...] = field(default=())
    # The first rows, until they have been surveyed.
    _first: Table | None = field(default=None, repr=False, compare=False)

    def __repr__(self) -> str:
        return summary(self, "columns", inputs=len(self.inputs))

    @classmethod
    def of(
        cls, inputs: Sequence[Input], reading: Reading | None = None, *, identified: bool = True
    ) -> PlotFiles:
        """Find out what files hold, from the names of their columns and from their first rows.

        Parameters
        ----------
        inputs : sequence of str or Source
            At least one, from `recording_files`.
        reading : Reading, optional
            How they are read.
        identified : bool
            Whether plots may have an identity; a column of it is ignored otherwise.

        Raises
        ------
        DataError
            If a column is missing or could be meant in two ways, its type differs between files, or
            there are no rows or no files.
        OSError
            If a file cannot be read.
        """
        reading = reading or Reading()
        if not inputs:
            raise DataError("plots: no file is given; expected at least one")
        with opened(inputs[0], reading) as source:
            description = reading.description.over(getattr(source, "description", None))
            names, types = tuple(source.types), dict(source.types)
            units, origin = getattr(source, "units", {}), getattr(source, "origin", "")
            columns = choose_columns(names, source.file, description, units)
        unused = looks_like_identity(names, columns) or ("" if identified else columns.id)
        if not identified:
            columns = replace(columns, id="")
        _check_alike(inputs, reading, {name: types[name] for name in columns.kinds}, origin)
        table = _first_table(inputs, reading, columns)
        decoder = decoder_of(columns, description, table, units)
        notes = notes_of(columns, decoder.clock, table, unused, identified=identified)
        return cls(tuple(inputs), reading, decoder, notes, table)

    @property
    def columns(self) -> Columns:
        """Columns of the files that are time, identity, position and noise."""
        return self.decoder.columns

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the files, for messages."""
        return tuple(map(_name, self.inputs))

    @property
    def paths(self) -> tuple[str, ...]:
        """Files on disk."""
        return tuple(each for each in self.inputs if isinstance(each, str) and each != "-")

    def only(self, number: int) -> PlotFiles:
        """One of the files by itself, read as it is among the others."""
        return replace(self, inputs=self.inputs[number : number + 1], _first=None)

    def absolute(self) -> PlotFiles:
        """The same files under names that other processes understand.

        Raises
        ------
        DataError
            If one is standard input or a pipe, which one process alone can read.
        """
        for each in self.inputs:
            if isinstance(each, str) and (each == "-" or Path(each).is_fifo()):
                raise DataError(
                    f"{'standard input' if each == '-' else each}: cannot be read by several "
                    "processes; save it to a file, or read it in one process"
                )
        inputs = (os.path.abspath(e) if isinstance(e, str) else e for e in self.inputs)
        return replace(self, inputs=tuple(inputs))

    def cleaner(self) -> Cleaner:
        """What takes the faults out of the pieces; it has a memory, so each run needs its own."""
        decoder = self.decoder
        rules = replace(self.reading.cleaning, wrap=decoder.description.wrap)
        clock, column = decoder.clock, self.columns.time
        return Cleaner(rules, clock.period, turn=decoder.period, column=column, show=clock.as_cell)

    def cleaned(self, pieces: Iterable[Piece], findings: Findings) -> Iterator[Piece]:
        """Take the faults out of the pieces of a run, and count them at the end.

        Parameters
        ----------
        pieces : iterable of Piece
            From `pieces`, or rows of it; one piece if the rows are to be sorted.
        findings : Findings
            Gets the counts.
        """
        cleaner = self.cleaner()
        for piece in pieces:
            yield cleaner.advance(cleaner.in_order(piece) if self.reading.sort else piece)
        rest = cleaner.finish()
        if rest is not None:
            yield rest
        findings.cleaning = findings.cleaning + cleaner.counts

    def pieces(
        self,
        *,
        rows: int | None = ROWS,
        findings: Findings | None = None,
        progress: Progress | None = None,
    ) -> Iterator[Piece]:
        """Read the files piece by piece, one after the other; faults are still in them.

        Parameters
        ----------
        rows : int or None
            Rows of a piece, at most; None makes each file one piece.
        findings : Findings, optional
            Gets what was left out, and the notes of the files.
        progress : callable, optional
            Called with the share that has been read.

        Yields
        ------
        Piece
            At least one row; no piece of a file without rows.

        Raises
        ------
        DataError
            If a file does not hold such tracks; names row, column and value.
        ValueError
            If `rows` is less than 1.
        OSError
            If a file cannot be read.

        Notes
        -----
        Holds one piece, and of a Parquet file about a megabyte a column, at a time, however large
        the row groups are.
        """
        found = Findings() if findings is None else findings
        farthest = 0.0
        for table in self.tables(rows=rows, findings=found, progress=progress):
            piece = self.piece_of(table, found)
            if len(piece):
                if self.columns.position == "geodetic":
                    farthest = max(farthest, _farthest(piece))
                yield piece
        if self.columns.position == "geodetic" and self.decoder.frame is not None:
            told = self.decoder.frame.remark(farthest, len(self.columns.axes))
            found.note([told] if told else [])

    def tables(
        self,
        more: Mapping[str, Kind] | None = None,
        *,
        rows: int | None = ROWS,
        findings: Findings | None = None,
        progress: Progress | None = None,
    ) -> Iterator[Table]:
        """Read the columns of the plots, and further ones, piece by piece.

        Parameters
        ----------
        more : mapping of str to Kind, optional
            Further columns, and what they must hold.
        rows, findings, progress
            As for `pieces`.

        Yields
        ------
        Table

        Raises
        ------
        DataError, ValueError, OSError
            As `pieces`.
        """
        if rows is not None and rows < 1:
            raise ValueError(f"rows must be at least 1, got {rows}")
        found = Findings() if findings is None else findings
        found.note(self.notes)
        sizes = [_size(each) for each in self.inputs]
        total, before = max(1, sum(sizes)), 0
        for each, size in zip(self.inputs, sizes, strict=True):

            def watch(share: float, before: int = before, size: int = size) -> None:
                if progress is not None:
                    progress((before + share * size) / total)

            with opened(each, self.reading) as source:
                yield from source.tables({**self.columns.kinds, **(more or {})}, rows, watch)
                found.note(getattr(source, "notes", ()))
            before += size

    def piece_of(self, table: Table, findings: Findings) -> Piece:
        """Plots of the rows of a table that have an identity.

        Parameters
        ----------
        table : Table
            The columns `Columns.kinds`.
        findings : Findings
            Gets the counts of rows without an identity and of positions that cannot be.

        Raises
        ------
        DataError
            If a time or a standard deviation is none; names row, column and value.
        """
        named = _named(table, self.columns)
        findings.unnamed += len(table.rows) - len(named.rows)
        return self.decoder.decode(named, findings.impossible)

    def surveyed(self) -> tuple[PlotFiles, Survey]:
        """Look at the first rows for what is not given: noise, and the usual time between plots.

        Returns
        -------
        PlotFiles
            The same files with what was found.
        Survey

        Raises
        ------
        DataError
            As `pieces`.
        """
        table = self._first or _first_table(self.inputs, self.reading, self.columns)
        found = self.survey(self.decoder.measured(table))
        return self.with_survey(found), found

    def survey(self, measured: Piece) -> Survey:
        """What rows show that were read by `PlotDecoder.measured`."""
        clean = joined(list(self.cleaned([measured], Findings())))
        codes = clean.ids.codes
        order = np.argsort(codes, kind="stable")
        steps = np.diff(clean.time[order])
        steps = steps[(np.diff(codes[order]) == 0) & (steps > 0)]
        # Not the median: of plots in near pairs that is the time within a pair.
        interval = float(np.quantile(steps, 0.75)) if len(steps) else math.nan
        if self.decoder.noise_is_known:
            return Survey(interval)
        try:
            return Survey(interval, self._noise(clean))
        except DataError as error:
            return Survey(interval, missing=str(error))

    def _noise(self, clean: Piece) -> NoiseEstimate:
        plots = clean.plots
        if self.columns.position == "angle":
            period = self.decoder.period or math.inf
            plots = unwrapped(plots[:, 0], clean.ids.codes, period)[:, None]
        elif self.columns.position == "polar":
            turn = 2 * math.pi / self.decoder.radians(1)
            angle = unwrapped(plots[:, 1], clean.ids.codes, turn)
            plots = np.column_stack([plots[:, :1], angle, plots[:, 2:]])
        names = self.columns.read if self.decoder.noise_is_polar else self.columns.axes
        return estimate_noise(clean.time, plots, clean.ids.codes, names=names)

    def with_survey(self, survey: Survey) -> PlotFiles:
        """Files with what a survey has found, as far as nothing else was said."""
        decoder, cleaning = self.decoder, self.reading.cleaning
        if survey.noise is not None and not decoder.noise_is_known:
            decoder = decoder.with_estimate(*_estimate(survey.noise, decoder))
        if cleaning.least_step is None and survey.interval > 0:
            cleaning = replace(cleaning, least_step=_LEAST_STEP * survey.interval)
        reading = replace(self.reading, cleaning=cleaning)
        return replace(self, decoder=decoder, reading=reading, _first=None)


# Noise of an axis, in parts of that of the axis with the largest.
_LEAST_NOISE = 1e-3
# A start waits until this part of the usual time between plots has passed.
_LEAST_STEP = 0.1


def _estimate(
    found: NoiseEstimate, decoder: PlotDecoder
) -> tuple[Sequence[float], Sequence[float]]:
    """Standard deviations and their errors, angles of polar plots in degrees."""
    count = len(found.sigma)
    if decoder.noise_is_polar:
        units = [1.0, *(math.degrees(decoder.radians(k)) for k in range(1, count))]
        return (found.sigma * units).tolist(), (found.standard_error * units).tolist()
    if found.axes_differ:
        # An axis on which nothing moves has the noise of its last digits, which no gate may take.
        least = _LEAST_NOISE * found.sigma.max()
        return np.maximum(found.sigma, least).tolist(), found.standard_error.tolist()
    return (found.pooled,) * count, (found.pooled_error,) * count


def _check_alike(
    inputs: Sequence[Input], reading: Reading, types: dict[str, str], origin: str
) -> None:
    """Check that all files have the columns of the first one, of the same types and origin."""
    first = _name(inputs[0])
    for each in inputs[1:]:
        with opened(each, reading) as source:
            others, whence = source.types, getattr(source, "origin", "")
        file = _name(each)
        if whence != origin:
            raise DataError(
                f"{file}: holds plots {whence or 'of no known origin'}; expected plots "
                f"{origin or 'of no known origin'}, as in {first}; read the files one by one"
            )
        for name, kind in types.items():
            if name not in others:
                raise DataError(f"{file}: no column {name!r}, which {first} has")
            if others[name] != kind:
                raise DataError(
                    f"{file}: column {name}: is {others[name]}; expected {kind}, as in {first}"
                )


def _first_table(inputs: Sequence[Input], reading: Reading, columns: Columns) -> Table:
    """First rows of the first file that has any."""
    seen = False
    for each in inputs:
        with opened(each, reading) as source:
            for table in source.tables(columns.kinds, ROWS):
                seen = True
                named = _named(table, columns)
                if len(named.rows):
                    return named
    if seen:
        raise DataError(f"{_name(inputs[0])}: column {columns.id}: no row has an identity")
    raise no_rows(_name(inputs[0]))


def _farthest(piece: Piece) -> float:
    """Distance in the plane of the plot that is farthest from the origin."""
    distance = np.hypot.reduce(piece.plots[:, :2], axis=1)
    return float(np.max(distance, initial=0.0, where=np.isfinite(distance)))


def _named(table: Table, columns: Columns) -> Table:
    """Rows that belong to a track: those with an identity, if there is a column of it."""
    return table.with_words(columns.id) if columns.id else table


def opened(each: Input, reading: Reading) -> AbstractContextManager[Source]:
    """Open a file, or columns in memory, as a reading says."""
    if isinstance(each, str):
        return open_table(each, reading.form, format=reading.format)
    return nullcontext(each)


def _name(each: Input) -> str:
    return each if isinstance(each, str) else each.file


def _size(each: Input) -> int:
    return os.path.getsize(each) if isinstance(each, str) and os.path.isfile(each) else 0
