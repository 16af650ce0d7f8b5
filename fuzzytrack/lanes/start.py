"""How a track starts, coasts and counts its plots; the same for every tracker.

A track without a plot waits for one. Its first plot gives the position, and its second one the
position again and the velocity between the two. From then on the track is *running*: each step
begins with a prediction, which a plot corrects; where a plot is missing, the track coasts on it. A
track with a one-point start is running after its first plot, with velocity 0.

The step functions of trackers (see `fuzzytrack.lanes.program.LaneProgram`) call these functions in
the order in which they stand here. They are scalar functions, inlined in compiled code: what is the
same for all lanes, or not used, costs nothing. A tracker whose lanes are single axes without
acceleration needs `single_axis_step` only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fuzzytrack.lanes.layout import Rows

__all__ = [
    "CORRECT_RETURNS", "CORRECT_TAKES", "axis_end", "axis_results", "axis_shown", "begin_step",
    "gain_results", "lane_end", "single_axis_step", "velocity_before",
]  # fmt: skip

#: What `single_axis_step` calls a tracker's own arithmetic with, and what it needs of it.
CORRECT_TAKES = "(buffer, lane, z, prediction, velocity, dt, gap, sigma, update, starts)"
CORRECT_RETURNS = "(prediction, position, velocity, alpha, beta)"


def begin_step(plots: float, gap: float, dt: float, seen: bool) -> tuple[float, float, bool, bool]:
    """Determine the kind of a step.

    Parameters
    ----------
    plots : float
        Number of plots before this step, counted up to 2.
    gap : float
        Time between the last of them and the step before (s).
    dt : float
        Time step (s); 0 at the first step of a track.
    seen : bool
        Whether there is a plot, with all its coordinates.

    Returns
    -------
    dt : float
        Time step to divide by: 1 at the first step, where the quotients are not used.
    gap : float
        Time since the last plot (s).
    running : bool
        Whether position and velocity are known, so that there is a prediction.
    update : bool
        Whether the plot corrects the prediction.
    """
    dt = dt if dt > 0.0 else 1.0
    running = plots >= 2.0
    return dt, gap + dt, running, seen & running


def velocity_before(
    plots: float, velocity: float, z: float, last: float, gap: float, seen: bool
) -> float:
    """Velocity of an axis before a plot corrects it (m/s).

    Parameters
    ----------
    plots : float
        Number of plots before this step.
    velocity : float
        Velocity without this plot (m/s).
    z, last : float
        This plot and the last one (m).
    gap : float
        Time between them (s), from `begin_step`.
    seen : bool
        Whether there is a plot.

    Returns
    -------
    float
        The difference of the first two plots over the time between them, when the second one is
        seen; 0 when the first one is; otherwise `velocity`.
    """
    start = (z - last) / gap if plots == 1.0 else 0.0
    return start if seen & (plots < 2.0) else velocity


def axis_results(rows: Rows, stride: int) -> Callable[..., None]:
    """Function that writes prediction and innovation of an axis; NaN where there is none.

    Parameters
    ----------
    rows : Rows
        Layout of a lane.
    stride : int
        Numbers between rows.

    Returns
    -------
    callable
        ``write(buffer, at, prediction, e, seen, running)`` for the axis whose first number is
        ``buffer[at]``: ``at`` is the lane plus `stride` times the axis.
    """
    nan = math.nan
    prediction_row, innovation_row = rows.predicted * stride, rows.innovation * stride

    def write(b: Any, at: int, prediction: float, e: float, seen: bool, running: bool) -> None:
        b[prediction_row + at] = prediction if running else nan
        b[innovation_row + at] = e if seen & running else nan

    return write


def axis_shown(rows: Rows, stride: int) -> Callable[..., None]:
    """Function that writes what is shown of an axis, for a program that keeps its state.

    Parameters
    ----------
    rows : Rows
        Layout of a lane.
    stride : int
        Numbers between rows.

    Returns
    -------
    callable
        ``show(buffer, at, x, v, a)`` with `at` as for `axis_results`.
    """
    n_axes, now = rows.n_axes, rows.now
    x_row, v_row, a_row = (row * stride for row in (now, now + n_axes, now + 2 * n_axes))

    def show(b: Any, at: int, x: float, v: float, a: float) -> None:
        b[x_row + at] = x
        b[v_row + at] = v
        b[a_row + at] = a

    return show


def axis_end(rows: Rows, stride: int, *, results: bool = True) -> Callable[..., None]:
    """Function that ends the step of an axis: position, last plot, prediction and innovation.

    Parameters
    ----------
    rows : Rows
        Layout of a lane.
    stride : int
        Numbers between rows.
    results : bool
        Whether to write prediction and innovation, too, as `axis_results` does.

    Returns
    -------
    callable
        ``end(buffer, at, z, last, prediction, corrected, e, seen, running)`` with `at` as there,
        and the innovation `e`. The position becomes `corrected` where the plot `z` corrects the
        prediction, `z` at the start, and `prediction` where the plot is missing.
    """
    position_row, last_row = rows.position * stride, rows.last_plot * stride
    write_results = axis_results(rows, stride)

    def end(
        b: Any, at: int, z: float, last: float, prediction: float, corrected: float, e: float,
        seen: bool, running: bool,
    ) -> None:  # fmt: skip
        position = corrected if running else z
        b[position_row + at] = position if seen else prediction
        b[last_row + at] = z if seen else last
        if results:
            write_results(b, at, prediction, e, seen, running)

    return end


def gain_results(rows: Rows, stride: int) -> Callable[..., None]:
    """Function that writes a set of gains of a lane; NaN where no plot corrects a prediction.

    Parameters
    ----------
    rows : Rows
        Layout of a lane.
    stride : int
        Numbers between rows.

    Returns
    -------
    callable
        ``write(buffer, at, update, alpha, beta, gamma)``: `at` is the lane, plus `stride` times the
        axis if each axis has its own gains.
    """
    nan, row, next_gain = math.nan, rows.gains * stride, rows.gain_sets * stride

    def write(b: Any, at: int, update: bool, alpha: float, beta: float, gamma: float) -> None:
        b[row + at] = alpha if update else nan
        b[row + next_gain + at] = beta if update else nan
        b[row + 2 * next_gain + at] = gamma if update else nan

    return write


def lane_end(
    rows: Rows, stride: int, *, two_point: bool = True, keep_gap: bool = True,
    count_gap: bool = True, settled: bool = False, results: bool = True,
) -> Callable[..., None]:  # fmt: skip
    """Function that ends the step of a lane: number of plots, time since the last one, and gains.

    Parameters
    ----------
    rows : Rows
        Layout of a lane.
    stride : int
        Numbers between rows.
    two_point : bool
        Whether a track is running after its second plot; otherwise after its first one.
    keep_gap : bool
        Whether the time since the last plot is kept for a running track; otherwise it is then 0.
    count_gap : bool
        Whether it is kept at all; not by a program that keeps its state, whose dt it is.
    settled : bool
        Whether number of plots and time are known to stay as they are.
    results : bool
        Whether to write the gains, too.

    Returns
    -------
    callable
        ``end(buffer, lane, plots, gap, seen, alpha, beta, gamma)``, with `plots` before this step
        and `gap` from `begin_step`. Gains are written as NaN where no plot corrects a prediction.
    """
    gap_row, plots_row = (r * stride for r in (rows.gap, rows.plots))
    write_gains = gain_results(rows, stride)
    first_count = 1.0 if two_point else 2.0

    def end(
        b: Any, i: int, plots: float, gap: float, seen: bool, alpha: float, beta: float,
        gamma: float,
    ) -> None:  # fmt: skip
        running = plots >= 2.0
        if not settled:
            counted = plots + 1.0 if plots > 0.0 else first_count
            counted = counted if counted < 2.0 else 2.0
            b[plots_row + i] = counted if seen else plots
            if count_gap:
                unused = seen if keep_gap else seen | running
                b[gap_row + i] = 0.0 if unused else gap
        if results:
            write_gains(b, i, seen & running, alpha, beta, gamma)

    return end


def single_axis_step(
    rows: Rows, stride: int, correct: Callable[..., tuple[float, float, float, float, float]]
) -> Callable[[Any, int], None]:
    """Step function of a tracker whose lanes are single axes with a two-point start.

    Parameters
    ----------
    rows : Rows
        Layout of a lane.
    stride : int
        Numbers between rows.
    correct : callable
        The tracker's own arithmetic, a scalar function ``correct(buffer, lane, z, prediction,
        velocity, dt, gap, sigma, update, starts)``. It is given the plot (m; NaN where missing),
        the prediction x + v·dt (m), the velocity before the correction (m/s, see
        `velocity_before`), the time step and the time since the last plot (s), and the standard
        deviation of the plot (m; 1 where it corrects nothing). `update` says whether the plot
        corrects the prediction, `starts` whether it is the second one, which gives the velocity.
        The tracker's memory is in the rows from ``rows.memory`` on: read and write row `r` as
        ``buffer[r * stride + lane]``.

        It returns ``(prediction, position, velocity, alpha, beta)``. Position and gains are used
        where there is an update; the prediction is as a rule the one that was given, and the
        velocity the given one where there is no update.

    Returns
    -------
    callable
        ``step(buffer, count)``, see `fuzzytrack.lanes.program.LaneProgram`.
    """
    end_axis, end_lane = axis_end(rows, stride), lane_end(rows, stride)
    x_row, v_row, last_row, gap_row, plots_row, plot_row, sigma_row, dt_row = (
        row * stride
        for row in (
            rows.position, rows.velocity, rows.last_plot, rows.gap, rows.plots, rows.plot,
            rows.sigma, rows.dt,
        )
    )  # fmt: skip

    def step(b: Any, count: int) -> None:
        # The compiler sees that no row runs into the next, and works on several lanes at once.
        for i in range(min(count, stride)):
            z, last, plots = b[plot_row + i], b[last_row + i], b[plots_row + i]
            seen = z == z
            dt, gap, running, update = begin_step(plots, b[gap_row + i], b[dt_row + i], seen)
            v = b[v_row + i]
            prediction = b[x_row + i] + v * dt
            v = velocity_before(plots, v, z, last, gap, seen)
            sigma = b[sigma_row + i] if update else 1.0
            starts = seen & (plots == 1.0)
            prediction, x, v, alpha, beta = correct(
                b, i, z, prediction, v, dt, gap, sigma, update, starts
            )
            b[v_row + i] = v
            end_axis(b, i, z, last, prediction, x, z - prediction, seen, running)
            end_lane(b, i, plots, gap, seen, alpha, beta, 0.0)

    return step
