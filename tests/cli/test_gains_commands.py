import json

import numpy as np
import pytest

from fuzzytrack import load_rulebase
from fuzzytrack.fuzzy.loading import rulebase_path
from fuzzytrack.gains import gain_card
from fuzzytrack.gains.certificate import error_matrix
from fuzzytrack.schedulers.reachable_gains import reachable_gains

EDGE = """\
rulebase: 1
name: edge
inputs:
  x: {universe: [-1, 1, 21], sets: {n: {trimf: [-1, -1, 1]}, p: {trimf: [-1, 1, 1]}}}
outputs:
  stiffness: {universe: [0.2, 0.8, 21], sets: {n: {trimf: [0.2, 0.2, 0.8]}}}
  damping: {universe: [0.3, 0.3001, 21], sets: {n: {trimf: [0.3, 0.3, 0.3001]}}}
operators: {and: product, or: sum, defuzzification: weighted-centers}
rules:
  - {if: {x: n}, then: {stiffness: n, damping: n}}
  - {if: {x: p}, then: {stiffness: n, damping: n}}
"""


def as_json(run, *words):
    result = run(*words, "--json")
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def test_card(run):
    text = run("gains", "--alpha", ".5", "--beta", ".7", "--sigma", "10").stdout
    lines = {" ".join(line.split()) for line in text.splitlines()}
    assert {
        "α = 0.5, β = 0.7; T = 1 s",
        "stable yes: all poles lie inside the unit circle",
        "region underdamped",
        "poles 0.4000 + 0.5831j modulus 0.7071, angle 55.55°",
        "tracking index none: for this α Kalata's β is 0.1716",
        "steady lag 1.429 m behind 1 m/s²",
        "predicted position 1.957 13.99 m",
        "velocity 0.8522 (m/s)²/m² 9.231 m/s",
        "covariance of filtered position and velocity: 73.91 m², 18.26 m²/s, 85.22 m²/s²",
    } <= lines
    assert max(map(len, text.splitlines())) <= 80


def test_card_as_json(run):
    found = as_json(run, "gains", "--alpha", ".5", "--beta", ".7", "--dt", "2", "--sigma", "10")
    assert found["noise_ratio"] == pytest.approx(
        {
            "predicted": 1.9565217391,
            "filtered": 0.7391304348,
            "interval": 1.2057971014,
            "velocity": 0.8521739130 / 4,
        }
    )
    assert found["deviation"]["velocity"] == pytest.approx(np.sqrt(85.2173913) / 2)
    assert found["lag_per_acceleration"] == pytest.approx(4 / 0.7)
    assert found["poles"][0] == pytest.approx(
        {"real": 0.4, "imaginary": 0.583095189, "modulus": np.sqrt(0.5), "angle": 55.550098}
    )
    np.testing.assert_allclose(found["covariance"][0], [73.9130435, 9.13043478])
    assert found["tracking_index"] is None
    assert found["omega3"] is None


def test_card_of_three_gains(run):
    text = run("gains", "--alpha", ".5", "--beta", ".4", "--gamma", ".1", "--dt", "2").stdout
    assert "ω₃ = 0.07295 (0.07295 rad/s)" in text
    assert "0 m behind 1 m/s², 160 m behind 1 m/s³" in text
    assert "Kalata's β is 0.1716 and γ 0.05887" in text
    assert "covariance" not in text
    found = gain_card(0.5, 0.4, 0.1, dt=2.0, sigma=10.0)
    assert found["covariance"] is None
    assert found["noise_ratio"]["acceleration"] == pytest.approx(0.004733728 / 16)
    assert "deviation" not in gain_card(0.5, 0.4, 0.1)


@pytest.mark.parametrize(
    ("gains", "reason"),
    [
        ((0, 0.5), "alpha must be above 0"),
        ((0.5, 0), "beta must be above 0"),
        ((1.5, 1.2), "2 alpha + beta must be below 4, and is 4.2"),
        ((0.5, 0.7, 1), "gamma must be below 4 alpha beta / (2 - alpha) = 0.933333"),
        ((0.5, 0.7, -0.1), "gamma must not be negative"),
    ],
)
def test_card_of_unstable_gains_says_why(run, gains, reason):
    words = [w for k, v in zip(("alpha", "beta", "gamma"), gains, strict=False) for w in (k, v)]
    words = [f"--{w}" if k % 2 == 0 else w for k, w in enumerate(words)]
    text = run("gains", *words).stdout
    assert f"no: {reason}" in text
    assert "noise" not in text
    found = as_json(run, "gains", *words)
    assert (found["stable"], found["region"]) == (False, "unstable")
    assert max(pole["modulus"] for pole in found["poles"]) >= 1


