"""Floating-point operations of a tracker, counted by running it on numbers that record them.

The convention is that of MATLAB 5, in which Llinas et al. (1998) counted their Table 5.7: an
addition, subtraction, multiplication, division or power is one operation, and so is a square root
or another elementary function. A comparison, a choice, a change of sign, an absolute value, a
rounding and an assignment are not counted, unless a `Tally` is set to count them. Arithmetic on
counted numbers is counted even if the result is an index; arithmetic on plain integers is not.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import CodeType, FunctionType, SimpleNamespace
from typing import Any

import numpy as np

from fuzzytrack.kernels.rebuild import rebuilt
from fuzzytrack.schedulers.base import GainScheduler
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker

__all__ = ["Counted", "OperationCount", "Tally", "count_operations", "count_program"]

_PERIOD, _SIGMA = 60.0, 115.0


class Tally:
    """Counts the operations on the numbers that it makes.

    Parameters
    ----------
    comparisons, signs : bool
        Whether to count comparisons too; and changes of sign and absolute values.

    Attributes
    ----------
    total : int
        Operations so far.
    """

    def __init__(self, comparisons: bool = False, signs: bool = False) -> None:
        self.comparisons = comparisons
        self.signs = signs
        self.total = 0

    def number(self, value: float) -> Counted:
        """A number on which operations are counted; a counted number unchanged."""
        return value if isinstance(value, Counted) else Counted(value, self)


class Counted:
    """A number whose operations are counted by a `Tally`; made by `Tally.number`.

    Results of arithmetic are counted numbers again, those of comparisons are plain. A counted
    number that is whole can be an index.
    """

    __slots__ = ("tally", "value")

    def __init__(self, value: float, tally: Tally) -> None:
        self.value = value
        self.tally = tally

    def _result(self, value: float, cost: int = 1) -> Counted:
        self.tally.total += cost
        return Counted(value, self.tally)

    def __add__(self, other: Counted | float) -> Counted:
        return self._result(self.value + plain(other))

    def __sub__(self, other: Counted | float) -> Counted:
        return self._result(self.value - plain(other))

    def __mul__(self, other: Counted | float) -> Counted:
        return self._result(self.value * plain(other))

    def __truediv__(self, other: Counted | float) -> Counted:
        return self._result(self.value / plain(other))

    def __pow__(self, other: Counted | float) -> Counted:
        return self._result(self.value ** plain(other))

    def __radd__(self, other: float) -> Counted:
        return self._result(other + self.value)

    def __rsub__(self, other: float) -> Counted:
        return self._result(other - self.value)

    def __rmul__(self, other: float) -> Counted:
        return self._result(other * self.value)

    def __rtruediv__(self, other: float) -> Counted:
        return self._result(other / self.value)

    def __rpow__(self, other: float) -> Counted:
        return self._result(other**self.value)

    def __neg__(self) -> Counted:
        return self._result(-self.value, self.tally.signs)

    def __abs__(self) -> Counted:
        return self._result(abs(self.value), self.tally.signs)

    def _compared(self, answer: bool) -> bool:
        self.tally.total += self.tally.comparisons
        return answer

    def __eq__(self, other: object) -> bool:
        return self._compared(self.value == plain(other))

    def __ne__(self, other: object) -> bool:
        return self._compared(self.value != plain(other))

    def __lt__(self, other: Counted | float) -> bool:
        return self._compared(self.value < plain(other))

    def __le__(self, other: Counted | float) -> bool:
        return self._compared(self.value <= plain(other))

    def __gt__(self, other: Counted | float) -> bool:
        return self._compared(self.value > plain(other))

    def __ge__(self, other: Counted | float) -> bool:
        return self._compared(self.value >= plain(other))

    __hash__ = None  # type: ignore[assignment]

    def __float__(self) -> float:
        return float(self.value)

    def __int__(self) -> int:
        return int(self.value)

    def __index__(self) -> int:
        if int(self.value) != self.value:
            raise TypeError(f"an index must be whole, got {self.value}")
        return int(self.value)

    def __round__(self) -> int:
        return round(self.value)

    def __repr__(self) -> str:
        return f"Counted({self.value!r})"


def plain(value: Any) -> Any:
    """The value of a counted number; anything else unchanged."""
    return value.value if isinstance(value, Counted) else value


def count_program(program: Callable[..., Any], *arguments: Any, **options: Any) -> tuple[int, Any]:
    """Count the operations of a function that makes its numbers with ``number``.

    Parameters
    ----------
    program : callable
        Function that takes, beside its arguments, ``number``: a function that makes a counted
        number of each number that the program calculates with.
    *arguments, **options
        Its other arguments.

    Returns
    -------
    int
        Number of operations.
    Any
        What the program returned.

    Examples
    --------
    >>> from fuzzytrack.testbed.operations import count_program
    >>> def distance(x, y, number):
    ...     x, y = number(x), number(y)
    ...     return (x * x + y * y) ** 0.5
    >>> count_program(distance, 3.0, 4.0)
    (4, Counted(5.0))
    """
    tally = Tally()
    result = program(*arguments, number=tally.number, **options)
    return tally.total, result


# ---------------------------------------------------------------- kernels


@dataclass(frozen=True)
class OperationCount:
    """Operations of a tracker on one track.

    Attributes
    ----------
    scheduler, recursion : int
        Operations of the scheduler and of everything else, over all scans and axes.
    scheduler_per_update, recursion_per_update : float
        Their mean for one axis at one corrected scan; NaN where there was none.
    """

    scheduler: int
    recursion: int
    scheduler_per_update: float
    recursion_per_update: float

    @property
    def total(self) -> int:
        """Operations of the scheduler and the recursion together."""
        return self.scheduler + self.recursion

    @property
    def per_update(self) -> float:
        """Mean operations of both for one axis at one corrected scan."""
        return self.scheduler_per_update + self.recursion_per_update


def count_operations(
    tracker: LaneTracker | GainScheduler | str, scans: int = 20, n_axes: int = 2
) -> OperationCount:
    """Count the operations of a tracker's own kernel on one track.

    Parameters
    ----------
    tracker : LaneTracker, GainScheduler or str
        A text names a tracker, see `fuzzytrack.trackers.catalog.make_tracker`. A scheduler is
        counted in a `fuzzytrack.AlphaBetaTracker`.
    scans : int
        Number of scans, at least 1; none is missed.
    n_axes : int
        Number of axes of space, at least 1.

    Returns
    -------
    OperationCount

    Raises
    ------
    TypeError
        If `tracker` is of another type.
    ValueError
        If a number is less than 1.

    Notes
    -----
    The functions are those that run in plain Python, copied with constants that count. Only what is
    executed is counted, not the other side of a select. The recursion is the same for all trackers,
    so it does more than Eqs. 2.1 to 2.3 of Llinas et al. (1998): an acceleration even if γ = 0, the
    time since the last plot, and the number of plots. Where the path through the functions depends
    on the data, it is that of a noisy straight track, with scans 60 s apart and noise of 115 m.

    Examples
    --------
    >>> from fuzzytrack import FixedGains
    >>> from fuzzytrack.testbed.operations import count_operations
    >>> count_operations(FixedGains(0.5, 0.2)).scheduler
    0
    """
    counted: object = make_tracker(tracker) if isinstance(tracker, str) else tracker
    if isinstance(counted, GainScheduler):
        counted = AlphaBetaTracker(counted)
    if not isinstance(counted, LaneTracker):
        raise TypeError(
            f"tracker must be a LaneTracker or a GainScheduler, got {type(counted).__name__}"
        )
    for name, number in (("scans", scans), ("n_axes", n_axes)):
        if number < 1:
            raise ValueError(f"{name} must be at least 1, got {number}")
    plots = _plots(scans, n_axes)
    groups = [range(n_axes)] if counted.coupled else [range(j, j + 1) for j in range(n_axes)]
    scheduler = recursion = updates = 0
    at_updates = [0, 0]
    for axes in groups:
        for corrected, spent in _run(counted, [[row[j] for j in axes] for row in plots]):
            scheduler += spent[0]
            recursion += spent[1]
            if corrected:
                updates += len(axes)
                at_updates = [at_updates[0] + spent[0], at_updates[1] + spent[1]]
    means = [spent / updates if updates else math.nan for spent in at_updates]
    return OperationCount(scheduler, recursion, *means)


def _plots(scans: int, n_axes: int) -> list[list[float]]:
    random = np.random.default_rng(1)
    way = np.outer(np.arange(scans), 300.0 + 60.0 * np.arange(n_axes))
    plots: list[list[float]] = (way + _SIGMA * random.normal(size=way.shape)).tolist()
    return plots


def _run(tracker: LaneTracker, plots: list[list[float]]) -> Iterator[tuple[bool, tuple[int, int]]]:
    """For each scan of a lane: whether it was corrected, and counts of scheduler and rest."""
    n_axes = len(plots[0])
    program = tracker.program(n_axes)
    rows = program.rows
    tally, inside = Tally(), Tally()
    scheduler = getattr(tracker, "scheduler", None)
    kernel = scheduler.kernel(n_axes).__code__ if isinstance(scheduler, GainScheduler) else None
    step = _counting(program.step(1), tally, inside, kernel)
    fresh = [0.0] * rows.total
    fresh[: rows.velocity] = [math.nan] * rows.velocity
    fresh[rows.memory : rows.state] = program.memory
    b = [tally.number(value) for value in fresh]
    for k, plot in enumerate(plots):
        given = [*plot, *[_SIGMA] * n_axes, _PERIOD if k else 0.0]
        b[rows.plot : rows.given] = [tally.number(value) for value in given]
        before = inside.total, tally.total
        step(b, 1)
        of_scheduler = inside.total - before[0]
        corrected = not math.isnan(b[rows.gains])
        yield corrected, (of_scheduler, tally.total - before[1] - of_scheduler)


def _counting(
    function: Callable[..., Any], tally: Tally, inside: Tally, kernel: CodeType | None
) -> Callable[..., Any]:
    """The function and all functions that it calls, with constants and `math` that count.

    Operations of the function with the code `kernel` are added to `inside` as well.
    """
    known: dict[int, Any] = {}
    namespace = SimpleNamespace(**{n: _elementary(v, tally) for n, v in vars(math).items()})

    def prepare(value: Any) -> Any:
        if isinstance(value, FunctionType):
            if id(value) not in known:
                known[id(value)] = counting(value)
            return known[id(value)]
        if value is math:
            return namespace
        if isinstance(value, float):
            return tally.number(value)
        if isinstance(value, tuple):
            return tuple(prepare(v) for v in value)
        return _elementary(value, tally)

    def counting(original: FunctionType) -> Callable[..., Any]:
        # Literals count too, since a select may pass one on to an operation with another.
        copy = rebuilt(original, prepare)
        if original.__code__ is not kernel:
            return copy

        def watched(*arguments: Any) -> Any:
            before = tally.total
            answer = copy(*arguments)
            inside.total += tally.total - before
            return answer

        return watched

    prepared: Callable[..., Any] = prepare(function)
    return prepared


def _elementary(value: Any, tally: Tally) -> Any:
    """A function of `math` that counts as one operation; its constants and anything else unchanged.

    Tests such as `math.isnan`, and rounding, are not counted.
    """
    free = (math.isnan, math.isinf, math.isfinite, math.floor, math.ceil, math.trunc)
    if getattr(value, "__module__", None) != "math" or not callable(value):
        return value

    def call(*arguments: Any) -> Any:
        answer = value(*map(plain, arguments))
        if value in free:
            return answer
        tally.total += 1
        return tally.number(answer)

    return call
