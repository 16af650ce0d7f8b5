"""The shipped rule bases give the published numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fuzzytrack.fuzzy.loading import load_rulebase, rulebase_path, shipped_rulebases
from fuzzytrack.fuzzy.system import FuzzySystem

TABLE_3_2 = """
S-L M-L L-L L-L S-L Z-M Z-S
S-M M-M L-L L-L M-M Z-S S-Z
Z-S S-M M-L L-L M-M S-Z M-Z
Z-Z S-S M-M L-L M-M S-S Z-Z
M-Z S-Z M-M L-L M-L S-M Z-S
S-Z Z-S M-M L-L L-L M-M S-M
Z-S Z-M S-L L-L L-L M-L S-L
"""
SEVEN = ("nl", "nm", "ns", "ze", "ps", "pm", "pl")
FAMILY = ("stiffness-damping", "stiffness-damping-cog", "stiffness-damping-wide")


def with_operators(name, **changes):
    rules = load_rulebase(name)
    return replace(rules, operators=replace(rules.operators, **changes))


def gains(stiffness, damping):
    """Llinas et al. (1998), Eq. 3.26."""
    scale = 2 * damping * stiffness + stiffness**2 + 1
    return 4 * damping * stiffness / scale, 4 * stiffness**2 / scale


def surfaces(rules, points=41):
    system = FuzzySystem(rules)
    return {name: system.surface(name, points).values for name in ("stiffness", "damping")}


def test_the_set_of_shipped_rule_bases():
    assert set(shipped_rulebases()) == {
        *FAMILY,
        "chan-style",
        "maneuver",
        "maneuver-two-rules",
        "omega-schedule",
        "tipper",
        "valve",
        "valve-confidence",
    }


@pytest.mark.parametrize("name", shipped_rulebases())
def test_names_and_sources(name):
    rules = load_rulebase(name)
    assert rules.name == name
    assert rules.source
    assert rules.description
    text = rulebase_path(name).read_text(encoding="utf-8")
    assert text.startswith("# yaml-language-server: $schema=rulebase.schema.json\nrulebase: 1\n")
    assert max(map(len, text.splitlines())) <= 100


@pytest.mark.parametrize("name", FAMILY)
def test_table_3_2(name):
    rules = load_rulebase(name)
    rows = [line.split() for line in TABLE_3_2.split("\n") if line]
    assert rules.layout.rows == "dE"
    assert rules.layout.columns == "E"
    found = {frozenset(r.conditions): r.consequents for r in rules.rules}
    assert len(found) == 49
    for row, line in zip(SEVEN, rows, strict=True):
        for column, cell in zip(SEVEN, line, strict=True):
            stiffness, damping = found[frozenset({("dE", row), ("E", column)})]
            assert (stiffness.output, damping.output) == ("stiffness", "damping")
            assert f"{stiffness.set_name}-{damping.set_name}" == cell
    assert dict(rules.scheduler) == {"normalization": "chan", "gains": "w-domain"}


# stiffness, damping, alpha, beta: smallest and largest; alpha and beta at E = dE = 0
RANGES = {
    "5.1 centroid": (
        "stiffness-damping-cog",
        "centroid",
        [(0.2603, 0.3397), (0.5761, 0.8539), (0.4386, 0.6843), (0.1843, 0.2737)],
        (0.6843, 0.2722),
    ),
    "5.1 weighted": (
        "stiffness-damping",
        "weighted-centers",
        [(0.25, 0.35), (0.54, 0.89), (0.4053, 0.7138), (0.1725, 0.2807)],
        (0.7138, 0.2807),
    ),
    "5.2 centroid": (
        "stiffness-damping-wide",
        "centroid",
        [(0.2618, 0.7382), (0.134, 1.166), (0.123, 1.054), (0.180, 0.947)],
        (1.054, 0.667),
    ),
    "5.2 weighted": (
        "stiffness-damping-wide",
        "weighted-centers",
        [(0.2, 0.8), (0.0, 1.3), (0.0, 1.118), (0.115, 1.059)],
        (1.118, 0.688),
    ),
}


@pytest.mark.parametrize(
    ("case", "algebra"),
    [*((case, ("product", "sum")) for case in RANGES), ("5.1 centroid", ("min", "max"))],
)
def test_ranges_of_the_control_surface(case, algebra):
    name, defuzzification, ranges, center = RANGES[case]
    rules = with_operators(
        name, conjunction=algebra[0], disjunction=algebra[1], defuzzification=defuzzification
    )
    values = surfaces(rules)
    alpha, beta = gains(values["stiffness"], values["damping"])
    for (low, high), found in zip(
        ranges, (values["stiffness"], values["damping"], alpha, beta), strict=True
    ):
        assert found.min() == pytest.approx(low, abs=5e-4)
        assert found.max() == pytest.approx(high, abs=5e-4)
    assert (alpha[20, 20], beta[20, 20]) == pytest.approx(center, abs=5e-4)


@pytest.mark.parametrize("name", FAMILY)
@pytest.mark.parametrize("method", ["exact", "relation"])
def test_point_symmetry(name, method):
    system = FuzzySystem(load_rulebase(name), method)
    random = np.random.default_rng(5)
    error, rate = random.uniform(-1, 1, (2, 2000))
    if method == "relation":
        # on grid points: between two of them ties are rounded one way
        error, rate = np.round(error * 20) / 20, np.round(rate * 20) / 20
    there, back = system(E=error, dE=rate), system(E=-error, dE=-rate)
    mirrored = system(E=-error, dE=rate)
    for output, values in there.items():
        np.testing.assert_allclose(values, back[output], rtol=0, atol=1e-12)
        # a single sign does matter
        assert np.abs(values - mirrored[output]).max() > 0.01


@pytest.mark.parametrize("name", FAMILY)
def test_output_centres_divide_the_range_in_three(name):
    for output in load_rulebase(name).outputs:
        low, high = output.universe.low, output.universe.high
        assert output.centers() == pytest.approx(np.linspace(low, high, 4), abs=1e-15)


def test_cog_differs_from_the_default_in_defuzzification_only():
    base, cog = load_rulebase("stiffness-damping"), load_rulebase("stiffness-damping-cog")
    assert cog.operators.defuzzification == "centroid"
    assert {v.universe.points for v in (*cog.inputs, *cog.outputs)} == {41}
    assert (
        replace(
            cog,
            name=base.name,
            description=base.description,
            source=base.source,
            operators=base.operators,
        )
        == base
    )


@pytest.mark.parametrize(
    ("service", "food", "tip"),
    [(2, 1, 7.0169), (4, 5, 14.4585), (7, 8, 20.3414), (1, 2, 5.5586)],
)
def test_tipper_gives_matlabs_numbers(service, food, tip):
    system = FuzzySystem(load_rulebase("tipper"))
    assert system(service=service, food=food)["tip"] == pytest.approx(tip, abs=5e-5)


def test_chan_style_levels():
    levels = np.array(
        [[0, 0, 1, 2, 3], [0, 1, 1, 2, 3], [1, 1, 2, 3, 3], [1, 2, 2, 3, 4], [2, 2, 3, 4, 4]]
    )
    quarters = np.arange(5) / 4
    rate, error = np.meshgrid(quarters, quarters, indexing="ij")
    rules = load_rulebase("chan-style")
    result = FuzzySystem(rules)(E=error, dE=rate)
    np.testing.assert_allclose(result["alpha"], 0.3 + 0.15 * levels, atol=1e-12)
    np.testing.assert_allclose(result["beta"], 0.1 + 0.125 * levels, atol=1e-12)
    assert dict(rules.scheduler) == {"normalization": "chan-magnitude", "gains": "direct"}
    assert "ours" in rules.description


def test_valve():
    rules = load_rulebase("valve")
    system = FuzzySystem(rules)
    # at peak and at middle of the universe by symmetry
    assert system(flow=1.0)["opening"] == pytest.approx(2, abs=1e-12)
    assert system(flow=1.5)["opening"] == pytest.approx(1.5, abs=1e-12)
    assert system(flow=2.0)["opening"] == pytest.approx(1, abs=1e-12)
    opening = system(flow=np.linspace(0, 3, 61))["opening"]
    assert (np.diff(opening) < 0).all()


def test_valve_with_less_confidence():
    plain, unsure = load_rulebase("valve"), load_rulebase("valve-confidence")
    assert unsure.rules[0].consequents[0].confidence == 0.5
    assert unsure.rules[1:] == plain.rules[1:]
    before, after = FuzzySystem(plain).relation("opening"), FuzzySystem(unsure).relation("opening")
    # the spike of the first rule is scaled down, the others stay (Fig. 3.4)
    assert after[0, -1] == pytest.approx(before[0, -1] / 2)
    np.testing.assert_array_equal(after[40:], before[40:])
    # a quarter of a weaker "large" no longer balances
    assert FuzzySystem(unsure)(flow=0.25)["opening"] < FuzzySystem(plain)(flow=0.25)["opening"]