def test_stable_gains_without_a_tracking_index():
    assert gain_card(1.2, 0.5)["tracking_index"] is None


def test_no_tracking_index_above_one(run):
    assert "none: Kalata's gains have α < 1" in run("gains", "--alpha", 1.2, "--beta", 0.5).stdout


@pytest.mark.parametrize(
    ("words", "gains"),
    [
        ("kalata --index 1", (0.75, 0.5, 0)),
        ("kalata --sigma-v .5 --sigma-w 50 --dt 10", (0.75, 0.5, 0)),
        ("kalata --index .1 --order 3", (0.6047587512, 0.2757538879, 0.1257364305)),
        ("benedict-bordner --alpha .5377", (0.5377, 0.197717, 0)),
        ("critically-damped --alpha .75", (0.75, 0.25, 0)),
        ("critically-damped --xi .5", (0.75, 0.25, 0)),
        ("critically-damped --xi .64 --order 3", (0.737856, 0.318816, 0.093312)),
        ("growing-memory --n 5", (0.6, 0.2, 0)),
        ("growing-memory --n 5 --order 3", (186 / 210, 162 / 210, 120 / 210)),
        ("w --omega0 .3 --zeta .7", (0.556291391, 0.238410596, 0)),
        ("w --omega0 .02 --zeta .7 --dt 30", (0.556291391, 0.238410596, 0)),
        (
            "w --omega0 .02 --zeta .7 --omega3 .01 --dt 30",
            (0.672041463, 0.352433055, 0.124388137),
        ),
        ("optimal --velocity 1 --sigma 1", (0.7690872515, 0.4805338162, 0)),
        ("optimal --velocity 1 --sigma 1 --kappa 100", (0.3617694618, 0.0798893321, 0)),
        ("optimal --acceleration .5 --sigma 1", (0.5416393630, 0.6718621400, 0)),
        ("optimal --acceleration .3 --sigma 1 --steady", (0.4370885100, 0.4163922788, 0)),
        (
            "optimal --velocity .5 --acceleration .2 --sigma 1 --order 3",
            (0.7400709359, 0.4646580669, 0.2039329553),
        ),
    ],
)
def test_design(run, words, gains):
    found = as_json(run, "design", *words.split())
    assert (found["alpha"], found["beta"], found["gamma"]) == pytest.approx(gains, abs=1e-6)
    assert found["stable"]
    assert found["design"] == words.split()[0]
    assert found["parameters"]
    text = run("design", *words.split()).stdout
    assert text.startswith(f"{found['design']}: ")
    assert "predicted position" in text


def test_tracking_index_of_kalatas_gains(run):
    for order in (2, 3):
        found = as_json(run, "design", "kalata", "--index", 0.327, "--order", order)
        assert found["tracking_index"] == pytest.approx(0.327)
    # As printed, with few digits.
    assert gain_card(0.5521, 0.2188)["tracking_index"] == pytest.approx(0.327, rel=1e-3)


def test_design_of_nothing_is_on_the_edge(run):
    assert "no: alpha must be above 0" in run("design", "kalata", "--index", 0).stdout


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("gains --alpha nan --beta 1", "error: alpha must be finite, got nan"),
        ("gains --alpha .5 --beta .7 --dt 0", "error: --dt: must be > 0, got 0"),
        ("gains --alpha .5 --beta .7 --sigma -1", "error: --sigma: must be > 0, got -1"),
        ("design benedict-bordner --alpha .5 --dt 0", "error: --dt: must be > 0, got 0"),
        ("gains --alpha .5", "Missing option '--beta'"),
        ("design kalata", "error: give either --index or --sigma-v"),
        ("design kalata --index 1 --sigma-v 1", "error: give either --index or --sigma-v"),
        ("design kalata --sigma-v 1", "error: --sigma-v needs --sigma-w too"),
        ("design kalata --index -1", "error: tracking_index must be finite and >= 0, got -1"),
        ("design kalata --index 1 --order 4", "--order"),
        ("design critically-damped", "error: give either --alpha or --xi"),
        ("design critically-damped --alpha .5 --order 3", "error: --order 3 needs --xi"),
        ("design benedict-bordner --alpha 1.5", "error: alpha must be > 0 and < 4 - 2 sqrt(2)"),
        ("design growing-memory --n 1", "error: n must be >= 2, the order, got 1"),
        ("design w --omega0 -1 --zeta 1", "error: omega0 must be finite and >= 0, got -1"),
        ("design optimal --sigma 1", "error: give --velocity or --acceleration, other than 0"),
        ("design optimal --sigma 1 --velocity 1 --acceleration 1", "not both; or --order 3"),
        ("design optimal --sigma 1 --velocity 1 --steady", "error: --steady is for"),
        ("design optimal --sigma 0 --velocity 1", "error: sigma must be finite and > 0, got 0"),
        ("certify nowhere", "nowhere"),
        ("certify valve", "error: valve cannot be certified: needed are outputs stiffness"),
        ("certify stiffness-damping --reach all", "error: --reach: unknown 'all'; one of universe"),
        ("certify chan-style --steps 4", "error: --steps: expected LOW:HIGH, two times, got '4'"),
        ("certify chan-style --steps 4:1", "error: --steps: must be two times with 0 < shortest"),
        ("certify chan-style --steps 0:1", "<= longest, got 0 and 1"),
        ("certify chan-style --steps 1:inf", "expected LOW:HIGH, two times, got '1:inf'"),
        ("certify chan-style --missed -1", "error: --missed: must be 0 to 1000, got -1"),
        ("certify chan-style --missed 1.5", "--missed"),
    ],
)
def test_bad_input_is_one_line(fails, words, message):
    assert message in fails(*words.split())


