"""Gains from a rule base: the fuzzy engine and the theory of gains together."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.kernel import infer_function
from fuzzytrack.fuzzy.loading import as_rulebase
from fuzzytrack.fuzzy.ramps import find_ramps
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.gains.period import pair_after, pair_rates
from fuzzytrack.normalizations import Normalization
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory, schedulers
from fuzzytrack.schedulers.gain_outputs import Conversion, GainOutputs
from fuzzytrack.schedulers.growing_memory import least_squares_gains
from fuzzytrack.schedulers.settings import SchedulerSettings, check_period, read_settings

__all__ = ["FuzzyScheduler"]


@schedulers.register("fuzzy")
@dataclass(frozen=True, repr=False)
class FuzzyScheduler(GainScheduler):
    """Schedules gains by a rule base.

    Parameters
    ----------
    rules : RuleBase, str or path
        A rule base; or the name of a shipped one or the path of a file, as for
        `fuzzytrack.load_rulebase`. Its outputs are ``stiffness`` and ``damping`` (gains through the
        w-domain, always stable); or ``stiffness`` alone (damping on Kalata's curve,
        ζ² = 1/2 + ω₀²/4); or ``alpha``, ``beta`` and maybe ``gamma`` (the gains themselves). Its
        scheduler settings name which: ``gains: w-domain``, ``kalata`` or ``direct``. They also name
        the ``normalization`` that makes its inputs, with the numbers that this takes
        (``rho: 0.8``). With ``opening: growing-memory`` a new track has the gains of a line fitted
        to all its plots, as long as their α is larger than that of the rules.
    method : {"exact", "relation", "table"}
        As for `fuzzytrack.fuzzy.system.FuzzySystem`.
    period : float, optional
        Sampling time to which the gains of the rules belong (s); the setting ``period`` of the rule
        base unless given. At other time steps the tracker uses the gains of the same filter in
        continuous time, see `fuzzytrack.gains.resampled_gains`. With neither, the gains are
        the same whatever the time step. An opening is not converted.

    Raises
    ------
    RuleBaseError
        If there is no such rule base; if a setting is missing or unknown, outputs and settings do
        not fit, there are more inputs than signals, or the outputs reach unstable gains. With a
        period also if it is not positive, or the outputs give γ or reach a negative real pole.
    TypeError
        If `rules` is something else.
    ValueError
        If the method cannot be used with the rule base.

    Notes
    -----
    Llinas et al. (1998), chapter 3; with a coupled normalization, Chan's scheme. The memory is that
    of the normalization; with an opening, the number of plots stands before it.
    """

    source: ClassVar[str] = "Llinas et al. (1998), chapter 3"

    rules: RuleBase
    method: str = "exact"
    period: float | None = None
    settings: SchedulerSettings = field(init=False, repr=False, compare=False)

    def __init__(
        self,
        rules: RuleBase | str | os.PathLike[str],
        method: str = "exact",
        period: float | None = None,
    ) -> None:
        rules = as_rulebase(rules)
        object.__setattr__(self, "rules", rules)
        object.__setattr__(self, "method", method)
        object.__setattr__(self, "settings", read_settings(rules))
        _check_range(self.rules)
        object.__setattr__(self, "period", self.settings.period)
        if period is not None:
            object.__setattr__(self, "period", float(period))
            check_period(rules, self.outputs, float(period))
        _never_silent(self.rules, self.system)
        # Made here, since not every rule base can be compiled.
        _ = self.inference

    def __getstate__(self) -> dict[str, Any]:
        # Tables are large, and both are quickly made again where they are needed.
        made = ("system", "inference")
        return {key: value for key, value in vars(self).items() if key not in made}

    @property
    def normalization(self) -> Normalization:
        """Normalization that makes the inputs of the rule base."""
        return self.settings.normalization

    @property
    def outputs(self) -> GainOutputs:
        """Conversion of its outputs to gains."""
        return self.settings.outputs

    @property
    def coupled(self) -> bool:  # type: ignore[override]
        """Whether all axes share one set of gains; from the normalization."""
        return self.normalization.coupled

    @property
    def needs_sigma(self) -> bool:  # type: ignore[override]
        """Whether plots need a standard deviation; from the normalization."""
        return self.normalization.needs_sigma

    @property
    def sees_starts(self) -> bool:  # type: ignore[override]
        """Whether the first plots of a track are followed: for the normalization, or to count."""
        return self.opens or self.normalization.sees_starts

    @property
    def sees_misses(self) -> bool:  # type: ignore[override]
        """Whether missed plots are followed; from the normalization."""
        return self.normalization.sees_misses

    @property
    def variance_start(self) -> str | None:  # type: ignore[override]
        """Start after which the variance of a prediction holds; from the normalization."""
        return self.normalization.variance_start

    @property
    def uses_acceleration(self) -> bool:  # type: ignore[override]
        """Whether the rule base gives γ."""
        return "gamma" in self.outputs.gain_names

    @property
    def opens(self) -> bool:
        """Whether a new track has the gains of a growing memory first."""
        return self.settings.opens

    @cached_property
    def system(self) -> FuzzySystem:
        """The fuzzy system behind the gains, to explain and draw."""
        return FuzzySystem(self.rules, self.method)

    @cached_property
    def inference(self) -> Callable[[tuple[float, ...]], tuple[float, ...]]:
        """The same as one scalar function, from the inputs to the outputs."""
        return infer_function(self.system)

    def initial_memory(self, n_axes: int) -> Memory:
        """Memory of the normalization; with an opening, after the number of plots."""
        own = self.normalization.initial_memory(n_axes)
        return (0.0, *own) if self.opens else own

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of a predicted position; see `GainScheduler.prediction_variance`."""
        own = memory[1:] if self.opens else memory
        return self.normalization.prediction_variance(own, dt)

    def kernel(self, n_axes: int) -> Kernel:
        """Normalize, infer, convert to gains; see `GainScheduler.kernel`."""
        normalize = self.normalization.kernel(n_axes)
        infer = self.inference
        to_gains = _at_time_step(self.outputs.conversion(self.rules.output_names), self.period)
        feedback = self.normalization.feedback(n_axes) or _unchanged

        def schedule(
            innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            signals, own = normalize(innovation, change, dt, sigma, memory)
            alpha, beta, gamma, retention = to_gains(infer(signals), dt)
            own = feedback(own, alpha, beta, gamma, dt, sigma)
            return alpha, beta, gamma, retention, own

        if not self.opens:
            return schedule

        is_seen = _is_seen_on_all_axes if self.coupled else _is_seen
        every_step = self.normalization.sees_starts or self.normalization.sees_misses

        def open_and_schedule(
            innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            seen = is_seen(sigma)
            count = memory[0] + 1.0 if seen else memory[0]
            before = memory[1:]
            signals, own = normalize(innovation, change, dt, sigma, before)
            alpha, beta, gamma, retention = to_gains(infer(signals), dt)
            first_alpha, first_beta = least_squares_gains(count if count > 2.0 else 2.0)
            # α and β from the same source: those of different ones need not be stable together.
            opening = first_alpha > alpha
            alpha = first_alpha if opening else alpha
            beta = first_beta if opening else beta
            gamma = 0.0 if opening else gamma
            own = feedback(own, alpha, beta, gamma, dt, sigma)
            own = own if seen | every_step else before
            return alpha, beta, gamma, retention, (count, *own)

        return open_and_schedule


def _at_time_step(
    to_gains: Conversion, period: float | None
) -> Callable[[tuple[float, ...], float], tuple[float, float, float, float]]:
    """Conversion of outputs to the gains at a time step, if they belong to a period."""
    if period is None:

        def at_any(outputs: tuple[float, ...], dt: float) -> tuple[float, float, float, float]:
            return to_gains(outputs)

        return at_any

    designed_at = period

    def at_time_step(outputs: tuple[float, ...], dt: float) -> tuple[float, float, float, float]:
        alpha, beta, gamma, retention = to_gains(outputs)
        new_alpha, new_beta = pair_after(pair_rates(alpha, beta), dt / designed_at)
        given = dt == designed_at
        return alpha if given else new_alpha, beta if given else new_beta, gamma, retention

    return at_time_step


def _unchanged(
    memory: Memory, alpha: float, beta: float, gamma: float, dt: float, sigma: Any
) -> Memory:
    return memory


def _is_seen(sigma: float) -> bool:
    return sigma != math.inf


def _is_seen_on_all_axes(sigma: tuple[float, ...]) -> bool:
    # A plot is seen on all axes or on none.
    return sigma[0] != math.inf


def _check_range(rules: RuleBase) -> None:
    """Gains that a rule base can reach must not be unstable.

    Stiffness and damping only have to be nonnegative; α, β, γ are checked at the corners of the
    box of their universes, which holds every inferred value.
    """
    if "stiffness" in rules.output_names:
        for name in rules.output_names:
            least = rules.output(name).universe.low
            if least < 0:
                raise RuleBaseError(
                    f"{name} must not be negative; its universe starts at {least:g}"
                )
        return
    low = {v.name: v.universe.low for v in rules.outputs}
    high = {v.name: v.universe.high for v in rules.outputs}
    gamma_low, gamma_high = low.get("gamma", 0.0), high.get("gamma", 0.0)
    # γ < 4αβ/(2 - α) is tightest at the lowest α and β
    stable = low["alpha"] >= 0 and low["beta"] >= 0 and 2 * high["alpha"] + high["beta"] <= 4
    stable = stable and gamma_low >= 0
    stable = stable and gamma_high * (2 - low["alpha"]) <= 4 * low["alpha"] * low["beta"]
    if not stable:
        raise RuleBaseError(
            f"{rules.name}: the universes of its outputs reach unstable gains; needed are "
            "alpha >= 0, beta >= 0, 2 alpha + beta <= 4 and 0 <= gamma <= 4 alpha beta/(2 - alpha)"
        )


def _never_silent(rules: RuleBase, system: FuzzySystem) -> None:
    """Raise RuleBaseError if there are inputs at which no rule fires, where gains would be NaN."""
    # Grades add up to 1 everywhere and every combination of sets has a rule: one always fires.
    if system.method == "exact" and find_ramps(rules) is not None:
        return
    axes = []
    for variable in rules.inputs:
        universe = variable.universe
        ends = [p for s in variable.sets for p in s.breakpoints()]
        inside = [p for p in ends if universe.low <= p <= universe.high]
        knots = np.unique([universe.low, universe.high, *universe.values[::10], *inside])
        axes.append(np.unique(np.concatenate([knots, (knots[1:] + knots[:-1]) / 2])))
    points = np.stack([g.ravel() for g in np.meshgrid(*axes, indexing="ij")], axis=1)
    for name, values in system.evaluate(points).items():
        empty = np.flatnonzero(np.isnan(values))
        if len(empty):
            where = ", ".join(
                f"{n}={x:g}" for n, x in zip(rules.input_names, points[empty[0]], strict=True)
            )
            raise RuleBaseError(
                f"{rules.name}: no rule about {name} fires at {where}; a tracker needs a gain "
                "everywhere: add a rule, or give the output a default"
            )
