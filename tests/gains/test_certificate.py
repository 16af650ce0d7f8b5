import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fuzzytrack as ft
from fuzzytrack.gains import alpha_beta_from_w
from fuzzytrack.gains.certificate import (
    box,
    certify,
    certify_region,
    error_matrix,
    polygon_in_gains,
)
from fuzzytrack.gains.elapsed_times import ElapsedTimes
from fuzzytrack.gains.growing_sequence import growing_sequence
from fuzzytrack.gains.period import resampled_gains
from fuzzytrack.gains.polygons import convex_hull

PUBLISHED = (0.25, 0.35), (0.54, 0.89)
WIDE = (0.2, 0.8), (0.0, 1.3)


def simulate(matrices, rng, runs, steps):
    """Largest length of the error after switching at random, from random starts of length 1."""
    angle = rng.uniform(0, 2 * np.pi, runs)
    error = np.stack([np.cos(angle), np.sin(angle)])
    for _ in range(steps):
        f = matrices[rng.integers(0, len(matrices), runs)]
        error = np.stack([
            f[:, 0, 0] * error[0] + f[:, 0, 1] * error[1],
            f[:, 1, 0] * error[0] + f[:, 1, 1] * error[1],
        ])  # fmt: skip
    return np.hypot(*error).max()


def test_the_published_limits_are_certified():
    found = certify_region(box(*PUBLISHED))
    assert found.verdict == "certified"
    assert found.rate == pytest.approx(0.815936, abs=1e-6)
    np.testing.assert_allclose(found.lyapunov, [[1, -1.449921], [-1.449921, 4.374020]], rtol=2e-4)
    assert not len(found.sequence)


def test_the_wide_limits_are_refuted_by_a_sequence():
    found = certify_region(box(*WIDE))
    assert found.verdict == "refuted"
    assert found.rate == pytest.approx(1.516598, abs=1e-6)
    assert found.growth == pytest.approx(1.355826, abs=1e-6)


@pytest.mark.parametrize(
    ("zeta", "growth"), [(0.0, 1.355826), (0.3, 1.159838), (0.5, 1.044697), (0.6, 0.989494)]
)
def test_growth_of_the_known_sequence(zeta, growth):
    product = np.eye(2)
    for omega0 in (0.2, 0.2, 0.2, 0.8):
        product = error_matrix(*alpha_beta_from_w(omega0, zeta)) @ product
    assert np.abs(np.linalg.eigvals(product)).max() ** 0.25 == pytest.approx(growth, abs=1e-6)
    found = certify_region(box((0.2, 0.8), (zeta, 1.3)))
    if growth > 1:
        assert found.verdict == "refuted"
        assert found.growth >= growth - 1e-6
    else:
        assert found.verdict == "certified"
        assert growth < found.rate < 1


def test_an_ellipse_needs_more_damping_than_a_polygon():
    # For an ellipse a damping above (w2 - w1)/(2 √(w1 w2)) = 0.75 is necessary.
    assert not len(certify_region(box((0.2, 0.8), (0.76, 1.3))).polygon)
    found = certify_region(box((0.2, 0.8), (0.74, 1.3)))
    assert (found.verdict, len(found.polygon) > 4) == ("certified", True)
    assert certify_region(box((0.2, 0.8), (0.59, 1.3))).verdict == "certified"
    assert certify_region(box((0.2, 0.8), (0.58, 1.3))).verdict == "refuted"


def test_the_error_matrix_is_that_of_the_tracker():
    """The prediction error of a tracker on noise-free, but wrongly started, tracks."""
    alpha, beta, dt = 0.6, 0.3, 2.0
    tracker = ft.AlphaBetaTracker(ft.FixedGains(alpha, beta))
    truth = np.zeros(6)
    plots = truth.copy()
    plots[:2] = 1.0, 4.0  # a wrong start
    result = tracker.run(dt * np.arange(6), plots)
    error = np.array([7.0, 3.0])  # prediction at the third plot, and T times velocity
    for k in range(2, 6):
        assert result.predicted[k] == pytest.approx(error[0])
        error = error_matrix(alpha, beta) @ error


@given(st.floats(0.05, 2), st.floats(1.01, 4), st.floats(0.05, 2), st.floats(0.0, 1.0))
@settings(max_examples=40)
def test_the_image_of_a_box_lies_in_the_hull(w1, ratio, z1, width):
    limits = (w1, w1 * ratio), (z1, z1 + width)
    around, reached = polygon_in_gains(box(*limits), pieces=3)
    hull = convex_hull(around)
    rng = np.random.default_rng(1)
    omega0, zeta = rng.uniform(*limits[0], 200), rng.uniform(*limits[1], 200)
    inside = np.concatenate([np.array(alpha_beta_from_w(omega0, zeta)).T, reached])
    if len(hull) == 2:
        return
    following = np.roll(hull, -1, axis=0)
    edge, to_point = following - hull, inside[:, None] - hull
    side = edge[:, 0] * to_point[..., 1] - edge[:, 1] * to_point[..., 0]
    assert side.min() > -1e-12


