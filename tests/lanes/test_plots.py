import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.lanes.plots import PlotLayout

TRACKER = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2))


def test_lanes_and_back():
    plots = np.arange(24.0).reshape(2, 3, 4)
    for coupled, shape in (False, (2, 12, 1)), (True, (2, 3, 4)):
        layout = PlotLayout.of(plots.shape, coupled)
        lanes = layout.to_lanes(plots)
        assert (lanes.shape, layout.lanes) == (shape, shape[1])
        np.testing.assert_array_equal(layout.from_lanes(lanes), plots)
    # A value of each track becomes one of each of its lanes.
    own = PlotLayout.of(plots.shape, False).times_to_lanes(np.array([[1.0, 2.0, 3.0]]))
    assert own.tolist() == [[1.0] * 4 + [2.0] * 4 + [3.0] * 4]


def test_no_tracks_have_no_lanes():
    layout = PlotLayout.of((5, 0, 2), False)
    assert (layout.lanes, layout.times_to_lanes(np.ones((5, 0))).shape) == (0, (5, 0))


def test_a_single_time_is_refused():
    with pytest.raises(ValueError, match=r"t: shape \(\) does not fit plots of shape \(2,\)"):
        TRACKER.run(0.0, [1.0, 2.0])
