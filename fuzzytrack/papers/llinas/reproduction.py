"""The experiments of the report together: all rows, the notes and the pictures."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.papers.llinas import field, sampling, theory
from fuzzytrack.papers.reproduction import Reproduction
from fuzzytrack.simulation.published import MANEUVERS
from fuzzytrack.tasks import Progress, part
from fuzzytrack.testbed.results import Results
from fuzzytrack.trackers.state import Gains

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["RUNS", "reproduce"]

Draw = Callable[[], "Figure"]

RUNS = 2000


def reproduce(runs: int, seed: int, progress: Progress) -> Reproduction:
    """Rebuild Tables 2.4 and 5.1 to 5.7, Figs. 5.1 to 5.3 and A.1; see `fuzzytrack.papers`."""
    dense = field.dense(runs, seed, part(progress, 0.0, 0.4))
    finer = field.finer_rows(runs, seed, dense["M4"], part(progress, 0.4, 0.45))
    far = field.far_rows(runs, seed, part(progress, 0.45, 0.65))
    check = field.isotropic_rows(runs, seed)
    progress(0.7)
    visited = field.visited_gains(runs, seed)
    progress(0.8)
    rows = (
        *theory.noise_rows(runs, seed),
        *theory.map_rows(),
        *sampling.origin_rows(),
        *theory.region_rows(),
        *field.visited_rows(visited, runs),
        *field.table_rows(dense),
        *check,
        *finer,
        *far,
        *theory.operation_rows(),
        *sampling.sampling_rows(),
        *sampling.appendix_rows(),
    )
    progress(1.0)
    return Reproduction(
        paper="llinas",
        title="Llinas, Singh, Chen & Tenne (1998): fuzzy α-β tracker in a field of sensors",
        rows=rows,
        notes=_NOTES,
        pictures=_pictures(dense, visited),
    )


_NOTES = (
    "Starts, courses, speeds, acceleration and radius of the maneuvers are not printed; ours are "
    "a fit to Table 5.3, about 20 numbers for its 40. Two results do not depend on the fit: which "
    "tracker is better in which maneuver, and that trackers 1 and 4 are equal.",
    "A published mean or variance matches if it is within two standard errors of an average over "
    "50 runs, the report's number, taken from the spread of our runs, and two of our own.",
    "Noise is read as a range variance of 200 m² and a bearing variance of 3π/180 rad²: no other "
    "reading of 200 [m] and 3 [deg] gives the level of tracker 1 in maneuver 1.",
    "Errors are distances between prediction and truth from the third scan on, coasted scans "
    "included. The 253 m that section 5.1 calls an RMS error is the mean of Table 5.3.",
    "The proposed tracker and the fixed one differ by less than a standard error of 50 runs; the "
    "claim that it mostly improves the fixed one is not confirmed.",
    "The fixed gains are the best for a straight line of 18 scans, not for an endless one. On "
    "maneuvering targets they are slow.",
    "Gains should follow the sampling time as ω₀ ~ T^0.6 to T^0.8 rather than T.",
)


# -------------------------------------------------------------------- pictures


def _pictures(dense: dict[str, Results], visited: dict[str, Gains]) -> dict[str, Draw]:
    rules = theory.rule_bases()
    regions = {
        f"{figure}-gains": _region(table, visited[table], rules[f"{table}, center of gravity"])
        for figure, table in (("fig5-2", "Table 5.1"), ("fig5-3", "Table 5.2"))
    }
    errors = {f"error-{name.lower()}": _errors(results) for name, results in dense.items()}
    return {"fig5-1-track": _track(dense["M4"])} | regions | errors | {"figa-1-noise": _noise}


def _track(results: Results) -> Draw:
    def draw() -> Figure:
        from fuzzytrack.plotting.experiments import plot_trajectories

        sample = results.sample
        predicted = {field.T4: sample.predicted[results.names.index(field.T4)]}
        return plot_trajectories(results.time, sample.truth, sample.plots, predicted)[0]

    return draw


def _region(table: str, gains: Gains, rules: RuleBase) -> Draw:
    def draw() -> Figure:
        from fuzzytrack.plotting.gain_plane import plot_gain_plane

        mark = {"α = 0.5377, β = 0.2018": sampling.PUBLISHED}
        return plot_gain_plane({f"gains visited, {table}": gains}, rules, mark=mark)[0]

    return draw


def _errors(results: Results) -> Draw:
    def draw() -> Figure:
        from fuzzytrack.plotting.experiments import plot_error_over_time

        curves = dict(zip(results.names, results.rmse_per_scan(), strict=True))
        figure, axes = plot_error_over_time(results.time, curves)
        axes.set_title(f"{results.scenario}, dense field")
        return figure

    return draw


def _noise() -> Figure:
    from fuzzytrack.plotting.curves import plot_curves

    noises = np.array(sampling.PROCESS_NOISES[1:])
    curves = {name: sampling.process_noise_errors(name)[1:] for name in MANEUVERS}
    return plot_curves(
        noises, curves, xlabel="process noise q ((m/s²)²)", ylabel="mean prediction error (m)",
        xlog=True,
    )[0]  # fmt: skip
