"""The command that tracks the plots of a file."""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass
from typing import Annotated, Any

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.complaints import printable
from fuzzytrack.cli.follow import FollowOptions, follow, follow_options
from fuzzytrack.cli.noise_words import noise_json, noise_sentence
from fuzzytrack.cli.option_groups import grouped
from fuzzytrack.cli.output import (
    print_json,
    print_table,
    progress,
    say,
    say_notes,
    show,
)
from fuzzytrack.cli.output_file import STANDARD_OUTPUT, output_file, told_aside
from fuzzytrack.cli.pictures import check_picture, save_picture
from fuzzytrack.cli.plot_options import gate_width, plot_reading
from fuzzytrack.io.column_names import is_unit
from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.formats import check_table
from fuzzytrack.io.plot_files import ROWS
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import Track
from fuzzytrack.io.track_formats import TRACK_SUFFIXES, check_geo_tracks, is_geo
from fuzzytrack.recordings.preparation import DEFAULT_TRACKER, PreparedPlots, prepare
from fuzzytrack.recordings.totals import Totals
from fuzzytrack.recordings.tracking import TrackedRecording, track_recording
from fuzzytrack.trackers.catalog import as_lane_tracker, make_tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker

__all__ = ["track"]


# Headings in the help.
_LARGE_JOBS = "Large recordings"
# Bytes of a file above which it is tracked in pieces by default.
_LARGE = 100_000_000
# With more tracks than this, only totals are printed.
_LISTED = 20
# Characters of an identity that are printed, at most.
_LONGEST = 40
_HEADS = ("plots", "missed", "duration (s)", "innovation RMS ({})", "mean α", "mean β")


@dataclass(frozen=True)
class _Pieces:
    """How a large recording is divided."""

    chunk_rows: int | None
    jobs: int
    scheduler: str | None
    partitions: int

    @property
    def apart(self) -> bool:
        """Whether tracks are divided among tasks."""
        return self.scheduler is not None or self.jobs > 1


def _pieces(
    chunk_rows: Annotated[
        int | None,
        typer.Option(
            min=1,
            metavar="N",
            help="Hold N rows at a time. [default: all if few]",
            rich_help_panel=_LARGE_JOBS,
        ),
    ] = None,
    jobs: Annotated[
        int,
        typer.Option(
            min=1,
            metavar="N",
            help="Processes of this computer; -o is a folder.",
            rich_help_panel=_LARGE_JOBS,
        ),
    ] = 1,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="Dask cluster; -o is a folder.", rich_help_panel=_LARGE_JOBS
        ),
    ] = None,
    partitions: Annotated[
        int,
        typer.Option(
            min=1,
            metavar="P",
            help="Tasks and files that tracks are divided among.",
            rich_help_panel=_LARGE_JOBS,
        ),
    ] = 16,
) -> _Pieces:
    return _Pieces(chunk_rows, jobs, scheduler, partitions)


