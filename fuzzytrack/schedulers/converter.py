"""From the outputs of rules to gains, plot by plot: a part of a scheduler's kernel."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fuzzytrack.gains.period import pair_after, pair_rates
from fuzzytrack.kernels.language import Memory

__all__ = ["Conversion", "Convert", "Converter", "Expect", "Memoryless", "seen_by"]

#: From the outputs, in the order of the rule base, to (α, β, γ, retention of acceleration).
Conversion = Callable[[tuple[float, ...]], tuple[float, float, float, float]]

#: ``expect(dt, sigma, memory) -> (time, variance, memory)``
Expect = Callable[[float, Any, Memory], tuple[float, Any, Memory]]

#: ``convert(outputs, dt, sigma, memory) -> (alpha, beta, gamma, retention, memory)``
Convert = Callable[[tuple[float, ...], float, Any, Memory], tuple[Any, Any, Any, float, Memory]]


class Converter(ABC):
    """Turns the outputs of rules into gains; it may remember the track.

    Attributes
    ----------
    own_gains, needs_sigma, sees_starts, uses_retention : bool
    variance_start : str or None
        As for a `fuzzytrack.schedulers.base.GainScheduler`.
    """

    own_gains: bool = False
    needs_sigma: bool = False
    sees_starts: bool = False
    uses_retention: bool = False
    variance_start: str | None = None

    def initial_memory(self, n_axes: int) -> Memory:
        """Memory of a new track; empty unless overridden."""
        return ()

    def expect(self, n_axes: int, coupled: bool) -> Expect:
        """Scalar function that is called before the rules.

        Parameters
        ----------
        n_axes : int
            Axes that a kernel gets at once.
        coupled : bool
            Whether it gets a tuple of them, or a number.

        Returns
        -------
        callable
            ``expect(dt, sigma, memory)`` returns the time step in the unit of the conversion, the
            variance of the innovation of each axis on a straight run, shaped as `sigma`, and the
            memory for `convert`, which may be longer. What is given, unless overridden.
        """

        def as_given(dt: float, sigma: Any, memory: Memory) -> tuple[float, Any, Memory]:
            return dt, sigma, memory

        return as_given

    @abstractmethod
    def convert(self, n_axes: int, coupled: bool) -> Convert:
        """Scalar function that is called after the rules; parameters as of `expect`.

        Returns
        -------
        callable
            ``convert(outputs, dt, sigma, memory)`` gets the outputs in the order of the rule base
            and the memory from `expect`, and returns what a scheduler's kernel does.
        """

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of the position predicted over a time; NaN unless overridden.

        See `fuzzytrack.schedulers.base.GainScheduler.prediction_variance`.
        """
        return math.nan


@dataclass(frozen=True)
class Memoryless(Converter):
    """Gains that follow from the outputs alone.

    Parameters
    ----------
    conversion : callable
    period : float, optional
        Sampling time to which the gains belong (s); without it they are used at any.
    """

    conversion: Conversion
    period: float | None = None

    def convert(self, n_axes: int, coupled: bool) -> Convert:
        """See `Converter.convert`."""
        to_gains = _at_time_step(self.conversion, self.period)

        def convert(
            outputs: tuple[float, ...], dt: float, sigma: Any, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            alpha, beta, gamma, retention = to_gains(outputs, dt)
            return alpha, beta, gamma, retention, memory

        return convert


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


def seen_by(coupled: bool) -> Callable[[Any], bool]:
    """Function from the standard deviation of a plot, as a kernel gets it, to whether it is seen.

    Parameters
    ----------
    coupled : bool
        Whether it is a tuple. A plot is then seen on all axes or on none.
    """

    def alone(sigma: float) -> bool:
        return sigma != math.inf

    def together(sigma: tuple[float, ...]) -> bool:
        return sigma[0] != math.inf

    return together if coupled else alone
