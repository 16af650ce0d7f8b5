"""Gains from a rule base: the fuzzy engine and the theory of gains together."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import count
from typing import Any, ClassVar

import numpy as np

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.coverage import find_hole
from fuzzytrack.fuzzy.kernel import infer_function
from fuzzytrack.fuzzy.loading import as_rulebase
from fuzzytrack.fuzzy.ramps import find_ramps
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.normalizations import Normalization
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory, schedulers
from fuzzytrack.schedulers.converter import Converter, seen_by
from fuzzytrack.schedulers.gain_outputs import ConvertedOutputs
from fuzzytrack.schedulers.growing_memory import least_squares_gains
from fuzzytrack.schedulers.maneuver_covariance import AXES
from fuzzytrack.schedulers.settings import SchedulerSettings, check_period, read_settings

__all__ = ["FuzzyScheduler"]

_REMEDY = "a tracker needs a gain everywhere: add a rule, or give the output a default"


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
        ζ² = 1/2 + ω₀²/4); or ``alpha``, ``beta`` and maybe ``gamma`` (the gains themselves); or
        ``noise`` and ``retention`` of a maneuver, for a covariance from which the gains follow. Its
        scheduler settings name which: ``gains: w-domain``, ``kalata``, ``direct`` or
        ``covariance``. They also name the ``normalization`` that makes its inputs, with the numbers
        that these take (``rho: 0.8``). With ``opening: growing-memory`` a new track has the gains
        of a line fitted to all its plots, as long as their α is larger than that of the rules.
    method : {"exact", "relation", "table"}
        As for `fuzzytrack.fuzzy.system.FuzzySystem`.
    period : float, optional
        Sampling time to which the gains of the rules belong (s); the setting ``period`` of the rule
        base unless given. At other time steps the tracker uses the gains of the same filter in
        continuous time, see `fuzzytrack.gains.resampled_gains`. With neither, the gains are
        the same whatever the time step. An opening is not converted.
    level : float, optional
        Strongest maneuver expected (m/s²), > 0; of ``gains: covariance`` only, as are those below.
        Without it the noise and the intervals of the plots say what is strong.
    velocity_sigma : float, optional
        Standard deviation of the velocity of a new track (m/s), > 0, about 0: for the tracker's
        start ``one-point``, and with a `level`. Without it, velocity comes from the first two
        plots.
    axes : {"shared", "own"}
        One covariance for all axes of a track, with the mean variance of a plot; or one for each
        axis, for plots whose noise differs much between axes.

    Raises
    ------
    RuleBaseError
        If there is no such rule base; if a setting is missing or unknown, outputs and settings do
        not fit, there are more inputs than signals, or the outputs reach unstable gains. With a
        period also if it is not positive, or the outputs give γ or reach a negative real pole.
    TypeError
        If `rules` is something else.
    ValueError
        If the method cannot be used with the rule base, a parameter is out of range, or the rule
        base does not use it.

    Notes
    -----
    Llinas et al. (1998), chapter 3; with a coupled normalization, Chan's scheme. The memory is that
    of the normalization and that of the conversion to gains; with an opening, the number of plots
    stands before it.
    """

    source: ClassVar[str] = "Llinas et al. (1998), chapter 3"

    rules: RuleBase
    method: str = "exact"
    period: float | None = None
    level: float | None = None
    velocity_sigma: float | None = None
    axes: str = "shared"
    settings: SchedulerSettings = field(init=False, repr=False, compare=False)

    def __init__(
        self,
        rules: RuleBase | str | os.PathLike[str],
        method: str = "exact",
        period: float | None = None,
        level: float | None = None,
        velocity_sigma: float | None = None,
        axes: str = "shared",
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
        for name, value in (("level", level), ("velocity_sigma", velocity_sigma), ("axes", axes)):
            object.__setattr__(self, name, value)
        # Made here with the inference, since not every rule base can be compiled.
        _ = self.converter

    @cached_property
    def converter(self) -> Converter:
        """The outputs' conversion to gains, with the numbers and parameters that it takes."""
        outputs = self.settings.outputs
        options = ("period", "level", "velocity_sigma")
        given = {name: getattr(self, name) for name in options}
        given = {name: value for name, value in given.items() if value is not None}
        if self.axes != AXES[0]:
            given["axes"] = self.axes
        for name in given:
            if name not in outputs.parameters:
                raise ValueError(
                    f"{name}: {self.rules.name} does not use it; it is for rule bases with "
                    f"gains: covariance, and this one has gains: {outputs.setting}"
                )
        quiet = self.inference((0.0,) * len(self.rules.inputs))
        return outputs.converter(self.rules.output_names, quiet, **self.settings.numbers, **given)

    def __getstate__(self) -> dict[str, Any]:
        # Tables are large, and all are quickly made again where they are needed.
        made = ("system", "inference", "converter")
        return {key: value for key, value in vars(self).items() if key not in made}

    @property
    def normalization(self) -> Normalization:
        """Normalization that makes the inputs of the rule base."""
        return self.settings.normalization

    @property
    def outputs(self) -> ConvertedOutputs:
        """Conversion of its outputs to gains."""
        return self.settings.outputs

    @property
    def coupled(self) -> bool:  # type: ignore[override]
        """Whether all axes share one set of gains; from the normalization."""
        return self.normalization.coupled

    @property
    def own_gains(self) -> bool:  # type: ignore[override]
        """Whether each axis of a track has its own gains although they are coupled."""
        return self.coupled and self.converter.own_gains

    @property
    def needs_sigma(self) -> bool:  # type: ignore[override]
        """Whether plots need a standard deviation; from normalization and conversion."""
        return self.normalization.needs_sigma or self.converter.needs_sigma

    @property
    def sees_starts(self) -> bool:  # type: ignore[override]
        """Whether the first plots of a track are followed: for its parts, or to count plots."""
        return self.opens or self.normalization.sees_starts or self.converter.sees_starts

    @property
    def sees_misses(self) -> bool:  # type: ignore[override]
        """Whether missed plots are followed; from the normalization."""
        return self.normalization.sees_misses

    @property
    def variance_start(self) -> str | None:  # type: ignore[override]
        """Start after which the variance of a prediction holds; from normalization or conversion.

        Only one of them has a covariance.
        """
        return self.normalization.variance_start or self.converter.variance_start

    @property
    def uses_acceleration(self) -> bool:  # type: ignore[override]
        """Whether γ can be other than 0."""
        return self.outputs.uses_acceleration

    @property
    def uses_retention(self) -> bool:  # type: ignore[override]
        """Whether the acceleration fades; from the conversion."""
        return self.converter.uses_retention

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
        """Memory of the normalization and of the conversion; with an opening, after the count."""
        own = self.normalization.initial_memory(n_axes), self.converter.initial_memory(n_axes)
        return (*((0.0,) if self.opens else ()), *own[0], *own[1])

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of a predicted position; see `GainScheduler.prediction_variance`."""
        if not self.outputs.has_covariance:
            own = memory[1:] if self.opens else memory
            return self.normalization.prediction_variance(own, dt)
        n_axes = next(n for n in count(1) if len(self.initial_memory(n)) == len(memory))
        kept = memory[len(self.normalization.initial_memory(n_axes)) :]
        return self.converter.prediction_variance(kept, dt)

    def kernel(self, n_axes: int) -> Kernel:
        """Normalize, infer, convert to gains; see `GainScheduler.kernel`."""
        return self._opening_kernel(n_axes) if self.opens else self._kernel(n_axes)

    def _kernel(self, n_axes: int) -> Kernel:
        normalize = self._normalize(n_axes)
        infer = self.inference
        expect = self.converter.expect(n_axes, self.coupled)
        convert = self.converter.convert(n_axes, self.coupled)
        feedback = self.normalization.feedback(n_axes) or _unchanged
        n_own = len(self.normalization.initial_memory(n_axes))
        is_seen = seen_by(self.coupled)
        # Only a conversion that follows all steps brings a normalization to a missed plot.
        follows = self.normalization.sees_starts or self.normalization.sees_misses
        always = follows or not self.converter.sees_starts

        def schedule(
            innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
        ) -> tuple[Any, Any, Any, float, Memory]:
            before = memory[:n_own]
            time, variance, kept = expect(dt, sigma, memory[n_own:])
            signals, own = normalize(innovation, change, dt, sigma, time, variance, before)
            alpha, beta, gamma, retention, kept = convert(infer(signals), dt, sigma, kept)
            own = feedback(own, alpha, beta, gamma, dt, sigma)
            own = own if is_seen(sigma) | always else before
            return alpha, beta, gamma, retention, (*own, *kept)

        return schedule

    def _normalize(self, n_axes: int) -> Callable[..., tuple[tuple[float, ...], Memory]]:
        """Kernel of the normalization, called with the numbers that it reads."""
        normalize = self.normalization.kernel(n_axes)
        if self.normalization.uses_expectation:

            def expected(
                innovation: Any, change: Any, dt: float, sigma: Any,
                time: float, variance: Any, memory: Memory,
            ) -> tuple[tuple[float, ...], Memory]:  # fmt: skip
                return normalize(innovation, change, time, variance, memory)

            return expected

        def given(
            innovation: Any, change: Any, dt: float, sigma: Any,
            time: float, variance: Any, memory: Memory,
        ) -> tuple[tuple[float, ...], Memory]:  # fmt: skip
            return normalize(innovation, change, dt, sigma, memory)

        return given

    def _opening_kernel(self, n_axes: int) -> Kernel:
        normalize = self.normalization.kernel(n_axes)
        infer = self.inference
        convert = self.converter.convert(n_axes, self.coupled)
        feedback = self.normalization.feedback(n_axes) or _unchanged
        is_seen = seen_by(self.coupled)
        every_step = self.normalization.sees_starts or self.normalization.sees_misses

        def open_and_schedule(
            innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            seen = is_seen(sigma)
            plots = memory[0] + 1.0 if seen else memory[0]
            before = memory[1:]
            signals, own = normalize(innovation, change, dt, sigma, before)
            alpha, beta, gamma, retention, _ = convert(infer(signals), dt, sigma, ())
            first_alpha, first_beta = least_squares_gains(plots if plots > 2.0 else 2.0)
            # α and β from the same source: those of different ones need not be stable together.
            opening = first_alpha > alpha
            alpha = first_alpha if opening else alpha
            beta = first_beta if opening else beta
            gamma = 0.0 if opening else gamma
            own = feedback(own, alpha, beta, gamma, dt, sigma)
            own = own if seen | every_step else before
            return alpha, beta, gamma, retention, (plots, *own)

        return open_and_schedule


def _unchanged(
    memory: Memory, alpha: float, beta: float, gamma: float, dt: float, sigma: Any
) -> Memory:
    return memory


def _check_range(rules: RuleBase) -> None:
    """Gains that a rule base can reach must not be unstable.

    Stiffness and damping only have to be nonnegative, noise and retention positive; α, β, γ are
    checked at the corners of the box of their universes, which holds every inferred value.
    """
    if "noise" in rules.output_names:
        for name in rules.output_names:
            least = rules.output(name).universe.low
            if least <= 0:
                raise RuleBaseError(
                    f"{name} must be > 0; its universe starts at {least:g}", rules.place(name)
                )
        return
    if "stiffness" in rules.output_names:
        for name in rules.output_names:
            least = rules.output(name).universe.low
            if least < 0:
                raise RuleBaseError(
                    f"{name} must not be negative; its universe starts at {least:g}",
                    rules.place(name),
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
            "alpha >= 0, beta >= 0, 2 alpha + beta <= 4 and 0 <= gamma <= 4 alpha beta/(2 - alpha)",
            rules.place("alpha"),
        )


def _never_silent(rules: RuleBase, system: FuzzySystem) -> None:
    """Raise RuleBaseError if there are inputs at which no rule fires, where gains would be NaN."""
    # Grades add up to 1 everywhere and every combination of sets has a rule: one always fires.
    if system.method == "exact" and find_ramps(rules) is not None:
        return
    place = rules.place(rules.input_names[0])
    # Single points, too, which no grid need meet; but a table has values at its nodes only, and a
    # relation at the points of the universes.
    if system.method == "exact":
        for output in rules.outputs:
            hole = find_hole(rules, output.name) if output.default is None else None
            if hole is not None and hole.stretches:
                raise RuleBaseError(f"{rules.name}: {hole}; {_REMEDY}", place)
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
                f"{rules.name}: no rule about {name} fires at {where}; {_REMEDY}", place
            )
