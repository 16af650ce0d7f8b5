"""When a target is measured: at a constant period, with jitter, in bursts, or irregularly."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import number, positive
from fuzzytrack.reprs import constructor_code
from fuzzytrack.simulation.noise import TIMES, substream

__all__ = ["PATTERNS", "REGULAR", "Sampling"]

# Scans of all tracks together, so that a short period cannot ask for more memory than there is.
MAX_SCANS = 10_000_000
# Of intervals; in a larger one the short interval is lost when times are rounded.
MAX_RATIO = 1e9


@dataclass(frozen=True)
class Sampling:
    """Times at which a target is measured.

    Parameters
    ----------
    pattern : {"regular", "jitter", "alternate", "burst", "log-uniform"}
        How one interval between scans differs from the next.
    numbers : float or sequence of float
        Of the pattern:

        - ``regular``: none; all intervals are equal.
        - ``jitter``: a share of the period, > 0 and < 0.5. Every scan is early or late by up to
          this share of the period, uniformly.
        - ``alternate``: two intervals that take turns, in this order, as a ratio, such as (1, 10).
        - ``burst``: the number of plots in a burst, at least 2, and how many times as long as the
          time between two of them the gap after a burst is, > 1.
        - ``log-uniform``: the smallest and the largest interval, as a ratio, such as (1, 10); each
          interval is drawn uniformly in its logarithm.

        An interval is in proportion to the others: the times are stretched to the mean `period`.
    period : float, optional
        Mean time between scans (s), > 0; that of the target's own times unless given.

    Raises
    ------
    ValueError
        If there is no such pattern, or its numbers are out of range.

    Examples
    --------
    >>> import numpy as np
    >>> from fuzzytrack.simulation.noise import streams
    >>> from fuzzytrack.simulation.sampling import Sampling
    >>> Sampling("alternate", (1, 3)).times(np.arange(7.0), streams(seed=1, runs=50))
    array([0. , 0.5, 2. , 2.5, 4. , 4.5, 6. ])
    >>> Sampling("jitter", 0.2).times(np.arange(7.0), streams(seed=1, runs=50)).shape
    (7, 50)
    """

    pattern: str = "regular"
    numbers: float | Sequence[float] = ()
    period: float | None = None

    def __repr__(self) -> str:
        return constructor_code(self)

    def __post_init__(self) -> None:
        if self.pattern not in PATTERNS:
            raise ValueError(f"pattern: unknown {self.pattern!r}; one of {', '.join(PATTERNS)}")
        pattern = PATTERNS[self.pattern]
        own = tuple(np.atleast_1d(np.asarray(self.numbers, dtype=np.float64)).tolist())
        if not pattern.fits(own):
            given = ", ".join(f"{value:g}" for value in own) or "none"
            raise ValueError(f"{self.pattern} must be {pattern.allowed}, got {given}")
        object.__setattr__(self, "numbers", own)
        if self.period is not None:
            object.__setattr__(self, "period", number("period", positive("period", self.period)))

    @property
    def common(self) -> bool:
        """Whether all tracks have the same times."""
        return not PATTERNS[self.pattern].random

    def times(self, time: Array, tracks: Sequence[np.random.SeedSequence]) -> Array:
        """Times of the scans, from the first of the target's own times until the last at most.

        Parameters
        ----------
        time : ndarray, shape (n_own,)
            The target's own times (s), increasing, at least two.
        tracks : sequence of SeedSequence
            Random stream of each track. The times come from a stream below it, so that nothing
            else that is drawn for the track depends on them.

        Returns
        -------
        ndarray, shape (n_steps,) or (n_steps, n_tracks)
            Common to all tracks if `common`, else each track's own.

        Raises
        ------
        ValueError
            If fewer than two scans are left, or there are more than 10 million in all.
        """
        if self == REGULAR:
            return time
        period = self._mean(time)
        intervals = math.floor((time[-1] - time[0]) / period * (1 + 1e-12))
        count = 1 if self.common else len(tracks)
        if intervals < 1:
            raise ValueError(
                f"period must leave two scans of a target of {time[-1] - time[0]:g} s, "
                f"got {period:g}"
            )
        if (intervals + 1) * count > MAX_SCANS:
            raise ValueError(
                f"period must not give more than {MAX_SCANS} scans in all, got {period:g}, "
                f"which gives {intervals + 1} in each of {count}"
            )
        if self.pattern == "regular":
            return np.asarray(time[0] + period * np.arange(intervals + 1))
        draw, numbers = PATTERNS[self.pattern].draw, np.atleast_1d(self.numbers)
        each = [draw(substream(track, TIMES), intervals, *numbers) for track in tracks[:count]]
        after = np.cumsum(np.stack(each, axis=1), axis=0)
        shares = np.concatenate([np.zeros((1, count)), after / after[-1]])
        times: Array = time[0] + intervals * period * shares
        return times[:, 0] if self.common else times

    def scan(self, first: int, time: Array) -> int:
        """The scan that is on average as late as scan `first` of the target's own times.

        At least 2, counted from 0: the first that a two-point start predicts.

        Parameters
        ----------
        first : int
            Number of a scan, from 0.
        time : ndarray
            As for `times`.

        Raises
        ------
        ValueError
            If there are less than two times.
        """
        if len(time) < 2:
            raise ValueError(f"sampling needs at least 2 scans, got {len(time)}")
        return max(2, math.ceil(first * _mean(time) / self._mean(time) * (1 - 1e-12)))

    def _mean(self, time: Array) -> float:
        return _mean(time) if self.period is None else self.period


def _mean(time: Array) -> float:
    return float(time[-1] - time[0]) / (len(time) - 1)


# ---------------------------------------------------------------- patterns


def _regular(rng: np.random.Generator, count: int) -> Array:
    return np.ones(count)


def _jitter(rng: np.random.Generator, count: int, share: float) -> Array:
    late = share * rng.uniform(-1, 1, count + 1)
    return np.diff(np.arange(count + 1) + late)


def _alternate(rng: np.random.Generator, count: int, one: float, other: float) -> Array:
    return np.where(np.arange(count) % 2 == 0, one, other)


def _burst(rng: np.random.Generator, count: int, plots: float, gap: float) -> Array:
    return np.where((np.arange(count) + 1) % int(plots) == 0, gap, 1.0)


def _log_uniform(rng: np.random.Generator, count: int, low: float, high: float) -> Array:
    return np.asarray(low * (high / low) ** rng.random(count))


def _two(own: tuple[float, ...]) -> bool:
    positive = all(math.isfinite(value) and value > 0 for value in own)
    return len(own) == 2 and positive and max(own) <= MAX_RATIO * min(own)


class Pattern(NamedTuple):
    """How intervals differ.

    Attributes
    ----------
    allowed : str
        The numbers that it takes, in words.
    fits : callable
        Whether numbers are allowed.
    draw : callable
        Intervals of a track, in proportion to each other.
    random : bool
        Whether they differ from track to track.
    """

    allowed: str
    fits: Callable[[tuple[float, ...]], bool]
    draw: Callable[..., Array]
    random: bool = False


#: Patterns by name.
PATTERNS = {
    "regular": Pattern("without numbers", lambda own: not own, _regular),
    "jitter": Pattern(
        "a number > 0 and < 0.5", lambda own: len(own) == 1 and 0 < own[0] < 0.5, _jitter, True
    ),
    "alternate": Pattern("two intervals > 0, one at most 1e9 times the other", _two, _alternate),
    "burst": Pattern(
        "a whole number of plots >= 2 and a gap > 1, at most 1e9",
        lambda own: (
            len(own) == 2 and own[0] >= 2 and own[0].is_integer() and 1 < own[1] <= MAX_RATIO
        ),
        _burst,
    ),
    "log-uniform": Pattern(
        "two rising intervals > 0, one at most 1e9 times the other",
        lambda own: _two(own) and own[0] < own[1],
        _log_uniform,
        True,
    ),
}

#: At the target's own times.
REGULAR = Sampling()
