"""Layout of a lane's numbers, and of a block of lanes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["BLOCK", "GAINS", "OUTPUTS", "Rows", "aligned"]

#: Lanes a block, and numbers between the rows of its buffer: whole pairs of vectors of 64 bytes,
#: single precision included. A few rows of it stay clear of one another in the cache, where
#: distances count by the remainder of 4,096 bytes.
BLOCK = 288

#: Names of the gains, in the order in which they lie in a lane.
GAINS = ("alpha", "beta", "gamma")

#: What a run can write down, in this order.
OUTPUTS = ("predicted", "filtered", "velocity", "acceleration", "innovation", *GAINS)


@dataclass(frozen=True)
class Rows:
    """Where things lie in the buffer of a lane: numbers of rows, by axes and memory.

    A lane is what gets its own gains: one axis of one track, or with a coupled scheduler the whole
    track. Its first `state` rows are what a track remembers, up to `kept` follow the results of the
    last step, and the rest is scratch.
    """

    n_axes: int
    n_memory: int

    @property
    def position(self) -> int:
        """First of `n_axes` rows of position (m)."""
        return 0

    @property
    def velocity(self) -> int:
        """First of `n_axes` rows of velocity (m/s)."""
        return self.n_axes

    @property
    def acceleration(self) -> int:
        """First of `n_axes` rows of acceleration (m/s²)."""
        return 2 * self.n_axes

    @property
    def last_plot(self) -> int:
        """First of `n_axes` rows of the last plot seen (m)."""
        return 3 * self.n_axes

    @property
    def gap(self) -> int:
        """Time since the last plot seen (s); 0 where nothing will ask for it."""
        return 4 * self.n_axes

    @property
    def plots(self) -> int:
        """Plots seen, counted up to 2."""
        return 4 * self.n_axes + 1

    @property
    def memory(self) -> int:
        """First of `n_memory` rows of the scheduler."""
        return 4 * self.n_axes + 2

    @property
    def state(self) -> int:
        """Number of rows that make up the state."""
        return 4 * self.n_axes + 2 + self.n_memory

    @property
    def predicted(self) -> int:
        """First of `n_axes` rows of the last prediction (m)."""
        return self.state

    @property
    def innovation(self) -> int:
        """First of `n_axes` rows of the last innovation (m)."""
        return self.state + self.n_axes

    @property
    def gains(self) -> int:
        """First of three rows of the last gains: α, β, γ."""
        return self.state + 2 * self.n_axes

    @property
    def kept(self) -> int:
        """Number of rows kept from step to step: state and results."""
        return self.state + 2 * self.n_axes + 3

    @property
    def plot(self) -> int:
        """First of `n_axes` rows of the plot (m), to be filled in before a step."""
        return self.kept

    @property
    def sigma(self) -> int:
        """First of `n_axes` rows of its standard deviation (m), likewise; a step leaves it."""
        return self.kept + self.n_axes

    @property
    def dt(self) -> int:
        """Time step (s), likewise."""
        return self.kept + 2 * self.n_axes

    @property
    def change(self) -> int:
        """First of `n_axes` rows of the change of observation (m), for use within a step."""
        return self.kept + 2 * self.n_axes + 1

    @property
    def noise(self) -> int:
        """First of `n_axes` rows of the standard deviation or variance that a step works with."""
        return self.kept + 3 * self.n_axes + 1

    @property
    def total(self) -> int:
        """Number of all rows."""
        return self.kept + 4 * self.n_axes + 1

    def output(self, name: str) -> int:
        """First row of an output, by its name in a result."""
        if name in GAINS:
            return self.gains + GAINS.index(name)
        return int(getattr(self, "position" if name == "filtered" else name))


def aligned(count: int, dtype: type = np.float64) -> NDArray[Any]:
    """Zeros that begin with a line of the cache."""
    numbers: NDArray[Any] = np.zeros(count + 16, dtype)
    skipped = -(numbers.ctypes.data // numbers.itemsize) % (64 // numbers.itemsize)
    return numbers[skipped : skipped + count]
