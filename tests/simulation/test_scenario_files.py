import math

import numpy as np
import pytest
from scenario_texts import HEAD, SENSORS, TARGET, complaint, with_sensors, with_target

from fuzzytrack.errors import ScenarioError
from fuzzytrack.simulation.noise import Noise, noisy_plots, streams
from fuzzytrack.simulation.plot_table import plot_columns
from fuzzytrack.simulation.published import kim_lee, llinas_maneuver, s3, track_set, warship
from fuzzytrack.simulation.sampling import Sampling
from fuzzytrack.simulation.scenario import PlotNoise
from fuzzytrack.simulation.scenario_files import (
    load_scenario,
    loads_scenario,
    scenario_path,
    scenario_source,
    shipped_scenarios,
)
from fuzzytrack.simulation.sensor_field import canonical_field
from fuzzytrack.simulation.trajectories import (
    constant_acceleration,
    constant_velocity,
    turn,
    turn_with_angular_acceleration,
    waypoints,
)
from fuzzytrack.testbed.montecarlo import monte_carlo
from fuzzytrack.trackers.catalog import make_tracker

# -------------------------------------------------------------------- shipped


@pytest.mark.parametrize("name", shipped_scenarios())
def test_shipped_scenarios_run(name):
    scenario = load_scenario(name)
    assert scenario.name == name
    assert scenario.source == scenario_source(name) != ""
    assert len(scenario.trackers) >= 3
    results = monte_carlo(scenario, None, runs=3, seed=1)
    assert results.names == scenario.trackers
    assert np.isfinite(results.rmse()).all()


def test_every_kind_of_target_is_shipped():
    assert {
        *("constant-velocity", "constant-acceleration", "turn", "turn-angular-acceleration"),
        *("waypoints", "kim-lee", "warship", "s3-white", "s3-coloured"),
        *("llinas-m1", "llinas-m2", "llinas-m3", "llinas-m4"),
        *("report", "mixed", "strong"),
    } <= set(shipped_scenarios())


@pytest.mark.parametrize("maneuver", ["M1", "M2", "M3", "M4"])
def test_llinas_maneuvers_are_seen_by_the_canonical_field(maneuver):
    scenario = load_scenario(f"llinas-{maneuver.lower()}")
    t, truth = llinas_maneuver(maneuver)
    np.testing.assert_array_equal(scenario.time, t)
    np.testing.assert_array_equal(scenario.position, truth)
    assert scenario.prepare_start
    assert scenario.first_scored == 2
    expected = canonical_field().measure(truth, streams(3, 5), linear=True)
    plots = scenario.sensors.measure(truth, streams(3, 5))
    np.testing.assert_allclose(plots.z, expected.z, rtol=1e-12)
    np.testing.assert_allclose(plots.sigma, expected.sigma, rtol=1e-12)


# -------------------------------------------------------------------- targets


MOTION = "speed: 6, heading: 30, start: [100, -20], steps: 7, period: 30"


SAME = {
    "speed": 6.0,
    "heading": math.radians(30),
    "start": (100.0, -20.0),
    "steps": 7,
    "period": 30.0,
}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (f"{{motion: constant-velocity, {MOTION}}}", constant_velocity(**SAME)),
        (
            f"{{motion: constant-acceleration, acceleration: 0.004, {MOTION}}}",
            constant_acceleration(acceleration=0.004, **SAME),
        ),
        (f"{{motion: turn, radius: -4500, {MOTION}}}", turn(radius=-4500.0, **SAME)),
        (
            "{motion: turn-with-angular-acceleration, acceleration: 0.004, radius: 4500, "
            f"{MOTION}}}",
            turn_with_angular_acceleration(acceleration=0.004, radius=4500.0, **SAME),
        ),
        ("{motion: turn, speed: 6, radius: 900}", turn(speed=6.0, radius=900.0)),
        (
            "{waypoints: [[0, 0], [9, 1], [20, 8]], leg: 100, period: 30}",
            waypoints([[0, 0], [9, 1], [20, 8]], leg=100.0, period=30.0),
        ),
        (
            "{waypoints: [[0], [9], [20]], times: [5, 80, 300]}",
            waypoints([[0], [9], [20]], times=[5.0, 80.0, 300.0]),
        ),
        ("{maneuver: M3}", llinas_maneuver("M3")),
        ("{maneuver: kim-lee}", kim_lee()),
        ("{maneuver: s3}", s3()),
        ("{maneuver: warship}", warship()),
        ("{maneuver: warship, rate: 0.02}", warship(0.02)),
    ],
)
def test_targets(text, expected):
    scenario = with_target(text)
    np.testing.assert_array_equal(scenario.time, expected[0])
    np.testing.assert_array_equal(scenario.position, expected[1])
    assert scenario.first_scored == 2


