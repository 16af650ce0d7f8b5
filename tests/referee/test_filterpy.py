"""FilterPy as a referee where it is right, and the evidence for where it is not.

The list for readers is docs/filterpy.md. FilterPy is optional: ``pip install filterpy``.
"""

from pathlib import Path

import numpy as np
import pytest

from fuzzytrack.gains import (
    benedict_bordner,
    convert_gamma,
    fading_memory,
    growing_memory,
    noise_ratio,
    optimal_for_velocity,
    steady_error,
)

gh = pytest.importorskip("filterpy.gh.gh_filter", reason="FilterPy is not installed")

DOCUMENT = Path(__file__).parents[2] / "docs" / "filterpy.md"
PAIRS = [(0.5, 0.7), (0.1, 0.02), (0.9, 1.1), (1.6, 0.3)]
TRIPLES = [(0.5, 0.4, 0.025), (0.7, 0.44, 0.06), (0.3, 0.05, 0.002), (1.05, 1.225, 0.375)]


def impulse_sums(g, h, k, dt):
    """Variance ratios from FilterPy's own recursion: prediction, then the filtered state."""
    tracker = gh.GHKFilter(0.0, 0.0, 0.0, dt, g, h, k)
    rows = []
    for z in [1.0] + [0.0] * 4000:
        tracker.update(z)
        rows.append((tracker.x_prediction, tracker.x, tracker.dx, tracker.ddx))
    return (np.array(rows) ** 2).sum(axis=0)


# ---------------------------------------------------------------- where it is right


@pytest.mark.parametrize(("g", "h"), PAIRS)
@pytest.mark.parametrize("dt", [1.0, 2.5])
def test_variance_ratios_of_pairs(g, h, dt):
    tracker = gh.GHFilter(0.0, 0.0, dt, g, h)
    assert tracker.VRF_prediction() == pytest.approx(noise_ratio(g, h), rel=1e-12)
    position, velocity = tracker.VRF()
    assert position == pytest.approx(noise_ratio(g, h, of="filtered"), rel=1e-12)
    assert velocity * dt**2 == pytest.approx(noise_ratio(g, h, of="velocity"), rel=1e-12)


@pytest.mark.parametrize("index", [0.1, 1.0, 5.0])
def test_benedict_bordner(index):
    alpha, beta = optimal_for_velocity(index)
    assert gh.benedict_bornder_constants(alpha) == pytest.approx((alpha, beta), rel=1e-12)
    assert benedict_bordner(alpha) == pytest.approx(beta, rel=1e-12)


@pytest.mark.parametrize(("g", "h", "k"), TRIPLES)
@pytest.mark.parametrize("dt", [1.0, 2.0])
def test_its_recursion_of_triples_has_our_variance_ratios(g, h, k, dt):
    gains = g, h, convert_gamma(k, "filterpy", "llinas")
    scale = {"predicted": 1, "filtered": 1, "velocity": dt**-2, "acceleration": dt**-4}
    expected = [noise_ratio(*gains, of=of) * s for of, s in scale.items()]
    assert impulse_sums(g, h, k, dt) == pytest.approx(expected, rel=1e-9)
    assert gh.GHKFilter(0.0, 0.0, 0.0, dt, g, h, k).VRF()[2] == pytest.approx(expected[3])


def test_bias_is_our_lag_with_the_other_sign():
    tracker = gh.GHKFilter(0.0, 0.0, 0.0, 2.0, 0.5, 0.4, 0.025)
    assert tracker.bias_error(0.01) == pytest.approx(-steady_error(0.5, 0.4, 0.1, 2.0, jerk=0.01))


@pytest.mark.parametrize("xi", [0.3, 0.64, 0.9])
def test_fading_memory(xi):
    assert gh.critical_damping_parameters(xi) == pytest.approx(fading_memory(xi))
    g, h, k = gh.critical_damping_parameters(xi, order=3)
    gamma = convert_gamma(k, "filterpy", "llinas")
    assert (g, h, gamma) == pytest.approx(fading_memory(xi, order=3))


def test_growing_memory_counts_from_0():
    alpha, beta = growing_memory(np.arange(2, 30))
    theirs = [gh.least_squares_parameters(n) for n in range(1, 29)]
    np.testing.assert_allclose(theirs, np.stack([alpha, beta], axis=-1), rtol=1e-12)


# ---------------------------------------------------------------- where it is not


