"""Gains from a rule base: the one place where the fuzzy engine meets the theory of gains."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fuzzytrack.errors import Location, RuleBaseError
from fuzzytrack.fuzzy.kernel import infer_function
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.gains.wdomain import bilinear
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory, schedulers
from fuzzytrack.schedulers.normalization import Normalization, normalizations

__all__ = ["FuzzyScheduler"]

W_DOMAIN = ("stiffness", "damping")
DIRECT = (("alpha", "beta"), ("alpha", "beta", "gamma"))


@schedulers.register("fuzzy")
@dataclass(frozen=True)
class FuzzyScheduler(GainScheduler):
    """Schedules gains by a rule base.

    Parameters
    ----------
    rules : RuleBase
        Its outputs are ``stiffness`` and ``damping`` (gains through the w-domain, always stable),
        or ``alpha`` and ``beta``, or ``alpha``, ``beta`` and ``gamma`` (gains themselves). Its
        scheduler settings say ``gains: w-domain`` or ``gains: direct``, and which
        ``normalization`` feeds its inputs.
    method : {"exact", "relation", "table"}
        As for `fuzzytrack.fuzzy.system.FuzzySystem`.

    Raises
    ------
    RuleBaseError
        If a setting is missing or unknown, outputs and settings do not fit, there are more inputs
        than signals, or the outputs reach unstable gains.
    ValueError
        If the method cannot be used with the rule base.

    Notes
    -----
    Llinas et al. (1998), chapter 3; with a coupled normalisation, Chan's scheme.
    """

    source: ClassVar[str] = "Llinas et al. (1998), chapter 3"

    rules: RuleBase
    method: str = "exact"
    normalization: Normalization = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        settings = _settings(self.rules)
        object.__setattr__(self, "normalization", _normalization(self.rules, settings))
        _check_gains(self.rules, settings["gains"])
        _check_range(self.rules)
        _never_silent(self.rules, self.system)
        infer_function(self.system)

    @property
    def coupled(self) -> bool:  # type: ignore[override]
        """Whether one set of gains serves all axes, as the normalisation says."""
        return self.normalization.coupled

    @property
    def needs_sigma(self) -> bool:  # type: ignore[override]
        """Whether plots need a standard deviation, as the normalisation says."""
        return self.normalization.needs_sigma

    @property
    def system(self) -> FuzzySystem:
        """The fuzzy system behind the gains, to explain and draw."""
        return FuzzySystem(self.rules, self.method)

    def initial_memory(self, n_axes: int) -> Memory:
        """Memory of the normalisation."""
        return self.normalization.initial_memory(n_axes)

    def kernel(self, n_axes: int) -> Kernel:
        """Normalise, infer, convert to gains; see `GainScheduler.kernel`."""
        normalize = self.normalization.kernel(n_axes)
        infer = infer_function(self.system)
        to_gains = _conversion(self.rules)

        def schedule(
            innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            signals, new_memory = normalize(innovation, change, dt, sigma, memory)
            alpha, beta, gamma = to_gains(infer(signals))
            return alpha, beta, gamma, 1.0, new_memory

        return schedule


def _settings(rules: RuleBase) -> dict[str, str]:
    settings = dict(rules.scheduler)
    for key in ("normalization", "gains"):
        if key not in settings:
            raise RuleBaseError(
                f"{rules.name} cannot schedule gains: no scheduler setting {key!r}; it needs "
                "scheduler: {normalization: chan, gains: w-domain} or the like"
            )
    return settings


def _location(word: str) -> Location | None:
    return getattr(word, "location", None)


def _normalization(rules: RuleBase, settings: dict[str, str]) -> Normalization:
    name = settings["normalization"]
    if name not in normalizations.names():
        raise RuleBaseError(
            f"unknown normalization {str(name)!r}; one of {', '.join(normalizations.names())}",
            _location(name),
        )
    normalization: Normalization = normalizations.get(name)()
    if len(rules.inputs) > len(normalization.signals):
        raise RuleBaseError(
            f"normalization {str(name)!r} gives {len(normalization.signals)} signals "
            f"({', '.join(normalization.signals)}); {rules.name} has {len(rules.inputs)} inputs",
            _location(name),
        )
    return normalization


def _check_gains(rules: RuleBase, gains: str) -> None:
    if gains not in ("w-domain", "direct"):
        raise RuleBaseError(
            f"unknown gains {str(gains)!r}; one of w-domain, direct", _location(gains)
        )
    outputs = set(rules.output_names)
    allowed = [set(W_DOMAIN)] if gains == "w-domain" else [set(names) for names in DIRECT]
    if outputs not in allowed:
        wanted = " or ".join(", ".join(sorted(names)) for names in allowed)
        raise RuleBaseError(
            f"gains {str(gains)!r} need outputs {wanted}; {rules.name} has "
            f"{', '.join(rules.output_names)}",
            _location(gains),
        )


def _check_range(rules: RuleBase) -> None:
    """Gains that a rule base can reach must not be unstable.

    Stiffness and damping only have to be nonnegative; α, β, γ are checked at the corners of the
    box of their universes, which holds every inferred value.
    """
    if set(rules.output_names) == set(W_DOMAIN):
        for name in W_DOMAIN:
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


def _conversion(rules: RuleBase) -> Any:
    """Function from the tuple of outputs to (α, β, γ)."""
    place = {name: k for k, name in enumerate(rules.output_names)}
    if "stiffness" in place:
        stiffness, damping = place["stiffness"], place["damping"]

        def from_w(outputs: tuple[float, ...]) -> tuple[float, float, float]:
            alpha, beta = bilinear(outputs[stiffness], outputs[damping])
            return alpha, beta, 0.0

        return from_w
    first, second = place["alpha"], place["beta"]
    if "gamma" not in place:

        def direct(outputs: tuple[float, ...]) -> tuple[float, float, float]:
            return outputs[first], outputs[second], 0.0

        return direct
    third = place["gamma"]

    def direct_gamma(outputs: tuple[float, ...]) -> tuple[float, float, float]:
        return outputs[first], outputs[second], outputs[third]

    return direct_gamma


def _never_silent(rules: RuleBase, system: FuzzySystem) -> None:
    """A tracker cannot use NaN gains: find inputs at which no rule fires."""
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