@pytest.mark.parametrize(("name", "first"), [("report", 2), ("mixed", 8), ("weaving", 8)])
def test_sets_of_targets(name, first):
    scenario = with_target(f"{{set: {name}, tracks: 5, seed: 3}}")
    np.testing.assert_array_equal(scenario.position, track_set(name, 5, 3).position)
    assert scenario.first_scored == first


def test_recorded_target_beside_the_scenario(tmp_path, monkeypatch):
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "track.csv").write_text("when,e,n\n0,0,0\n1,5,2\n3,9,4\n")
    file = tmp_path / "there" / "mine.yaml"
    file.write_text(f"{HEAD}target: {{file: track.csv, time: when, axes: [e, n]}}\n{SENSORS}")
    monkeypatch.chdir(tmp_path)
    scenario = load_scenario("there/mine.yaml")
    assert scenario.time.tolist() == [0, 1, 3]
    assert scenario.position.tolist() == [[0, 0], [5, 2], [9, 4]]
    (tmp_path / "there" / "track.csv").write_text("when,e,n\n0,0,0\n1,,2\n3,9,4\n")
    with pytest.raises(ScenarioError, match=r"there/mine.yaml:3:9: position must be finite"):
        load_scenario("there/mine.yaml")
    (tmp_path / "there" / "track.csv").unlink()
    with pytest.raises(
        ScenarioError, match=r"mine.yaml:3:16: cannot read there/track.csv: No such"
    ):
        load_scenario("there/mine.yaml")


# -------------------------------------------------------------------- sampling


def sampled(target, sampling):
    return loads_scenario(f"{HEAD}target: {target}\n{SENSORS}sampling: {sampling}\n")


@pytest.mark.parametrize(
    ("text", "target", "path"),
    [
        (
            "{motion: turn, speed: 6, radius: 900, steps: 12}",
            turn(speed=6.0, radius=900.0, steps=12),
            lambda t: turn(speed=6.0, radius=900.0, at=t),
        ),
        (
            "{waypoints: [[0], [9], [20]], times: [5, 80, 300]}",
            waypoints([[0], [9], [20]], times=[5.0, 80.0, 300.0]),
            lambda t: waypoints([[0], [9], [20]], times=[5.0, 80.0, 300.0], at=t),
        ),
        ("{maneuver: M4}", llinas_maneuver("M4"), lambda t: llinas_maneuver("M4", at=t)),
        ("{maneuver: kim-lee}", kim_lee(), lambda t: kim_lee(at=t)),
        ("{maneuver: s3}", s3(), lambda t: s3(at=t)),
        ("{maneuver: warship}", warship(), lambda t: warship(at=t)),
    ],
)
def test_sampled_targets(text, target, path):
    scenario = sampled(text, "{log-uniform: [1, 10]}")
    own = target[0]
    assert scenario.time.shape == (len(own), 100)
    np.testing.assert_array_equal(scenario.time[0], own[0])
    np.testing.assert_allclose(scenario.time[-1], own[-1], rtol=1e-14)
    np.testing.assert_array_equal(scenario.position, path(scenario.time)[1])
    # On its own times the path is the target itself.
    np.testing.assert_allclose(path(own)[1], target[1], rtol=1e-12, atol=1e-9)
    np.testing.assert_array_equal(sampled(text, "{log-uniform: [1, 10]}").time, scenario.time)
    every = sampled(text, f"{{period: {2 * (own[1] - own[0])}}}")
    np.testing.assert_allclose(every.time, own[::2], rtol=1e-14)
    np.testing.assert_allclose(every.position, target[1][::2], rtol=1e-12, atol=1e-9)


