import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fuzzytrack.simulation.starting import prepare_start

NAN = math.nan


def test_leading_unseen_scans_are_trimmed():
    z = [[NAN, NAN], [NAN, NAN], [1.0, 2.0], [3.0, 4.0], [NAN, NAN]]
    t, plots = prepare_start([0, 1, 2, 3, 4], z, 5.0)
    assert_array_equal(t, [2, 3, 4])
    assert_array_equal(plots.z, z[2:])
    assert_array_equal(plots.sigma, np.full((3, 2), 5.0))


def test_a_missed_second_plot_is_interpolated_in_time():
    t, plots = prepare_start([0, 3, 4, 6], [10.0, NAN, NAN, 40.0], [2.0, NAN, NAN, 4.0])
    assert_array_equal(t, [0, 3, 4, 6])
    assert_array_equal(plots.z, [10.0, 25.0, NAN, 40.0])
    assert_allclose(plots.sigma, [2.0, math.hypot(1.0, 2.0), NAN, 4.0])


def test_each_run_by_itself():
    z = np.array(
        [
            [NAN, NAN, NAN, NAN],
            [1.0, NAN, NAN, 8.0],
            [NAN, 5.0, NAN, 9.0],
            [7.0, NAN, NAN, NAN],
            [NAN, 6.0, 2.0, 9.0],
        ]
    )[..., None]
    given = z.copy()
    t, plots = prepare_start(np.arange(5.0), z, 1.0)
    assert_array_equal(t, [1, 2, 3, 4])
    expected = z[1:].copy()
    expected[1, 0], expected[2, 1] = 4.0, 5.5
    assert_array_equal(plots.z, expected)
    assert_array_equal(z, given)


def test_no_later_plot_leaves_it_missed():
    _, plots = prepare_start([0, 1, 2], [4.0, NAN, NAN], 1.0)
    assert_array_equal(plots.z, [4.0, NAN, NAN])
    assert_array_equal(prepare_start([0], [4.0], 1.0)[1].z, [4.0])


def test_wrong_arguments():
    with pytest.raises(ValueError, match="z: no scan has a plot"):
        prepare_start([0, 1], [NAN, NAN], 1.0)
    with pytest.raises(
        ValueError, match=r"t: needs one time a scan.*\(2,\) for t and \(1,\) for z"
    ):
        prepare_start([0, 1], [1.0], 1.0)
