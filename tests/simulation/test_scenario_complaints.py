"""What is wrong with the text of a scenario, and where."""

import random

import pytest
from scenario_texts import HEAD, SENSORS, TARGET, complaint

from fuzzytrack.errors import ScenarioError
from fuzzytrack.simulation.scenario_files import (
    loads_scenario,
    scenario_path,
)

# -------------------------------------------------------------------- sampling


@pytest.mark.parametrize(
    ("text", "place", "expected"),
    [
        ("{}", 11, "sampling must be a mapping"),
        ("{jitters: 1}", 12, "unknown key in sampling: 'jitters'; did you mean 'jitter'? allowed: "
         "jitter, alternate, burst, log-uniform, period"),
        ("{jitter: 0.1, burst: [2, 5]}", 25, "sampling has 'jitter' already; it takes one of"),
        ("{jitter: 0.7}", 20, "jitter must be a number > 0 and < 0.5, got 0.7"),
        ("{jitter: often}", 20, "jitter must be a finite number, not 'often'"),
        ("{alternate: [1]}", 23, "alternate must be two intervals > 0, one at most 1e9"),
        ("{burst: [2.5, 5]}", 19, "burst must be a whole number of plots >= 2 and a gap > 1"),
        ("{log-uniform: [10, 1]}", 25, "log-uniform must be two rising intervals > 0, one"),
        ("{period: -1}", 20, "period must be finite and > 0, got -1"),
        ("{period: 2000}", 20, "period must leave two scans of a target of 1140 s, got 2000"),
        ("{period: 1000}", 11, "the target has 2 scans; at least 3"),
        ("{jitter: 0.1, period: 1e-3}", 33, "period must not give more than 10000000 scans"),
    ],
)  # fmt: skip
def test_complaints_of_sampling(text, place, expected):
    found = complaint(f"{HEAD}{TARGET}{SENSORS}sampling: {text}\n")
    assert found.startswith(f"s.yaml:5:{place}: {expected}"), found


# -------------------------------------------------------------------- complaints


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "s.yaml:1:1: the text is empty"),
        ("# nothing\n", "s.yaml:1:1: the text is empty"),
        ("a: b: c", "s.yaml:1:5: not YAML"),
        ("- 1\n", "s.yaml:1:1: the scenario must be a mapping"),
        ("name: x\n", "s.yaml:1:1: the scenario lacks its format version, 'scenario: 1'"),
        ("scenario: 2\n", "s.yaml:1:11: unknown format version '2'"),
        (
            f"{HEAD}{TARGET}sensor: {{sigma: 1}}\n",
            "s.yaml:4:1: unknown key in the scenario: 'sensor'; did you mean 'sensors'? allowed: "
            "scenario, name, target, sensors, source, sampling, start, score, process_sigma, "
            "trackers",
        ),
        (HEAD + SENSORS, "s.yaml:1:1: the scenario lacks the key 'target'"),
        (HEAD + TARGET, "s.yaml:1:1: the scenario lacks the key 'sensors'"),
        (HEAD + TARGET + TARGET + SENSORS, "s.yaml:4:1: key 'target' is given twice"),
        (
            f"{HEAD}{TARGET}{SENSORS}start: early\n",
            "s.yaml:5:8: unknown start 'early'; allowed: as-seen, interpolate",
        ),
        (
            f"{HEAD}{TARGET}{SENSORS}score: {{from: 21}}\n",
            "s.yaml:5:15: from must be a whole number from 1 to 20, got 21",
        ),
        (
            f"{HEAD}{TARGET}{SENSORS}process_sigma: -1\n",
            "s.yaml:5:16: process_sigma must be finite and >= 0, got -1",
        ),
        (
            f"{HEAD}{TARGET}{SENSORS}trackers: [chan-style, chan-stile]\n",
            "s.yaml:5:24: tracker 'chan-stile': no such tracker; did you mean 'chan-style'?",
        ),
        (
            f"{HEAD}{TARGET}{SENSORS}trackers: ['fixed:alpha=0.5']\n",
            "s.yaml:5:12: tracker 'fixed:alpha=0.5': needs beta",
        ),
        (
            f"{HEAD}{TARGET}{SENSORS}trackers: [chan-style, chan-style]\n",
            "s.yaml:5:24: tracker 'chan-style' is given twice",
        ),
        (f"{HEAD}{TARGET}{SENSORS}trackers: []\n", "s.yaml:5:11: trackers must be a list"),
    ],
)
def test_complaints(text, expected):
    assert complaint(text).startswith(expected)