def test_a_sampled_set():
    scenario = sampled("{set: mixed, tracks: 5, seed: 3}", "{alternate: [1, 10], period: 2}")
    expected = track_set("mixed", 5, 3, Sampling("alternate", (1, 10), 2.0))
    np.testing.assert_array_equal(scenario.time, expected.time)
    np.testing.assert_array_equal(scenario.position, expected.position)
    assert scenario.time.shape == (30,)
    assert scenario.first_scored == expected.first_scored == 4
    drawn = sampled("{set: mixed, tracks: 5, seed: 3}", "{jitter: 0.2}")
    expected = track_set("mixed", 5, 3, Sampling("jitter", 0.2))
    np.testing.assert_array_equal(drawn.time, expected.time)
    np.testing.assert_array_equal(drawn.position, expected.position)


def test_an_experiment_with_times_of_each_run(tmp_path):
    text = f"{HEAD}target: {{set: mixed, tracks: 3, seed: 3}}\n{SENSORS}sampling: {{jitter: 0.3}}\n"
    scenario = loads_scenario(text + "process_sigma: 1\n")
    trackers = ["fixed:alpha=0.5:beta=0.2", "kalman-cv:sigma_v=1"]
    results = monte_carlo(scenario, trackers, 5, 1)
    np.testing.assert_array_equal(results.time, scenario.time.mean(axis=1))
    np.testing.assert_array_equal(results.sample.time, scenario.time[:, 0])
    for run in range(5):
        times = scenario.time[:, run % 3]
        z = scenario.position[:, run % 3] + results.measured[run]
        predicted = make_tracker(trackers[1]).run(times, z, 10.0).predicted
        errors = predicted - scenario.position[:, run % 3]
        np.testing.assert_allclose(results.predicted[1, run], errors, rtol=1e-9, atol=1e-9)
    assert np.isfinite(results.nis[:, :, 2:]).all()
    columns = plot_columns(scenario, 5, 1)
    np.testing.assert_array_equal(columns["t_s"].reshape(5, -1), scenario.time.T[[0, 1, 2, 0, 1]])


def test_sampling_needs_a_time_between_scans():
    target = "target: {waypoints: [[0, 0], [1, 1]], leg: 1, period: 5}\n"
    found = complaint(f"{HEAD}{target}{SENSORS}sampling: {{jitter: 0.1}}\n")
    assert "sampling needs at least 2 scans, got 1" in found


def test_where_sampling_does_not_go(tmp_path):
    text = f"{HEAD}{TARGET}{SENSORS}sampling: {{jitter: 0.1}}\nstart: interpolate\n"
    assert complaint(text) == (
        "s.yaml:6:8: start 'interpolate' needs times that are the same in all runs"
    )
    assert loads_scenario(text.replace("{jitter: 0.1}", "{period: 30}")).prepare_start
    text = f"{HEAD}target: {{file: track.csv}}\n{SENSORS}sampling: {{period: 9}}\n"
    assert complaint(text).startswith(
        "s.yaml:5:11: sampling needs a target that is known at all times"
    )
    target = "target: {set: mixed, tracks: 9000}\n"
    text = f"{HEAD}{target}{SENSORS}sampling: {{jitter: 0.2, period: 0.01}}\n"
    assert complaint(text).startswith(
        "s.yaml:5:33: period must not give more than 10000000 scans in all, got 0.01, which gives "
        "5901 in each of 9000"
    )


# -------------------------------------------------------------------- sensors


def test_noise():
    text = "{sigma: [15, 23], correlation: 0.7, freedom: 5, detection: 0.9, clean: 2}"
    assert with_sensors(text) == PlotNoise((15.0, 23.0), Noise(0.7, 5.0), 0.9, 2)
    assert with_sensors("{sigma: 115}") == PlotNoise(115.0)
    text = "{sigma: 1, factors: [1, 3], spread: 2, outliers: {factor: 9, share: 0.1}, told: 0.5}"
    assert with_sensors(text) == PlotNoise(
        1.0, factors=(1.0, 3.0), spread=2.0, outliers=(0.1, 9.0), told=0.5
    )
    truth = llinas_maneuver("M1")[1]
    plots = with_sensors("{sigma: 115}").measure(truth, streams(1, 4))
    np.testing.assert_array_equal(plots.z, noisy_plots(truth, 115.0, streams(1, 4)).z)


