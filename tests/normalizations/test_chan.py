import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.normalizations import normalizations
from fuzzytrack.normalizations.chan import (
    Chan,
    ChanMagnitude,
    ChanSigned,
    relative,
    relative_signed,
)

meters = st.floats(-1e6, 1e6)
unit = st.floats(-1, 1)


def signals(normalization, innovation, change, memory, sigma=1.0, n_axes=1):
    return normalization.kernel(n_axes)(innovation, change, 1.0, sigma, memory)


@pytest.mark.parametrize(
    ("error", "moved", "expected"),
    [(1, 2, 0.5), (1, -2, 0.5), (1, -1, 1), (0, 3, 0), (0, 0, 0), (2, 1, 1)],
)
def test_chan_error(error, moved, expected):
    (normalized, _), memory = signals(Chan(), float(error), float(moved), (0.0,))
    assert normalized == expected
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
    # An innovation of `now` against a displacement of 1 is a normalized error of `now`.
    (_, rate), _ = signals(Chan(), float(now), 1.0, (float(before),))
    assert rate == pytest.approx(expected)


@given(meters, meters, unit)
def test_chan_is_odd_bounded_and_keeps_signs(error, moved, before):
    (e, rate), memory = signals(Chan(), error, moved, (before,))
    assert -1 <= e <= 1
    assert -1 <= rate <= 1
    assert e * error >= 0
    assert rate * (e - before) >= 0
    (opposite, opposite_rate), _ = signals(Chan(), -error, -moved, (-before,))
    assert (opposite, opposite_rate) == (-e, -rate)
    assert memory == (e,)


@given(meters, meters)
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


@given(st.lists(st.tuples(meters, meters, unit), min_size=1, max_size=4))
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


def test_registered_normalizations():
    names = {"chan", "chan-signed", "chan-magnitude"}
    names |= {"predicted", "scale", "smoothed", "smoothed-magnitude"}
    assert names <= set(normalizations.names())
    for plugin in normalizations:
        assert plugin.source
        assert len(plugin.factory.signals) == 2