@pytest.mark.parametrize(
    ("text", "place", "expected"),
    [
        ("{}", 9, "target must be a mapping"),
        ("M1", 9, "target must be a mapping, 'word: value', not 'M1'"),
        (
            "{manoeuvre: M1}",
            10,
            "unknown key in target: 'manoeuvre'; did you mean 'maneuver'? allowed: motion, "
            "waypoints, maneuver, set, file",
        ),
        ("{speed: 5}", 9, "target needs one of motion, waypoints, maneuver, set, file"),
        ("{maneuver: M1, set: mixed}", 24, "target has 'maneuver' already; it takes one of"),
        (
            "{maneuver: kimlee}",
            20,
            "unknown maneuver 'kimlee'; did you mean 'kim-lee'? allowed: M1, M2, M3, M4, kim-lee, "
            "s3, warship",
        ),
        ("{maneuver: s3, rate: 1}", 24, "unknown key in a target in maneuver s3: 'rate'"),
        ("{maneuver: warship, rate: 0}", 35, "rate must be finite and > 0, got 0"),
        ("{motion: straight, speed: 5}", 18, "unknown motion 'straight'; allowed: constant-vel"),
        (
            "{motion: turn, speed: 5, radios: 9}",
            34,
            "unknown key in a target in turn: 'radios'; did you mean 'radius'?",
        ),
        ("{motion: turn, speed: 5}", 9, "a target in turn lacks the key 'radius'"),
        ("{motion: turn, speed: fast, radius: 5}", 31, "speed must be a finite number, not 'fast'"),
        ("{motion: turn, speed: 5, radius: 0}", 42, "radius must be finite and not 0, got 0"),
        (
            "{motion: constant-velocity, speed: 5, steps: 1}",
            54,
            "steps must be a whole number from 3 to 100000, got 1",
        ),
        (
            "{motion: constant-velocity, speed: 5, steps: 1e30}",
            54,
            "steps must be a whole number from 3 to 100000, got 1",
        ),
        (
            "{motion: constant-velocity, speed: 5, period: 0}",
            55,
            "period must be finite and > 0, got 0",
        ),
        ("{motion: constant-velocity, speed: 5, start: [1]}", 54, "start must be two coordinates"),
        ("{motion: constant-velocity, speed: 1e308}", 9, "position must be finite"),
        (
            "{waypoints: [[5, 5], [5, 5]]}",
            21,
            "points must not all lie on one spot; all 2 lie on [5.0, 5.0]",
        ),
        ("{waypoints: [[5, 5]]}", 21, "points must have shape (n_points, n_axes), two way-points"),
        (
            "{waypoints: [[5, 5], [6]]}",
            30,
            "has 1 coordinates, the first of the waypoints 2",
        ),
        ("{waypoints: [5, 6]}", 22, "each of the waypoints must be a list, not '5'"),
        ("{waypoints: [[0], [9]], period: 1e-9}", 9, "more than 100000 scans"),
        ("{waypoints: [[0], [9]]}", 9, "the target has 2 scans; at least 3"),
        (
            "{waypoints: [[0], [9]], leg: 9, times: [0, 1]}",
            38,
            "leg and times both set the times of the points",
        ),
        ("{waypoints: [[0], [9]], times: [0, -1]}", 40, "times must be 2 increasing numbers"),
        ("{set: mixed}", 9, "a set of targets lacks the key 'tracks'"),
        ("{set: mild, tracks: 5}", 15, "unknown set 'mild'; did you mean 'mixed'?"),
        (
            "{set: mixed, tracks: 0}",
            30,
            "tracks must be a whole number from 1 to 10000, got 0",
        ),
        ("{set: mixed, tracks: 5, seed: -1}", 39, "seed must be a whole number from 0"),
    ],
)
def test_complaints_of_targets(text, place, expected):
    found = complaint(f"{HEAD}target: {text}\n{SENSORS}")
    assert found.startswith(f"s.yaml:3:{place}: {expected}"), found


FIELD = "reach: 1000, range_sigma: 10, bearing_sigma: 1"


