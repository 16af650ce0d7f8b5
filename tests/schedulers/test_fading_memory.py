import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack import AlphaBetaTracker, FixedGains
from fuzzytrack.schedulers.fading_memory import FadingMemory


def poles(alpha, beta, gamma):
    move = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]])
    gain = np.array([[alpha], [beta], [gamma / 2]])
    return np.linalg.eigvals(move - gain @ move[:1])


def test_both_conventions_of_the_published_example():
    alpha, beta, gamma = FadingMemory(0.64).gains
    assert (alpha, beta) == pytest.approx((0.737856, 0.318816), abs=1e-12)
    assert gamma / 2 == pytest.approx(0.046656)
    assert poles(alpha, beta, gamma) == pytest.approx(np.full(3, 0.64), abs=1e-4)
    printed = FadingMemory(0.64, "njonjo").gains
    assert printed == pytest.approx((alpha, beta, 2 * gamma))
    expected = [0.403581, 0.746545 - 0.303669j, 0.746545 + 0.303669j]
    assert sorted(poles(*printed), key=lambda p: (p.real, p.imag)) == pytest.approx(
        expected, abs=1e-6
    )


@given(st.floats(0, 0.999), st.sampled_from(["mahafza", "njonjo"]), st.sampled_from([2, 3]))
def test_it_is_stable_for_all_xi(xi, convention, order):
    FixedGains(*FadingMemory(xi, convention, order).gains)


@given(st.floats(0.1, 0.9), st.integers(2, 3))
def test_it_fits_all_plots_with_weights_that_fade(xi, order):
    """From the formulas of weighted least squares over a long record."""
    times = np.arange(-300.0, 1.0)
    plots = np.random.default_rng(0).normal(size=301)
    powers = times[:, None] ** np.arange(order)
    weights = xi**-times
    fit = np.linalg.solve(powers.T @ (weights[:, None] * powers), powers.T @ (weights * plots))
    result = AlphaBetaTracker(FadingMemory(xi, order=order)).run(times, plots)
    assert result.filtered[-1] == pytest.approx(fit[0], abs=1e-6)
    assert result.velocity[-1] == pytest.approx(fit[1], abs=1e-6)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"xi": 1.0}, "xi must be >= 0 and < 1, got 1"),
        ({"xi": 0.5, "convention": "brookner"}, "convention must be one of mahafza, njonjo, got"),
        ({"xi": 0.5, "order": 4}, "order must be 2 or 3, got 4"),
    ],
)
def test_parameters_are_checked(arguments, message):
    with pytest.raises(ValueError, match=message):
        FadingMemory(**arguments)
