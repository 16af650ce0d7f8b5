"""Rows of a table as plots: each kind of position, with its noise."""

import math

import numpy as np
import pytest

from fuzzytrack import DataError
from fuzzytrack.io.data_frame import FrameSource
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.plot_files import PlotFiles
from fuzzytrack.io.reading import Reading


def read(columns, findings=None, **options):
    """Decoder and the only piece of some columns."""
    time = np.arange(len(next(iter(columns.values()))), dtype=float)
    source = FrameSource.of({"t": time, **columns})
    files = PlotFiles.of((source,), Reading.of(**options))
    (piece,) = files.pieces(findings=findings)
    return files.decoder, piece


RADAR = {"r": [1000.0, 2000.0], "az": [90.0, 180.0]}


def test_polar_plots_without_noise_are_where_range_and_azimuth_say():
    decoder, piece = read(RADAR, polar=("r", "az"))
    assert decoder.columns.axes == ("x", "y")
    np.testing.assert_allclose(piece.plots, [[1000, 0], [0, -2000]], atol=1e-9)
    assert piece.sigma is None
    assert decoder.noise_is_polar
    assert not decoder.noise_is_known


def test_azimuth_from_east_turns_the_other_way():
    _, piece = read(RADAR, polar=("r", "az"), azimuth_from="east")
    np.testing.assert_allclose(piece.plots, [[0, 1000], [-2000, 0]], atol=1e-9)


def test_polar_noise_becomes_noise_along_and_across():
    decoder, piece = read(RADAR, polar=("r", "az"), sigma_range=10.0, sigma_azimuth=1.0)
    assert decoder.noise == (10.0, 1.0)
    assert decoder.sigma is None
    across = np.deg2rad(1.0)
    # Along the range in x, then in y; the range is exact to 1 part in 10^4.
    np.testing.assert_allclose(piece.sigma[0], [10.0, 1000 * across], rtol=2e-3)
    np.testing.assert_allclose(piece.sigma[1], [2000 * across, 10.0], rtol=5e-3)


def test_polar_noise_from_columns_with_an_elevation():
    columns = {**RADAR, "el": [0.0, 30.0], "sr": [5.0, 6.0], "sa": [0.5, 0.5]}
    decoder, piece = read(
        columns,
        polar=("r", "az", "el"),
        sigma_range="sr",
        sigma_azimuth="sa",
        sigma_elevation=0.25,
    )
    assert decoder.columns.noise == ("sr", "sa")
    assert piece.plots.shape == piece.sigma.shape == (2, 3)
    assert piece.sigma[0, 0] == pytest.approx(5.0, rel=1e-2)
    assert piece.plots[1, 2] == pytest.approx(1000.0, rel=1e-4)


def test_angles_in_radians_by_their_names():
    degrees = read(RADAR, polar=("r", "az"), sigma_range=10.0, sigma_azimuth=1.0)[1]
    columns = {"r": RADAR["r"], "az_rad": np.deg2rad(RADAR["az"])}
    radians = read(columns, polar=("r", "az_rad"), sigma_range=10.0, sigma_azimuth=1.0)[1]
    np.testing.assert_allclose(radians.plots, degrees.plots, atol=1e-9)
    # Standard deviations of angles are in degrees in both.
    np.testing.assert_allclose(radians.sigma, degrees.sigma)


def test_lengths_in_other_units_become_meters():
    plain = {**RADAR, "ox": [500.0, 1000.0], "oy": [0.0, -500.0], "sr": [10.0, 20.0]}
    options = {"sigma_azimuth": 1.0, "valid": (("r", 500, 3000),)}
    meters = read(plain, polar=("r", "az"), own_ship=("ox", "oy"), sigma_range="sr", **options)[1]
    columns = {
        "Rng[NM]": plain["r"] / np.float64(1852),
        "az": plain["az"],
        "ox_km": plain["ox"] / np.float64(1000),
        "oy": plain["oy"],
        "sr (ft)": plain["sr"] / np.float64(0.3048),
    }
    # Limits are those of the column, in its own unit.
    options["valid"] = (("Rng[NM]", 0.25, 2),)
    polar, own = ("Rng[NM]", "az"), ("ox_km", "oy")
    other = read(columns, polar=polar, own_ship=own, sigma_range="sr (ft)", **options)[1]
    np.testing.assert_allclose(other.plots, meters.plots, atol=1e-9)
    np.testing.assert_allclose(other.sigma, meters.sigma)


def test_altitudes_in_feet_become_meters():
    places = {"lat": [60.0, 60.0], "lon": [10.0, 10.0]}
    for site in (None, (60.0, 10.0, 1000.0)):
        columns = {**places, "alt_ft": [10000.0, 11000.0]}
        _, piece = read(columns, geodetic=("lat", "lon", "alt_ft"), site=site)
        assert np.diff(piece.plots[:, 2]) == pytest.approx(304.8, abs=1e-3)
        begins = 0 if site is None else 2048
        assert piece.plots[0, 2] == pytest.approx(begins, abs=1e-3)


@pytest.mark.parametrize(("name", "period"), [("bearing", 360.0), ("bearing_rad", 2 * math.pi)])
def test_a_bare_angle_has_a_period(name, period):
    decoder, piece = read({name: [0.5, 1.0]}, angle=name)
    assert decoder.period == period
    assert piece.plots.tolist() == [[0.5], [1.0]]
    assert read(RADAR, polar=("r", "az"))[0].period is None