def test_grid_of_sensors():
    text = (
        "{grid: 3, spacing: medium, centre: [-3000, 0], reach: 4000, range_sigma: 20, "
        "bearing_sigma: 2, detection: 0.8, correlation: 0.1, linear: yes, sigma_from: plot}"
    )
    sensors = with_sensors(text)
    assert sensors.field.position[0].tolist() == [-8000, -5000]
    assert len(sensors.field.position) == 9
    assert sensors.field.bearing_sigma[0] == pytest.approx(math.radians(2))
    assert (sensors.field.detection, sensors.noise.correlation) == (0.8, 0.1)
    assert (sensors.linear, sensors.sigma_from) == (True, "plot")


def test_scattered_sensors():
    sensors = with_sensors(
        "{positions: [[0, 0], [-3000, -900]], reach: [1000, 1500], range_sigma: 20, "
        "bearing_sigma: [1, 2], linear: no}"
    )
    assert sensors.field.reach.tolist() == [1000, 1500]
    np.testing.assert_allclose(sensors.field.bearing_sigma, np.radians([1, 2]))
    assert not sensors.linear


def test_what_is_scored_and_run():
    scenario = loads_scenario(
        f"{HEAD}{TARGET}{SENSORS}score: {{from: 5}}\nprocess_sigma: 0.05\nstart: interpolate\n"
        "trackers: ['fixed:alpha=0.5:beta=0.2', chan-style]\nsource: me\n"
    )
    assert (scenario.first_scored, scenario.process_sigma, scenario.source) == (4, 0.05, "me")
    assert scenario.prepare_start
    assert scenario.trackers == ("fixed:alpha=0.5:beta=0.2", "chan-style")


def test_rule_bases_beside_the_scenario(tmp_path, monkeypatch):
    from fuzzytrack.fuzzy.loading import rulebase_path

    (tmp_path / "there").mkdir()
    rules = tmp_path / "there" / "own.yaml"
    rules.write_bytes(rulebase_path("chan-style").read_bytes())
    file = tmp_path / "there" / "mine.yaml"
    file.write_text(f"{HEAD}{TARGET}{SENSORS}trackers: ['own.yaml:start=one-point']\n")
    monkeypatch.chdir(tmp_path)
    scenario = load_scenario(file)
    results = monte_carlo(scenario, None, runs=2, seed=0)
    assert results.names == (f"{rules}:start=one-point",)
    rules.write_text("rulebase: 2\n")
    with pytest.raises(ScenarioError, match=r"mine.yaml:5:12: .*own.yaml:1:11: unknown format"):
        load_scenario(file)


# -------------------------------------------------------------------- complaints


def test_names_and_paths(tmp_path):
    assert scenario_path("mixed").stem == "mixed"
    (tmp_path / "own.yaml").write_text(HEAD)
    assert scenario_source(tmp_path / "own.yaml") == ""
    with pytest.raises(ScenarioError, match=r"unknown scenario 'mixt'; did you mean 'mixed'\?"):
        load_scenario("mixt")
    with pytest.raises(ScenarioError, match=r"cannot read scenario .*: No such file"):
        load_scenario(tmp_path / "none.yaml")
    (tmp_path / "big.yaml").write_bytes(b"#" * 200_000)
    with pytest.raises(ScenarioError, match="longer than 128 KiB"):
        load_scenario(tmp_path / "big.yaml")


def test_a_scenario_by_its_name_in_an_experiment():
    trackers = ["fixed:alpha=0.5:beta=0.2"]
    by_name = monte_carlo("constant-velocity", trackers, 2, 1)
    loaded = monte_carlo(load_scenario("constant-velocity"), trackers, 2, 1)
    np.testing.assert_array_equal(by_name.predicted, loaded.predicted)
    with pytest.raises(ScenarioError, match="unknown scenario 'constant-velocty'; did you mean"):
        monte_carlo("constant-velocty", trackers, 2, 1)
    with pytest.raises(TypeError, match=r"scenario must be a Scenario, the name .*, got int"):
        monte_carlo(7, trackers, 2, 1)
