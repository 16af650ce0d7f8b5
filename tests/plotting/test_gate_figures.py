"""The picture of gates: outlines, predicted places, and lines to the plots that were taken."""

import numpy as np
import pytest
from drawn_lines import lines
from matplotlib.collections import LineCollection, PolyCollection

from fuzzytrack.plotting import plot_gates
from fuzzytrack.scan import Scan, ScanTracker
from fuzzytrack.scan.scan_gates import scan_gates

PERIOD = 1.7


@pytest.fixture(scope="module")
def session():
    """Two moving tracks that are confirmed, and a tentative one that began in the last scan."""
    found = ScanTracker().start()
    for k in range(12):
        plots = [[300.0 + 5.0 * k, 200.0], [-200.0, -100.0 + 6.0 * k], [0.0, 400.0]]
        found.step(Scan(PERIOD * k, np.array(plots[: 3 if k == 11 else 2])))
    return found


SCAN = Scan(12 * PERIOD, np.array([[361.0, 201.0], [5e2, -300.0], [-200.0, -28.0]]), own=(7.0, 8.0))


def test_outlines_predictions_and_taken_plots(session):
    _, ax = plot_gates(session, SCAN)
    gates = scan_gates(session, SCAN)
    drawn = lines(ax)
    np.testing.assert_array_equal(drawn["predicted"], gates.predicted)
    np.testing.assert_array_equal(drawn["plot"], SCAN.positions[1:2])
    np.testing.assert_array_equal(drawn["plot taken"], SCAN.positions[[0, 2]])
    np.testing.assert_array_equal(drawn["radar"], [[7.0, 8.0]])
    filled = [c for c in ax.collections if isinstance(c, PolyCollection)]
    corners = [path.vertices[:-1] for c in filled for path in c.get_paths()]
    # The tentative one first.
    np.testing.assert_allclose(corners, gates.outlines[[2, 0, 1]])
    segments = [
        s for c in ax.collections if isinstance(c, LineCollection) for s in c.get_segments()
    ]
    for number, plot in ((0, 0), (1, 2)):
        line = [gates.predicted[number], SCAN.positions[plot]]
        assert any(s.shape == (2, 2) and np.allclose(s, line) for s in segments)
    names = [text.get_text() for text in ax.get_legend().get_texts()]
    assert names[:4] == ["plot", "plot taken", "undecided, tentative", "moving"]
    assert {text.get_text() for text in ax.texts} == {"1", "2", "3"}


def test_only_what_is_asked_for(session):
    _, ax = plot_gates(session, SCAN, tentative=False)
    assert {text.get_text() for text in ax.texts} == {"1", "2"}
    extent = ((300.0, 420.0), (150.0, 250.0))
    _, ax = plot_gates(session, SCAN, extent)
    assert {text.get_text() for text in ax.texts} == {"1"}
    assert ax.get_xlim()[0] <= 300 < 420 <= ax.get_xlim()[1]
    assert ax.get_xlim()[1] - ax.get_xlim()[0] < 300
    assert "radar" not in lines(ax)


def test_north_is_upwards(session):
    _, ax = plot_gates(session, SCAN, axes_names=("north", "east"))
    assert ax.get_ylabel() == "north (m)"
    np.testing.assert_array_equal(lines(ax)["plot"], [[-300.0, 500.0]])


def test_no_track_and_no_plot():
    _, ax = plot_gates(ScanTracker().start(), Scan(0.0, np.empty((0, 2))))
    assert ax.get_title() == "no track"
