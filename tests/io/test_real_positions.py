"""Recorded plots as positions: places on earth, polar plots, and a moving own ship."""

import csv
import os
from pathlib import Path

import numpy as np
import pytest

from fuzzytrack.io.geodetic import LocalFrame
from fuzzytrack.io.own_ship import relative_to_own_ship
from fuzzytrack.io.polar import cartesian_to_polar, polar_to_cartesian

BESIDE = Path(__file__).resolve().parents[2].parent / "shared" / "data"


@pytest.fixture(scope="module")
def columns():
    """Columns of a recorded file as text, or skip."""
    folder = Path(os.environ.get("FUZZYTRACK_DATA", BESIDE))

    def read(name):
        if not (folder / name).is_file():
            pytest.skip(f"no {name} in FUZZYTRACK_DATA or beside the project")
        with (folder / name).open() as file:
            rows = list(csv.DictReader(file))
        return {key: np.array([row[key] for row in rows]) for key in rows[0]}

    return read


def numbers(table, *names):
    return [np.array([float(cell or "nan") for cell in table[name]]) for name in names]


def test_latitudes_and_longitudes_of_a_drone(columns):
    """The file beside them has an azimuthal-equidistant projection about the first, on WGS 84."""
    lat, lon, alt = numbers(columns("uav_gps/UAV_Rot.csv"), "latitude", "longitude", "altitude (m)")
    derived = np.stack(numbers(columns("uav_gps/uav_enu.csv"), "x_m", "y_m"), axis=-1)
    frame = LocalFrame(lat[0], lon[0])
    found = frame.to_local(lat, lon)
    assert not (found.impossible | found.too_far).any()
    # Rounded to 1 mm there; at 1.9 km the projections differ by 0.03 mm.
    assert np.abs(found.position - derived).max() < 0.6e-3
    back = frame.to_geodetic(found.position)
    assert back.lat == pytest.approx(lat, abs=1e-11)
    assert back.lon == pytest.approx(lon, abs=1e-11)
    # 700 m up, the same angles are 0.011 % longer distances.
    high = LocalFrame(lat[0], lon[0], alt[0]).to_local(lat, lon, alt).position
    scale = np.linalg.norm(high[:, :2]) / np.linalg.norm(derived)
    assert scale == pytest.approx(1 + alt[0] / 6371e3, abs=1e-5)
    # The plane of the origin falls behind the height by up to 0.3 m.
    drop = np.sum(derived**2, axis=1) / (2 * 6371e3)
    assert high[:, 2] + drop == pytest.approx(alt - alt[0], abs=5e-3)


def test_simulated_radar_plots_of_an_airliner(columns):
    plots = columns("adsb_turns/radar_plots_sim.csv")
    truth = columns("adsb_turns/truth_1s.csv")
    t, distance, degrees = numbers(plots, "t_s", "range_m", "az_deg")
    found = polar_to_cartesian(
        distance, np.radians(degrees), sigma_range=50.0, sigma_azimuth=np.radians(0.1)
    )
    assert not found.impossible.any()
    times, *axes = numbers(truth, "t_s", "x_m", "y_m")
    true = np.stack([np.interp(t, times, axis) for axis in axes], axis=-1)
    own = plots["truth_id"] != ""
    error = found.position[own] - true[own]
    # 50 m along and 0.1° across, as its README says.
    solved = np.linalg.solve(found.covariance[own], error[..., None])[..., 0]
    assert np.mean(np.sum(error * solved, axis=1)) == pytest.approx(2.0, abs=0.15)
    assert np.abs(error.mean(axis=0)).max() < 10
    back = cartesian_to_polar(polar_to_cartesian(distance, np.radians(degrees)).position)
    assert back.range == pytest.approx(distance, rel=1e-12)
    assert np.degrees(back.azimuth) == pytest.approx(degrees % 360, abs=1e-9)


def test_the_published_places_of_an_airliner(columns):
    """Its file of true positions has a local plane about the radar at 52.14 N 5.35 E."""
    truth = columns("adsb_turns/truth_1s.csv")
    x, y, lat, lon = numbers(truth, "x_m", "y_m", "raw_lat", "raw_lon")
    found = LocalFrame(52.14, 5.35).to_local(lat, lon).position
    error = found - np.stack([x, y], axis=-1)
    # Smoothed there; a few of the published places lag by more than 100 m.
    assert np.abs(np.nanmedian(error, axis=0)).max() < 5
    assert np.nanmedian(np.abs(error), axis=0).max() < 25


def test_radar_plots_from_a_moving_ferry(columns):
    plots = columns("autoferry_radar/radar_detections.csv")
    scans = columns("autoferry_radar/radar_scans.csv")
    ship = {
        (scenario, scan): (float(east), float(north))
        for scenario, scan, north, east in zip(
            scans["scenario"],
            scans["scan"],
            scans["own_north_m"],
            scans["own_east_m"],
            strict=True,
        )
    }
    keys = zip(plots["scenario"], plots["scan"], strict=True)
    own = np.array([ship[key] for key in keys])
    names = "rel_east_m", "rel_north_m", "east_m", "north_m"
    rel_east, rel_north, east, north = numbers(plots, *names)
    expected = np.stack([east, north], axis=-1)
    seen = cartesian_to_polar(np.stack([rel_east, rel_north], axis=-1))
    relative = polar_to_cartesian(seen.range, seen.azimuth)
    found = relative_to_own_ship(relative, own)
    # Rounded to 1 mm in both files.
    assert found.position == pytest.approx(expected, abs=2.1e-3)
    # As bearings from a bow that points to 217°.
    headed = polar_to_cartesian(seen.range, seen.azimuth - np.radians(217.0))
    turned = relative_to_own_ship(headed, own, 217.0)
    assert turned.position == pytest.approx(expected, abs=2.1e-3)
    # The same with the ferry as a place on earth.
    frame = LocalFrame(63.4389, 10.3995)
    places = frame.to_geodetic(own)
    on_earth = relative_to_own_ship(
        relative, np.stack([places.lat, places.lon], axis=-1), frame=frame
    )
    # 600 m away, north is turned by 0.01°.
    assert on_earth.position == pytest.approx(expected, abs=0.1)
