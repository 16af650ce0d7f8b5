"""The command that tracks the plots of a file."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from fuzzytrack.arrays import Array
from fuzzytrack.cli import options
from fuzzytrack.cli.output import print_json, print_table, progress, say, show
from fuzzytrack.cli.pictures import check_picture, save_picture
from fuzzytrack.io.files import check_output
from fuzzytrack.io.table import table_writer
from fuzzytrack.io.tracks import Recording, read_tracks
from fuzzytrack.recordings.ragged import run_tracks
from fuzzytrack.recordings.track_writer import write_tracks
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker
from fuzzytrack.trackers.result import TrackResult
from fuzzytrack.trackers.state import Gains

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fuzzytrack.recordings.large_jobs import LargeJob
    from fuzzytrack.recordings.totals import Totals

__all__ = ["read", "track"]


# Bytes of a file above which it is tracked in pieces although nobody asks for it.
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
    sigma: Annotated[
        float | None,
        typer.Option(metavar="S", help="Standard deviation of the plots, for trackers that ask."),
    ] = None,
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
    100 MB, is tracked in pieces: files larger than memory will do.
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
        coordinates = None if axes is None else options.names(axes, "--axes")
        job = LargeJob.of(file, chosen, sigma, chunk_rows, time=time, id=id, axes=coordinates)
        with progress("tracking") as watch:
            if apart:
                totals = job.track_apart(output, jobs, scheduler, partitions, watch)
            else:
                totals = job.track(output, watch)
        _report(file, job, totals, tracker, output, json)
        return
    _look_ahead(file, output, plot)
    recording = read(file, time, id, axes, sort)
    with progress("tracking") as watch:
        plots = [(t.time, t.plots) for t in recording.tracks]
        results = run_tracks(chosen, plots, sigma, watch)
    if output is not None:
        with progress("writing") as watch:
            write_tracks(output, recording, results, watch)
    if plot is not None:
        save_picture(plot, lambda: _draw(recording, results), (file,))
    if json:
        _print_json(recording, results, tracker, {"output": output, "plot": plot})
        return
    _print_table(recording, results)
    for written in filter(None, (output, plot)):
        say(f"wrote {written}")


def read(file: str, time: str | None, id: str | None, axes: str | None, sort: bool) -> Recording:
    """Read a recording as the options say, with a progress bar."""
    chosen = None if axes is None else options.names(axes, "--axes")
    with progress("reading") as watch:
        return read_tracks(file, time=time, id=id, axes=chosen, sort=sort, progress=watch)


def _is_large(file: str) -> bool:
    return os.path.isfile(file) and os.path.getsize(file) > _LARGE


def _look_ahead(file: str, output: str | None, plot: str | None) -> None:
    """Find out what cannot be written before the work is done."""
    if output is not None:
        table_writer(output)
        check_output(output, (file,))
    if plot is not None:
        check_picture(plot, (file,))


def _check_pieces(sort: bool, plot: str | None) -> None:
    for option, given in (("--sort", sort), ("--plot", plot)):
        if given:
            raise ValueError(
                f"{option}: needs the whole recording in memory; not for a folder, and not with "
                "--chunk-rows, --jobs or --scheduler"
            )


def _report(
    file: str, job: LargeJob, totals: Totals, tracker: str, output: str | None, json: bool
) -> None:
    """Print totals; single tracks are not kept."""
    columns = job.columns
    if json:
        print_json(
            {
                "file": file,
                "tracker": tracker,
                "time": columns.time,
                "axes": columns.axes,
                "tracks": None,
                "number": totals.tracks,
                "total": totals.summary,
                "output": output,
                "plot": None,
            }
        )
        return
    whose = f"all {totals.tracks}" if columns.id else "track"
    print_table([columns.id, *_HEADS], [[whose, *_row(totals.summary)]])
    if output is not None:
        say(f"wrote {output}")


# -------------------------------------------------------------------- summary


def _summary(results: Sequence[TrackResult]) -> dict[str, Any]:
    """Numbers about one track, or about several together."""
    seen = np.concatenate([~np.isnan(r.measured).any(axis=1) for r in results])
    squares = np.concatenate([(r.innovation**2).sum(axis=1) for r in results])
    return {
        "plots": int(seen.sum()),
        "missed": int((~seen).sum()),
        "duration": float(sum(r.time[-1] - r.time[0] for r in results)),
        "innovation_rms": math.sqrt(_mean(squares)),
        "alpha": _mean(np.concatenate([r.gains.alpha for r in results])),
        "beta": _mean(np.concatenate([r.gains.beta for r in results])),
    }


def _mean(values: Array) -> float:
    known = values[~np.isnan(values)]
    return float(known.mean()) if known.size else math.nan


def _print_json(
    recording: Recording, results: Sequence[TrackResult], tracker: str, written: dict[str, Any]
) -> None:
    rows = [
        {"id": track.id if recording.id else None, **_summary([result])}
        for track, result in zip(recording.tracks, results, strict=True)
    ]
    print_json(
        {
            "file": recording.file,
            "tracker": tracker,
            "time": recording.time,
            "axes": recording.axes,
            "tracks": rows,
            "total": _summary(results),
            **written,
        }
    )


def _print_table(recording: Recording, results: Sequence[TrackResult]) -> None:
    many = len(results) > 1
    rows: list[list[str]] = []
    if len(results) <= _LISTED:
        for track, result in zip(recording.tracks, results, strict=True):
            rows.append([track.id if recording.id else "track", *_row(_summary([result]))])
    if many:
        rows += [[]] if rows else []
        rows.append([f"all {len(results)}", *_row(_summary(results))])
    print_table([recording.id, *_HEADS], rows)


def _row(summary: dict[str, Any]) -> list[str]:
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

    return plot_track(_in_line(results), axes_names=recording.axes, unit="")[0]


def _in_line(results: Sequence[TrackResult]) -> TrackResult:
    """All tracks one after the other, with a gap between them, so that no line joins two."""

    def joined(parts: Sequence[Array]) -> Array:
        gap = np.full((1, *parts[0].shape[1:]), np.nan)
        return np.concatenate([piece for part in parts for piece in (part, gap)][:-1])

    gains = [joined([getattr(r.gains, n) for r in results]) for n in ("alpha", "beta", "gamma")]
    names = ("time", "measured", "predicted", "filtered", "velocity", "acceleration", "innovation")
    values = {name: joined([getattr(r, name) for r in results]) for name in names}
    return TrackResult(**values, gains=Gains(*gains), state=None)
