"""The start, the gaps and the end of a step, by hand and against a whole tracker."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.lanes.layout import Rows
from fuzzytrack.lanes.program import LaneProgram
from fuzzytrack.lanes.start import (
    axis_end,
    begin_step,
    lane_end,
    single_axis_step,
    velocity_before,
)
from fuzzytrack.lanes.tuples import gather, scatter
from fuzzytrack.trackers.compilation import announce
from fuzzytrack.trackers.lane_tracker import LaneTracker

NAN = math.nan


@pytest.mark.parametrize(
    ("plots", "seen", "running", "update"),
    [
        (0.0, True, False, False),
        (1.0, True, False, False),
        (1.0, False, False, False),
        (2.0, True, True, True),
        (2.0, False, True, False),
    ],
)
def test_a_step_of_a_running_track_with_a_plot_is_an_update(plots, seen, running, update):
    assert begin_step(plots, 3.0, 0.5, seen) == (0.5, 3.5, running, update)


def test_the_first_step_can_be_divided_by():
    assert begin_step(0.0, 0.0, 0.0, True)[0] == 1.0


def test_velocity_starts_with_the_second_plot():
    # Plots 10 and 4 m, 3 s apart; 7 m/s without them.
    assert velocity_before(0.0, 7.0, 4.0, 10.0, 3.0, True) == 0.0
    assert velocity_before(1.0, 7.0, 4.0, 10.0, 3.0, True) == -2.0
    assert velocity_before(1.0, 7.0, NAN, 10.0, 3.0, False) == 7.0
    assert velocity_before(2.0, 7.0, 4.0, 10.0, 3.0, True) == 7.0


@pytest.mark.parametrize(
    ("seen", "running", "position", "last", "predicted", "innovation"),
    [
        (True, True, 5.5, 6.0, 5.0, 1.0),
        (True, False, 6.0, 6.0, NAN, NAN),
        (False, True, 5.0, 2.0, 5.0, NAN),
        (False, False, 5.0, 2.0, NAN, NAN),
    ],
)
def test_an_axis_ends(seen, running, position, last, predicted, innovation):
    # Lane 1 of 3, second axis.
    rows, stride = Rows(2, 0), 3
    b = [-1.0] * (rows.total * stride)
    axis_end(rows, stride)(b, 1 + stride, 6.0, 2.0, 5.0, 5.5, 1.0, seen, running)
    places = [
        (row + 1) * stride + 1
        for row in (rows.position, rows.last_plot, rows.predicted, rows.innovation)
    ]
    np.testing.assert_equal([b[p] for p in places], [position, last, predicted, innovation])
    assert [b[p] for p in range(len(b)) if p not in places] == [-1.0] * (len(b) - 4)
    # Without results these stay as they were.
    b = [-1.0] * (rows.total * stride)
    axis_end(rows, stride, results=False)(b, 1 + stride, 6.0, 2.0, 5.0, 5.5, 1.0, seen, running)
    np.testing.assert_equal([b[p] for p in places], [position, last, -1.0, -1.0])


@pytest.mark.parametrize(
    ("options", "plots", "seen", "counted", "gap"),
    [
        ({}, 0.0, True, 1.0, 0.0),
        ({"two_point": False}, 0.0, True, 2.0, 0.0),
        ({}, 0.0, False, 0.0, 4.0),
        ({}, 1.0, True, 2.0, 0.0),
        ({}, 1.0, False, 1.0, 4.0),
        ({"keep_gap": False}, 1.0, False, 1.0, 4.0),
        ({}, 2.0, True, 2.0, 0.0),
        ({}, 2.0, False, 2.0, 4.0),
        ({"keep_gap": False}, 2.0, False, 2.0, 0.0),
    ],
)
def test_a_lane_ends(options, plots, seen, counted, gap):
    rows, stride = Rows(1, 2), 2
    b = [-1.0] * (rows.total * stride)
    lane_end(rows, stride, **options)(b, 1, plots, 4.0, seen, 0.5, 0.2, 0.1)
    assert (b[rows.plots * stride + 1], b[rows.gap * stride + 1]) == (counted, gap)
    gains = [b[(rows.gains + k) * stride + 1] for k in range(3)]
    np.testing.assert_equal(gains, [0.5, 0.2, 0.1] if seen and plots == 2.0 else [NAN] * 3)
    assert b[::2] == [-1.0] * rows.total


def test_a_settled_lane_without_results_stays_as_it_is():
    rows = Rows(1, 0)
    b = [-1.0] * rows.total
    lane_end(rows, 1, settled=True, results=False)(b, 0, 2.0, 4.0, True, 0.5, 0.2, 0.1)
    assert b == [-1.0] * rows.total


@dataclass(frozen=True)
class Fixed(LaneTracker):
    """Fixed gains, as an author of a tracker would write them."""

    alpha: float = 0.6
    beta: float = 0.3

    def program(self, n_axes):
        alpha, beta = self.alpha, self.beta
        rows = Rows(n_axes, 0)

        def correct(b, i, z, prediction, v, dt, gap, sigma, update, starts):
            e = z - prediction if update else 0.0
            velocity = v + (beta * (1.0 / dt)) * e if update else v
            return prediction, prediction + alpha * e, velocity, alpha, beta

        return LaneProgram(rows, (), lambda stride: single_axis_step(rows, stride, correct))


def test_a_tracker_of_single_axes_is_the_alpha_beta_tracker():
    random = np.random.default_rng(5)
    t = np.cumsum(random.uniform(0.2, 3.0, 60))
    z = random.normal(size=(60, 7, 2)).cumsum(axis=0)
    z[random.random(z.shape) < 0.3] = NAN
    ours, whole = Fixed(), ft.AlphaBetaTracker(ft.FixedGains(0.6, 0.3))
    expected = whole.run(t, z)
    for compiled in (False, True):
        if compiled:
            ours.compile()
            # A large job is announced, so this one is run compiled.
            announce(ours, 1, 10**9)
        found = ours.run(t, z)
        for name in ("predicted", "filtered", "velocity", "innovation"):
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
        np.testing.assert_array_equal(found.gains.beta, expected.gains.beta)


def test_tuples_of_a_buffer():
    buffer = [float(k) for k in range(10)]
    assert gather(3, 2)(buffer, 1) == (1.0, 3.0, 5.0)
    assert gather(0, 2)(buffer, 1) == ()
    scatter(3, 2)(buffer, 1, (-1.0, -3.0, -5.0), True)
    scatter(2, 2)(buffer, 0, (7.0, 7.0), False)
    assert buffer == [0.0, -1.0, 2.0, -3.0, 4.0, -5.0, 6.0, 7.0, 8.0, 9.0]
