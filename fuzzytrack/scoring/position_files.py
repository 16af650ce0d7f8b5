"""Tables of tracks and of true positions, read from files that `fuzzytrack.io` can read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.column_names import plain_name
from fuzzytrack.io.columns import Columns, choose_columns, known, looks_like_identity, time_columns
from fuzzytrack.io.description import PlotDescription
from fuzzytrack.io.files import PathLike
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.formats import read_table
from fuzzytrack.io.piece import joined
from fuzzytrack.io.plot_files import PlotFiles, opened
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import recording_files
from fuzzytrack.io.table import Kind, Table
from fuzzytrack.plurals import counted
from fuzzytrack.scoring.positions import KINDS, Positions

__all__ = ["TableOptions", "read_positions", "read_times", "read_truth"]

# Columns of position that are taken where there are no x and y.
_COMPASS = ("north", "east")
# Column of the number of a scan, in a table of scans or of plots.
_SCAN = "scan"
_TENTATIVE, _COASTING = "tentative", "coasting"
# The row of its plot, where a track has none.
_NO_PLOT = "-1"


@dataclass(frozen=True, kw_only=True)
class TableOptions:
    """What a table of positions means, as far as a user says so.

    Attributes
    ----------
    reading : Reading
        Columns of time, identity and position, and the form of the file. The identity is found by
        its usual names unless given, and so are x and y, or north and east.
    group : str, optional
        Column of the recording that a row belongs to.
    kind, status : str, optional
        Columns of the kind of a track, and of whether it is tentative; ``kind`` and ``status``
        unless given, if there are such columns.
    velocity : tuple of str, optional
        Columns of velocity (m/s); v before the names of position unless given, if there are.
    tentative : bool
        Whether tentative tracks count.
    """

    reading: Reading = field(default_factory=Reading)
    group: str | None = None
    kind: str | None = None
    status: str | None = None
    velocity: tuple[str, ...] | None = None
    tentative: bool = False


@dataclass(frozen=True, eq=False)
class _Header:
    """The columns of a table: of the plots, and others by use; the reading that names them."""

    inputs: tuple[str, ...]
    reading: Reading
    columns: Columns
    others: dict[str, tuple[str, ...]]


@dataclass(frozen=True, eq=False)
class _Opened:
    """A table whose columns are known: how its plots are read, and its other columns by use."""

    files: PlotFiles
    others: dict[str, tuple[str, ...]]


def read_positions(
    tracks: PathLike,
    truth: PathLike,
    of_tracks: TableOptions | None = None,
    of_truth: TableOptions | None = None,
) -> tuple[tuple[Positions, Positions], tuple[str, ...]]:
    """Read tracks and true positions, in the same frame and from the same beginning of time.

    Parameters
    ----------
    tracks, truth : str or path
        The files.
    of_tracks, of_truth : TableOptions, optional
        What their columns are. Columns of position and of the group are the same in the truth, if
        it has them and nothing else is said.

    Returns
    -------
    (tracks, truth) : tuple of Positions
    notes : tuple of str
        Which columns were used, and what was left out.

    Raises
    ------
    DataError
        If a column is missing or could be meant in two ways, or a cell does not hold what it must.
    OSError
        If a file cannot be read.
    """
    header = _header(tracks, "tracks", of_tracks or TableOptions())
    options = _like(of_truth or TableOptions(), of_tracks or TableOptions(), header.columns, truth)
    second = _opened(truth, "truth", options)
    if not _has_rows(header):
        there, _ = _read(second, "truth", tentative=True)
        notes = ["tracks: no rows, so there is no track", f"truth: {_sentence(second)}"]
        return (_none_like(there), there), tuple(notes)
    first = _with_files(header)
    second = replace(second, files=_in_frame(second.files, first.files))
    given, left_out = _read(first, "tracks", tentative=(of_tracks or TableOptions()).tentative)
    there, _ = _read(second, "truth", tentative=True)
    notes = [f"{name}: {_sentence(each)}" for name, each in (("tracks", first), ("truth", second))]
    if "status" in second.others and "status" not in first.others:
        notes.append("the truth has a column status, as tracks have; are the two files swapped?")
    if left_out:
        notes.append(f"tracks: {counted(left_out, 'row')} of tentative tracks left out")
    return (given, there), tuple(notes)


def read_truth(truth: PathLike, plots: PlotFiles, options: TableOptions | None = None) -> Positions:
    """Read true positions in the frame and the time of a recording of plots.

    Parameters
    ----------
    truth : str or path
        The file.
    plots : PlotFiles
        The recording.
    options : TableOptions, optional
        What the columns of the truth are; those of position and time are the same as of the plots,
        if it has them and nothing else is said.

    Raises
    ------
    DataError
        As for `read_positions`, or if the clocks are of different kinds.
    OSError
        If the file cannot be read.
    """
    options = options or TableOptions()
    found = _opened(truth, "truth", _like(options, options, plots.columns, truth))
    found = replace(found, files=_in_frame(found.files, plots))
    return _read(found, "truth", tentative=True)[0]


def _sentence(table: _Opened) -> str:
    more = [f"{use} {', '.join(names)}" for use, names in table.others.items() if names]
    return "; ".join([table.files.columns.sentence, *more])


def _like(
    options: TableOptions, model: TableOptions, columns: Columns, file: PathLike
) -> TableOptions:
    """Options of the truth, with the columns of the tracks where it has the same ones."""
    said = options.reading.description
    with opened(recording_files(file)[0], options.reading) as source:
        there = {name.lower() for name in source.types}
    if all(getattr(said, name) is None for name in ("axes", "polar", "geodetic", "angle")):
        same = all(name.lower() in there for name in columns.read)
        if same:
            use = "axes" if columns.position == "cartesian" else columns.position
            found: dict[str, Any] = {use: columns.read}
            said = replace(said, **found)
    if said.time is None and not columns.date and columns.time.lower() in there:
        said = replace(said, time=columns.time)
    group = options.group
    if group is None and model.group is not None and model.group.lower() in there:
        group = model.group
    return replace(options, reading=replace(options.reading, description=said), group=group)


def _has_rows(header: _Header) -> bool:
    """Whether a table has rows, or only names of columns, as of a tracker that found nothing."""
    for each in header.inputs:
        with opened(each, header.reading) as source:
            if any(len(table.rows) for table in source.tables({header.columns.time: "word"}, 1)):
                return True
    return False


def _none_like(truth: Positions) -> Positions:
    """No track, in the recordings of the truth."""
    group = None if truth.group is None else truth.group[:0]
    none = np.empty(0)
    return Positions.make("tracks", none, none, truth.position[:0], group=group)


def _opened(file: PathLike, name: str, options: TableOptions) -> _Opened:
    """Find the columns of a table, and what its first rows show."""
    return _with_files(_header(file, name, options))


def _with_files(header: _Header) -> _Opened:
    return _Opened(PlotFiles.of(header.inputs, header.reading), header.others)


def _header(file: PathLike, name: str, options: TableOptions) -> _Header:
    """Find the columns of a table by its header."""
    inputs = recording_files(file)
    with opened(inputs[0], options.reading) as source:
        names = tuple(source.types)
        said = options.reading.description.over(getattr(source, "description", None))
        said = _with_position(said, names)
        columns = choose_columns(names, source.file, said, getattr(source, "units", {}))
        if columns.position == "angle":
            raise DataError(
                f"{source.file}: holds angles; expected x and y, range and azimuth, or latitude "
                "and longitude"
            )
        id = columns.id or looks_like_identity(names, columns)
        if not id:
            raise DataError(
                f"{source.file}: no column of the identity of {name}; there are {', '.join(names)}"
            )
        # Polar positions become x and y about the radar, so velocities are along these.
        axes = columns.axes if columns.position == "polar" else columns.read
        others = _others(names, source.file, options, axes)
    said = replace(said, id=id, axes=columns.read if columns.position == "cartesian" else None)
    return _Header(inputs, replace(options.reading, description=said), columns, others)


def _with_position(said: PlotDescription, names: tuple[str, ...]) -> PlotDescription:
    """Take north and east as the position where nothing is said and there are no x and y."""
    given = (said.axes, said.polar, said.geodetic, said.angle)
    plain = {plain_name(name)[0]: name for name in reversed(names)}
    if any(each is not None for each in given) or "x" in plain:
        return said
    if all(word in plain for word in _COMPASS):
        return replace(said, axes=tuple(plain[word] for word in _COMPASS))
    return said


def _others(
    names: tuple[str, ...], file: str, options: TableOptions, axes: tuple[str, ...]
) -> dict[str, tuple[str, ...]]:
    """Columns of group, kind, status, plot and velocity."""
    found: dict[str, tuple[str, ...]] = {}
    for use in ("group", "kind", "status"):
        said = getattr(options, use)
        if said is not None:
            found[use] = (known(names, said, use, file),)
        elif use != "group" and use in names:
            found[use] = (use,)
    if options.tentative and "plot" in names:
        # Of tentative tracks the status does not say whether they coast.
        found["plot"] = ("plot",)
    if options.velocity is not None:
        if len(options.velocity) != len(axes):
            raise DataError(
                f"velocity: {len(options.velocity)} given; expected {len(axes)}, one for each axis"
            )
        found["velocity"] = tuple(known(names, each, "velocity", file) for each in options.velocity)
    else:
        usual = [_velocity_of(axis, names) for axis in axes]
        if all(usual):
            found["velocity"] = tuple(usual)
    return found


def _velocity_of(axis: str, names: tuple[str, ...]) -> str:
    """Column of the velocity along an axis, by its usual names; empty if there is none."""
    plain = plain_name(axis)[0]
    wanted = (f"{axis}_velocity", f"v{axis}", f"v{plain}", f"v_{plain}", f"{plain}_velocity")
    for word in wanted:
        for name in names:
            if word.lower() in (name.lower(), plain_name(name)[0]):
                return name
    return ""


def _in_frame(truth: PlotFiles, tracks: PlotFiles) -> PlotFiles:
    """True positions in the frame of the tracks, and their times from the same beginning."""
    clock, first = truth.decoder.clock, tracks.decoder.clock
    if clock.form != first.form or (clock.dated != first.dated and clock.counted and first.counted):
        raise DataError(
            f"truth: times of {truth.names[0]} and of {tracks.names[0]} are of different kinds "
            f"({clock.form} and {first.form}); expected the same clock"
        )
    clock = replace(clock, origin=first.origin, counted=first.counted)
    return replace(truth, decoder=replace(truth.decoder, clock=clock, frame=tracks.decoder.frame))


def _read(table: _Opened, name: str, *, tentative: bool) -> tuple[Positions, int]:
    """Positions of a table, and how many tentative rows were left out."""
    files = table.files
    piece = joined(list(files.pieces(rows=None, findings=Findings())))
    id = np.array(piece.ids.names, dtype=object)[piece.ids.codes].astype(str)
    columns: dict[str, Any] = {"time": piece.time, "id": id, "position": piece.plots}
    kept = np.ones(len(id), dtype=np.bool_)
    if table.others:
        more = _other_columns(files, table.others)
        if "velocity" in more:
            columns["velocity"] = more["velocity"]
        if "group" in more:
            columns["group"] = more["group"]
        if "kind" in more:
            columns["kind"] = _kinds(files.names[0], table.others["kind"][0], more["kind"])
        if "status" in more:
            columns["coasting"] = more["status"] == _COASTING
        if "plot" in more:
            columns["coasting"] = more["plot"] == _NO_PLOT
        if "status" in more and not tentative:
            kept = more["status"] != _TENTATIVE
    shown = {key: values[kept] for key, values in columns.items()}
    return Positions.make(name, **shown), int((~kept).sum())


def _other_columns(files: PlotFiles, others: Mapping[str, tuple[str, ...]]) -> dict[str, Any]:
    """Other columns of the rows that have an identity."""
    kinds: dict[str, Kind] = {files.columns.id: "word"}
    for use, names in others.items():
        kinds |= dict.fromkeys(names, "gaps" if use == "velocity" else "word")
    parts: dict[str, list[Any]] = {use: [] for use in others}
    for each in files.inputs:
        with opened(each, files.reading) as source:
            for table in source.tables(kinds, None):
                named = table.with_words(files.columns.id)
                for use, names in others.items():
                    parts[use].append(_values(named, use, names))
    return {use: np.concatenate(found) for use, found in parts.items()}


def _values(table: Table, use: str, names: tuple[str, ...]) -> NDArray[Any]:
    if use == "velocity":
        velocity: Array = np.stack([table.numbers[name] for name in names], axis=1)
        return velocity
    words = table.words[names[0]]
    return np.array(words.names, dtype=object)[words.codes].astype(str)


def _kinds(file: str, column: str, words: NDArray[Any]) -> NDArray[Any]:
    wrong = ~np.isin(words, KINDS)
    if wrong.any():
        raise DataError(
            f"{file}: column {column}: {str(words[wrong][0])!r}; expected {', '.join(KINDS)}"
        )
    return words


def read_times(
    file: PathLike,
    tracks: PathLike,
    of_tracks: TableOptions | None = None,
    time: str | None = None,
) -> Array | dict[str, Array]:
    """Times of a table of scans, by group if tracks have one.

    Parameters
    ----------
    file : str or path
        The table: a row for each scan, also for those without a track.
    tracks : str or path
        The table of tracks, whose clock it has.
    of_tracks : TableOptions, optional
        What the columns of that are; those of time and group have the same names in both.
    time : str, optional
        Column of time in the table of scans. Unless given, it is called as in that of tracks, or
        has a usual name.

    Raises
    ------
    DataError
        If there are no such columns, a time is none, or a scan has several rows.
    OSError
        If a file cannot be read.
    """
    options = of_tracks or TableOptions()
    files = _opened(tracks, "tracks", options).files
    clock = files.decoder.clock
    chosen: dict[str, Kind] = {}

    def wanted(names: tuple[str, ...]) -> Mapping[str, Kind]:
        column = time or (files.columns.time if files.columns.time in names else None)
        chosen[time_columns(names, PlotDescription(time=column), str(file))[1]] = "time"
        if options.group is not None:
            chosen[known(names, options.group, "group", str(file))] = "word"
        more: dict[str, Kind] = {} if _SCAN in chosen or _SCAN not in names else {_SCAN: "word"}
        return chosen | more

    table = read_table(file, wanted)
    name, *group = chosen
    seconds = clock.seconds(table.cells[name], table.rows, table.file, name)
    if _SCAN in table.words and _SCAN not in chosen:
        _check_scans_once(table, group)
    if not group:
        return seconds
    found = table.words[group[0]]
    return {name: seconds[found.codes == code] for code, name in enumerate(found.names)}


def _check_scans_once(table: Table, group: list[str]) -> None:
    """Refuse a table with several rows of a scan, as one of plots has."""
    seen: dict[tuple[str, ...], int] = {}
    for row, words in enumerate(zip(*(table.words[name] for name in (*group, _SCAN)), strict=True)):
        if words in seen:
            raise DataError(
                f"{table.file}: row {table.rows[row]}, column {_SCAN}: {words[-1]!r} is also in "
                f"row {table.rows[seen[words]]}; expected a table of scans, each in one row "
                "(`group` is the column that tells recordings apart)"
            )
        seen[words] = row
