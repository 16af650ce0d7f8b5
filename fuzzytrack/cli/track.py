"""The command that tracks the plots of a file."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.output import print_json, print_table, progress, say, show
from fuzzytrack.cli.pictures import check_picture, save_picture
from fuzzytrack.cli.recording import axes_named, read_recording
from fuzzytrack.io.columns import Columns
from fuzzytrack.io.formats import check_table
from fuzzytrack.io.recording import Recording
from fuzzytrack.recordings.ragged import join_tracks, run_tracks
from fuzzytrack.recordings.totals import Totals
from fuzzytrack.recordings.track_writer import write_tracks
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker
from fuzzytrack.trackers.result import TrackResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["track"]


# Bytes of a file above which it is tracked in pieces by default.
_LARGE = 100_000_000
# With more tracks than this, only totals are printed.
_LISTED = 20
_HEADS = ("plots", "missed", "duration (s)", "innovation RMS", "mean α", "mean β")


def track(
    file: Annotated[
        str,
        typer.Argument(metavar="FILE|DIR", help="CSV or Parquet file, or a folder of Parquet."),
    ],
    tracker: Annotated[
        str,
        typer.Option("--tracker", metavar="NAME|FILE.yaml", help="See `fuzzytrack trackers`."),
    ] = "stiffness-damping",
    time: options.Time = None,
    id: options.Id = None,
    axes: options.Axes = None,
    sigma: options.PlotSigma = None,
    sort: options.Sort = False,
    output: Annotated[
        str | None,
        typer.Option(
            "--output", "-o", metavar="OUT.csv|DIR", help="Write the tracks (or .parquet)."
        ),
    ] = None,
    plot: Annotated[
        str | None, typer.Option(metavar="FILE.png", help="Draw the tracks (or .pdf, .svg…).")
    ] = None,
    chunk_rows: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", help="Hold N rows at a time. [default: all if few]"),
    ] = None,
    jobs: Annotated[
        int, typer.Option(min=1, metavar="N", help="Processes of this computer; -o is a folder.")
    ] = 1,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Dask cluster; -o is a folder.")
    ] = None,
    partitions: Annotated[
        int, typer.Option(min=1, metavar="P", help="Tasks and files that tracks are divided among.")
    ] = 16,
    plugin: options.Plugins = None,
    json: options.Json = False,
) -> None:
    """Track the plots of a file, or of a folder of files in order of their names.

    Times are in seconds; an empty cell or nan is a missed plot. A folder, or a file of more than
    100 MB, is tracked in pieces, and may be larger than memory.
    """
    if sigma is not None and not 0 < sigma < math.inf:
        raise ValueError(f"--sigma must be > 0, got {sigma:g}")
    options.load_plugins(plugin)
    chosen = make_tracker(tracker)
    apart = scheduler is not None or jobs > 1
    if (
        apart
        or chunk_rows is not None
        or os.path.isdir(file)
        or (_is_large(file) and isinstance(chosen, LaneTracker) and not (sort or plot))
    ):
        from fuzzytrack.recordings.large_jobs import LargeJob

        _check_pieces(sort, plot)
        job = LargeJob.of(file, chosen, sigma, chunk_rows, time=time, id=id, axes=axes_named(axes))
        with progress("tracking") as watch:
            if apart:
                folder = _folder(output)
                totals = job.track_apart(folder, jobs, scheduler, partitions, watch)
            else:
                totals = job.track(output, watch)
        run = _Run(job.columns, totals)
    else:
        _look_ahead(file, output, plot)
        recording = read_recording(file, time, id, axes, sort)
        with progress("tracking") as watch:
            plots = [(t.time, t.plots) for t in recording.tracks]
            results = run_tracks(chosen, plots, sigma, watch)
        if output is not None:
            with progress("writing") as watch:
                write_tracks(output, recording, results, watch)
        if plot is not None:
            save_picture(plot, lambda: _draw(recording, results), (file,))
        run = _Run.whole(recording, results, listed=_LISTED if not json else len(results))
    if json:
        _print_json(run, {"file": file, "tracker": tracker}, {"output": output, "plot": plot})
        return
    _print_table(run)
    for written in filter(None, (output, plot)):
        say(f"wrote {written}")


def _is_large(file: str) -> bool:
    return os.path.isfile(file) and os.path.getsize(file) > _LARGE


# -------------------------------------------------------------------- checks


def _look_ahead(file: str, output: str | None, plot: str | None) -> None:
    """Find out what cannot be written before the work is done."""
    if output is not None:
        check_table(output, (file,))
    if plot is not None:
        check_picture(plot, (file,))


def _check_pieces(sort: bool, plot: str | None) -> None:
    for option, given in (("--sort", sort), ("--plot", plot)):
        if given:
            raise ValueError(
                f"{option}: needs the whole recording in memory; not for a folder, and not with "
                "--chunk-rows, --jobs or --scheduler"
            )


def _folder(output: str | None) -> str:
    if output is None:
        raise ValueError("--jobs and --scheduler need -o DIR, a folder for the tracks")
    return output


# -------------------------------------------------------------------- summary


@dataclass(frozen=True, eq=False)
class _Run:
    """What is printed of a run: its columns, its totals, and those of single tracks if listed."""

    columns: Columns
    total: Totals
    tracks: tuple[tuple[str, Totals], ...] | None = None

    @classmethod
    def whole(cls, recording: Recording, results: Sequence[TrackResult], listed: int) -> _Run:
        """Run of a whole recording; at most so many tracks are listed one by one."""
        tracks = None
        if len(results) <= listed:
            pairs = zip(recording.tracks, results, strict=True)
            tracks = tuple((track.id, Totals.of([result])) for track, result in pairs)
        return cls(recording.columns, Totals.of(results), tracks)


def _print_json(run: _Run, read: dict[str, Any], written: dict[str, Any]) -> None:
    columns = run.columns
    tracks: dict[str, Any] = {"tracks": None, "number": run.total.tracks}
    if run.tracks is not None:
        rows = [{"id": id if columns.id else None, **of.summary} for id, of in run.tracks]
        tracks = {"tracks": rows}
    total = {"total": run.total.summary}
    print_json({**read, "time": columns.time, "axes": columns.axes, **tracks, **total, **written})


def _print_table(run: _Run) -> None:
    columns = run.columns
    rows = [[id if columns.id else "track", *_row(of)] for id, of in run.tracks or ()]
    if len(rows) != 1:
        rows += [[]] if rows else []
        rows.append([f"all {run.total.tracks}" if columns.id else "track", *_row(run.total)])
    print_table([columns.id, *_HEADS], rows)


def _row(totals: Totals) -> list[str]:
    summary = totals.summary
    numbers = [show(summary[key], 4) for key in ("innovation_rms", "alpha", "beta")]
    return [
        str(summary["plots"]),
        str(summary["missed"]),
        f"{summary['duration']:.6g}",
        *numbers,
    ]


# -------------------------------------------------------------------- picture


def _draw(recording: Recording, results: Sequence[TrackResult]) -> Figure:
    from fuzzytrack.plotting import plot_track

    return plot_track(join_tracks(results), axes_names=recording.axes, unit="")[0]