@pytest.mark.parametrize(
    ("text", "place", "expected"),
    [
        ("{sigma: -5}", 18, "sigma must be finite and > 0, got -5"),
        ("{sigma: [1, 0]}", 18, "sigma must be finite and > 0, got 0 at index 1"),
        ("{sigma: [1, 2, 3]}", 18, "sigma has 3 numbers, the target 2 axes"),
        ("{sigma: many}", 18, "sigma must be a finite number, not 'many'"),
        ("{sigma: 5, spread: 0.5}", 29, "spread must be finite and >= 1, got 0.5"),
        ("{sigma: 5, told: 0}", 27, "told must be finite and > 0, got 0"),
        ("{sigma: 5, factors: [1, -2]}", 30, "factors must be finite and > 0, got -2 at index 1"),
        ("{sigma: 5, outliers: 0.1}", 31, "outliers must be a mapping"),
        ("{sigma: 5, outliers: {share: 0.1}}", 31, "outliers lacks the key 'factor'"),
        ("{sigma: 5, outliers: {share: 2, factor: 3}}", 31, "outliers must be a share from 0 to 1"),
        (
            "{sigma: 5, corelation: 0.5}",
            21,
            "unknown key in sensors: 'corelation'; did you mean 'correlation'? allowed: sigma, "
            "detection, clean, factors, spread, outliers, told, correlation, freedom",
        ),
        (
            "{variance: 5}",
            11,
            "unknown key in sensors: 'variance'; allowed: sigma, grid, positions",
        ),
        ("{reach: 5}", 10, "sensors needs one of sigma, grid, positions"),
        ("{sigma: 5, grid: 7}", 21, "sensors has 'sigma' already; it takes one of"),
        ("{sigma: 5, correlation: 1}", 34, "correlation must be between -1 and 1, got 1"),
        ("{sigma: 5, freedom: 2}", 30, "freedom must be > 2, got 2"),
        ("{sigma: 5, detection: 0}", 32, "detection must be > 0 and <= 1, got 0"),
        ("{sigma: 5, clean: -1}", 28, "clean must be a whole number from 0"),
        (
            f"{{grid: 0, spacing: 5, {FIELD}}}",
            17,
            "grid must be a whole number from 1 to 100, got 0",
        ),
        (
            f"{{grid: 7, spacing: sparce, {FIELD}}}",
            29,
            "unknown spacing 'sparce'; did you mean 'sparse'? allowed: dense, medium, sparse",
        ),
        (f"{{grid: 7, spacing: -2, {FIELD}}}", 29, "spacing must be finite and > 0, got -2"),
        (f"{{grid: 7, {FIELD}}}", 10, "a grid of sensors lacks the key 'spacing'"),
        (
            f"{{grid: 7, spacing: 2000, centre: [90000, 0], {FIELD}}}",
            10,
            "no sensor has the target within its reach in any scan",
        ),
        (
            f"{{grid: 7, spacing: 2000, linear: perhaps, {FIELD}}}",
            43,
            "unknown linear 'perhaps'; allowed: yes, true, no, false",
        ),
        (
            f"{{grid: 7, spacing: 2000, sigma_from: plots, {FIELD}}}",
            47,
            "unknown sigma_from 'plots'; did you mean 'plot'? allowed: truth, plot",
        ),
        (f"{{grid: 7, spacing: 2000, detection: 0, {FIELD}}}", 46, "detection must be > 0"),
        (
            "{grid: 7, spacing: 2000, reach: 1000, range_sigma: 10, bearing_sigma: -1}",
            80,
            "bearing_sigma must be > 0, got -1",
        ),
        (f"{{positions: [], {FIELD}}}", 22, "positions must be a list, not a list without"),
        (f"{{positions: [[0, 0, 0]], {FIELD}}}", 22, "position must have shape (n_sensors, 2)"),
        (
            "{positions: [[0, 0]], reach: [1, 2], range_sigma: 10, bearing_sigma: 1}",
            39,
            "reach must be a number or 1, one for each sensor",
        ),
    ],
)
def test_complaints_of_sensors(text, place, expected):
    found = complaint(f"{HEAD}{TARGET}sensors: {text}\n")
    assert found.startswith(f"s.yaml:4:{place}: {expected}"), found


def test_a_field_needs_two_axes_and_is_bounded():
    text = f"{HEAD}target: {{maneuver: kim-lee}}\nsensors: {{grid: 3, spacing: 9, {FIELD}}}\n"
    assert "is for targets with two axes, this one has 1" in complaint(text)
    text = (
        f"{HEAD}target: {{set: mixed, tracks: 20}}\nsensors: {{grid: 100, spacing: 9, {FIELD}}}\n"
    )
    assert "10000 sensors and 1200 positions of targets are too many" in complaint(text)


@pytest.mark.untraced
def test_damaged_texts_load_or_are_complained_of():
    rng = random.Random(1)
    whole = [scenario_path(name).read_text() for name in ("llinas-m1", "waypoints", "s3-coloured")]
    # Making trackers takes the longest, and is tested elsewhere.
    texts = [text.partition("trackers:")[0] for text in whole]
    outcomes = set()
    for _ in range(300):
        text = rng.choice(texts)
        at, length = rng.randrange(len(text)), rng.choice([0, 1, 2, 8])
        damaged = (
            text[:at] + rng.choice(["", "-", "0", ": ", "[", "e9", "\t"]) + text[at + length :]
        )
        try:
            loads_scenario(damaged)
            outcomes.add("loads")
        except ScenarioError as error:
            outcomes.add(error.location.file)
    assert outcomes == {"loads", "<text>"}