@pytest.mark.parametrize(("reach", "rate"), [("universe", 0.815936), ("rules", 0.799842)])
def test_certified(run, reach, rate):
    found = as_json(run, "certify", "stiffness-damping", "--reach", reach)
    assert found["verdict"] == "certified"
    assert found["rate"] == pytest.approx(rate, abs=1e-5)
    assert (found["sequence"], found["growth"]) == ([], None)
    p = np.array(found["lyapunov"])
    for alpha, beta in reachable_gains(load_rulebase("stiffness-damping"), reach):
        f = error_matrix(alpha, beta)
        excess = np.linalg.eigvalsh(f.T @ p @ f - (found["rate"] + 1e-9) ** 2 * p)
        assert excess.max() < 1e-9
    text = run("certify", "stiffness-damping", "--reach", reach).stdout
    assert text.startswith("stiffness-damping: certified\n")
    assert max(map(len, text.splitlines())) <= 80
    assert f"to {found['rate']:.4f} of what it was" in " ".join(text.split())
    assert "Covered: constant T, no missed plots.\n" in text
    assert (found["steps"], found["missed"]) == (None, 0)
    assert found["covered"] == "constant T, no missed plots"


def test_refuted_by_an_explicit_sequence(run):
    found = as_json(run, "certify", "stiffness-damping-wide")
    assert found["verdict"] == "refuted"
    product = np.eye(2)
    for step in found["sequence"]:
        product = error_matrix(step["alpha"], step["beta"]) @ product
    growth = np.abs(np.linalg.eigvals(product)).max() ** (1 / len(found["sequence"]))
    assert growth == pytest.approx(found["growth"])
    assert growth > 1.3
    text = run("certify", "stiffness-damping-wide").stdout
    assert "stable, or on the edge of stability:" in " ".join(text.split())
    assert f"grow by a factor of {found['growth']:.4f} a plot" in " ".join(text.split())
    assert text.count("1.0000\n") == len(found["sequence"])


def test_refuted_by_gains_that_are_stable(run, csv):
    file = csv(EDGE, "edge.yaml")
    text = run("certify", file).stdout
    assert text.startswith(f"{file}: refuted\n")
    words = " ".join(text.split())
    assert "though each by itself, at constant T, is stable:" in words
    assert "1.1598 a plot" in words


def test_not_decided(run, csv):
    # Without a velocity gain worth mentioning an error of velocity neither grows nor shrinks.
    text = EDGE.replace("stiffness", "alpha").replace("damping", "beta")
    text = text.replace("0.3001", "1e-12").replace("0.3", "0")
    file = csv(text, "edge.yaml")
    assert "nor a sequence of gains that makes" in " ".join(run("certify", file).stdout.split())
    found = as_json(run, "certify", file)
    assert (found["verdict"], found["growth"]) == ("not decided", None)


def test_certified_over_a_range_of_times(run):
    words = "certify", "omega-schedule", "--steps", "2:3", "--missed", "0"
    found = as_json(run, *words)
    assert (found["verdict"], found["steps"], found["missed"]) == ("certified", [2, 3], 0)
    text = run(*words).stdout
    assert "Covered: time between rows in [2, 3] s, changing in any way, no missed plots.\n" in text
    assert f"{found['rate']:.4f} of what it was" in " ".join(text.split())
    words = "certify", "omega-schedule", "--steps", "1:2"
    found = as_json(run, *words)
    text = run(*words).stdout
    assert f"polygon of {len(found['polygon'])} corners" in " ".join(text.split())
    assert max(map(len, text.splitlines())) <= 80