def wrong_variance_of_prediction():
    ratio = gh.GHKFilter(0.0, 0.0, 0.0, 1.0, 0.5, 0.4, 0.025).VRF_prediction()
    assert ratio == pytest.approx(0.9419, abs=5e-5)
    assert impulse_sums(0.5, 0.4, 0.025, 1.0)[0] == pytest.approx(1.3432, abs=5e-5)


def negative_variance():
    position, _, _ = gh.GHKFilter(0.0, 0.0, 0.0, 1.0, 0.5, 0.4, 0.025).VRF()
    assert position == pytest.approx(-0.9851, abs=5e-5)
    assert impulse_sums(0.5, 0.4, 0.025, 1.0)[1] == pytest.approx(0.5858, abs=5e-5)


def half_the_variance_of_velocity():
    for dt in (1.0, 2.0):
        _, velocity, _ = gh.GHKFilter(0.0, 0.0, 0.0, dt, 0.5, 0.4, 0.025).VRF()
        assert velocity == pytest.approx(0.13698, abs=5e-6)  # whatever dt is
        assert impulse_sums(0.5, 0.4, 0.025, dt)[2] == pytest.approx(2 * velocity / dt**2)


def batch_without_k():
    z = np.arange(200.0) ** 3 * 0.01 / 6
    batch = gh.GHKFilter(0.0, 0.0, 0.0, 1.0, 0.5, 0.4, 0.025).batch_filter(z)
    pair = gh.GHFilter(0.0, 0.0, 1.0, 0.5, 0.4).batch_filter(z)
    assert (batch == pair).all()
    tracker = gh.GHKFilter(0.0, 0.0, 0.0, 1.0, 0.5, 0.4, 0.025)
    for plot in z:
        tracker.update(plot)
    assert tracker.x - batch[-1, 0] == pytest.approx(2.372, abs=5e-4)


def batch_of_scalars_only():
    tracker = gh.GHFilter(np.zeros(2), np.zeros(2), 1.0, 0.5, 0.4)
    with pytest.raises(ValueError, match="sequence"):
        tracker.batch_filter(np.ones((3, 2)))


def missed_plot_raises():
    with pytest.raises(TypeError):
        gh.GHFilter(0.0, 0.0, 1.0, 0.5, 0.4).update(None)


def nan_is_for_ever():
    tracker = gh.GHFilter(0.0, 0.0, 1.0, 0.5, 0.4)
    for z in (1.0, np.nan, 3.0, 4.0):
        tracker.update(z)
    assert np.isnan(tracker.x)


def critical_is_not_critical():
    g, h = gh.benedict_bornder_constants(0.8, critical=True)
    assert h == pytest.approx(0.2)
    assert sorted(np.roots([1, g + h - 2, 1 - g])) == pytest.approx([0.2764, 0.7236], abs=5e-5)


def plot_not_kept():
    for order in (0, 2):
        tracker = gh.GHFilterOrder(0.0, 1.0, order, 0.5, 0.4, 0.025)
        tracker.update(2.0)
        assert not np.any(tracker.z)


def prediction_misprinted():
    tracker = gh.GHKFilter(0.0, 1.0, 2.0, 1.0, 0.5, 0.4, 0.025)
    tracker.update(3.0)
    assert tracker.ddx_prediction == 2
    assert "GHFilter object" in repr(tracker)
    assert "ddx_prediction = 3.0" in repr(tracker)


FAULTS = {
    "`GHKFilter.VRF_prediction()`": wrong_variance_of_prediction,
    "`GHKFilter.VRF()`, position": negative_variance,
    "`GHKFilter.VRF()`, velocity": half_the_variance_of_velocity,
    "`GHKFilter.batch_filter`": batch_without_k,
    "`batch_filter` of vectors": batch_of_scalars_only,
    "`update(None)`": missed_plot_raises,
    "`update(nan)`": nan_is_for_ever,
    "`benedict_bornder_constants(g, critical=True)`": critical_is_not_critical,
    "`GHFilterOrder.z`": plot_not_kept,
    "`repr(GHKFilter)`": prediction_misprinted,
}


@pytest.mark.parametrize("check", FAULTS.values(), ids=[f.__name__ for f in FAULTS.values()])
def test_the_listed_fault_is_there(check):
    check()


def test_the_page_lists_these_faults():
    rows = [line for line in DOCUMENT.read_text().splitlines() if line.startswith("| `")]
    assert [row.split(" | ")[0].removeprefix("| ") for row in rows] == list(FAULTS)
