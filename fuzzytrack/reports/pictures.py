"""Pictures of a Monte Carlo experiment, with captions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fuzzytrack.testbed.metrics import distance
from fuzzytrack.testbed.results import Quantity, Results
from fuzzytrack.trackers.state import Gains

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["CAPTIONS", "LEVEL", "report_pictures"]

#: Confidence level of all intervals.
LEVEL = 0.95
# Width in inches, for words that can be read where a picture is as wide as a phone.
WIDTH = 5.6
# Largest number of trackers in the picture of one run.
SHOWN = 4
# Part of the path that a close-up shows at most; a larger one is no close-up.
CLOSE = 0.4
# Largest number of letters of a name in a legend.
ROOM = 44

#: Heading and caption of each picture.
CAPTIONS = {
    "comparison": (
        "Errors of the trackers",
        "Root mean square error over all runs and scored scans, of predicted and of filtered "
        "positions; further left is better. Lines are two standard errors to either side, about "
        "95 %. The dashed line is the error of the plots themselves.",
    ),
    "error-over-time": (
        "Error over time",
        "Root mean square error over runs at each scan, of predicted and of filtered positions; "
        "low is good. Bands are two standard errors to either side, about 95 %: where the bands of "
        "two trackers are apart, the difference is hardly chance. Shaded scans do not count.",
    ),
    "error-distribution": (
        "Distribution of errors",
        "Share of all scored errors of prediction that do not exceed a size; a curve further left "
        "is better. Marks are the median (50 %) and the error that 95 % stay within. The largest "
        "errors, beyond 99 % of those of every tracker, are outside the picture.",
    ),
    "trajectories": (
        "One run",
        f"The first run: the true path, the plots, and what the first {SHOWN} trackers at most "
        "predicted for each scan, in a plane also close up where one of them erred most, unless "
        "that is much of the path. Hollow marks are scans without a plot, where the tracker "
        "coasted.",
    ),
    "gain-plane": (
        "Gains used",
        "Position gain α and velocity gain β that each tracker used in the first run. Inside the "
        "triangle constant gains are stable. Fixed gains are one point; scheduled gains "
        "spread out. Gains near the left corner smooth much and follow slowly; to the right they "
        "follow every plot.",
    ),
    "consistency": (
        "Consistency",
        "Normalized innovation squared, mean over runs at each scan. A filter whose presumed "
        "noise is right stays in the band in 95 % of scans; above it the variances are too "
        "small, below too large. Trackers without a line have no covariance to judge.",
    ),
}


def report_pictures(results: Results) -> dict[str, Figure]:
    """Pictures of an experiment, as the report shows them.

    Parameters
    ----------
    results : Results
        Results of the experiment.

    Returns
    -------
    dict of str to Figure
        ``comparison``, ``error-over-time``, ``error-distribution``, ``trajectories``,
        ``gain-plane`` and, where there is NIS, ``consistency``. They do not belong to pyplot;
        nothing needs closing.
    """
    labels = _labels(results.names)
    pictures = {
        "comparison": _draw_comparison(results, labels),
        "error-over-time": _draw_error_over_time(results, labels),
        "error-distribution": _draw_error_distribution(results, labels),
        "trajectories": _draw_trajectories(results, labels),
        "gain-plane": _draw_gain_plane(results, labels),
    }
    if results.nis is not None and not np.isnan(results.nis).all():
        pictures["consistency"] = _draw_consistency(results, labels)
    return pictures


def _draw_comparison(results: Results, labels: Sequence[str]) -> Figure:
    from fuzzytrack.plotting.comparison import plot_estimates

    figure = _figure(2.2 + 0.56 * len(labels))
    quantities: tuple[Quantity, ...] = ("predicted", "filtered")
    for panel, quantity in zip(figure.subplots(2), quantities, strict=True):
        plot_estimates(
            labels,
            results.rmse(quantity),
            results.rmse_se(quantity),
            reference={"plots": results.measured_rmse},
            what=f"RMSE of {quantity} position",
            ax=panel,
        )
    return figure


def _draw_error_over_time(results: Results, labels: Sequence[str]) -> Figure:
    from fuzzytrack.plotting import plot_error_over_time

    figure = _figure(7.2)
    panels = figure.subplots(2, sharex=True)
    quantities: tuple[Quantity, ...] = ("predicted", "filtered")
    for panel, quantity in zip(panels, quantities, strict=True):
        rmse, error = results.rmse_per_scan(quantity), results.rmse_per_scan_se(quantity)
        low = np.maximum(rmse - 2 * error, 0.0)
        plot_error_over_time(
            results.time,
            dict(zip(labels, rmse, strict=True)),
            dict(zip(labels, zip(low, rmse + 2 * error, strict=True), strict=True)),
            scored_from=results.time[results.first_scored],
            what=f"RMSE of {quantity} position",
            ax=panel,
        )
    # One legend serves both.
    panels[0].get_legend().remove()
    panels[0].set_xlabel("")
    return figure


def _draw_error_distribution(results: Results, labels: Sequence[str]) -> Figure:
    from fuzzytrack.plotting import plot_error_distribution

    figure = _figure(4.6)
    scored = [away[results.scored] for away in results.predicted_distance]
    plot_error_distribution(dict(zip(labels, scored, strict=True)), ax=figure.subplots())
    return figure


def _draw_trajectories(results: Results, labels: Sequence[str]) -> Figure:
    from fuzzytrack.plotting import plot_trajectories

    run = results.sample
    tracks = dict(list(zip(labels, run.predicted, strict=True))[:SHOWN])
    n_axes = run.truth.shape[1]
    away = distance(run.predicted[:SHOWN] - run.truth)[:, results.first_scored :]
    if n_axes != 2 or np.isnan(away).all():
        figure = _figure(6.0 if n_axes == 2 else 2.2 + 2.2 * n_axes)
        panels = figure.subplots(1 if n_axes == 2 else n_axes, sharex=True)
        plot_trajectories(run.time, run.truth, run.plots, tracks, ax=panels)
        return figure
    step = np.median(distance(np.diff(run.truth, axis=0)))
    reach = 3 * max(float(np.nanmax(away)), float(step)) or 1.0
    if reach > CLOSE * float(np.linalg.norm(np.ptp(run.truth, axis=0))) > 0:
        figure = _figure(6.0)
        plot_trajectories(run.time, run.truth, run.plots, tracks, ax=figure.subplots())
        return figure
    figure = _figure(10.0)
    whole, close = figure.subplots(2)
    plot_trajectories(run.time, run.truth, run.plots, tracks, ax=whole)
    # One legend serves both.
    whole.get_legend().remove()
    # Markers of every scan would cover the lines beneath; the close-up shows them.
    for line in whole.lines:
        if line.get_label() in tracks:
            line.set_marker("")
    worst = results.first_scored + int(np.nanargmax(np.fmax.reduce(away)))
    there = run.truth[worst]
    plot_trajectories(
        run.time,
        run.truth - there,
        run.plots - there,
        {label: track - there for label, track in tracks.items()},
        unit="m",
        axes_names=("x from there", "y from there"),
        ax=close,
    )
    close.set_title(f"around the largest error, at t = {run.time[worst]:.6g} s", fontsize=10)
    close.locator_params(nbins=5)
    close.set_aspect("equal", adjustable="box")
    close.set(xlim=(-reach, reach), ylim=(-reach, reach))
    return figure


def _draw_gain_plane(results: Results, labels: Sequence[str]) -> Figure:
    from fuzzytrack.plotting import plot_gain_plane

    run = results.sample
    gains = map(Gains, run.alpha, run.beta, run.gamma)
    figure = _figure(6.2)
    plot_gain_plane(dict(zip(labels, gains, strict=True)), ax=figure.subplots())
    return figure


def _draw_consistency(results: Results, labels: Sequence[str]) -> Figure:
    from fuzzytrack.plotting import plot_consistency

    found = results.nis_consistency(LEVEL)
    assert found is not None
    figure = _figure(4.6)
    plot_consistency(
        results.time,
        dict(zip(labels, found.scan_mean, strict=True)),
        # The band of the tracker with the most runs, which is the narrowest.
        (np.fmax.reduce(found.scan_low), np.fmin.reduce(found.scan_high)),
        ax=figure.subplots(),
    )
    return figure


def _figure(height: float) -> Figure:
    """Figure that pyplot does not know: it opens no window and need not be closed."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, height))
    # Else the title of a panel is read as the label of the axis above it.
    figure.set_layout_engine("constrained", h_pad=0.1)
    return figure


def _labels(names: Sequence[str]) -> list[str]:
    """Names for legends: short, still different from each other, without mathematical notation."""
    short = [name if len(name) <= ROOM else f"{name[: ROOM - 1]}…" for name in names]
    if len(set(short)) < len(short):
        short = [f"{number}. {name}" for number, name in enumerate(short, 1)]
    # Matplotlib leaves labels out of a legend that begin with an underscore.
    return [f" {s}" if s.startswith("_") else s for s in (s.replace("$", r"\$") for s in short)]
