"""Pictures of recordings: in the units and at the places of their plots."""

import matplotlib
import numpy as np
import pytest

import fuzzytrack as ft

matplotlib.use("Agg")


@pytest.fixture(autouse=True)
def closed():
    yield
    from matplotlib import pyplot as plt

    plt.close("all")


def drawn(figure):
    ax = figure.axes[0]
    return ax, {line.get_label(): np.array(line.get_data()).T for line in ax.lines}


def test_polar_plots_are_drawn_around_their_sensor():
    t = np.arange(30.0)
    far = {"t": t, "range": 20_000.0 + 100 * t, "az": 10.0 + t}
    tracked = ft.track(far, polar=("range", "az"), sigma_range=5, sigma_azimuth=0.1)
    ax, lines = drawn(tracked.plot())
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("east (km)", "north (km)")
    np.testing.assert_array_equal(lines["sensor"], [(0.0, 0.0)])
    np.testing.assert_allclose(
        lines["plots"][0], 20 * np.array([np.sin(0.1745), np.cos(0.1745)]), rtol=1e-3
    )
    assert ax.get_aspect() == 1.0
    # A sensor that moves is no longer at the origin.
    own = {"own_x": 3 * t, "own_y": 0 * t}
    moving = ft.track(far | own, polar=("range", "az"), own_ship=("own_x", "own_y"), sigma=50.0)
    assert "sensor" not in drawn(moving.plot())[1]


def test_places_on_earth_are_drawn_by_longitude_and_latitude():
    t = np.arange(30.0)
    lat, lon = 60 + 1e-3 * t, 179.99 + 1e-3 * t
    given = {"t": t, "lat": lat, "lon": (lon + 180) % 360 - 180, "alt": 100 + t}
    tracked = ft.track(given, geodetic=("lat", "lon"), sigma=5.0)
    ax, lines = drawn(tracked.plot())
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("longitude (deg)", "latitude (deg)")
    east = lines["plots"][:, 0]
    # No jump where longitudes pass 180 degrees.
    np.testing.assert_allclose((east - lon + 180) % 360, 180, atol=1e-6)
    np.testing.assert_allclose(np.diff(east), 1e-3, atol=1e-6)
    np.testing.assert_allclose(lines["plots"][:, 1], lat, atol=1e-6)
    assert ax.get_aspect() == pytest.approx(1 / np.cos(np.radians(60)), rel=1e-3)
    high = ft.track(given, geodetic=("lat", "lon", "alt"), sigma=5.0).plot()
    labels = [ax.get_ylabel() for ax in high.axes]
    assert labels == ["latitude (deg)", "altitude (m)", "gains"]
    height = high.axes[1].lines[0].get_ydata()
    np.testing.assert_allclose(height, 100 + t, atol=1e-3)


@pytest.mark.parametrize(
    ("axes", "labels", "aspect"),
    [
        (("x_m", "y_m"), ("x (m)", "y (m)"), 1.0),
        (("x_m", "z_ft"), ("x (m)", "z (ft)"), "auto"),
        (("x", "y"), ("x", "y"), 1.0),
    ],
)
def test_units_are_those_of_the_columns(axes, labels, aspect):
    t = np.arange(10.0)
    tracked = ft.track({"t": t, axes[0]: 3 * t, axes[1]: 400 - t}, axes=axes, sigma=1.0)
    ax, _ = drawn(tracked.plot())
    assert (ax.get_xlabel(), ax.get_ylabel()) == labels
    assert ax.get_aspect() == aspect


def test_tracks_keep_their_identities_and_few_show_their_gains():
    t = np.tile(np.arange(8.0), 4)
    ids = np.repeat(["A7", "B2", "C3", "D4"], 8)
    x = np.repeat([0.0, 50, 90, 130], 8) + t
    for count in (1, 2, 3, 4):
        some = np.isin(ids, ids[: 8 * count])
        plots = {"id": ids[some], "t": t[some], "x": x[some], "y": t[some]}
        tracked = ft.track(plots, id="id", sigma=1.0)
        figure = tracked.plot()
        names = {"filtered"} if count == 1 else {"A7", "B2", "C3", "D4"} & set(ids[some])
        assert names <= set(drawn(figure)[1])
        assert len(figure.axes) == (2 if count <= 3 else 1)
        assert len(tracked.plot(gains=False).axes) == 1
        assert len(tracked.plot(gains=True).axes) == 2
    single = ft.track({"t": [0.0], "x": [1.0], "y": [2.0]}, sigma=1.0)
    assert len(single.plot().axes) == 1


def test_plots_beyond_the_gate_are_marked():
    t = np.arange(40.0)
    x = 10 * t + np.random.default_rng(1).normal(size=40)
    x[20] += 60
    _, lines = drawn(ft.track({"t": t, "x": x, "y": 2 * t}, sigma=1.0).plot())
    np.testing.assert_array_equal(lines["plots not used"], [(x[20], 40.0)])
    assert np.isnan(lines["plots"][20]).all()
    assert len(lines["coasted"]) == 1


def test_tracks_are_in_the_order_of_their_names():
    t = np.repeat(np.arange(6.0), 3)
    ids = np.tile(["A10", "B1", "A2"], 6)
    tracked = ft.track({"id": ids, "t": t, "x": t, "y": 3 * t}, id="id", sigma=1.0)
    legend = drawn(tracked.plot())[0].get_legend()
    named = [text.get_text() for text in legend.get_texts()]
    assert named == ["plots", "A2", "B1", "A10", "start", "end"]
