"""The base class of normalizations, which make the inputs of a rule base, and their registry."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from fuzzytrack.kernels.language import Memory
from fuzzytrack.plugins import Registry
from fuzzytrack.reprs import constructor_code

__all__ = ["Feedback", "Normalization", "Normalize", "normalizations"]

#: ``normalize(innovation, change, dt, sigma, memory) -> (signals, memory)``
Normalize = Callable[[Any, Any, float, Any, Memory], tuple[tuple[float, ...], Memory]]

#: ``feedback(memory, alpha, beta, gamma, dt, sigma) -> memory``
Feedback = Callable[[Memory, float, float, float, float, Any], Memory]


class Normalization(ABC):
    """Turns innovation and change of observation into dimensionless signals.

    Attributes
    ----------
    source : str
        Paper, or other origin.
    signals : tuple of str
        What the kernel returns, in order; a rule base takes its inputs from them, first to first.
    numbers : mapping of str to str
        Numbers that its constructor takes, and what each is, for the JSON Schema of rule bases.
    uses_expectation : bool
        Whether the kernel gets, as `dt` and `sigma`, the time step in the unit of the conversion
        and the variance that it expects of the innovation of each axis on a straight run, infinity
        where it expects nothing. This needs the conversion ``covariance``.
    coupled, needs_sigma, sees_starts, sees_misses : bool
    variance_start : str or None
        As for a `fuzzytrack.schedulers.base.GainScheduler`.

    Notes
    -----
    The numbers that its constructor takes can be given next to its name in the scheduler settings
    of a rule base.

    If the rule base opens with a growing memory, or the conversion has a covariance, a
    normalization is called with zeros at the first plot of a track, and at the second if velocity
    starts from it, even if it does not see starts.
    """

    source: ClassVar[str] = ""
    signals: ClassVar[tuple[str, ...]] = ()
    numbers: ClassVar[Mapping[str, str]] = {}
    uses_expectation: ClassVar[bool] = False
    coupled: ClassVar[bool] = False
    needs_sigma: ClassVar[bool] = False
    sees_starts: ClassVar[bool] = False
    sees_misses: ClassVar[bool] = False
    variance_start: ClassVar[str | None] = None

    @abstractmethod
    def kernel(self, n_axes: int) -> Normalize:
        """Scalar function to signals and new memory; arguments as of a scheduler's kernel."""

    @abstractmethod
    def initial_memory(self, n_axes: int) -> Memory:
        """Memory of a new track."""

    def feedback(self, n_axes: int) -> Feedback | None:
        """Scalar function from the gains that were chosen to the memory; None unless overridden.

        It is called after inference, with the memory that the kernel returned and the gains for the
        same plot; at steps whose gains are dropped too, if the normalization sees them.
        """
        return None

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of the position predicted over a time; NaN unless overridden.

        See `fuzzytrack.schedulers.base.GainScheduler.prediction_variance`.
        """
        return math.nan

    def __repr__(self) -> str:
        return constructor_code(self)


normalizations: Registry[type[Normalization]] = Registry(
    "normalization", "fuzzytrack.normalizations", Normalization
)