def test_a_bare_angle_from_the_bow():
    columns = {"bearing": [10.0, 350.0], "heading_rad": np.deg2rad([90.0, 20.0])}
    _, piece = read(columns, angle="bearing", own_heading="heading_rad")
    np.testing.assert_allclose(piece.plots[:, 0] % 360, [100.0, 10.0])


def test_geodetic_plots_about_a_site_and_about_the_first_plot():
    columns = {"lat": [60.0, 60.01], "lon": [10.0, 10.0]}
    # Along the meridian of the ellipsoid WGS 84 at 60° a degree has 111,412 m.
    _, about_first = read(columns, geodetic=("lat", "lon"))
    np.testing.assert_allclose(about_first.plots[0], [0.0, 0.0], atol=1e-6)
    assert about_first.plots[1, 1] == pytest.approx(1114.12, abs=0.1)
    decoder, about_site = read(columns, geodetic=("lat", "lon"), site=(60.01, 10.0), sigma=3.0)
    assert about_site.plots[0, 1] == pytest.approx(-1114.12, abs=0.1)
    assert decoder.columns.axes == ("east", "north")
    assert decoder.sigma == 3.0


def test_impossible_places_are_missed_plots_and_counted():
    findings = Findings()
    columns = {"lat": [60.0, 91.0, -60.0], "lon": [10.0, 10.0, 100.0]}
    _, piece = read(columns, findings, geodetic=("lat", "lon"))
    assert np.isnan(piece.plots[1:]).all()
    assert dict(findings.impossible) == {
        "an impossible latitude or longitude": 1,
        "a place more than 5000 km away": 1,
    }


def test_no_place_at_all():
    with pytest.raises(DataError, match="columns lat, lon: no latitude and longitude within"):
        read({"lat": [91.0], "lon": [0.0]}, geodetic=("lat", "lon"))


def test_an_impossible_range_is_a_missed_plot():
    findings = Findings()
    _, piece = read({"r": [-1.0, 5.0], "az": [0.0, 0.0]}, findings, polar=("r", "az"))
    assert np.isnan(piece.plots[0]).all()
    assert dict(findings.impossible) == {"an impossible range or angle": 1}


def test_polar_plots_of_a_moving_ship_that_turns():
    own = {"ox": [100.0, 200.0], "oy": [0.0, 50.0], "heading": [0.0, 90.0]}
    columns = {**own, "r": [1000.0, 1000.0], "az": [0.0, 0.0]}
    _, piece = read(columns, polar=("r", "az"), own_ship=("ox", "oy"), own_heading="heading")
    np.testing.assert_allclose(piece.plots, [[100, 1000], [1200, 50]], atol=1e-9)


def test_cartesian_plots_of_a_moving_ship():
    columns = {"x": [1.0, 2.0], "y": [0.0, 0.0], "ox": [10.0, 20.0], "oy": [5.0, 6.0]}
    _, piece = read(columns, own_ship=("ox", "oy"), sigma=2.0)
    np.testing.assert_allclose(piece.plots, [[11, 5], [22, 6]])


def test_an_own_ship_on_the_earth_is_the_origin():
    columns = {"r": [100.0, 100.0], "az": [0.0, 0.0], "lat": [60.0, 60.01], "lon": [10.0, 10.0]}
    decoder, piece = read(columns, polar=("r", "az"), own_ship=("lat", "lon"))
    assert decoder.own_ship_is_geodetic
    np.testing.assert_allclose(piece.plots[:, 1], [100.0, 1214.12], atol=0.1)


def test_standard_deviations_from_columns():
    columns = {"x": [1.0, 2.0], "y": [0.0, 0.0], "sx": [3.0, 4.0], "sy": [5.0, 6.0]}
    decoder, piece = read(columns, sigma=("sx", "sy"))
    assert piece.sigma.tolist() == [[3, 5], [4, 6]]
    assert decoder.noise_is_known
    assert decoder.sigma is None


def test_a_missed_plot_needs_no_standard_deviation():
    columns = {"x": [1.0, math.nan], "s": [3.0, math.nan]}
    assert read(columns, sigma="s")[1].sigma.tolist() == [[3], [1]]
    with pytest.raises(DataError, match="row 2, column s: 0; expected a standard deviation > 0"):
        read({"x": [1.0, 2.0], "s": [3.0, 0.0]}, sigma="s")


def test_values_that_are_not_valid_are_missed_plots_and_counted():
    findings = Findings()
    columns = {"x": [1.0, -999.0, 3.0], "y": [0.0, 0.0, 0.0]}
    limits = (("x", 0.0, math.inf), ("y", -1.0, 1.0))
    _, piece = read(columns, findings, valid=limits)
    assert np.isnan(piece.plots).all(axis=1).tolist() == [False, True, False]
    assert dict(findings.impossible) == {"x outside of 0 to inf": 1}


def test_an_estimate_fills_in_what_is_not_given():
    decoder, _ = read(RADAR, polar=("r", "az"), sigma_azimuth=0.5)
    assert not decoder.noise_is_known
    found = decoder.with_estimate([10.0, 1.0], [0.1, 0.2])
    assert found.noise == (10.0, 0.5)
    assert found.noise_errors == (0.1, None)
    assert found.noise_is_known


def test_a_date_and_a_time_of_day_are_one_time():
    columns = {
        "day": ["2024-05-01", "2024-05-02"],
        "clock": ["23:59:59", "00:00:01"],
        "x": [0.0, 1.0],
    }
    _, piece = read(columns, time=("day", "clock"))
    assert np.diff(piece.time).tolist() == [2.0]
