import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.tuning.parameters import SCALES, Parameter, Space


@pytest.mark.parametrize("scale", SCALES)
@given(start=st.floats(0.01, 0.99), coordinate=st.floats(-5, 5))
def test_values_and_coordinates_are_inverse_within_the_limits(scale, start, coordinate):
    parameter = Parameter("p", start, 0.005, 0.995, scale)
    value = parameter.value(coordinate)
    assert 0.005 <= value <= 0.995
    assert parameter.value(0.0) == start
    if 0.006 < value < 0.99:
        assert parameter.coordinate(value) == pytest.approx(coordinate, abs=0.02)


def test_steps_are_factors_odds_and_parts_of_the_range():
    assert Parameter("p", 2.0, 0.1, 100.0).value(1.0) == pytest.approx(2.0 * np.exp(0.3), rel=1e-4)
    odds = Parameter("p", 0.8, 0.0, 1.0, "probability").value(-1.0)
    assert odds / (1 - odds) == pytest.approx(4.0 * np.exp(-0.6), rel=1e-3)
    assert Parameter("p", 1.0, -5.0, 5.0, "linear").value(1.0) == pytest.approx(2.2)
    # Values have few digits, so that what is printed is what was measured.
    assert len(repr(Parameter("p", 2.0, 0.1, 100.0).value(0.123))) <= 6


def test_a_start_beyond_the_limits_is_moved_into_them():
    assert Parameter("p", 2.0, 0.0, 1.0, "probability").start == 1.0 - 1e-4
    with pytest.raises(ValueError, match="p: limits must rise, got 3 to 1"):
        Parameter("p", 2.0, 3.0, 1.0)
    with pytest.raises(ValueError, match="limits must rise, got -1 to 1"):
        Parameter("p", 0.5, -1.0, 1.0)
    with pytest.raises(ValueError, match="unknown 'even'; one of linear, log, probability"):
        Parameter("p", 0.5, 0.1, 1.0, "even")


def test_numbers_of_a_rising_group_are_in_order():
    three = tuple(Parameter(name, 1.0, 0.1, 10.0) for name in "abc")
    space = Space(three, ((0, 2),))
    numbers = space.numbers([2.0, 1.0, -1.0])
    assert numbers[0] < numbers[2]
    assert numbers[1] == three[1].value(1.0)
    assert sorted(numbers) == sorted(space.numbers([-1.0, 1.0, 2.0]))
    assert space.bounds.shape == (3, 2)
    assert space.restricted([1, 2]) == Space(three[1:])
    assert space.restricted([0, 2]) == Space((three[0], three[2]), ((0, 1),))
