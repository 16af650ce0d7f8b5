"""Recorded plots tracked from their files as they are, against what is known of the truth."""

import csv
import math
import os
from pathlib import Path

import numpy as np
import pytest

import fuzzytrack as ft

BESIDE = Path(__file__).resolve().parents[2].parent / "shared" / "data"


@pytest.fixture(scope="module")
def real():
    """Path of a recorded file, or skip."""
    folder = Path(os.environ.get("FUZZYTRACK_DATA", BESIDE))

    def find(name):
        if not (folder / name).is_file():
            pytest.skip(f"no {name} in FUZZYTRACK_DATA or beside the project")
        return str(folder / name)

    return find


def columns(path, *names):
    """Columns of numbers of a file, NaN where a cell is empty."""
    with open(path) as file:
        rows = list(csv.DictReader(file))
    return [np.array([float(row[name] or "nan") for row in rows]) for name in names]


def rms(positions, truth):
    return math.sqrt(np.nanmean(np.sum((positions - truth) ** 2, axis=-1)))


def test_a_drone_from_its_dates_latitudes_and_longitudes(real):
    """As from the file of meters that was derived from them."""
    path = real("uav_gps/UAV_Rot.csv")
    with pytest.raises(ft.DataError, match="columns 'time' and 'timestamp' could all be the time"):
        ft.track(path)
    with pytest.raises(ft.DataError, match="`geodetic`=latitude,longitude takes"):
        ft.track(path, time="time")
    # The noise of these places is centimeters, and the drone turns by meters between two of them.
    raw = ft.track(path, time="time", geodetic=("latitude", "longitude"))
    derived = ft.track(real("uav_gps/uav_enu.csv"))
    (one,), (other,) = raw.results, derived.results
    assert len(one.predicted) == 965
    assert np.array_equal(raw.recording.tracks[0].time, derived.recording.tracks[0].time)
    assert np.nanmax(np.abs(one.predicted - other.predicted)) < 0.05
    assert rms(one.predicted, raw.recording.tracks[0].plots) < 1.5


def test_an_airliner_from_range_and_azimuth(real):
    """Of the plots, 556 are clutter without an identity. The README: 50 m and 0.1°."""
    path = real("adsb_turns/radar_plots_sim.csv")
    tracked = ft.track(path, polar=("range_m", "az_deg"), id="truth_id")
    assert tracked.findings.unnamed == 556
    (track,), (result,) = tracked.recording.tracks, tracked.results
    assert len(track.time) == 1020
    noise, error = tracked.recording.decoder.noise, tracked.recording.decoder.noise_errors
    for value, deviation, right in zip(noise, error, (50, 0.1), strict=True):
        assert value == pytest.approx(right, rel=0.05)
        assert abs(value - right) < 3 * deviation
    t, *axes = columns(real("adsb_turns/truth_1s.csv"), "t_s", "x_m", "y_m")
    truth = np.stack([np.interp(track.time, t, axis) for axis in axes], axis=-1)
    assert rms(track.plots, truth) == pytest.approx(118, abs=1)
    assert rms(result.filtered, truth) < 90
    assert rms(result.predicted, truth) < 146


@pytest.mark.untraced
def test_its_published_places(real):
    path = real("adsb_turns/truth_1s.csv")
    smooth = ft.track(path, id="icao24")
    places = ft.track(path, id="icao24", geodetic=("raw_lat", "raw_lon"), site=(52.14, 5.35))
    assert sum(len(track.time) for track in places.recording.tracks) == 4501
    x, y = columns(path, "x_m", "y_m")
    found = np.concatenate([result.filtered for result in places.results])
    error = np.linalg.norm(found - np.stack([x, y], axis=-1), axis=1)
    assert np.nanmedian(error) < 30
    assert rms(smooth.results[0].predicted, smooth.recording.tracks[0].plots) < 1


def test_a_radar_on_a_ferry(real):
    """Plots of several targets in a scan are refused; those near a target are tracked."""
    path = real("autoferry_radar/radar_detections.csv")
    with pytest.raises(ft.DataError, match=r"row 3, column t_s: time 1\.184 .* repeats"):
        ft.track(path, axes=("east_m", "north_m"), id="scenario")
    scenario, t, east, north = columns(path, "scenario", "t_s", "east_m", "north_m")
    truth = columns(
        real("autoferry_radar/ground_truth.csv"),
        "scenario", "target_id", "t_s", "east_m", "north_m",
    )  # fmt: skip
    # The radar lags by this much, see the README.
    for number, lag in ((2, 2.25), (4, 3.5), (16, 1.75)):
        for target in (1, 2):
            rows = (truth[0] == number) & (truth[1] == target)
            places = np.stack(
                [
                    np.interp(t - lag, truth[2][rows], axis[rows], np.nan, np.nan)
                    for axis in truth[3:]
                ],
                axis=-1,
            )
            plots = np.stack([east, north], axis=-1)
            near = (scenario == number) & (np.linalg.norm(plots - places, axis=1) < 20)
            nearest = {}
            for row in np.flatnonzero(near):
                distance = np.linalg.norm(plots[row] - places[row])
                if distance < nearest.get(t[row], (math.inf, 0))[0]:
                    nearest[t[row]] = distance, row
            chosen = np.array([row for _, row in nearest.values()])
            tracked = ft.track((t[chosen], plots[chosen]))
            filtered = np.concatenate([result.filtered for result in tracked.results])
            assert rms(filtered, places[chosen]) < 1.05 * rms(plots[chosen], places[chosen])
