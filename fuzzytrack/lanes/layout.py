"""Layout of a lane's numbers, and of a block of lanes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["BLOCK", "GAINS", "MEMORY", "OUTPUTS", "Rows", "aligned"]

#: Number of lanes of a block, and of numbers between the rows of its buffer: a multiple of two
#: vectors of 64 bytes, also in single precision, but no power of two, at which distance rows would
#: displace one another from the cache.
BLOCK = 288

#: Names of the gains, in the order in which they lie in a lane.
GAINS = ("alpha", "beta", "gamma")

#: Names of the outputs of a run, in the order of the compiled loops.
OUTPUTS = ("predicted", "filtered", "velocity", "acceleration", "innovation", *GAINS)

#: Name of one more output, which a run gives only if it is asked for: the memory of each lane after
#: each step, from which variances are computed.
MEMORY = "memory"


@dataclass(frozen=True)
class Rows:
    """Layout of a lane: which row of a buffer holds what.

    A lane is what gets its own gains: one axis of one track, or with a coupled scheduler the whole
    track. Row `r` of lane `i` is ``buffer[r * stride + i]``. The first `state` rows are the state
    of a track at `last_time`, those up to `kept` the results of its last step; then come plot,
    sigma and dt of the step, and scratch. A step uses neither `last_time` nor the rows from `now`
    on: the loops that call it keep them.

    Attributes
    ----------
    n_axes : int
        Axes of a lane.
    n_memory : int
        Numbers in the memory of the tracker or its scheduler, for a lane.
    scratch : tuple of str
        Names of rows for intermediate results of a step, one row each. At the beginning of a step
        they contain values of another step.
    gain_sets : int
        Sets of gains of a lane: 1, or `n_axes` if each axis has its own.
    """

    n_axes: int
    n_memory: int
    scratch: tuple[str, ...] = ()
    gain_sets: int = 1

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
        """First of `n_axes` rows of the last plot (m), missed ones not counted."""
        return 3 * self.n_axes

    @property
    def gap(self) -> int:
        """Time from the last plot to that of the state (s); 0 where the tracker does not use it."""
        return 4 * self.n_axes

    @property
    def plots(self) -> int:
        """Number of plots, counted up to 2, missed ones not counted."""
        return 4 * self.n_axes + 1

    @property
    def memory(self) -> int:
        """First of `n_memory` rows of the tracker's or scheduler's own."""
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
        """First of the rows of the last gains: `gain_sets` rows of α, then those of β and γ."""
        return self.state + 2 * self.n_axes

    @property
    def results(self) -> int:
        """Number of rows that a step writes: state and results."""
        return self.state + 2 * self.n_axes + 3 * self.gain_sets

    @property
    def now(self) -> int:
        """First of 3 `n_axes` rows of position, velocity and acceleration at the last step.

        They differ from those of the state where the plot of that step was missed.
        """
        return self.results

    @property
    def last_time(self) -> int:
        """Time (s) to which the state belongs; NaN before the first plot."""
        return self.results + 3 * self.n_axes

    @property
    def kept(self) -> int:
        """Number of rows kept from step to step."""
        return self.last_time + 1

    @property
    def plot(self) -> int:
        """First of `n_axes` rows of the plot (m), filled in before a step."""
        return self.kept

    @property
    def sigma(self) -> int:
        """First of `n_axes` rows of its standard deviation (m), filled in before a step.

        A step does not write there: one that is the same at all times is filled in once.
        """
        return self.kept + self.n_axes

    @property
    def dt(self) -> int:
        """Time from that of the state to the step (s), filled in before a step.

        0 if there has been no plot.
        """
        return self.kept + 2 * self.n_axes

    @property
    def given(self) -> int:
        """Number of rows that have their numbers before a step: those kept, and what it is given.

        The rows of `scratch` follow.
        """
        return self.kept + 2 * self.n_axes + 1

    @property
    def total(self) -> int:
        """Number of all rows."""
        return self.given + len(self.scratch)

    def scratch_row(self, name: str) -> int:
        """Row of intermediate results, by its name in `scratch`."""
        return self.given + self.scratch.index(name)

    def output(self, name: str) -> int:
        """First row where a step writes an output, by its name in a result."""
        if name in GAINS:
            return self.gains + GAINS.index(name) * self.gain_sets
        return int(getattr(self, "position" if name == "filtered" else name))

    def width(self, name: str) -> int:
        """Number of rows of an output, by its name in a result."""
        return self.gain_sets if name in GAINS else self.n_axes

    def shown(self, name: str) -> int:
        """First row of an output after a step, among those that are kept."""
        row = self.output(name)
        return row if row >= self.predicted else self.now + row


def aligned(count: int, dtype: type = np.float64) -> NDArray[Any]:
    """Zeros that begin at the start of a cache line (64 bytes)."""
    numbers: NDArray[Any] = np.zeros(count + 16, dtype)
    skipped = -(numbers.ctypes.data // numbers.itemsize) % (64 // numbers.itemsize)
    return numbers[skipped : skipped + count]
