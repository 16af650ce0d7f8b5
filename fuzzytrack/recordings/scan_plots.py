"""Recordings of plots without identities, read as the scans of a radar."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fuzzytrack.errors import DataError
from fuzzytrack.io.column_names import plain_name
from fuzzytrack.io.columns import known
from fuzzytrack.io.decoder import PlotDecoder, is_latitude
from fuzzytrack.io.files import PathLike
from fuzzytrack.io.plot_files import ROWS, PlotFiles, opened
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.table import no_rows
from fuzzytrack.numerals import is_number
from fuzzytrack.recordings.antenna_turn import antenna_of
from fuzzytrack.recordings.preparation import inputs_of
from fuzzytrack.recordings.radar_place import RadarPlace
from fuzzytrack.recordings.scan_cut import ScanCut
from fuzzytrack.recordings.scan_findings import ScanFindings
from fuzzytrack.recordings.scan_gathering import GatheringRules, ScanGathering
from fuzzytrack.recordings.scan_list import ScanList, own_columns
from fuzzytrack.recordings.scan_options import (
    check_plots,
    check_sectors,
    checked,
    without_identities,
)
from fuzzytrack.recordings.scan_order import CountedOn, RowOrder
from fuzzytrack.recordings.scan_rhythm import period_doubt, recognize_scans
from fuzzytrack.recordings.scan_rows import RowColumns, ScanRows, read_rows
from fuzzytrack.reprs import summary
from fuzzytrack.scan.scan import UNKNOWN_PLACE, Scan
from fuzzytrack.tasks import Progress

__all__ = ["ScanPlots", "scans_of"]

# Names of columns that say which scan a plot belongs to.
_SCANS = ("scan", "scan_number", "scan_no", "scan_id", "sweep", "sweep_number", "frame")
# Rows that show how the radar makes its scans.
_FIRST = 5_000


@dataclass(frozen=True)
class ScanPlots:
    """Plots of a recording, and how they are divided into scans.

    Attributes
    ----------
    files : PlotFiles
        Where they are from.
    columns : RowColumns
        Columns of scan, group and position of the radar.
    cut : ScanCut
        Where scans begin.
    said : str
        How scans are found, in a sentence.
    list : ScanList or None
        All scans with their times, those without a plot included.
    lateness : float or None
        How late a plot may come (s); None if none may.
    sectors : int or None
        Sectors of a turn, if plots are tracked sector by sector behind the beam.
    radar : tuple of float
        Position of the radar where no column has it (m).
    findings : ScanFindings
        Counts and notes; it grows while scans are read.
    """

    files: PlotFiles
    columns: RowColumns
    cut: ScanCut
    said: str = ""
    list: ScanList | None = None
    lateness: float | None = None
    sectors: int | None = None
    radar: tuple[float, float] = UNKNOWN_PLACE
    findings: ScanFindings = field(default_factory=ScanFindings, compare=False)

    def __repr__(self) -> str:
        return summary(self, "cut", files=len(self.files.inputs))

    @classmethod
    def of(
        cls,
        plots: Any,
        reading: Reading | None = None,
        *,
        scan: str | None = None,
        period: float | None = None,
        group: str | None = None,
        own: tuple[str, ...] | None = None,
        scans: PathLike | None = None,
        lateness: float | None = None,
        sectors: int | None = None,
    ) -> ScanPlots:
        """Find out what a recording holds, and how its plots are divided into scans.

        Parameters
        ----------
        plots : path, data frame, mapping or tuple
            As for `fuzzytrack.track`.
        reading : Reading, optional
            How it is read, without those of `scan_options.OF_TRACKS`. Identities are not used.
        scan : str, optional
            Column in which plots of one scan have the same word or number.
        period : float, optional
            Time of a turn of the antenna (s). Without both, scans are recognized: by a column with
            a usual name, equal times, bearings that follow an antenna, or times between plots.
        group : str, optional
            Column that says which of several recordings a row belongs to; the rows of each follow
            each other.
        own : (str, str), optional
            Columns of the position of a moving radar, in the frame of the plots; in the list of
            scans if it has them, otherwise in the recording; or two numbers, the position of a
            radar that does not move (m). Plots that are relative to the radar have the option
            `own_ship` of the reading instead. Without it, the noise of plots given by x and y is
            taken to be the same everywhere.
        scans : str or path, optional
            Table of all scans, see `ScanList.read`; needs a column of scans.
        lateness : float, optional
            Plots that come up to so many seconds late are put in order, later ones left out.
        sectors : int, optional
            The antenna turns, and plots are tracked sector by sector behind it, so many a turn: at
            least 4. A column or a list of scans is not used then.

        Raises
        ------
        DataError
            If a column is missing, the scans cannot be recognized, or there are no plots.
        ValueError
            If options do not fit together, or a value is wrong; names it.
        OSError
            If a file cannot be read.
        """
        reading = checked(reading or Reading(), period, lateness, scan)
        check_sectors(sectors, scan, scans)
        # An open source is one of a live feed.
        inputs = (plots,) if hasattr(plots, "tables") else inputs_of(plots)
        files = PlotFiles.of(inputs, without_identities(inputs[0], reading), identified=False)
        check_plots(files.decoder, files.names[0])
        radar = _radar(files, own, sectors)
        still = _is_place(own)
        own = None if still else own
        columns = _columns(
            files, scan, group, own, searched=(period or sectors) is None, listed=scans
        )
        if still:
            columns = replace(columns, own=(), radar=radar)
        listed = None
        if scans is not None:
            if not columns.scan:
                raise ValueError("scans: needs the column of the scans; name it with `scan`")
            listed = ScanList.read(scans, files.decoder, columns, own)
            columns = replace(columns, own=() if listed.has_own else columns.own)
            if still and listed.has_own:
                raise ValueError(f"own: {listed.file} has the positions of the radar; remove it")
        made = cls(files, columns, ScanCut(), "", listed, lateness, sectors, radar)
        _check_own(made, own)
        cut, said = made._cut(period)
        made.findings.note([*filter(None, [made.findings.doubt]), *_notes(made)])
        return replace(made, cut=cut, said=said)

    # ---------------------------------------------------------------- reading

    def scans(
        self, progress: Progress | None = None, *, rows: int | None = ROWS
    ) -> Iterator[tuple[str, Scan]]:
        """Read the scans, one after the other.

        Parameters
        ----------
        progress : callable, optional
            Called with the share of the recording that has been read.
        rows : int or None
            Rows that are held at a time; with the option `sort` of the reading all are.

        Yields
        ------
        group : str
            Which recording it is of; empty if there is one only.
        scan : Scan

        Raises
        ------
        DataError
            If a cell does not hold what it must, times fall, or a scan comes twice; names row,
            column and value.
        OSError
            If a file cannot be read.
        """
        gathering: ScanGathering | None = None
        group = ""
        for word, part in self.rows(progress, rows=rows):
            if gathering is None or word != group:
                if gathering is not None:
                    yield from ((group, each) for each in gathering.finish())
                group, gathering = word, self.gathering(word)
            yield from ((group, each) for each in gathering.advance(part))
        assert gathering is not None
        yield from ((group, each) for each in gathering.finish())

    def rows(
        self, progress: Progress | None = None, *, rows: int | None = ROWS
    ) -> Iterator[tuple[str, ScanRows]]:
        """Read the plots in order of time, group by group, before they are divided into scans.

        Parameters
        ----------
        progress, rows
            As for `scans`.

        Yields
        ------
        group : str
        part : ScanRows

        Raises
        ------
        DataError, OSError
            As `scans`.
        """
        # Plots of one scan need not be in order where a column says which they are.
        order = None
        if self.cut.rule != "column" or self.lateness is not None:
            order = RowOrder(self.lateness, self.files.decoder, self.findings)
        group: str | None = None
        done: set[str] = set()
        for part in self._parts(rows, progress):
            word = str(part.groups[0])
            if group is not None and word != group:
                yield from _held(group, order)
                done.add(group)
            if word in done:
                raise DataError(
                    f"{part.file}: row {part.rows[0]}, column {self.columns.group}: {word!r} "
                    f"comes again after {group!r}; expected the rows of a group one after the "
                    "other"
                )
            group = word
            yield group, part if order is None else order.advance(part)
        if group is None:
            raise no_rows(self.files.names[0])
        yield from _held(group, order)

    def live(self) -> ScanPlots:
        """The same for a feed, whose late plots are counted rather than an error."""
        late = 0.0 if self.lateness is None and self.cut.rule != "column" else self.lateness
        return replace(self, lateness=late)

    def clock(self) -> CountedOn:
        """What counts times on where their clock starts again."""
        decoder = self.files.decoder
        wrap = decoder.description.wrap
        period = decoder.clock.period if wrap == "auto" else wrap
        return CountedOn(period, wrap == "auto", self.findings)

    def radar_place(self) -> RadarPlace:
        """What follows the position of the radar in the rows of a group."""
        return RadarPlace(self.findings, self.radar, told=bool(self.columns.own))

    def gathering(self, group: str = "", *, drop_late: bool = False) -> ScanGathering:
        """What puts the rows of a group together as scans."""
        moved = self.list is not None and self.list.has_own and _is_relative(self.files.decoder)
        rules = GatheringRules(
            self.cut,
            self.files.decoder,
            self.columns.scan,
            moved,
            drop_late or self.lateness is not None,
            self.radar,
            bool(self.columns.own),
        )
        return ScanGathering(rules, self.findings, self.list, group)

    def _parts(self, rows: int | None, progress: Progress | None) -> Iterator[ScanRows]:
        """Rows of one group each, their times counted on where the clock starts again."""
        sort, clock = self.files.reading.sort, self.clock()
        pieces = read_rows(
            self.files, self.columns, self.findings, rows=None if sort else rows, progress=progress
        )
        group: str | None = None
        for piece in _one(pieces) if sort else pieces:
            for part in _by_group(piece, sort):
                if group is not None and str(part.groups[0]) != group:
                    clock.begin()
                group = str(part.groups[0])
                part = replace(part, time=clock.advance(part.time))
                yield part.take(np.argsort(part.time, kind="stable")) if sort else part

    # ---------------------------------------------------------------- recognition

    def _head(self) -> ScanRows:
        """First rows, in order of time."""
        first = replace(self, findings=ScanFindings())
        rows = next(first._parts(_FIRST, None), None)
        if rows is None:
            raise no_rows(self.files.names[0])
        head = rows.take(slice(0, _FIRST))
        return head.take(np.argsort(head.time, kind="stable"))

    def _cut(self, period: float | None) -> tuple[ScanCut, str]:
        if self.columns.scan:
            return ScanCut("column"), f"by column {self.columns.scan}"
        head = self._head()
        if period is not None and self.sectors is None:
            self.findings.doubt = period_doubt(head, period)
            return ScanCut("period", float(period)), f"one every {period:.4g} s"
        if self.sectors is not None:
            antenna = antenna_of(head, period, self.files.names[0])
            latency = 2 * antenna.period / self.sectors
            return ScanCut("period", antenna.period), (
                f"{antenna.said}; {self.sectors} sectors a turn, reports up to {latency:.3g} s "
                "behind the beam"
            )
        found, said = recognize_scans(head)
        if found is None:
            raise DataError(
                f"{self.files.names[0]}: cannot tell which plots are of one scan: {said}; name the "
                "column of the scans with `scan`, or give the time of a turn with `period`"
            )
        return found, said


def scans_of(plots: Any, reading: Reading | None = None, **options: Any) -> Iterator[Scan]:
    """Scans of a recording, one after the other; see `ScanPlots.of`.

    Parameters
    ----------
    plots, reading
        As for `ScanPlots.of`.
    **options
        The others of `ScanPlots.of`.

    Yields
    ------
    Scan

    Raises
    ------
    DataError, ValueError, OSError
        As `ScanPlots.of` and `ScanPlots.scans`.
    """
    for _, scan in ScanPlots.of(plots, reading, **options).scans():
        yield scan


# -------------------------------------------------------------------- what is asked for


def _columns(
    files: PlotFiles,
    scan: str | None,
    group: str | None,
    own: tuple[str, ...] | None,
    *,
    searched: bool,
    listed: PathLike | None,
) -> RowColumns:
    """Columns beside those of the plots; those that are named must be there."""
    with opened(files.inputs[0], files.reading) as source:
        names, file = tuple(source.types), source.file
    found = "" if scan is None else known(names, scan, "scan", file)
    if scan is None and searched:
        used = files.columns.kinds
        free = [name for name in names if plain_name(name)[0] in _SCANS and name not in used]
        found = free[0] if len(free) == 1 else ""
    place: tuple[str, ...] = ()
    if own is not None:
        if len(own) != 2:
            raise ValueError(f"own: {len(own)} given; expected two columns, or two numbers (m)")
        if listed is None or any(name in names for name in own):
            place = tuple(known(names, name, "own", file) for name in own)
    elif not files.columns.own_ship:
        place = own_columns(names, files.columns.axes)
    columns = RowColumns(found, "" if group is None else known(names, group, "group", file), place)
    for other in files.inputs[1:]:
        with opened(other, files.reading) as source:
            for name in columns.kinds:
                if name not in source.types:
                    raise DataError(f"{source.file}: no column {name!r}, which {file} has")
    return columns


def _is_place(own: tuple[str, ...] | None) -> bool:
    """Whether two numbers are given, not names of columns."""
    return own is not None and len(own) == 2 and all(is_number(each) for each in own)


def _radar(
    files: PlotFiles, own: tuple[str, ...] | None, sectors: int | None
) -> tuple[float, float]:
    """Position of the radar in the frame of the plots, as far as it is not in columns."""
    if own is not None and _is_place(own):
        if _is_relative(files.decoder):
            raise ValueError("own: plots in range and azimuth are relative to the radar; remove it")
        return float(own[0]), float(own[1])
    relative = files.decoder.columns.position == "polar"
    # The frame of places on earth is that of the site; a turning antenna needs an origin.
    at_origin = relative or files.reading.description.site is not None or sectors is not None
    return (0.0, 0.0) if at_origin else UNKNOWN_PLACE


def _check_own(plots: ScanPlots, said: tuple[str, ...] | None) -> None:
    """Check that the position of the radar can be used."""
    decoder, own, listed = plots.files.decoder, plots.columns.own, plots.list
    if said is not None and decoder.columns.own_ship:
        raise ValueError("own and own_ship: plots are in a fixed frame, or relative; give one")
    if said is not None and not own and (listed is None or not listed.has_own):
        raise DataError(f"{listed and listed.file}: `own`: no columns {', '.join(said)}")
    if not own:
        return
    if _is_relative(decoder):
        raise DataError(
            f"`own`: plots in range and azimuth are relative to the radar; `own_ship`="
            f"{','.join(own)} adds its position"
        )
    if is_latitude(own[0]) and decoder.frame is None:
        raise DataError(
            f"`own`: {own[0]!r} is a latitude by its name, but the plots have no place on earth"
        )


def _is_relative(decoder: PlotDecoder) -> bool:
    """Whether plots are relative to a radar whose position is not known to the decoder."""
    return decoder.columns.position == "polar" and not decoder.columns.own_ship


def _notes(plots: ScanPlots) -> Iterator[str]:
    columns = plots.files.columns
    if len(columns.axes) > 2:
        yield f"{columns.axes[2]}: tracks are in the plane of the other two coordinates"
    own = plots.columns.own or columns.own_ship
    if own:
        yield f"position of the radar from columns {', '.join(own)}"
    listed = plots.list is not None and plots.list.has_own
    if plots.list is not None and listed:
        yield f"position of the radar from {plots.list.file}"
    elif not own and math.isnan(plots.radar[0]):
        yield "position of the radar not known, so its bearing noise is not used; `own` gives it"


# -------------------------------------------------------------------- pieces


def _held(group: str, order: RowOrder | None) -> Iterator[tuple[str, ScanRows]]:
    """Rows of a group that are still waited for."""
    rest = None if order is None else order.finish()
    if rest is not None:
        yield group, rest


def _one(pieces: Iterator[ScanRows]) -> Iterator[ScanRows]:
    """All pieces as one, if there are any."""
    parts = list(pieces)
    if parts:
        yield ScanRows.joined(parts)


def _by_group(piece: ScanRows, sort: bool) -> Iterator[ScanRows]:
    """Rows of one group each; those of the whole recording if they are sorted."""
    if not len(piece):
        return
    if sort:
        _, first, codes = np.unique(piece.groups, return_index=True, return_inverse=True)
        for code in np.argsort(first).tolist():
            yield piece.take(np.flatnonzero(codes == code))
        return
    cuts = np.flatnonzero(piece.groups[1:] != piece.groups[:-1]) + 1
    for start, end in zip([0, *cuts.tolist()], [*cuts.tolist(), len(piece)], strict=True):
        yield piece.take(slice(start, end))