@grouped(reading=plot_reading, pieces=_pieces, live=follow_options)
def track(
    files: Annotated[
        list[str],
        typer.Argument(metavar="FILE|DIR...", help="Files of plots, a folder of them, or -."),
    ],
    reading: Reading,
    pieces: _Pieces,
    live: FollowOptions | None,
    tracker: Annotated[
        str | None,
        typer.Option(
            "--tracker",
            metavar="NAME|FILE",
            help="See `fuzzytrack trackers`; or the file of a rule base: .yaml, .fis (MATLAB), "
            f".fll (fuzzylite). [default: {DEFAULT_TRACKER}]",
        ),
    ] = None,
    gate: options.Gate = "auto",
    output: Annotated[
        str | None,
        typer.Option(
            "--output",
            "-o",
            metavar="OUT.csv|DIR|-",
            help="Write the tracks (or .parquet; .geojson, .kml, .czml or .gpx); - prints CSV.",
        ),
    ] = None,
    quote_formulas: Annotated[
        bool,
        typer.Option("--quote-formulas", help="In CSV, quote text that a spreadsheet would run."),
    ] = False,
    plot: Annotated[
        str | None, typer.Option(metavar="FILE.png", help="Draw the tracks (or .pdf, .svg…).")
    ] = None,
    plugin: options.Plugins = None,
    json: options.Json = False,
) -> None:
    """Track the plots of a file, or of several files in their order.

    A folder, or a file of more than 100 MB, is tracked in pieces, and may be larger than memory.
    """
    options.load_plugins(plugin)
    width = gate_width(gate)
    if live is not None:
        _check_follow(plot, pieces)
        follow(
            files, reading, tracker, width, output, live, json=json, quote_formulas=quote_formulas
        )
        return
    large = len(files) == 1 and _is_large(files[0]) and _goes_on(tracker)
    in_pieces = pieces.apart or pieces.chunk_rows is not None or len(files) > 1
    in_pieces = in_pieces or os.path.isdir(files[0])
    if output == STANDARD_OUTPUT and json:
        raise ValueError("--json: -o - writes the tracks to standard output; name a file")
    with output_file(output) as place:
        if in_pieces or (large and not (reading.sort or plot)):
            _check_pieces(reading.sort, plot)
            folder = _folder(output) if pieces.apart else place
            prepared = prepare(files, tracker, reading, width)
            run = _track_pieces(prepared, pieces, folder, quote_formulas=quote_formulas)
        else:
            _look_ahead(files[0], place, plot)
            with progress("tracking") as watch:
                tracked = track_recording(files[0], tracker, reading, watch, place, gate=width)
            if place is not None:
                with progress("writing") as watch:
                    tracked.write(place, watch, quote_formulas=quote_formulas)
            if plot is not None:
                save_picture(plot, tracked.plot, (files[0],))
            run = _Run.whole(tracked, listed=_LISTED if not json else len(tracked))
    if json:
        file = files[0] if len(files) == 1 else list(files)
        _print_json(run, {"file": file, "tracker": run.tracker}, {"output": output, "plot": plot})
        return
    with told_aside(output):
        _print_table(run)
        for written in (output, plot):
            if written not in (None, STANDARD_OUTPUT):
                say(f"wrote {written}")


def _track_pieces(
    prepared: PreparedPlots, pieces: _Pieces, place: str | None, *, quote_formulas: bool
) -> _Run:
    """Track a recording in pieces to a file, or in partitions to a folder."""
    from fuzzytrack.recordings.large_jobs import LargeJob

    made = as_lane_tracker(prepared.tracker)
    job = LargeJob(prepared.files, made, pieces.chunk_rows or ROWS, prepared.judge)
    with progress("tracking") as watch:
        if pieces.apart:
            assert place is not None
            totals = job.track_apart(place, pieces.jobs, pieces.scheduler, pieces.partitions, watch)
        else:
            totals = job.track(place, watch, quote_formulas=quote_formulas)
    return _Run.of(prepared, totals)


def _goes_on(tracker: str | None) -> bool:
    """Whether a tracker can continue from piece to piece."""
    return tracker is None or isinstance(make_tracker(tracker), LaneTracker)


def _is_large(file: str) -> bool:
    return os.path.isfile(file) and os.path.getsize(file) > _LARGE


# -------------------------------------------------------------------- checks


def _look_ahead(file: str, output: str | None, plot: str | None) -> None:
    """Find out what cannot be written before the work is done."""
    if output is not None and is_geo(output):
        check_geo_tracks(output, (file,))
    elif output is not None:
        check_table(output, (file,), others=TRACK_SUFFIXES)
    if plot is not None:
        check_picture(plot, (file,))


def _check_pieces(sort: bool, plot: str | None) -> None:
    for option, given in (("--sort", sort), ("--plot", plot)):
        if given:
            raise ValueError(
                f"{option}: needs the whole recording in memory; not for a folder, and not with "
                "--chunk-rows, --jobs or --scheduler"
            )


