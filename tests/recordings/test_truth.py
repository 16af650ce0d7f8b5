"""True positions of recorded plots, in their coordinates and at their times."""

import numpy as np
import pytest

from fuzzytrack import DataError
from fuzzytrack.io import Reading, read_tracks
from fuzzytrack.io.plot_files import PlotFiles
from fuzzytrack.io.recording import read_recording, recording_files
from fuzzytrack.recordings.truth import read_truth, true_positions


def found(plots, truth, **options):
    """True positions of each track of a file of plots."""
    files = PlotFiles.of(recording_files(plots), Reading.of(**options))
    tracks = read_recording(files).tracks
    true = read_truth(truth, files)
    return [true_positions(track, true) for track in tracks]


@pytest.fixture
def files(tmp_path):
    def write(name, text):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


def test_truth_is_interpolated_and_unknown_outside(files):
    plots = files("plots.csv", "t,id,x,y\n9,a,0,0\n10,a,0,0\n11,b,0,0\n11,a,,\n12,a,0,0\n13,a,0,0")
    truth = files("truth.csv", "t,id,x,y\n10,a,21,1\n12,a,25,2\n0,b,0,0\n500,b,1000,0\n")
    a, b = found(plots, truth, id="id")
    np.testing.assert_array_equal(a[:, 0], [np.nan, 21, 23, 25, np.nan])
    np.testing.assert_array_equal(a[1:4, 1], [1, 1.5, 2])
    np.testing.assert_array_equal(b, [[22, 0]])


def test_columns_beside_the_plots(files):
    plots = files("plots.csv", "t,x,y,u,v\n0,1,2,3,4\n1,5,6,7,8\n")
    (columns,) = found(plots, "v, u")
    np.testing.assert_array_equal(columns, [[4, 3], [8, 7]])
    with pytest.raises(DataError, match=r"truth: there is no file vv,u, and .* no column 'vv'"):
        found(plots, "vv,u")


def test_dates_begin_where_those_of_the_plots_do(files):
    plots = files("plots.csv", "time,x\n2024-05-01T12:00:10Z,0\n2024-05-01T12:00:20Z,0\n")
    truth = files("truth.csv", "time,x\n2024-05-01T12:00:00Z,0\n2024-05-01T12:00:30Z,300\n")
    (dates,) = found(plots, truth)
    np.testing.assert_allclose(dates[:, 0], [100, 200])
    late = files("late.csv", "time,x\n10000000,0\n10000001,0\n")
    near = files("near.csv", "time,x\n9999999,0\n10000003,4\n")
    np.testing.assert_allclose(found(late, near)[0][:, 0], [1, 2])
    with pytest.raises(DataError, match=r"times of .*late\.csv are numbers, those of .* dates"):
        found(plots, late)


def test_polar_plots_may_have_a_truth_in_x_and_y(files):
    plots = files(
        "plots.csv",
        "t,range,azimuth,true_range,true_azimuth,east,north\n0,9,88,10,90,10,0\n1,9,2,10,0,0,10\n",
    )
    wanted = [[10, 0], [0, 10]]
    same = files("same.csv", "t,range,azimuth\n0,10,90\n1,10,0\n")
    flat = files("flat.csv", "t,x,y\n0,10,0\n1,0,10\n")
    for truth in (same, flat, "true_range,true_azimuth", "east,north"):
        options = {"polar": ("range", "azimuth"), "sigma_range": 1, "sigma_azimuth": 1}
        (places,) = found(plots, truth, **options)
        np.testing.assert_allclose(places, wanted, atol=1e-9)


def test_places_on_earth_are_about_the_origin_of_the_plots(files):
    plots = files("plots.csv", "t,lat,lon\n0,50,10\n1,50.001,10\n2,50.002,10\n")
    truth = files("truth.csv", "t,lat,lon\n-1,49.999,10\n3,50.003,10\n")
    options = {"geodetic": ("lat", "lon")}
    (places,) = found(plots, truth, **options)
    (track,) = read_tracks(plots, **options).tracks
    # Along a meridian the truth passes through the plots; the plane drops by millimeters.
    np.testing.assert_allclose(places, track.plots, atol=0.01)


def test_angles_are_in_the_turn_of_the_plot(files):
    plots = files("plots.csv", "t,heading\n0,359\n1,1\n2,\n3,358\n")
    truth = files("truth.csv", "t,heading\n0,358\n3,4\n")
    (angles,) = found(plots, truth, angle="heading")
    # From 358 over north to 364.
    np.testing.assert_allclose(angles[[0, 1, 3], 0], [358, 0, 364])
    (columns,) = found(plots, "heading", angle="heading")
    np.testing.assert_allclose(columns[[0, 1, 3], 0], [359, 1, 358])


def test_what_does_not_fit_is_named(files):
    plots = files("plots.csv", "t,id,x,y\n0,a,0,0\n1,b,0,0\n")
    alone = files("truth.csv", "t,id,x,y\n0,a,0,0\n")
    with pytest.raises(DataError, match=r"truth\.csv: has no track 'b', for which there are plots"):
        found(plots, alone, id="id")
    space = files("space.csv", "t,id,x,y,z\n0,a,0,0,0\n1,b,0,0,0\n")
    with pytest.raises(DataError, match=r"space\.csv: has 3 axes, the plots have 2"):
        found(plots, space, id="id")
