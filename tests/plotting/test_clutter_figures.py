"""The clutter map: which densities are read where, and how they are colored."""

import numpy as np
import pytest
from drawn_lines import lines
from harbor import harbor
from matplotlib.colors import LogNorm

from fuzzytrack.plotting import plot_clutter_map
from fuzzytrack.scan import Scan

HARBOR = harbor()


def ramp(x, y):
    """Grows along x only."""
    return 1e-6 * 10 ** (x / 100.0) + 0 * y


def mesh_of(ax):
    (mesh,) = ax.collections
    return mesh


def test_densities_are_read_at_the_middles_of_cells():
    seen = []

    def density(x, y):
        seen.append((x, y))
        return ramp(x, y)

    _, ax = plot_clutter_map(density, extent=((0.0, 200.0), (-50.0, 50.0)), cells=20)
    ((x, y),) = seen
    assert x.shape == y.shape == (20, 10)
    np.testing.assert_allclose(x[:, 0], np.arange(5.0, 200.0, 10.0))
    np.testing.assert_allclose(y[0], np.arange(-45.0, 50.0, 10.0))
    mesh = mesh_of(ax)
    np.testing.assert_allclose(np.asarray(mesh.get_array()), ramp(x, y))
    assert isinstance(mesh.norm, LogNorm)
    assert ax.child_axes[0].get_ylabel() == "clutter (plots per m² and scan)"
    assert ax.get_aspect() == 1.0


def test_north_is_upwards():
    extent = ((0.0, 200.0), (-50.0, 50.0))
    _, ax = plot_clutter_map(ramp, extent=extent, axes_names=("north", "east"), cells=20)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("east (m)", "north (m)")
    coordinates = mesh_of(ax).get_coordinates()
    values = np.asarray(mesh_of(ax).get_array())
    # Where the density is high is where north is large.
    high = np.unravel_index(values.argmax(), values.shape)
    assert coordinates[high][1] == pytest.approx(190.0)


def test_a_session_is_asked_for_its_density_and_a_number_is_spread():
    class Session:
        @staticmethod
        def clutter_density(x, y):
            return np.full(np.shape(x), 3e-5)

    extent = ((0.0, 10.0), (0.0, 10.0))
    for density in (Session(), lambda x, y: 3e-5):
        _, ax = plot_clutter_map(density, extent=extent, cells=4)
        np.testing.assert_array_equal(mesh_of(ax).get_array(), np.full((4, 4), 3e-5))


def test_the_map_goes_as_far_as_the_plots_and_shows_the_last_ones():
    far = Scan(999.0, np.array([[1e7, 1e7]]))
    scans = [*HARBOR.scans, far, *HARBOR.scans[-3:]]
    _, ax = plot_clutter_map(ramp, scans, recent=3)
    drawn = lines(ax)
    expected = np.concatenate([scan.positions for scan in scans[-3:]])
    np.testing.assert_array_equal(drawn["plots of the last 3 scans"], expected)
    np.testing.assert_array_equal(drawn["radar"], [HARBOR.scans[-1].own])
    low, high = ax.get_xlim()
    everything = np.concatenate([scan.positions for scan in HARBOR.scans])
    assert low < np.quantile(everything[:, 0], 0.01)
    assert np.quantile(everything[:, 0], 0.99) < high < 2000


def test_very_low_densities_share_a_color():
    def density(x, y):
        return np.where(x < 5, 1e-30, 1.0)

    _, ax = plot_clutter_map(density, extent=((0.0, 10.0), (0.0, 10.0)), cells=4)
    assert (mesh_of(ax).norm.vmin, mesh_of(ax).norm.vmax) == (1e-5, 1.0)


@pytest.mark.parametrize(
    ("density", "options", "message"),
    [
        (ramp, {}, "extent: must be given if there are no scans with a plot"),
        (ramp, {"scans": [Scan(0.0, np.empty((0, 2)))]}, "extent: must be given if there are no"),
        (ramp, {"extent": ((1, 0), (0, 1))}, "extent: needs a first and a larger last value"),
        (lambda x, y: 0 * x, {"extent": ((0, 1), (0, 1))}, "density: must be positive everywhere"),
        (3.0, {"extent": ((0, 1), (0, 1))}, "density: must be a session .* got float"),
    ],
)
def test_what_cannot_be_drawn_is_said(density, options, message):
    with pytest.raises(ValueError, match=message):
        plot_clutter_map(density, **options)
