import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack import FuzzyScheduler, loads_rulebase
from fuzzytrack.schedulers import normalizations
from fuzzytrack.schedulers.normalization import (
    Chan,
    ChanMagnitude,
    ChanSigned,
    Scale,
    Smoothed,
    SmoothedMagnitude,
    relative,
    relative_signed,
)
from fuzzytrack.testing import check_scheduler

metres = st.floats(-1e6, 1e6)
unit = st.floats(-1, 1)


def signals(normalization, innovation, change, memory, sigma=1.0, n_axes=1):
    return normalization.kernel(n_axes)(innovation, change, 1.0, sigma, memory)


@pytest.mark.parametrize(
    ("error", "moved", "expected"),
    [(1, 2, 0.5), (1, -2, 0.5), (1, -1, 1), (0, 3, 0), (0, 0, 0), (2, 1, 1)],
)
def test_chan_error(error, moved, expected):
    (normalised, _), memory = signals(Chan(), float(error), float(moved), (0.0,))
    assert normalised == expected
    assert memory == (expected,)


@pytest.mark.parametrize(
    ("now", "before", "expected"),
    [
        (0.6, 0.4, 0.5),
        (0.2, 0.4, -0.5),
        (-0.1, 0.4, -1),
        (0.9, 0.4, 1),
        (-0.2, -0.4, 0.5),
        (-0.6, -0.4, -0.5),
        (0.5, 0, 1),
        (0, 0.5, -1),
        (0, 0, 0),
    ],
)
def test_chan_error_rate(now, before, expected):
    # An innovation of `now` against a displacement of 1 is a normalised error of `now`.
    (_, rate), _ = signals(Chan(), float(now), 1.0, (float(before),))
    assert rate == pytest.approx(expected)


@given(metres, metres, unit)
def test_chan_is_odd_bounded_and_keeps_signs(error, moved, before):
    (e, rate), memory = signals(Chan(), error, moved, (before,))
    assert -1 <= e <= 1
    assert -1 <= rate <= 1
    assert e * error >= 0
    assert rate * (e - before) >= 0
    (opposite, opposite_rate), _ = signals(Chan(), -error, -moved, (-before,))
    assert (opposite, opposite_rate) == (-e, -rate)
    assert memory == (e,)


@given(metres, metres)
def test_chan_does_not_depend_on_the_direction_of_travel(error, moved):
    assert relative(error, moved) == relative(error, -moved)


def test_the_signed_form_turns_with_the_direction_of_travel():
    assert relative_signed(1.0, 2.0) == 0.5
    assert relative_signed(1.0, -2.0) == -0.5
    assert relative_signed(-3.0, 2.0) == -1.0
    assert relative_signed(0.0, 0.0) == 0.0
    # (E, E′) = (-0.2, -0.4) and (-0.6, -0.4): the opposite of Chan's
    for now, expected in ((-0.2, -0.5), (-0.6, 0.5)):
        (_, rate), _ = signals(ChanSigned(), now, 1.0, (-0.4,))
        assert rate == pytest.approx(expected)


@given(st.lists(st.tuples(metres, metres, unit), min_size=1, max_size=4))
def test_chan_magnitude_is_the_root_mean_square_of_chan(axes):
    errors, moves, before = zip(*axes, strict=True)
    alone = [signals(Chan(), e, d, (b,))[0] for e, d, b in axes]
    n = len(axes)
    (size, rate), memory = signals(ChanMagnitude(), errors, moves, before, (1.0,) * n, n)
    assert size == pytest.approx((sum(e * e for e, _ in alone) / n) ** 0.5)
    assert rate == pytest.approx((sum(r * r for _, r in alone) / n) ** 0.5)
    assert 0 <= size <= 1 + 1e-12
    assert memory == tuple(e for e, _ in alone)
    assert ChanMagnitude().initial_memory(n) == (0.0,) * n


