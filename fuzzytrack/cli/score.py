"""The command that scores tracks against the truth."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.output import print_json, print_table, progress, say, say_notes, show
from fuzzytrack.cli.pictures import check_picture, save_picture
from fuzzytrack.cli.plot_options import number_or
from fuzzytrack.io.reading import Reading
from fuzzytrack.scoring.instants import Timing
from fuzzytrack.scoring.metrics import METRICS, Settings
from fuzzytrack.scoring.position_files import TableOptions, read_positions, read_times
from fuzzytrack.scoring.score_tracks import score_positions
from fuzzytrack.scoring.scores import Scores

__all__ = ["score"]

_Text = str | None

# Headings in the help.
_DISTANCES, _TIMES = "Distances", "Times"
_TRACKS, _TRUTH = "Columns of the tracks", "Columns of the truth"

# Columns of the table of several recordings.
_SHORT = {
    "ospa": "OSPA",
    "share_tracked": "tracked",
    "first_match": "first match",
    "switches": "switches",
    "breaks": "breaks",
    "moving_false_per_minute": "moving false",
    "rmse": "RMSE",
}

_UNITS = "OSPA and RMSE in m, first match in s, moving false tracks in s/min"


def _option(heading: str, metavar: str, help: str) -> Any:
    return typer.Option(metavar=metavar, help=help, rich_help_panel=heading)


def score(
    tracks: Annotated[
        str, typer.Argument(metavar="TRACKS", help="Table of tracks: CSV (or Parquet).")
    ],
    truth: Annotated[str, typer.Option("--truth", metavar="FILE", help="Table of true positions.")],
    cutoff: Annotated[
        float, _option(_DISTANCES, "M", "Cut-off of OSPA, OSPA(2), GOSPA and HOTA, m.")
    ] = 20.0,
    order: Annotated[float, _option(_DISTANCES, "P", "Order of OSPA, OSPA(2) and GOSPA.")] = 2.0,
    within: Annotated[
        float, _option(_DISTANCES, "M", "Largest distance of a track from its true object, m.")
    ] = 15.0,
    match: Annotated[
        float | None,
        _option(_DISTANCES, "M", "The same for CLEAR MOT, IDF1 and SIAP. [default: --within]"),
    ] = None,
    window: Annotated[int, _option(_DISTANCES, "N", "Instants of a window of OSPA(2).")] = 10,
    truth_lists: Annotated[
        str,
        _option(
            _DISTANCES, "all|moving", "With moving, static tracks far from the truth do not count."
        ),
    ] = "all",
    moving_above: Annotated[
        _Text,
        _option(_DISTANCES, "M/S", "Tracks that get from end to end faster than this are moving."),
    ] = None,
    lag: Annotated[
        str,
        _option(
            _TIMES, "S|GROUP=S,…|auto|none", "How late the clock of the tracks is, s; auto fits it."
        ),
    ] = "none",
    scans: Annotated[
        _Text,
        _option(_TIMES, "FILE", "Table with the times of all scans. [default: rows of the tracks]"),
    ] = None,
    step: Annotated[
        _Text, _option(_TIMES, "S", "Compare on a grid of this step, s. [default: rows]")
    ] = None,
    max_gap: Annotated[
        _Text,
        _option(
            _TIMES, "S", "Interpolate no longer gaps of the truth, s. [default: by the samples]"
        ),
    ] = None,
    time: Annotated[
        _Text, _option(_TRACKS, "COL", "Column of time (s, dates). [default: t, time…]")
    ] = None,
    id: Annotated[
        _Text, _option(_TRACKS, "COL", "Column of the identity. [default: track_id, id…]")
    ] = None,
    axes: Annotated[
        _Text, _option(_TRACKS, "COL,COL", "Columns of position, m. [default: x,y or north,east]")
    ] = None,
    polar: Annotated[
        _Text, _option(_TRACKS, "R,AZ", "Columns of range, m, and azimuth, degrees from north.")
    ] = None,
    geodetic: Annotated[
        _Text, _option(_TRACKS, "LAT,LON", "Columns of latitude and longitude, in degrees.")
    ] = None,
    velocity: Annotated[
        _Text, _option(_TRACKS, "COL,COL", "Columns of velocity, m/s. [default: vx,vy…]")
    ] = None,
    kind: Annotated[
        _Text, _option(_TRACKS, "COL", "Column of moving, static, undecided. [default: kind]")
    ] = None,
    group: Annotated[
        _Text, _option(_TRACKS, "COL", "Column of the recording; each is scored by itself.")
    ] = None,
    tentative: Annotated[
        bool,
        typer.Option(
            "--tentative", rich_help_panel=_TRACKS, help="Count tentative tracks as well."
        ),
    ] = False,
    truth_time: Annotated[
        _Text, _option(_TRUTH, "COL", "Column of time. [default: as in the tracks, or t, time…]")
    ] = None,
    truth_id: Annotated[
        _Text, _option(_TRUTH, "COL", "Column of the identity. [default: id, target_id…]")
    ] = None,
    truth_axes: Annotated[
        _Text,
        _option(_TRUTH, "COL,COL", "Columns of position. [default: as in the tracks, or x,y]"),
    ] = None,
    truth_polar: Annotated[
        _Text, _option(_TRUTH, "R,AZ", "Columns of range, m, and azimuth, degrees from north.")
    ] = None,
    truth_group: Annotated[
        _Text, _option(_TRUTH, "COL", "Column of the recording. [default: --group]")
    ] = None,
    plot: Annotated[
        _Text, typer.Option(metavar="FILE.png", help="Draw OSPA over time (or .pdf, .svg…).")
    ] = None,
    json: options.Json = False,
) -> None:
    """Score tracks against true positions: OSPA, GOSPA, SIAP, CLEAR MOT, IDF1, HOTA and more.

    Several recordings in one file, by --group, are a line each, with their mean.
    """
    settings = Settings(cutoff=cutoff, order=order, within=within, match=match, window=window)
    timing = Timing(step=_seconds(step, "--step"), max_gap=_seconds(max_gap, "--max-gap"))
    late = options.lags(lag)
    if plot is not None:
        check_picture(plot, (tracks, truth))
    of_tracks = TableOptions(
        reading=Reading.of(
            time=time,
            id=id,
            axes=_names(axes, "--axes"),
            polar=_names(polar, "--polar"),
            geodetic=_names(geodetic, "--geodetic"),
        ),
        group=group,
        kind=kind,
        velocity=_names(velocity, "--velocity"),
        tentative=tentative,
    )
    of_truth = TableOptions(
        reading=Reading.of(
            time=truth_time,
            id=truth_id,
            axes=_names(truth_axes, "--truth-axes"),
            polar=_names(truth_polar, "--truth-polar"),
        ),
        group=truth_group,
    )
    with progress("scoring"):
        (given, there), notes = read_positions(tracks, truth, of_tracks, of_truth)
        # Without tracks the truth has the clock.
        clocked = (tracks, of_tracks) if len(given) else (truth, _grouped(of_truth, group))
        times = None if scans is None else read_times(scans, *clocked)
        scores = score_positions(
            given,
            there,
            settings,
            timing,
            lag=late,
            scans=times,
            truth_lists=truth_lists,  # type: ignore[arg-type]  # checked there
            moving_above=_seconds(moving_above, "--moving-above"),
            notes=notes,
        )
    if plot is not None:
        save_picture(plot, scores.plot, (tracks, truth))
    if json:
        print_json({"tracks": tracks, "truth": truth, **scores.to_json_dict(), "plot": plot})
        return
    say_notes(scores.notes)
    if len(scores.groups) > 1:
        _print_groups(scores, group or "group")
    else:
        _print_all(scores)
    if plot is not None:
        say(f"wrote {plot}")


def _grouped(options: TableOptions, group: str | None) -> TableOptions:
    return options if options.group is not None else replace(options, group=group)


def _names(text: str | None, option: str) -> tuple[str, ...] | None:
    return None if text is None else tuple(options.names(text, option))


def _seconds(text: str | None, option: str) -> float | None:
    return None if text is None else float(number_or(text, option, {}))


# -------------------------------------------------------------------- tables


def _print_groups(scores: Scores, name: str) -> None:
    """One line a recording, and the mean."""
    rows = [_line(group.name, group.metrics) for group in scores.groups]
    rows += [[], _line("mean", scores.means)]
    print_table([name, *_SHORT.values()], rows, title=_UNITS)
    say()
    _print_means(scores)


def _line(name: str, metrics: dict[str, float]) -> list[str]:
    return [name, *(show(metrics[key], 3) for key in _SHORT)]


@dataclass(frozen=True)
class _Column:
    """A column of the table of all metrics."""

    head: str
    values: dict[str, float]


def _columns(scores: Scores, whole: str) -> list[_Column]:
    kinds = scores.means_by_kind.items()
    return [_Column(whole, scores.means), *(_Column(kind, values) for kind, values in kinds)]


def _print_means(scores: Scores) -> None:
    _print_metrics(_columns(scores, "mean"))


def _print_all(scores: Scores) -> None:
    """Every metric of one recording."""
    (one,) = scores.groups
    say(f"{one.objects} true objects, {one.tracks} tracks, {len(one.time)} instants")
    _print_metrics(_columns(scores, "all tracks"))


def _print_metrics(columns: list[_Column]) -> None:
    """All metrics by their families, those of each kind of track beside them."""
    rows: list[list[str]] = []
    family = ""
    for name, metric in METRICS.items():
        if family and metric.family != family:
            rows.append([])
        family = metric.family
        label = f"{metric.label} ({metric.unit})" if metric.unit else metric.label
        rows.append([label, *(show(column.values[name], 4) for column in columns)])
    print_table(["", *(column.head for column in columns)], rows)
