"""Facts about a rule base: its outputs, gains and symmetry over a grid of the inputs."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.as_json import rule_as_json
from fuzzytrack.fuzzy.coverage import Hole, find_hole
from fuzzytrack.fuzzy.loading import as_rulebase
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.fuzzy.table import build_table
from fuzzytrack.reprs import summary
from fuzzytrack.schedulers.fuzzy import FuzzyScheduler
from fuzzytrack.schedulers.gain_outputs import gains_of
from fuzzytrack.tasks import Progress

__all__ = ["Review", "explanation", "grid_table", "review"]

# Points of the grid on which a rule base is evaluated, over all inputs.
_POINTS = 10_201
_MAX_CELLS = 1_000_000
_TABLE_INPUTS = 2
# Largest difference that counts as none, relative to the largest value.
_EQUAL = 1e-9


@dataclass(frozen=True)
class Review:
    """Facts about a rule base, found on a grid over its inputs.

    Attributes
    ----------
    rules : RuleBase
        The rule base.
    written : tuple of int or None
        Combinations of sets with a rule, and all of them; None where they are too many to count.
    silent : float
        Share of the grid on which no rule fires.
    holes : tuple of Hole
        For each output about which no rule fires at some inputs, such inputs: they may be a single
        point, on which no grid need have a point.
    ranges : dict of str to (float, float)
        What each output reaches, its default included where no rule fires, and α and β where they
        follow from the outputs.
    symmetry : str
        How the outputs change when all inputs change sign.
    table_bounds : dict of str to float
        Error bounds of the interpolation table; empty with more than two inputs.
    schedules : str
        How the rule base schedules gains; empty if it does not.
    """

    rules: RuleBase
    written: tuple[int, int] | None
    silent: float
    holes: tuple[Hole, ...]
    ranges: dict[str, tuple[float, float]]
    symmetry: str
    table_bounds: dict[str, float]
    schedules: str

    def __repr__(self) -> str:
        return summary(self, "rules", "schedules")

    @property
    def mistakes(self) -> tuple[RuleBaseError, ...]:
        """For each output that is NaN at some inputs an error that says where, and the remedy."""
        return tuple(
            RuleBaseError(
                f"{hole}; add a rule, or give {hole.output} a default",
                self.rules.place(hole.output),
            )
            for hole in self.holes
            if hole.stretches and self.rules.output(hole.output).default is None
        )

    def as_json(self) -> dict[str, Any]:
        """Review as JSON prints it."""
        return {
            "name": self.rules.name,
            "inputs": {v.name: len(v.sets) for v in self.rules.inputs},
            "outputs": {v.name: len(v.sets) for v in self.rules.outputs},
            "rules": len(self.rules.rules),
            "combinations_with_a_rule": self.written and self.written[0],
            "combinations": self.written and self.written[1],
            "silent": self.silent,
            "holes": {
                hole.output: {"text": str(hole), "underflow": hole.underflow}
                | {name: [low, high] for name, low, high in hole.stretches}
                for hole in self.holes
            },
            "ranges": self.ranges,
            "symmetry": self.symmetry,
            "table_bounds": self.table_bounds,
            "schedules": self.schedules,
        }


def explanation(system: FuzzySystem, point: dict[str, float]) -> dict[str, Any]:
    """Rules that fire at a point, outputs there, and gains behind them, as JSON prints it.

    Parameters
    ----------
    system : FuzzySystem
    point : dict of str to float
        A value for each input.
    """
    values = system.evaluate(np.array([[point[name] for name in system.rules.input_names]]))
    return {
        "rulebase": system.rules.name,
        "method": system.method,
        "at": point,
        "rules": [
            {"number": f.number, "strength": f.strength, **rule_as_json(f.rule)}
            for f in system.explain(**point)
        ],
        "outputs": {name: float(v[0]) for name, v in values.items()},
        "gains": {name: float(v[0]) for name, v in gains_of(values).items()},
    }


def grid_table(
    system: FuzzySystem, points: int, at: Mapping[str, float], *, corners: bool = False
) -> dict[str, Array]:
    """Inputs, outputs, and gains behind the outputs, over a grid of the first two inputs.

    Parameters
    ----------
    system : FuzzySystem
    points : int
        Points on each axis.
    at : mapping of str to float
        Values of the other inputs.
    corners : bool
        Whether the points include every corner of the sets.

    Returns
    -------
    dict of str to ndarray
        One column each, a row for every point of the grid.
    """
    rules = system.rules
    axes = [v.nodes(points, corners=corners) for v in rules.inputs[:2]]
    axes += [np.array([at[name]]) for name in rules.input_names[2:]]
    grid = np.stack([g.ravel() for g in np.meshgrid(*axes, indexing="ij")], axis=1)
    inputs = {name: grid[:, k] for k, name in enumerate(rules.input_names)}
    outputs = system.evaluate(grid)
    return inputs | outputs | gains_of(outputs)


def review(rules: RuleBase | str | os.PathLike[str], *, progress: Progress | None = None) -> Review:
    """Review a rule base.

    Parameters
    ----------
    rules : RuleBase, str or path
        A rule base, itself or as for `fuzzytrack.load_rulebase`.
    progress : callable, optional
        Called with the share that is done of the longest part, the error of a table.

    Raises
    ------
    RuleBaseError, ValueError
        If there is no such rule base, or it has scheduler settings, but cannot schedule gains.
    """
    rules = as_rulebase(rules)
    settings = dict(rules.scheduler)
    if settings:
        FuzzyScheduler(rules)
    system = FuzzySystem(rules)
    grid = _grid(rules)
    values = system.evaluate(grid)
    found = (find_hole(rules, name) for name in values)
    holes = tuple(hole for hole in found if hole is not None)
    # A point in each hole, where the output is its default.
    silent = [hole.point for hole in holes if hole.stretches]
    reached = system.evaluate(np.concatenate([grid, silent])) if silent else values
    return Review(
        rules=rules,
        written=_written(rules),
        silent=float(system.is_silent(grid).mean()),
        holes=holes,
        ranges={name: _ends(v) for name, v in {**reached, **gains_of(reached)}.items()},
        symmetry=_symmetry(system, grid, values),
        table_bounds=_table_bounds(system, progress),
        schedules=", ".join(f"{key} {value}" for key, value in settings.items()),
    )


def _grid(rules: RuleBase) -> Array:
    """Regular grid over the inputs, its middle and ends included, shape (n, n_inputs)."""
    points = max(3, round(_POINTS ** (1 / len(rules.inputs))) // 2 * 2 + 1)
    points = min(points, 1001)
    while points > 3 and points ** len(rules.inputs) > 2 * _POINTS:
        points -= 2
    axes = [np.linspace(v.universe.low, v.universe.high, points) for v in rules.inputs]
    return np.stack([g.ravel() for g in np.meshgrid(*axes, indexing="ij")], axis=1)


def _written(rules: RuleBase) -> tuple[int, int] | None:
    shape = tuple(len(v.sets) for v in rules.inputs)
    # Python integers, which do not overflow
    cells = 1
    for count in shape:
        cells *= count
    if cells > _MAX_CELLS:
        return None
    has = np.zeros(shape, dtype=bool)
    for rule in rules.rules:
        for conditions in map(dict, rule.groups):
            has[
                tuple(
                    v.index(conditions[v.name]) if v.name in conditions else slice(None)
                    for v in rules.inputs
                )
            ] = True
    return int(has.sum()), cells


def _ends(values: Array) -> tuple[float, float]:
    known = values[~np.isnan(values)]
    return (float(known.min()), float(known.max())) if known.size else (np.nan, np.nan)


def _symmetry(system: FuzzySystem, grid: Array, values: dict[str, Array]) -> str:
    rules = system.rules
    if any(v.universe.low != -v.universe.high for v in rules.inputs):
        return "not compared: the inputs do not reach as far below 0 as above"
    found = {name: _parity(v, system.evaluate(-grid)[name]) for name, v in values.items()}
    if len(set(found.values())) == 1:
        return next(iter(found.values()))
    return "; ".join(f"{name}: {what}" for name, what in found.items())


def _parity(values: Array, mirrored: Array) -> str:
    if not np.array_equal(np.isnan(values), np.isnan(mirrored)):
        return "not symmetric"
    scale = _EQUAL * float(np.nanmax(np.abs(values), initial=0.0))
    apart = float(np.nanmax(np.abs(values - mirrored), initial=0.0))
    if apart <= scale:
        return "symmetric: the outputs stay when all inputs change sign"
    if float(np.nanmax(np.abs(values + mirrored), initial=0.0)) <= scale:
        return "symmetric: the outputs change sign with the inputs"
    return f"not symmetric: an output changes by up to {apart:.2g} with the inputs' signs"


def _table_bounds(system: FuzzySystem, progress: Progress | None) -> dict[str, float]:
    # With more inputs the error of a table takes long to measure, and tables are little used.
    if len(system.rules.inputs) > _TABLE_INPUTS:
        return {}
    return build_table(system.rules, system.evaluate, system.table_nodes, progress).bounds