def test_scale_divides_by_the_standard_deviation():
    (error, rate), memory = signals(Scale(), 6.0, 100.0, (0.5,), sigma=2.0)
    assert (error, rate, memory) == (3.0, 2.5, (3.0,))


@given(st.lists(st.tuples(st.floats(-1e3, 1e3), st.floats(0.1, 1e3)), min_size=1, max_size=30),
       st.floats(0, 0.99))  # fmt: skip
def test_smoothed_is_a_weighted_mean_of_scaled_innovations(plots, rho):
    memory = Smoothed(rho).initial_memory(1)
    for innovation, sigma in plots:
        (mean, error), memory = signals(Smoothed(rho), innovation, 1.0, memory, sigma)
        assert error == innovation / sigma
    scaled = np.array([e / s for e, s in plots])
    weights = (1 - rho) * rho ** np.arange(len(plots))[::-1]
    assert mean == pytest.approx(weights @ scaled, rel=1e-9, abs=1e-9)
    assert memory == (mean,)


@given(st.lists(st.tuples(metres, st.floats(0.1, 1e3), unit), min_size=1, max_size=4))
def test_smoothed_magnitude_is_the_root_mean_square_of_smoothed(axes):
    innovations, sigmas, before = zip(*axes, strict=True)
    alone = [signals(Smoothed(), e, 1.0, (b,), s)[0] for e, s, b in axes]
    n = len(axes)
    (mean, error), memory = signals(
        SmoothedMagnitude(), innovations, (1.0,) * n, before, sigmas, n)  # fmt: skip
    assert mean == pytest.approx(np.sqrt(np.mean([m * m for m, _ in alone])))
    assert error == pytest.approx(np.sqrt(np.mean([e * e for _, e in alone])))
    assert memory == tuple(m for m, _ in alone)
    assert SmoothedMagnitude().initial_memory(n) == (0.0,) * n


@pytest.mark.parametrize("rho", [-0.1, 1.0])
@pytest.mark.parametrize("normalization", [Smoothed, SmoothedMagnitude])
def test_the_smoothing_is_checked(normalization, rho):
    with pytest.raises(ValueError, match=f"rho must be >= 0 and < 1, got {rho:g}"):
        normalization(rho)


@pytest.mark.parametrize("name", ["smoothed", "smoothed-magnitude"])
def test_a_rule_base_on_a_smoothed_signal_keeps_the_contract(name):
    text = f"""
rulebase: 1
name: by-lag
inputs:
  lag: {{universe: [-3, 3, 61], sets: {{left: {{trimf: [-3, -3, 0]}},
        small: {{trimf: [-3, 0, 3]}}, right: {{trimf: [0, 3, 3]}}}}}}
outputs:
  alpha: {{universe: [0.2, 0.8, 61], sets: {{low: {{trimf: [0.2, 0.2, 0.8]}},
          high: {{trimf: [0.2, 0.8, 0.8]}}}}}}
  beta: {{universe: [0.05, 0.5, 46], sets: {{low: {{trimf: [0.05, 0.05, 0.5]}},
         high: {{trimf: [0.05, 0.5, 0.5]}}}}}}
operators: {{and: product, or: sum, defuzzification: weighted-centers}}
rules:
  - {{if: {{lag: small}}, then: {{alpha: low, beta: low}}}}
  - {{if: {{lag: left}}, then: {{alpha: high, beta: high}}}}
  - {{if: {{lag: right}}, then: {{alpha: high, beta: high}}}}
scheduler: {{normalization: {name}, gains: direct}}
"""
    check_scheduler(FuzzyScheduler(loads_rulebase(text)))


def test_registered_normalisations():
    names = {"chan", "chan-signed", "chan-magnitude", "scale", "smoothed", "smoothed-magnitude"}
    assert names <= set(normalizations.names())
    for plugin in normalizations:
        assert plugin.source
        assert len(plugin.factory.signals) == 2
