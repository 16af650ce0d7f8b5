"""Times at which a target maneuvers, and their shading in pictures over time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from fuzzytrack.arrays import Array
from fuzzytrack.plotting._track_styles import STYLES

__all__ = ["Intervals", "checked_intervals", "maneuvers_of", "shade_maneuvers"]

#: First and last time of each (s).
Intervals = Sequence[tuple[float, float]]

# A target maneuvers where its acceleration is this part of its largest.
_PART = 0.2
# Accelerations below this part of a maneuver that would use up the whole path are rounding errors.
_ROUNDING = 1e-6
# Part of the time beyond which a target maneuvers always: shades would say nothing.
_ALWAYS = 0.95
# With more intervals, the truth has noise of its own.
_MOST = 12


def maneuvers_of(time: Array, truth: Array) -> list[tuple[float, float]]:
    """Intervals in which a target accelerates.

    Parameters
    ----------
    time : ndarray, shape (n_steps,)
        Times (s).
    truth : ndarray, shape (n_steps, n_axes)
        True positions; rows with NaN are left out.

    Returns
    -------
    list of (float, float)
        First and last time of each (s), to one plot. None where the path is straight, where the
        target maneuvers always, or where there would be more than 12, as in a recorded truth with
        noise of its own.
    """
    from scipy.ndimage import binary_closing

    known = np.isfinite(truth).all(axis=1) & np.isfinite(time)
    time, truth = time[known], truth[known]
    if len(time) < 4:
        return []
    step = np.diff(time)[:, None]
    velocity = np.diff(truth, axis=0) / step
    acceleration = np.linalg.norm(
        np.diff(velocity, axis=0) / (0.5 * (step[1:] + step[:-1])), axis=1
    )
    largest = acceleration.max()
    whole = np.ptp(time)
    rounding = 4 * np.finfo(float).eps * np.abs(truth).max() / float(step.min()) ** 2
    if largest <= max(_ROUNDING * np.linalg.norm(np.ptp(truth, axis=0)) / whole**2, rounding):
        return []
    # Each is about the middle one of three plots.
    busy = np.concatenate([[False], acceleration > _PART * largest, [False]])
    if np.count_nonzero(np.diff(busy.astype(int)) > 0) > _MOST:
        return []
    # Gaps of one or two plots are closed.
    edges = np.flatnonzero(np.diff(binary_closing(busy, np.ones(3)).astype(int)))
    begins, ends = time[edges[::2]], time[edges[1::2] + 1]
    if (ends - begins).sum() > _ALWAYS * whole:
        return []
    return [(float(begin), float(end)) for begin, end in zip(begins, ends, strict=True)]


def checked_intervals(intervals: object) -> list[tuple[float, float]]:
    """Intervals as a user gives them.

    Raises
    ------
    ValueError
        If one is no pair of times in their order.
    """
    pairs = np.asarray(intervals, dtype=np.float64)
    if pairs.size == 0:
        return []
    if pairs.ndim != 2 or pairs.shape[1] != 2 or not (pairs[:, 0] <= pairs[:, 1]).all():
        raise ValueError(
            f"maneuvers: must be pairs of times, the first one before the second, got {intervals!r}"
        )
    return [(float(a), float(b)) for a, b in pairs]


def shade_maneuvers(ax: Axes, intervals: Intervals, scale: float = 1.0) -> None:
    """Shade maneuvers, with one entry in the legend; times are divided by `scale`."""
    for number, (begin, end) in enumerate(intervals):
        label = "target maneuvers" if number == 0 else "_"
        ax.axvspan(begin / scale, end / scale, label=label, **STYLES["maneuver"])
