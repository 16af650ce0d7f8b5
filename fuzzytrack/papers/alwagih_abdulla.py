"""Al-Wagih & Abdulla: five ways to select α and β, in white and in colored noise."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.papers.alwagih_abdulla_tables import (
    METHODS,
    TABLE_1,
    TABLE_2,
    averages,
    table_rows,
)
from fuzzytrack.papers.reproduction import Reproduction, Row, row
from fuzzytrack.schedulers import BenedictBordner, GrowingMemory, LinearCombination
from fuzzytrack.simulation.noise import WHITE, Noise, streams
from fuzzytrack.simulation.published import s3
from fuzzytrack.simulation.scenario import PlotNoise, Scenario
from fuzzytrack.tasks import Progress
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.bank import ParallelBank
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.runners import runner
from fuzzytrack.trackers.window_search import WindowSearch

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["NOISES", "RUNS", "reproduce", "scenario", "trackers"]

Draw = Callable[[], "Figure"]

RUNS = 500
NOISES = ("white", "coloured")

_TABLES = {"white": ("Table 1", TABLE_1), "coloured": ("Table 2", TABLE_2)}
_AXES = ("X", "Y")
_SMALL = "M1, α = 0.01"
_LAST, _BEST, _SOFT = "M5 last", "M5 best", "M5 soft"

# Relative deviation from the paper's averages that is allowed, for a scenario fitted to them.
_MADE = 0.28
# A step of the search costs as much as hundreds of other steps: from here on compiling pays.
_COMPILED_RUNS = 50


def scenario(noise: str = "white") -> Scenario:
    """The experiment: scenario S3, whose first two plots are clean.

    Parameters
    ----------
    noise : {"white", "coloured"}
        White, or AR(1) with a correlation of 0.7.

    Raises
    ------
    ValueError
        If there is no such noise.
    """
    if noise not in NOISES:
        raise ValueError(f"noise: unknown {noise!r}; one of {', '.join(NOISES)}")
    time, position = s3()
    sensors = {
        "white": PlotNoise((15.0, 23.0), WHITE, clean=2),
        "coloured": PlotNoise((19.0, 23.0), Noise(correlation=0.7), clean=2),
    }
    return Scenario(
        name=f"s3-{noise}",
        time=time,
        position=position,
        sensors=sensors[noise],
        source="made after Al-Wagih & Abdulla, Tables 1 and 2",
    )


def trackers() -> dict[str, Tracker]:
    """Trackers that are compared, by label: M1 to M5 as published, M5 without hindsight, fixed."""
    return {
        "M1": AlphaBetaTracker(BenedictBordner(0.05)),
        "M2": AlphaBetaTracker(GrowingMemory()),
        "M3": AlphaBetaTracker(LinearCombination(0.05, 0.05)),
        "M4": WindowSearch(80),
        "M5": ParallelBank(selection="hindsight"),
        _LAST: ParallelBank(selection="last"),
        _BEST: ParallelBank(selection="best"),
        _SOFT: ParallelBank(selection="soft"),
        "fixed α = 0.3": AlphaBetaTracker(BenedictBordner(0.3)),
        "fixed α = 0.4": AlphaBetaTracker(BenedictBordner(0.4)),
    }


def reproduce(runs: int, seed: int, progress: Progress) -> Reproduction:
    """Rebuild Tables 1 to 6; see `fuzzytrack.papers.reproduce`."""
    wanted = trackers()
    errors: dict[str, dict[str, Array]] = {noise: {} for noise in NOISES}
    # The search over the window takes about as long as all the others.
    weights = {label: len(wanted) if label == "M4" else 1 for label in wanted}
    done, steps = 0, len(NOISES) * sum(weights.values())
    for noise in NOISES:
        experiment = scenario(noise)
        plots = experiment.sensors.measure(experiment.position, streams(seed, runs))
        truth = experiment.position[:, None]
        for label, tracker in wanted.items():
            found = _predicted(tracker, experiment.time, plots.z, plots.sigma)
            errors[noise][label] = found - truth
            done += weights[label]
            progress(done / steps)
        errors[noise]["plots"] = plots.z - truth
    return Reproduction(
        paper="alwagih-abdulla",
        title="Al-Wagih & Abdulla: new algorithms for selecting α and β",
        rows=(*_noise_free_rows(), *_error_rows(errors, runs), *table_rows()),
        notes=(
            "The paper states neither tracks, noise, number of plots, window, grid, weight nor the "
            "gains of its bank. Scenario S3 is made after its averages, with about as many free "
            "numbers as there are averages: it shows that they are possible, no more.",
            "M5 chooses each prediction by the plot that it predicts: it cannot track. Its gain "
            "over M1 in Y comes from the large α in its bank; one fixed α of 0.4 is as good. "
            "Chosen by the last plot (M5 last) the bank is worse than the plots themselves; "
            "by all plots, older ones with less weight (M5 best, M5 soft), it is about as good as "
            "the best fixed gain in white noise.",
            "M4 is as far from the target in Y as M1 is, so its window must cover most of the "
            "track: it acts late, or not at all.",
            "In X, M1 is better than M2 and M3 in S3, but not in the averages; and S3 lacks "
            "the large spread of the five experiments: their tracks must have differed in X.",
        ),
        pictures=_pictures(errors),
    )


def _predicted(tracker: Tracker, time: Array, z: Array, sigma: Array) -> Array:
    if not isinstance(tracker, WindowSearch):
        return tracker.run(time, z, sigma).predicted
    core = runner(tracker, 1)
    lanes = z.reshape(len(z), -1, 1)
    native = True if z.shape[1] >= _COMPILED_RUNS else None
    outputs = core(
        core.fresh(lanes.shape[1]), lanes, time[:, None], np.full((1, 1, 1), np.nan), native
    )[1]
    return outputs["predicted"].reshape(z.shape)


def _rmse(errors: Array) -> Array:
    """Root mean square error along the scans, Eq. 26.

    The number of measured data is that of all plots; the two of the start count with no error.
    """
    return np.asarray(np.sqrt((errors[2:] ** 2).sum(axis=0) / len(errors)))


# -------------------------------------------------------------------- rows


def _noise_free_rows() -> list[Row]:
    time, position = s3()
    small = AlphaBetaTracker(BenedictBordner(0.01))
    wanted = {label: tracker for label, tracker in trackers().items() if label in METHODS[:3]}
    rows = []
    for label, tracker in (wanted | {_SMALL: small}).items():
        rmse = _rmse(tracker.run(time, position).predicted - position)
        for axis, ours in zip(_AXES, rmse, strict=True):
            rows.append(row("S3", f"{label}: {axis}, no noise (m)", float(ours)))
    return rows


def _error_rows(errors: dict[str, dict[str, Array]], runs: int) -> list[Row]:
    rows = []
    for noise, found in errors.items():
        table, printed = _TABLES[noise]
        published = averages(printed)
        for label, error in found.items():
            rmse = _rmse(error)
            for number, axis in enumerate(_AXES):
                values = rmse[:, number]
                se = float(values.std(ddof=1) / math.sqrt(runs)) if runs > 1 else None
                said = float(published[label, axis]) if label in METHODS else None
                rows.append(
                    row(table, f"{label}: {axis}, {noise} (m)", float(values.mean()),
                        published=said, within=_MADE * (said or 0.0), se=se, runs=runs,
                        why=_why(label, axis))
                )  # fmt: skip
    return rows


def _why(label: str, axis: str) -> str:
    if label not in METHODS:
        return ""
    if (label, axis) == ("M4", "X"):
        return "in S3 the target maneuvers late in X, and the window is full soon after: M4 follows"
    return (
        "published is the average of five experiments; our scenario is made after these averages, "
        f"so {_MADE:.0%} of them are allowed"
    )


# -------------------------------------------------------------------- pictures

# The scenarios have the paper's spelling.
_NOISES = {"white": "white", "coloured": "colored"}
_DRAWN = ("M1", "M4", "M5", _SOFT)


def _pictures(errors: dict[str, dict[str, Array]]) -> dict[str, Draw]:
    return {
        "fig7-white": _methods("white", errors["white"]),
        "fig8-coloured": _methods("coloured", errors["coloured"]),
        "error-x": _over_time("X", errors["white"]),
        "error-y": _over_time("Y", errors["white"]),
    }


def _methods(noise: str, errors: dict[str, Array]) -> Draw:
    """Drawing of the RMSE of the five methods, ours and the paper's."""
    published = averages(_TABLES[noise][1])
    curves = {}
    for number, axis in enumerate(_AXES):
        curves[f"{axis}, published"] = [float(published[method, axis]) for method in METHODS]
        curves[f"{axis}, S3"] = [float(_rmse(errors[m])[:, number].mean()) for m in METHODS]

    def draw() -> Figure:
        from fuzzytrack.plotting.comparison import plot_comparison

        figure, axes = plot_comparison(curves, categories=METHODS, what="average RMSE")
        axes.set_title(f"{_NOISES[noise]} noise")
        return figure

    return draw


def _over_time(axis: str, errors: dict[str, Array]) -> Draw:
    """Drawing of the root mean square over runs, from the fourth scan on."""
    number = _AXES.index(axis)
    time = s3()[0][3:]
    curves = {label: np.sqrt((errors[label][3:, :, number] ** 2).mean(axis=1)) for label in _DRAWN}

    def draw() -> Figure:
        from fuzzytrack.plotting.curves import plot_curves

        return plot_curves(
            time, curves, xlabel="time (s)", ylabel=f"RMSE in {axis} (m)", ylog=True,
            title="white noise",
        )[0]  # fmt: skip

    return draw