def test_a_period_makes_the_difference(run, csv):
    words = "certify", "stiffness-damping", "--steps", "1:12"
    assert as_json(run, *words)["verdict"] == "refuted"
    found = as_json(run, *words, "--period", "4")
    assert (found["verdict"], found["period"]) == ("certified", 4)
    text = " ".join(run(*words, "--period", "4").stdout.split())
    assert "no missed plots; gains of a period of 4 s." in text
    # The setting of a rule base; without steps T is the period, and the gains are those written.
    file = csv(
        EDGE.replace("0.2, 0.8", "0.3, 0.4")
        .replace("[0.2, 0.3, 0.4]", "[0.3, 0.3, 0.4]")
        .replace("0.3, 0.3001", "0.7, 0.8")
        .replace("[0.7, 0.7, 0.8]", "[0.7, 0.7, 0.8]")
        + "scheduler: {normalization: chan, gains: w-domain, period: 3}\n",
        "own.yaml",
    )
    found = as_json(run, "certify", file)
    assert (found["period"], found["covered"][:14]) == (3, "constant T = 3")
    assert "got alpha=1.11828" in run("certify", "stiffness-damping-wide", "--period", "4").stderr


def test_refuted_by_gains_and_times(run):
    words = "certify", "omega-schedule", "--steps", "1:4", "--missed", "3"
    found = as_json(run, *words)
    product = np.eye(2)
    for step in found["sequence"]:
        assert 1 <= step["elapsed"] <= 16
        assert step["elapsed"] <= 4 * (1 + step["missed"])
        product = error_matrix(step["alpha"], step["beta"], step["elapsed"]) @ product
    growth = np.abs(np.linalg.eigvals(product)).max() ** (1 / len(found["sequence"]))
    assert growth == pytest.approx(found["growth"])
    assert growth > 2
    text = run(*words).stdout
    assert "up to 3 missed plots in a row." in " ".join(text.split())
    assert "plot  time  missed  stiffness" in text
    one = run("certify", "stiffness-damping", "--missed", "1").stdout
    assert "Covered: constant T, up to 1 missed plot in a row.\n" in one


def test_steps_of_direct_gains_have_no_stiffness(run, csv):
    text = EDGE.replace("stiffness", "alpha").replace("damping", "beta")
    text = text.replace("[0.2, 0.8, 21]", "[0.01, 0.02, 21]")
    text = text.replace("[0.2, 0.2, 0.8]", "[0.01, 0.01, 0.02]")
    text = text.replace("0.3001", "2").replace("0.3", "0.1")
    found = as_json(run, "certify", csv(text, "edge.yaml"))
    assert found["verdict"] == "refuted"
    assert set(found["sequence"][0]) == {"alpha", "beta", "elapsed", "missed", "modulus"}


def test_certified_by_a_theorem(run, csv):
    words = "certify", "maneuver-two-rules", "--steps", ".5:2", "--missed", "1", "--sigma-ratio", 2
    found = as_json(run, *words)
    assert (found["verdict"], found["missing"]) == ("certified", "")
    assert (found["noise"], found["retention"]) == ([0.12, 2], [1, 4])
    assert (found["steps"], found["missed"], found["sigma_ratio"]) == ([0.5, 2], 1, 2)
    assert found["contraction_is"] == "sampled"
    text = run(*words).stdout
    assert text.startswith("maneuver-two-rules: certified\nCovered: time between rows in [0.5, 2]")
    assert "  time since the last plot in [0.5, 4] τ₀\n" in text
    assert "  σ of a plot in [0.5, 2] σ of the first one\n" in text
    assert "\nUnits: a₀ = level/3, τ₀ = √(σ/a₀) with σ of the first plot" in text
    assert f"{found['contraction']['20']:.3f} after 20 plots" in " ".join(text.split())
    assert max(map(len, text.splitlines())) <= 80
    rules = rulebase_path("maneuver-two-rules").read_text().replace("[0.12, 2, 41]", "[0, 2, 41]")
    text = " ".join(run("certify", csv(rules, "zero.yaml")).stdout.split())
    assert "The theorem does not apply: the noise must be above 0 and bounded" in text
    assert "constant T = 1 τ₀, no missed plots." in text
