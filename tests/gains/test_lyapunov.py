import numpy as np
import pytest

from fuzzytrack.gains.growing_sequence import growing_sequence
from fuzzytrack.gains.lyapunov import common_lyapunov, largest_rate
from fuzzytrack.gains.polygon_norm import ellipse, polygon_norm, reducing_polygon

# Its products grow by the golden ratio a matrix and a half: the known joint spectral radius.
GOLDEN = np.array([[[1.0, 1.0], [0.0, 1.0]], [[1.0, 0.0], [1.0, 1.0]]])
RADIUS = (1 + np.sqrt(5)) / 2


def random_set(seed, count=3):
    matrices = np.random.default_rng(seed).normal(size=(count, 2, 2))
    return 0.4 * matrices


@pytest.mark.parametrize("seed", range(8))
def test_the_best_ellipse_is_found(seed):
    """A random search over P finds none that is better, and some that are nearly as good."""
    matrices = random_set(seed)
    rate, p = common_lyapunov(matrices)
    assert largest_rate(matrices, p) == pytest.approx(rate, rel=1e-12)
    assert p[0, 0] == 1
    rng = np.random.default_rng(100 + seed)
    best = np.inf
    center, width = np.linalg.cholesky(p), 3.0
    for _ in range(4000):
        root = np.tril(center + width * rng.normal(size=(2, 2)))
        if abs(np.linalg.det(root)) < 1e-6:
            continue
        found = largest_rate(matrices, root @ root.T)
        width = max(0.9 * width, 1e-5) if found < best else width
        best = min(best, found)
    assert best >= rate * (1 - 1e-9)


def test_the_rate_is_the_largest_growth_of_the_norm():
    matrices = random_set(5)
    p = np.array([[1.0, -0.4], [-0.4, 2.0]])
    e = np.random.default_rng(6).normal(size=(20000, 2))
    size = np.sqrt(np.einsum("ki,ij,kj->k", e, p, e))
    after = np.einsum("nij,kj->nki", matrices, e)
    grown = np.sqrt(np.einsum("nki,ij,nkj->nk", after, p, after)) / size
    assert grown.max() <= largest_rate(matrices, p)
    assert grown.max() == pytest.approx(largest_rate(matrices, p), rel=1e-4)


def test_a_set_with_a_known_joint_spectral_radius():
    rate, p = common_lyapunov(GOLDEN)
    assert rate > RADIUS - 1e-12
    order, growth = growing_sequence(GOLDEN, p, 8)
    assert growth == pytest.approx(RADIUS)
    assert sorted(order.tolist()) == [0, 1]
    scaled = GOLDEN / (1.02 * RADIUS)
    found, corners = reducing_polygon(scaled, ellipse(p), 0.99)
    assert found < 1
    e = np.random.default_rng(3).normal(size=(2000, 2))
    after = np.einsum("nij,kj->nki", scaled, e)
    assert (polygon_norm(after, corners) <= (found + 1e-12) * polygon_norm(e, corners)).all()
    # None for a set that grows.
    assert reducing_polygon(GOLDEN / (0.98 * RADIUS), ellipse(p), 0.99)[0] > 1


def test_polygon_norm():
    corners = np.array([[2.0, -1.0], [2.0, 1.0], [-2.0, 1.0], [-2.0, -1.0]])
    points = np.array([[2.0, 0.3], [0.0, 1.0], [-4.0, -2.0], [1.0, -3.0], [0.0, 0.0], [-1.0, 0.0]])
    assert polygon_norm(points, corners) == pytest.approx([1, 1, 2, 3, 0, 0.5])


def test_corners_of_an_ellipse_lie_on_it_counterclockwise():
    p = np.array([[1.0, -0.6], [-0.6, 3.0]])
    corners = ellipse(p, 12)
    assert np.einsum("ki,ij,kj->k", corners, p, corners) == pytest.approx(np.ones(12))
    following = np.roll(corners, -1, axis=0)
    assert (corners[:, 0] * following[:, 1] > corners[:, 1] * following[:, 0]).all()


def test_longer_sequences_only_while_none_grows():
    # 12 quarter turns with a stretch: grows only as a whole, never within 8.
    angle = np.pi / 12
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    project = np.array([[0.0, 2.0], [0.0, 0.0]])
    matrices = np.stack([0.99 * turn, project])
    order, growth = growing_sequence(matrices, np.eye(2), 3)
    assert growth < 1
    order, growth = growing_sequence(matrices, np.eye(2), 48)
    assert growth > 1
    assert order.tolist().count(1) == 1
