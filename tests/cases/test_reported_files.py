"""Small files after public reports, each with its right value; they are kept beside the project."""

import csv
import os
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from fuzzytrack.cli.app import app

BESIDE = Path(__file__).resolve().parents[2].parent / "shared" / "cases"
FIXED = ("--tracker", "fixed:alpha=0.5:beta=0.2")


@pytest.fixture
def track(tmp_path):
    """Track a file of a case; gives the columns of the tracks, numbers where they are some."""

    def call(name, *options):
        path = Path(os.environ.get("FUZZYTRACK_CASES", BESIDE)) / name
        if not path.is_file():
            pytest.skip(f"no {name} in FUZZYTRACK_CASES or beside the project")
        out = tmp_path / "out.csv"
        result = CliRunner().invoke(app, ["track", str(path), *options, "-o", str(out)])
        if result.exit_code:
            assert result.exit_code == 2, result.output
            (line,) = result.stderr.splitlines()
            return line
        with out.open(encoding="utf-8", newline="") as stream:
            rows = list(csv.DictReader(stream))
        return {name: values_of([row[name] for row in rows]) for name in rows[0]}

    return call


def values_of(cells):
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return cells


@pytest.mark.parametrize(
    ("name", "options", "velocity"),
    [
        ("02-epoch-nanoseconds/ms.csv", FIXED, 2.5),
        ("02-epoch-nanoseconds/ns.csv", FIXED, 5.0),
        ("02-epoch-nanoseconds/ns-1us.csv", FIXED, 5e4),
        ("02-epoch-nanoseconds/s.csv", FIXED, 2.5),
        ("19-clock-wrap/midnight.csv", ("--id", "track"), 200.0),
        ("25-guessed-columns/temperature.csv", ("--time", "time", *FIXED), 0.5),
    ],
)
def test_velocities(track, name, options, velocity):
    found = track(name, *options)["x_velocity"]
    np.testing.assert_allclose(found[1:], velocity, rtol=1e-9)


def test_a_bearing_that_passes_north(track):
    found = track("05-angle-wrap/bearing.csv", "--angle", "bearing", *FIXED)
    expected = [0.024, 1.016, 2.009, 2.954, 4.015]
    np.testing.assert_allclose(found["bearing_filtered"][5:], expected, atol=0.0006)
    assert found["bearing_velocity"][5:] == pytest.approx(1, abs=0.025)


def test_copies_of_a_row(track):
    found = track("04-duplicate-times/dups.csv", "--id", "id")
    ours = np.array(found["id"]) == "A7"
    assert ours.sum() == 4
    np.testing.assert_allclose(found["x_velocity"][ours][1:], 10, atol=0.5)


@pytest.mark.parametrize("name", ["gap-rows.csv", "gap-dropped.csv"])
def test_rows_left_out_change_nothing(track, name):
    found = track(f"13-missing-tokens/{name}", *FIXED)
    np.testing.assert_allclose(found["x_velocity"][-3:], [10.5, 11.4, 11.57])


@pytest.mark.parametrize("name", ["start", "mid", "pairs"])
def test_plots_almost_at_one_time(track, name):
    """About what the plots themselves show in the long run, by a parabola through all of them."""
    found = track(f"14-near-duplicate-times/{name}.csv")
    t, x = found["time"], found["x"]
    known = np.isfinite(x)
    course = np.polyval(np.polyfit(t[known], x[known], 2), t)
    assert np.sqrt(np.mean((found["x_filtered"] - course)[2:] ** 2)) < 3


def test_two_voyages_of_one_ship(track):
    found = track("15-gap-between-voyages/gap.csv", "--id", "id", "--tracker", "stiffness-damping")
    assert found["segment"].tolist() == [0] * 20 + [1] * 20
    error = np.hypot(found["x_innovation"], found["y_innovation"])
    assert np.sqrt(np.nanmean(error**2)) == pytest.approx(11.8, abs=0.05)


def test_spikes_of_a_sonar(track):
    found = track("16-spikes-sentinels/sonar.csv", "--sigma", "0.01")["x_filtered"]
    assert (found > 0.505).all()
    assert (found < 0.535).all()


def test_codes_for_no_position(track):
    words = ("--id", "id", "--axes", "lon,lat", "--cartesian", "--tracker", "stiffness-damping")
    found = track("16-spikes-sentinels/ais.csv", *words, "--valid", "lon=-180:180")
    np.testing.assert_allclose(found["lon_velocity"][1:], 7e-5, rtol=1e-6)
    east = track("16-spikes-sentinels/ais.csv", "--id", "id", "--geodetic", "lat,lon")
    np.testing.assert_allclose(east["east_velocity"][1:], 5.9688, rtol=1e-4)


@pytest.mark.parametrize(
    ("name", "options", "remedy"),
    [
        ("01-decimal-comma/comma.csv", (), "quotes must be around them, or semicolons"),
        ("03-iso-time/ais.csv", ("--axes", "LON,LAT"), "--geodetic=LAT,LON"),
        ("04-duplicate-times/whole-seconds.csv", (), "--duplicates to say which plot counts"),
        ("05-angle-wrap/bearing.csv", ("--axes", "bearing"), "--angle=bearing"),
        ("17-mot-no-header/det.txt", (), "if the id -1 says that there is none"),
        ("25-guessed-columns/temperature.csv", (), "name one of them with --time"),
    ],
)
def test_what_cannot_be_tracked_is_an_error_with_the_remedy(track, name, options, remedy):
    assert remedy in track(name, *options)
