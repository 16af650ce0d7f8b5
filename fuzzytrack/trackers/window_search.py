"""An α-β filter whose α is searched over a moving window of plots."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fuzzytrack.gains import design
from fuzzytrack.gains.checks import finite
from fuzzytrack.lanes.layout import Rows
from fuzzytrack.lanes.program import LaneProgram
from fuzzytrack.lanes.start import single_axis_step
from fuzzytrack.trackers.base import trackers
from fuzzytrack.trackers.lane_tracker import LaneTracker, check_missed

__all__ = ["WindowSearch"]


@trackers.register("window-search")
@dataclass(frozen=True, repr=False)
class WindowSearch(LaneTracker):
    """α with the least innovations over the last plots: method M4 of Al-Wagih & Abdulla.

    After each plot the last `window` plots are tracked again with every α of a grid, from the state
    that the track had before them; the α with the least sum of squared innovations corrects the
    next plot. Until the window is full α stays as it was given. β = α²/(2 - α) throughout.

    Parameters
    ----------
    window : int
        Number of plots searched, at least 2, not counting the two of the start.
    alpha : float
        Position gain until the window is full, 0 < α < 4 - 2√2 = 1.1716.
    grid_step : float
        Distance of the grid's α: grid_step, 2·grid_step, … up to 1; 0 < grid_step <= 1.
    missed : {"elapsed", "step"}
        As for `fuzzytrack.AlphaBetaTracker`.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    Notes
    -----
    Al-Wagih & Abdulla, M4, Algorithm 2. The authors give neither window nor grid. A window of 80 of
    100 plots and α = 0.05 before fit their tables: the search acts late, or not at all. After two
    noisy plots so small an α leaves a large error until the window is full; 0.5 does not. The least
    of equal sums is that of the lowest α. Missed plots are not in the window, and the time between
    plots may be irregular. A plot takes window/grid_step trial corrections, and the state of a
    track has 5·window numbers on each axis.

    Examples
    --------
    >>> from fuzzytrack.trackers.window_search import WindowSearch
    >>> plots = [0, 10, 20, 31, 44, 59, 76]
    >>> WindowSearch(window=2).run(range(7), plots).gains.alpha
    array([ nan,  nan, 0.05, 0.05, 0.05, 1.  , 1.  ])
    """

    source: ClassVar[str] = "Al-Wagih & Abdulla, M4, Algorithm 2"

    uses_acceleration = False

    window: int = 10
    alpha: float = 0.05
    grid_step: float = 0.05
    missed: str = "elapsed"

    def __post_init__(self) -> None:
        check_missed(self.missed)
        window = operator.index(self.window)
        if window < 2:
            raise ValueError(f"window must be at least 2 plots, got {window}")
        design.benedict_bordner(self.alpha)
        step = float(finite("grid_step", self.grid_step))
        if not 0 < step <= 1:
            raise ValueError(f"grid_step must be > 0 and <= 1, got {step:g}")
        object.__setattr__(self, "window", window)
        object.__setattr__(self, "alpha", float(self.alpha))
        object.__setattr__(self, "grid_step", step)

    @property
    def grid(self) -> tuple[float, ...]:
        """The α that are tried."""
        # A step that divides 1, up to rounding, reaches it.
        count = math.floor(1 / self.grid_step + 1e-9)
        return tuple(min(k * self.grid_step, 1.0) for k in range(1, count + 1))

    def program(self, n_axes: int) -> LaneProgram:
        """The α-β recursion with the search; see `LaneTracker.program`."""
        rows = Rows(n_axes, 5 * self.window + 2)
        memory = (*(0.0,) * (5 * self.window + 1), self.alpha)
        return LaneProgram(rows, memory, lambda stride: _step(self, rows, stride))


def _step(tracker: WindowSearch, rows: Rows, stride: int) -> Callable[[Any, int], None]:
    """Function that does one time step of the first lanes, single axes, of a buffer, in place.

    The memory holds the window, then its number of plots, then α.
    """
    window = tracker.window
    count_row, alpha_row = rows.memory + 5 * window, rows.memory + 5 * window + 1
    remember, search = _remember(rows.memory, window, stride), _search(tracker, rows.memory, stride)
    full = float(window)

    def correct(
        b: Any, i: int, z: float, prediction: float, v: float, dt: float, gap: float, sigma: float,
        update: bool, starts: bool,
    ) -> tuple[float, float, float, float, float]:  # fmt: skip
        e = z - prediction if update else 0.0
        alpha = b[alpha_row * stride + i]
        beta = alpha * alpha / (2.0 - alpha)
        if update:
            remember(b, i, z, gap, dt, prediction, v)
            held = b[count_row * stride + i] + 1.0
            held = held if held < full else full
            b[count_row * stride + i] = held
            if held == full:
                b[alpha_row * stride + i] = search(b, i, alpha)
        return prediction, prediction + alpha * e, v + (beta * (1.0 / dt)) * e, alpha, beta

    return single_axis_step(rows, stride, correct)


def _remember(first_row: int, window: int, stride: int) -> Callable[..., None]:
    """Function that puts a plot at the end of the window, and the first one out.

    The window is five runs of rows, oldest first: plots, times since the plot before, time steps,
    predictions, and velocities before the plots.
    """

    def remember(
        b: Any, i: int, z: float, gap: float, dt: float, prediction: float, velocity: float
    ) -> None:
        for r in range(first_row, first_row + 5 * window - 1):
            b[r * stride + i] = b[(r + 1) * stride + i]
        b[(first_row + window - 1) * stride + i] = z
        b[(first_row + 2 * window - 1) * stride + i] = gap
        b[(first_row + 3 * window - 1) * stride + i] = dt
        b[(first_row + 4 * window - 1) * stride + i] = prediction
        b[(first_row + 5 * window - 1) * stride + i] = velocity

    return remember


def _search(tracker: WindowSearch, plots_row: int, stride: int) -> Callable[..., float]:
    """Function that finds the α with the least squared innovations over the window."""
    window, alphas = tracker.window, tracker.grid
    betas = tuple(np.asarray(design.benedict_bordner(alphas)).tolist())
    candidates, infinity = len(alphas), math.inf
    gaps_row, steps_row = plots_row + window, plots_row + 2 * window
    predictions_row, velocities_row = plots_row + 3 * window, plots_row + 4 * window

    def search(b: Any, i: int, current: float) -> float:
        best, least = current, infinity
        for g in range(candidates):
            alpha, beta, total = alphas[g], betas[g], 0.0
            x, v = 0.0, b[velocities_row * stride + i]
            for k in range(window):
                known = b[predictions_row * stride + i]
                prediction = x + v * b[(gaps_row + k) * stride + i] if k > 0 else known
                e = b[(plots_row + k) * stride + i] - prediction
                total = total + e * e
                x = prediction + alpha * e
                v = v + (beta / b[(steps_row + k) * stride + i]) * e
            best = alpha if total < least else best
            least = total if total < least else least
        return best

    return search
