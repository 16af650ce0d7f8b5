"""Llinas et al. (1998): noise ratios, the region of the fuzzy gains, and operation counts."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from fuzzytrack.fuzzy.loading import load_rulebase
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.gains.performance import NoisyOutput, noise_ratio
from fuzzytrack.gains.wdomain import alpha_beta_from_w, w_from_alpha_beta
from fuzzytrack.papers.llinas import programs
from fuzzytrack.papers.llinas.columns import Columns, columns
from fuzzytrack.papers.llinas.sampling import PUBLISHED, second_differences_filtered
from fuzzytrack.papers.reproduction import Row, row
from fuzzytrack.testbed.operations import count_operations, count_program
from fuzzytrack.trackers.catalog import make_tracker

__all__ = ["map_rows", "noise_rows", "operation_rows", "region_rows", "rule_bases"]


# -------------------------------------------------------------------- Table 2.4

_ALPHA, _BETA = 0.5, 0.7
_STEPS, _SETTLED = 200, 60


def noise_rows(runs: int, seed: int) -> list[Row]:
    """Table 2.4: three closed forms, and a simulation."""
    outputs: dict[NoisyOutput, tuple[str, float]] = {
        "predicted": ("prediction (Eq. 2.69)", 1.9565),
        "interval": ("mean over the interval (Sklansky)", 1.2058),
        "filtered": ("filtered position (Benedict & Bordner)", 0.7391),
    }
    rows = [
        row("Table 2.4", f"variance ratio of the {name}", float(noise_ratio(_ALPHA, _BETA, of=of)),
            published=number, within=5e-5, why=_THREE)
        for of, (name, number) in outputs.items()
    ]  # fmt: skip
    noise = np.random.default_rng(seed).normal(size=(_STEPS, runs))
    # Plots of a target at rest are noise, so plot minus innovation is the error of the prediction.
    predicted = noise[2:] - second_differences_filtered(_ALPHA, _BETA, noise)
    each = (predicted[_SETTLED:] ** 2).mean(axis=0)
    se = float(each.std(ddof=1) / np.sqrt(runs)) if runs > 1 else None
    simulated = row("Table 2.4", "variance ratio of the prediction, simulated", float(each.mean()),
                    published=1.9540, within=0.02, se=se, runs=runs, why=_LENGTH)  # fmt: skip
    return [rows[0], simulated, *rows[1:]]


_THREE = "three different quantities: each value is right for its own"
_LENGTH = "the length of the report's simulation is not stated; 1 % is allowed for it"


# -------------------------------------------------------------------- region of the gains


def map_rows() -> list[Row]:
    """The published fixed gains as frequency and damping, which Table 5.1 encloses."""
    omega, zeta = map(float, w_from_alpha_beta(*PUBLISHED))
    why = "the middle of the limits of Table 5.1 is 0.3 and 0.715"
    return [
        row("Sec. 5.1", "stiffness ω₀ of α = 0.5377, β = 0.2018", omega, why=why),
        row("Sec. 5.1", "damping ζ of α = 0.5377, β = 0.2018", zeta, why=why),
    ]


def rule_bases() -> dict[str, RuleBase]:
    """Rule bases of Tables 5.1 and 5.2, by table and defuzzification."""
    wide = load_rulebase("stiffness-damping-wide")
    centroid = replace(wide.operators, defuzzification="centroid")
    return {
        "Table 5.1, center of gravity": load_rulebase("stiffness-damping-cog"),
        "Table 5.1, weighted centers": load_rulebase("stiffness-damping"),
        "Table 5.2, center of gravity": replace(wide, operators=centroid),
        "Table 5.2, weighted centers": wide,
    }


def region_rows() -> list[Row]:
    """Tables 5.1 and 5.2: gains that the rules reach within their limits, on the grid of inputs."""
    return [found for name, rules in rule_bases().items() for found in _reached(name, rules)]


def _reached(name: str, rules: RuleBase) -> Iterator[Row]:
    table, engine = name.split(", ")
    grids = np.meshgrid(*(v.universe.values for v in rules.inputs), indexing="ij")
    points = np.stack([grid.ravel() for grid in grids], axis=1)
    # On grid points this equals the report's relational matrix.
    outputs = FuzzySystem(rules).evaluate(np.concatenate([points, np.zeros((1, 2))]))
    outputs["α"], outputs["β"] = alpha_beta_from_w(outputs["stiffness"], outputs["damping"])
    why = _HALF if engine == "center of gravity" else ""
    for output in ("stiffness", "damping", "α", "β"):
        grid = outputs[output][:-1]
        limits: tuple[float | None, float | None] = (None, None)
        if output in rules.output_names:
            universe = rules.output(output).universe
            limits = universe.low, universe.high
        for end, value, limit in zip(
            ("least", "largest"), (grid.min(), grid.max()), limits, strict=True
        ):
            yield row(table, f"{engine}: {end} {output}", float(value), published=limit,
                      within=1e-9, why=why if limit is not None else "")  # fmt: skip
    for output in ("α", "β"):
        yield row(table, f"{engine}: {output} at E = ΔE = 0", float(outputs[output][-1]))


_HALF = (
    "the limits are those of the universe; the outer sets are half triangles, whose center of "
    "gravity lies a tenth of the range inside"
)


# -------------------------------------------------------------------- Table 5.7

_SCANS, _PERIOD, _SIGMA, _SIGMA_V = 20, 60.0, 115.0, 0.0447


def operation_rows() -> list[Row]:
    """Table 5.7: operations of the report's equations, and of this package's kernels."""
    plots, truth = _plots()
    rules = load_rulebase("stiffness-damping-cog")
    table = columns(rules)
    chan = FuzzySystem(load_rulebase("chan-style"))

    def counted(program: Callable[..., Any], *arguments: Any, **options: Any) -> int:
        return count_program(program, plots, truth, _PERIOD, *arguments, **options)[0]

    def gains(magnitudes: tuple[float, float]) -> tuple[float, ...]:
        values = chan.evaluate(np.array([magnitudes]))
        return float(values["alpha"][0]), float(values["beta"][0])

    said = partial(row, "Table 5.7")
    matrix = counted(programs.kalman_matrix, _SIGMA, _SIGMA_V)
    joseph = counted(programs.kalman_matrix, _SIGMA, _SIGMA_V, joseph=True)
    scalar = counted(programs.kalman_scalar, _SIGMA, _SIGMA_V)
    weighted = counted(programs.proposed, _normalized(table), weighted_sum=True)
    return [
        said("tracker 1, fixed α-β (operations)", counted(programs.alpha_beta, *PUBLISHED),
             published=470, within=2, why=_START),
        said("tracker 2, fixed α-β-γ (operations)",
             counted(programs.alpha_beta_gamma, 0.75, 0.24, 0.005),
             published=974, within=2, why=_START),
        said("tracker 3, Chan-style without its rules (operations)",
             counted(programs.chan, gains), published=941, why=_CHAN),
        said("tracker 4, proposed, center of gravity (operations)",
             counted(programs.proposed, table), published=2287, why=_PROPOSED),
        said("tracker 4, proposed, weighted sum (operations)", weighted,
             published=2287, why=_PROPOSED),
        said("tracker 5, Kalman in matrices (operations)", matrix, published=8282, why=_KALMAN),
        said("tracker 5, Kalman in matrices, Joseph form (operations)", joseph,
             published=8282, why=_KALMAN),
        said("tracker 5, Kalman written out (operations)", scalar, published=8282, why=_KALMAN),
        said("published Kalman over Kalman written out", 8282 / scalar),
        *_kernel_rows(),
    ]  # fmt: skip


def _kernel_rows() -> list[Row]:
    specs = {
        "fixed α-β": f"fixed:alpha={PUBLISHED[0]}:beta={PUBLISHED[1]}",
        "proposed": "stiffness-damping",
        "Kalman": f"kalman-cv:sigma_v={_SIGMA_V}",
    }
    rows = []
    for name, spec in specs.items():
        per_update = count_operations(make_tracker(spec)).scheduler_per_update  # type: ignore[arg-type]
        quantity = f"gains of {name} in this package, an update of an axis (operations)"
        rows.append(row("Table 5.7", quantity, per_update))
    return rows


def _normalized(table: Columns) -> Columns:
    """Levels that add up to 1 in every cell, as Eq. 3.13 takes them."""
    levels = (np.array(output) for output in table.levels)
    return replace(
        table, levels=tuple((a / a.sum(axis=-1, keepdims=True)).tolist() for a in levels)
    )


def _plots() -> tuple[list[list[float]], list[list[float]]]:
    """A noisy straight track of 20 scans."""
    truth = np.outer(np.arange(_SCANS), [300.0, 180.0])
    noise = _SIGMA * np.random.default_rng(1).normal(size=truth.shape)
    return (truth + noise).tolist(), truth.tolist()


_START = "one start of an axis (2) is not in the report's count"
_CHAN = (
    "the report leaves its toolbox's rules out, too; how its program normalizes and takes "
    "magnitudes is not printed"
)
_PROPOSED = (
    "the report counts 54 for a fuzzy evaluation; from which grid and which form of the center is "
    "not printed"
)
_KALMAN = (
    "the report's factor of 18 over the fixed filter is its way to write matrices: written out in "
    "scalars the same filter takes about twice the fixed one's"
)
