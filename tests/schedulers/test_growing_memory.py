import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker
from fuzzytrack.schedulers import BenedictBordner, GrowingMemory, LinearCombination

STEPS = np.arange(12.0)


def s3():
    """Scenario S3 without noise: axes X and Y."""
    acceleration = np.zeros((100, 2))
    acceleration[70:, 0] = 0.62
    acceleration[:23, 1] = 1.45
    x, v = np.zeros(2), np.array([20.0, 0.0])
    positions = []
    for a in acceleration:
        positions.append(x)
        x, v = x + v + a / 2, v + a
    return np.array(positions)


@pytest.mark.parametrize(
    ("scheduler", "x", "y"),
    [
        (BenedictBordner(0.05), 43.56, 279.64),
        (BenedictBordner(0.01), 60.58, 1102.58),
        (GrowingMemory(), 46.29, 68.19),
        (LinearCombination(0.05, 0.05), 46.23, 72.02),
    ],
)
def test_prediction_errors_on_the_scenario_without_noise(scheduler, x, y):
    plots = s3()
    result = AlphaBetaTracker(scheduler).run(np.arange(100.0), plots)
    # Over all measured plots, as in the authors' Eq. 26; the first two have no error.
    errors = np.sqrt(np.nansum((result.predicted - plots) ** 2, axis=0) / 100)
    assert errors == pytest.approx([x, y], abs=0.02)


@pytest.mark.parametrize("start", ["two-point", "one-point"])
def test_growing_memory_is_the_least_squares_line(start):
    plots = np.random.default_rng(3).normal(0.0, 10.0, 12)
    result = AlphaBetaTracker(GrowingMemory(), start).run(STEPS, plots)
    for n in range(2, 12):
        slope, _ = line = np.polyfit(STEPS[:n], plots[:n], 1)
        assert result.velocity[n - 1] == pytest.approx(slope)
        assert result.predicted[n] == pytest.approx(np.polyval(line, STEPS[n]))


def test_the_memory_stops_growing_at_its_limit_and_counts_only_what_was_seen():
    plots = np.zeros(12)
    plots[[0, 3, 4, 7]] = np.nan
    gains = AlphaBetaTracker(GrowingMemory(5)).run(STEPS, plots).gains
    counts = [np.nan, np.nan, np.nan, np.nan, np.nan, 3, 4, np.nan, 5, 5, 5, 5]
    expected = [2 * (2 * n - 1) / (n * (n + 1)) for n in counts]
    np.testing.assert_allclose(gains.alpha, expected)
    np.testing.assert_allclose(gains.beta, [6 / (n * (n + 1)) for n in counts])


def test_the_combination_mixes_beta_only():
    runs = [AlphaBetaTracker(s).run(STEPS, np.zeros(12)).gains for s in (
        GrowingMemory(8), LinearCombination(0.5, 0.25, 8))]  # fmt: skip
    np.testing.assert_array_equal(runs[1].alpha, runs[0].alpha)
    np.testing.assert_allclose(runs[1].beta, 0.75 * runs[0].beta + 0.25 * 0.25 / 1.5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: BenedictBordner(1.2), r"alpha must be > 0 and < 4 - 2 sqrt\(2\).*, got 1.2"),
        (lambda: GrowingMemory(1.5), "limit must be >= 2 plots, got 1.5"),
        (lambda: GrowingMemory(np.nan), "limit must be finite, got nan"),
        (lambda: LinearCombination(0.0), "alpha must be > 0"),
        (lambda: LinearCombination(0.1, 1.1), "weight must be from 0 to 1, got 1.1"),
        (lambda: LinearCombination(0.1, 0.1, 1), "limit must be >= 2 plots, got 1"),
    ],
)
def test_parameters_are_checked(make, message):
    with pytest.raises(ValueError, match=message):
        make()
