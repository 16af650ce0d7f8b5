import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack.gains import alpha_beta_from_w, is_stable
from fuzzytrack.gains.period import resampled_gains
from fuzzytrack.gains.polygons import center_of_gravity, convex_hull, part_below
from fuzzytrack.gains.resampled_region import resampled_region
from fuzzytrack.gains.stability import factored, has_negative_pole


def outside(corners, points):
    """How far the points lie outside of a polygon, at most, over its size."""
    following = np.roll(corners, -1, axis=0)
    edge = following - corners
    edge = edge / np.linalg.norm(edge, axis=1)[:, None]
    to_point = points[:, None] - corners
    side = edge[:, 0] * to_point[..., 1] - edge[:, 1] * to_point[..., 0]
    return -side.min() / np.abs(corners).max()


@given(
    st.floats(0.05, 0.8), st.floats(1.05, 3), st.floats(0.1, 1.2), st.floats(1.05, 3),
    st.floats(0.02, 20), st.floats(1, 1.1), st.integers(0, 99),
)  # fmt: skip
@settings(max_examples=60, deadline=None)
def test_all_gains_at_all_times_are_inside(w, w_ratio, zeta, zeta_ratio, shortest, ratio, seed):
    rng = np.random.default_rng(seed)
    corners = np.array([(a, b) for a in (w, w * w_ratio) for b in (zeta, zeta * zeta_ratio)])
    gains = convex_hull(np.stack(alpha_beta_from_w(*corners.T), axis=1))
    alpha, beta = (rng.dirichlet(np.full(len(gains), 0.3), 400) @ gains).T
    usable = is_stable(alpha, beta)
    usable[usable] = ~has_negative_pole(
        *factored(alpha[usable], beta[usable], 0.0 * alpha[usable])[:2]
    )
    alpha, beta = alpha[usable], beta[usable]
    dt = shortest * rng.uniform(1, ratio, len(alpha))
    found = np.stack(resampled_gains(alpha, beta, period=1, dt=dt)[:2], axis=1)
    region = resampled_region(gains, shortest, shortest * ratio)
    if len(found):
        assert outside(region, found) < 1e-9


def test_the_region_is_not_much_larger_than_needed():
    gains = np.array([[0.4, 0.1], [0.6, 0.15], [0.5, 0.3]])
    region = resampled_region(gains, 0.5, 0.5)
    exact = np.stack(resampled_gains(*gains.T, period=1, dt=0.5)[:2], axis=1)
    assert np.abs(region.min(axis=0) - exact.min(axis=0)).max() < 0.01
    assert np.abs(region.max(axis=0) - exact.max(axis=0)).max() < 0.01


def test_at_the_period_the_gains_stay():
    gains = np.array([[0.4, 0.1], [0.6, 0.15], [0.5, 0.3]])
    assert resampled_region(gains, 1.0, 1.0) is gains


def test_parts_of_a_polygon():
    square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    left = part_below(square, np.array([1.0, 0.0, -0.5]))
    assert sorted(map(tuple, left)) == [(0, 0), (0, 2), (0.5, 0), (0.5, 2)]
    assert part_below(square, np.array([1.0, 0.0, 1.0])).shape == (0, 2)
    assert part_below(square[:1], np.array([1.0, 0.0, 0.0])).tolist() == [[0, 0]]


def test_center_of_gravity():
    triangle = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 6.0]])
    assert center_of_gravity(triangle) == pytest.approx([1, 2])
    # A corner on an edge does not move it, as it would the mean of the corners.
    assert center_of_gravity(np.insert(triangle, 1, [1.0, 0.0], axis=0)) == pytest.approx([1, 2])
    assert center_of_gravity(triangle[:2]) == pytest.approx([1.5, 0])