@pytest.mark.parametrize("elapsed", [0.5, 1.0, 3.0])
def test_the_error_matrix_at_other_times_is_that_of_the_tracker(elapsed):
    """The error predicted for a time U = 2 after each plot."""
    alpha, beta, unit = 0.6, 0.3, 2.0
    tracker = ft.AlphaBetaTracker(ft.FixedGains(alpha, beta))
    t = np.concatenate([[0.0, 5.0], 5.0 + elapsed * unit * np.arange(1, 5)])
    plots = np.zeros(6)
    plots[:2] = -3.0, 4.0
    result = tracker.run(t, plots)
    error = np.stack([result.filtered + unit * result.velocity, unit * result.velocity], axis=1)
    for k in range(2, 6):
        np.testing.assert_allclose(error[k], error_matrix(alpha, beta, elapsed) @ error[k - 1])


@pytest.mark.parametrize(
    ("name", "steps", "pair"),
    [("omega-schedule", (1, 4), 1.2903), ("stiffness-damping", (1, 12), 1.2624)],
)
def test_known_growth_at_changing_times(name, steps, pair):
    found = ft.certify(name, steps=steps)
    assert found.verdict == "refuted"
    assert found.growth**2 > pair
    # The known sequences have two plots, with the shortest and the longest step.
    assert ft.certify(name, steps=steps, max_length=2).growth ** 2 == pytest.approx(pair, abs=1e-4)


def test_small_fixed_gains_are_certified_over_a_range_of_times():
    assert certify([[0.3, 0.05]], times=ElapsedTimes(1, 4)).verdict == "certified"
    assert certify([[0.3, 0.05]], times=ElapsedTimes(1, 2, missed=1)).verdict == "certified"
    assert certify([[0.3, 0.05]], times=ElapsedTimes(1, 16)).verdict == "refuted"


@given(st.floats(0.01, 100), st.floats(1, 3), st.integers(0, 3))
@settings(max_examples=10, deadline=None)
def test_only_the_ratio_of_the_steps_matters(low, ratio, missed):
    gains = [[0.5, 0.2], [0.4, 0.15]]
    found = certify(gains, times=ElapsedTimes(low, low * ratio, missed))
    same = certify(gains, times=ElapsedTimes(1.0, ratio, missed))
    assert found.verdict == same.verdict
    assert found.rate == pytest.approx(same.rate, rel=1e-6)
    np.testing.assert_allclose(found.elapsed, low * same.elapsed, rtol=1e-6)


def test_a_period_makes_gains_safe_at_changing_times():
    gains, times = [[0.5, 0.2], [0.4, 0.15]], ElapsedTimes(1, 12)
    assert certify(gains, times=times).verdict == "refuted"
    found = certify(gains, times=times, period=4)
    assert found.verdict == "certified"
    # Constant T is the period, where the gains are those that were given.
    assert certify(gains, period=4).rate == certify(gains).rate
    # Gains on the edge of stability cannot be converted, so no sequence is made of them.
    assert (
        certify([[0.0, 0.0]], reached=[[0.0, 0.0]], period=4, times=times).verdict == "not decided"
    )
    with pytest.raises(ValueError, match="negative real pole belong to one sampling time"):
        certify([[1.5, 0.5]], period=4)


def test_a_refutation_with_a_period_has_the_gains_that_are_used():
    gains = np.array([[0.02, 0.3], [0.03, 0.001]])
    found = certify(gains, times=ElapsedTimes(1, 3), period=1)
    assert found.verdict == "refuted"
    possible = np.concatenate(
        [np.stack(resampled_gains(*gains.T, period=1, dt=s)[:2], axis=1) for s in (1, 3)]
    )
    for used in found.sequence:
        assert np.abs(possible - used).max(axis=1).min() < 1e-12


def test_gains_on_the_edge_are_not_decided():
    # With gains of 0 an error neither grows by a factor nor shrinks.
    assert certify([[0.0, 0.0]]).verdict == "not decided"


def test_a_certified_matrix_contracts_every_gain_inside():
    found = certify_region(box(*PUBLISHED))
    rng = np.random.default_rng(2)
    alpha, beta = alpha_beta_from_w(rng.uniform(0.25, 0.35, 500), rng.uniform(0.54, 0.89, 500))
    f, p = error_matrix(alpha, beta), found.lyapunov
    excess = np.swapaxes(f, -1, -2) @ p @ f - found.rate**2 * p
    assert np.linalg.eigvalsh(excess).max() < 1e-9


