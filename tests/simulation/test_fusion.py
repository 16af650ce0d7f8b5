import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fuzzytrack.simulation.fusion import fuse, fuse_pair

NAN = math.nan


def test_a_pair_by_hand():
    z, variance = fuse_pair([1.0, NAN, 3.0, NAN], 1.0, [5.0, 6.0, NAN, NAN], 3.0)
    np.testing.assert_array_equal(z, [2.0, 6.0, 3.0, NAN])
    np.testing.assert_array_equal(variance, [0.75, 3.0, 1.0, NAN])


@given(
    st.lists(
        st.tuples(st.floats(-1e4, 1e4) | st.just(NAN), st.floats(0.01, 1e6)),
        min_size=1,
        max_size=5,
    )
)
def test_fusion_is_the_weighted_mean_in_any_order(sensors):
    found = [
        fuse(*(np.array(column)[:, None] for column in zip(*order, strict=True)))
        for order in itertools.permutations(sensors)
    ]
    seen = [(z, v) for z, v in sensors if not math.isnan(z)]
    if not seen:
        assert all(math.isnan(z[0]) and math.isnan(v[0]) for z, v in found)
        return
    total = math.fsum(1 / v for _, v in seen)
    mean = math.fsum(z / v for z, v in seen) / total
    assert_allclose([z[0] for z, _ in found], mean, rtol=1e-9, atol=1e-9)
    assert_allclose([v[0] for _, v in found], 1 / total, rtol=1e-12)


def test_many_sensors_and_axes_at_once():
    rng = np.random.default_rng(1)
    z = rng.normal(size=(3, 4, 6, 2))
    z[rng.random(z.shape) < 0.3] = NAN
    variance = rng.uniform(1, 9, (6, 2))
    fused, of_fused = fuse(z, variance)
    weight = np.where(np.isnan(z), 0.0, 1 / variance)
    assert_allclose(fused, (weight * np.nan_to_num(z)).sum(axis=2) / weight.sum(axis=2))
    assert_allclose(of_fused, 1 / weight.sum(axis=2))
    # a sensor that sees nothing changes no bit
    blind = np.insert(z, 2, NAN, axis=2)
    again, _ = fuse(blind, np.insert(variance, 2, 5.0, axis=0))
    np.testing.assert_array_equal(again, fused)


def test_the_fused_error_has_the_fused_variance():
    rng = np.random.default_rng(2)
    variance = np.array([[4.0], [25.0], [9.0]])
    z = np.sqrt(variance) * rng.standard_normal((20000, 3, 1))
    fused, of_fused = fuse(z, variance)
    assert_allclose(fused.var(), of_fused[0, 0], rtol=0.05)


@pytest.mark.parametrize("size", [1e-200, 1e200, 1.7e308])
def test_variances_of_any_size(size):
    z, variance = fuse_pair(0.0, size, 1.0, size)
    assert z == 0.5
    assert_allclose(variance, size / 2)


def test_wrong_arguments():
    with pytest.raises(ValueError, match=r"variance must be positive.* got 0 at index \(1, 0\)"):
        fuse([[1.0], [2.0]], [[1.0], [0.0]])
    with pytest.raises(ValueError, match=r"variance2 must be positive.* got inf"):
        fuse_pair(1.0, 1.0, 2.0, math.inf)
    with pytest.raises(ValueError, match=r"z: needs shape \(..., n_sensors, n_axes\)"):
        fuse([1.0, 2.0], 1.0)
    with pytest.raises(ValueError, match=r"variance: shape \(3,\) does not broadcast"):
        fuse([[1.0, 2.0]], [1.0, 2.0, 3.0])
