"""Several models of how a target moves: their numbers, and where those of a lane are."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from fuzzytrack.gains.checks import nonnegative_deviation, number
from fuzzytrack.lanes.layout import Rows
from fuzzytrack.reprs import constructor_code
from fuzzytrack.trackers.markov_chain import MarkovChain

__all__ = ["COVARIANCE", "UNITS", "ModelRows", "ModelSet", "MotionModel"]

#: Numbers in the memory before the probabilities: variance of the first plot (m²), 1/τ0 (1/s), a0²
#: (m²/s⁴), and the number of intervals between plots that τ0 is the mean of.
UNITS = 4
#: Numbers of a covariance: P₁₁, P₁₂, P₁₃, P₂₂, P₂₃, P₃₃.
COVARIANCE = 6


@dataclass(frozen=True, repr=False)
class MotionModel:
    """How a target moves, in the units of `fuzzytrack.trackers.InteractingModels`.

    Attributes
    ----------
    noise : float
        Standard deviation of the acceleration (in a0), >= 0. Without retention it is drawn anew for
        each step; with infinite retention it is the change of the acceleration at a step.
    retention : float
        Time for which a target keeps its acceleration (in τ0), >= 0: 0 for a target without one
        (nearly constant velocity), infinity for one that always keeps it (nearly constant
        acceleration).
    """

    noise: float
    retention: float = 0.0

    def __post_init__(self) -> None:
        noise = number("noise", nonnegative_deviation("noise", self.noise))
        retention = float(self.retention)
        if not retention >= 0.0:
            raise ValueError(f"retention must be >= 0, or infinity, got {retention:g}")
        object.__setattr__(self, "noise", noise)
        object.__setattr__(self, "retention", retention)

    def __repr__(self) -> str:
        return constructor_code(self)

    @property
    def accelerates(self) -> bool:
        """Whether it has an acceleration."""
        return self.retention > 0.0


@dataclass(frozen=True)
class ModelSet:
    """Numbers of a tracker, as its step needs them.

    Attributes
    ----------
    models : tuple of MotionModel
    chain : MarkovChain
        Transitions between them, time in τ0.
    start_acceleration : float
        Standard deviation of the acceleration of a new track (in a0).
    gap_rate : float
        The noise is divided by 1 + this times the time step (in τ0).
    acceleration : float or None
        a0 (m/s²); None where it comes from the intervals between plots.
    half_freedom : int or None
        Half the degrees of freedom of the likelihood; None for a Gaussian one.
    plot_variance : float or None
        Variance of all plots (m²); None where each has its own.
    """

    models: tuple[MotionModel, ...]
    chain: MarkovChain
    start_acceleration: float
    gap_rate: float
    acceleration: float | None
    half_freedom: int | None
    plot_variance: float | None


@dataclass(frozen=True)
class ModelRows:
    """Where the numbers of a lane with several models are, beside what `Rows` says.

    The memory holds `UNITS`, the probabilities, and for each model its mean (positions, velocities
    and accelerations of all axes) and its covariance. Scratch holds the same for the models after
    prediction, and what comes in between.

    Attributes
    ----------
    n_axes, n_models : int
    """

    n_axes: int
    n_models: int

    @classmethod
    def of_memory(cls, count: int, n_models: int) -> ModelRows:
        """Rows of a memory of so many numbers."""
        size = (count - UNITS) // n_models - 1
        return cls((size - COVARIANCE) // 3, n_models)

    @property
    def size(self) -> int:
        """Numbers of a model."""
        return 3 * self.n_axes + COVARIANCE

    @property
    def n_memory(self) -> int:
        """Numbers of the memory."""
        return UNITS + self.n_models * (1 + self.size)

    @cached_property
    def pairs(self) -> tuple[tuple[int, int], ...]:
        """Pairs of models."""
        n = self.n_models
        return tuple((i, k) for i in range(n) for k in range(i + 1, n))

    @cached_property
    def rows(self) -> Rows:
        """Layout of a lane."""
        n = self.n_models
        counts = dict.fromkeys(("plot_variance", "pace", "time", "scale"), 1)
        counts |= {"chance": n, "share": n * n, "spread": COVARIANCE * max(1, len(self.pairs))}
        counts |= {"moved": n * self.size, "gain": 3 * n}
        names = tuple(f"{name} {k}" for name, count in counts.items() for k in range(count))
        return Rows(self.n_axes, self.n_memory, names)

    def scratch(self, name: str) -> int:
        """First row of intermediate results."""
        return self.rows.scratch_row(f"{name} 0")

    @property
    def rate(self) -> int:
        """Row of 1/τ0 (1/s)."""
        return self.rows.memory + 1

    @property
    def noise_unit(self) -> int:
        """Row of a0² (m²/s⁴)."""
        return self.rows.memory + 2

    @property
    def probability(self) -> int:
        """First of the rows of the probabilities."""
        return self.rows.memory + UNITS

    def model(self, j: int) -> int:
        """First row of a model: its mean; the covariance is 3·n_axes rows on."""
        return self.probability + self.n_models + j * self.size

    def moved(self, j: int) -> int:
        """The same of a model after prediction."""
        return self.scratch("moved") + j * self.size

    def shares(self, j: int) -> int:
        """First row of the shares of all models in the mixture from which a model starts."""
        return self.scratch("share") + j * self.n_models