def check_random_boxes(boxes, runs, steps, seed=3):
    """No certified box lets the error outlive its rate; counts the verdicts."""
    rng = np.random.default_rng(seed)
    verdicts = []
    for _ in range(boxes):
        w1, z1 = rng.uniform(0.05, 1.0), rng.uniform(0.1, 1.0)
        found = certify_region(
            box((w1, w1 * rng.uniform(1, 4)), (z1, z1 * rng.uniform(1, 3))), max_length=4
        )
        verdicts.append(found.verdict)
        if found.verdict == "certified":
            matrices = error_matrix(*found.vertices.T)
            largest = simulate(matrices, rng, runs, steps)
            sizes = found.norm([(np.cos(a), np.sin(a)) for a in np.linspace(0, np.pi, 1000)])
            spread = 1.01 * sizes.max() / sizes.min()
            # Errors that shrink below the smallest normal numbers keep a rounding error.
            assert largest <= spread * found.rate**steps * (1 + 1e-6) + 1e-290
    return verdicts


@pytest.mark.untraced
def test_no_certified_box_diverges():
    verdicts = check_random_boxes(boxes=40, runs=100, steps=200)
    assert verdicts.count("certified") > 10
    assert verdicts.count("refuted") > 0


@pytest.mark.parametrize("limits", [WIDE, ((0.2, 0.8), (0.3, 1.3)), ((0.1, 1.5), (0.2, 0.9))])
def test_a_refuting_sequence_stays_inside_the_box(limits):
    found = certify_region(box(*limits))
    assert found.verdict == "refuted"
    for alpha, beta in found.sequence:
        # The w-domain by hand: at zero damping the gains lie on the edge of stability.
        u = 4 - 2 * alpha - beta
        omega0, zeta = np.sqrt(beta / u), alpha / np.sqrt(beta * u)
        assert limits[0][0] - 1e-9 <= omega0 <= limits[0][1] + 1e-9
        assert limits[1][0] - 1e-9 <= zeta <= limits[1][1] + 1e-9


def test_a_refuting_sequence_really_diverges():
    found = certify_region(box(*WIDE))
    error = np.array([1.0, 0.3])
    for k in range(400):
        error = error_matrix(*found.sequence[k % len(found.sequence)]) @ error
    assert np.linalg.norm(error) > 0.01 * found.growth**400


def test_a_single_pair_has_the_rate_of_its_poles():
    found = certify([[0.5377, 0.2018]])
    radius = np.abs(np.linalg.eigvals(error_matrix(0.5377, 0.2018))).max()
    assert found.verdict == "certified"
    assert found.rate == pytest.approx(radius, abs=1e-6)


def test_a_double_pole():
    # Critically damped: both poles at 0.5, and no ellipse has exactly their rate.
    found = certify([[0.75, 0.25]])
    assert found.verdict == "certified"
    assert 0.5 < found.rate < 0.5001


def test_unstable_gains_refute_themselves():
    found = certify([[0.5, 0.2], [1.9, 1.0]])
    assert found.verdict == "refuted"
    np.testing.assert_array_equal(found.sequence, [[1.9, 1.0]])


def test_polygons_of_no_area():
    assert certify_region([(0.3, 0.5), (0.3, 0.9)]).verdict == "certified"
    assert len(convex_hull(np.array([[0.1, 0.1], [0.2, 0.2], [0.3, 0.3]]))) == 2


@pytest.mark.parametrize(
    ("gains", "message"),
    [
        ([], r"pairs \(alpha, beta\)"),
        ([[0.5, 0.2, 0.1]], r"pairs \(alpha, beta\)"),
        ([[0.5, np.nan]], "gains must be finite"),
    ],
)
def test_bad_gains(gains, message):
    with pytest.raises(ValueError, match=message):
        certify(gains)


def test_bad_arguments():
    with pytest.raises(ValueError, match="max_length must be at least 1, got 0"):
        certify([[0.5, 0.2]], max_length=0)
    with pytest.raises(ValueError, match="stiffness must be 0 < low <= high"):
        box((0.0, 0.3), (0.5, 0.9))
    with pytest.raises(ValueError, match="damping must be 0 <= low <= high"):
        box((0.2, 0.3), (0.9, 0.5))


def test_pairs_of_plots_in_quick_succession():
    found = certify([[0.5, 0.2]], 2, times=ElapsedTimes(0.02, 0.98))
    assert found.verdict == "refuted"
    assert sorted(found.elapsed) == [0.02, 0.98]
    assert found.growth**2 == pytest.approx(3.95, abs=0.01)


def test_a_cycle_begins_at_the_same_matrix_whatever_the_rounding():
    shears = np.array([[[1.0, 1.0], [0.0, 1.0]], [[1.0, 0.0], [1.0, 1.0]]])
    for order in ([0, 1], [1, 0]):
        cycle, growth = growing_sequence(shears[order], np.eye(2), 2)
        assert cycle.tolist() == [1, 0]
        assert growth == pytest.approx((1 + 5**0.5) / 2)