def _check_follow(plot: str | None, pieces: _Pieces) -> None:
    for option, given in (
        ("--plot", plot is not None),
        ("--chunk-rows", pieces.chunk_rows is not None),
        ("--jobs", pieces.jobs > 1),
        ("--scheduler", pieces.scheduler is not None),
    ):
        if given:
            raise ValueError(
                f"{option}: needs the whole recording; not with --follow. Track the file that was "
                "recorded meanwhile"
            )


def _folder(output: str | None) -> str:
    if output is None or output == STANDARD_OUTPUT:
        raise ValueError("--jobs and --scheduler need -o DIR, a folder for the tracks")
    return output


# -------------------------------------------------------------------- summary


@dataclass(frozen=True, eq=False)
class _Run:
    """What is printed of a run: its columns, its totals, and those of single tracks if listed."""

    decoder: PlotDecoder
    tracker: str
    findings: Findings
    total: Totals
    tracks: tuple[tuple[Track, Totals], ...] | None = None

    @classmethod
    def of(cls, prepared: PreparedPlots, total: Totals) -> _Run:
        """Run of a recording in pieces."""
        prepared.findings.merge(total.findings)
        return cls(prepared.files.decoder, prepared.spec, prepared.findings, total)

    @classmethod
    def whole(cls, tracked: TrackedRecording, listed: int) -> _Run:
        """Run of a whole recording; at most so many tracks are listed one by one."""
        tracks = None
        recording, results = tracked.recording, tracked.results
        if len(results) <= listed:
            pairs = zip(recording.tracks, results, strict=True)
            tracks = tuple((track, Totals.of([result])) for track, result in pairs)
        assert recording.decoder is not None
        return cls(recording.decoder, tracked.spec, tracked.findings, tracked.totals, tracks)


def _label(track: Track) -> str:
    """Identity of a track, with the number of its segment from the second one on."""
    id = printable(track.id)
    id = id if len(id) <= _LONGEST else id[:_LONGEST] + "…"
    return f"{id} ({track.segment + 1})" if track.segment else id


def _print_json(run: _Run, read: dict[str, Any], written: dict[str, Any]) -> None:
    columns = run.decoder.columns
    tracks: dict[str, Any] = {"tracks": None, "number": run.total.tracks}
    if run.tracks is not None:
        rows = [
            {"id": one.id if columns.id else None, "segment": one.segment, **of.summary}
            for one, of in run.tracks
        ]
        tracks = {"tracks": rows}
    total = {"total": run.total.summary}
    found = {
        "columns": asdict(columns),
        **noise_json(run.decoder),
        **run.findings.to_json_dict(),
    }
    print_json(
        {**read, "time": columns.time, "axes": columns.axes, **found, **tracks, **total, **written}
    )


def _print_table(run: _Run) -> None:
    columns = run.decoder.columns
    say(f"columns: {columns.sentence}")
    say(f"tracker: {run.tracker}")
    noise = noise_sentence(run.decoder)
    if noise:
        say(f"sigma: {noise}")
    say_notes(run.findings.notes)
    start = "" if columns.id else "track"
    rows = [[start + _label(one), *_row(of)] for one, of in run.tracks or ()]
    if len(rows) != 1:
        rows += [[]] if rows else []
        rows.append([f"all {run.total.tracks}" if columns.id else "track", *_row(run.total)])
    unit = _unit(run.decoder)
    print_table([columns.id, *(head.format(unit) for head in _HEADS)], rows)
    for fault in run.findings.sentences():
        say(fault)


def _unit(decoder: PlotDecoder) -> str:
    """Unit of positions and of innovations; Cartesian positions are in that of their columns."""
    columns = decoder.columns
    if columns.position == "angle":
        return "deg" if decoder.period == 360 else "rad"
    unit = columns.unit(columns.axes[0]) if columns.position == "cartesian" else ""
    return unit if is_unit(unit) else "m"


def _row(totals: Totals) -> list[str]:
    summary = totals.summary
    numbers = [show(summary[key], 4) for key in ("innovation_rms", "alpha", "beta")]
    return [
        str(summary["plots"]),
        str(summary["missed"]),
        f"{summary['duration']:.6g}",
        *numbers,
    ]
