import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker
from fuzzytrack.gains import quality
from fuzzytrack.schedulers.track_quality import QualityGains, quality_gains


@pytest.mark.parametrize(
    ("n", "alpha", "beta"),
    [
        (1, 0.8333333333, 0.7003401714778812),
        (2, 0.7, 0.4091097700),
        (10, 0.2948717949, 0.0513799192),
        (30, 0.1193181818, 0.0075776687),
    ],
)
def test_published_formulas(n, alpha, beta):
    assert quality_gains(float(n)) == pytest.approx((alpha, beta), abs=5e-11)
    assert quality_gains(float(n)) == pytest.approx(quality(n), rel=1e-14)


def by_hand(plots, cap, drop):
    """Quality used at each plot, after a start from two points."""
    quality, seen, used = 0, 0, []
    for plot in plots:
        hit = not np.isnan(plot)
        seen += hit
        used.append(quality if hit and seen > 2 else np.nan)
        if seen < 2:
            continue
        if hit:
            quality = min(quality + 1, cap)
        else:
            quality = max(quality - drop, 1)
    return np.array(used, float), quality


@pytest.mark.parametrize("scheduler", [QualityGains(), QualityGains.as_published()])
def test_hits_raise_and_misses_lower_the_quality(scheduler):
    plots = np.where(np.random.default_rng(4).random(150) < 0.1, np.nan, 0.0)
    plots[[0, 2, 3]] = np.nan
    plots[80:84] = np.nan
    plots[90:130] = 0.0
    result = AlphaBetaTracker(scheduler).run(np.arange(150.0), plots)
    used, last = by_hand(plots, scheduler.cap, scheduler.drop)
    assert np.nanmax(used) == scheduler.cap
    seen = ~np.isnan(used)
    np.testing.assert_array_equal(np.isnan(result.gains.alpha), ~seen)
    alpha, beta = quality(used[seen])
    np.testing.assert_allclose(result.gains.alpha[seen], alpha)
    np.testing.assert_allclose(result.gains.beta[seen], beta)
    assert result.state.lanes[result.state.rows.memory, 0] == last


def test_a_start_from_one_point_begins_at_quality_one():
    gains = AlphaBetaTracker(QualityGains(), "one-point").run(np.arange(5.0), np.zeros(5)).gains
    np.testing.assert_allclose(gains.alpha[1:], quality([1, 1, 2, 3])[0])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"cap": 0.5}, "cap must be >= 1, got 0.5"),
        ({"drop": -1}, "drop must be >= 0, got -1"),
        ({"cap": np.inf}, "cap must be finite, got inf"),
    ],
)
def test_parameters_are_checked(arguments, message):
    with pytest.raises(ValueError, match=message):
        QualityGains(**arguments)
