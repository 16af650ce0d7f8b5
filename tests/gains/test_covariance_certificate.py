import re

import numpy as np
import pytest

from fuzzytrack.gains.covariance_certificate import (
    CovarianceLimits,
    certify_covariance,
    contraction,
)
from fuzzytrack.gains.elapsed_times import ElapsedTimes
from fuzzytrack.gains.singer import fade

TWO_RULES = CovarianceLimits((0.12, 2.0), (1.0, 4.0), delay=1.0, gap=0.5)
WIDE = CovarianceLimits(
    (0.09, 2.7), (0.3, 7.0), 1.0, 0.6, ElapsedTimes(0.3, 3, missed=2), sigma_ratio=2.0
)


def by_hand(limits, share, plots):
    """Contraction of one sequence, with information matrices in place of gains."""

    def place(low, high, x):
        return low * (high / low) ** x

    p, f_all = np.eye(3), np.eye(3)
    for k, (step, missed, noise, retention, sigma) in enumerate(share):
        if k == len(share) - plots:
            p0, f_all = p, np.eye(3)
        count = min(int(missed * (limits.times.missed + 1)), limits.times.missed)
        s = place(limits.times.low, limits.times.high, step) * (1 + count)
        phi = fade(s / place(*limits.retention, retention))
        f = np.array([[1, s, phi * s * s / 2], [0, 1, phi * s], [0, 0, phi]])
        d = s + limits.delay
        g = np.array([d * d / 2, d, 1]) * place(*limits.noise, noise)
        before = f @ p @ f.T + (1 - phi**2) / (1 + s / limits.gap) * np.outer(g, g)
        r = place(1 / limits.sigma_ratio, limits.sigma_ratio, sigma) ** 2
        information = np.linalg.inv(before) + np.diag([1 / r, 0, 0])
        p = np.linalg.inv(information)
        # I - KH = P⁺(P⁻)⁻¹
        f_all = p @ np.linalg.inv(before) @ f @ f_all
    ratio = f_all.T @ np.linalg.inv(p) @ f_all @ p0
    return np.sqrt(np.abs(np.linalg.eigvals(ratio)).max())


def test_contraction_of_a_sequence():
    shares = np.random.default_rng(1).random((3, 9, 5))
    found = contraction(WIDE, shares, 4)
    for share, left in zip(shares, found, strict=True):
        assert left == pytest.approx(by_hand(WIDE, share, 4), rel=1e-7)


def test_no_plot_lets_the_norm_grow():
    shares = np.random.default_rng(2).integers(0, 2, (300, 25, 5)).astype(float)
    assert contraction(WIDE, shares, 1).max() <= 1 + 1e-9


def test_limits_of_the_shipped_kind_are_certified():
    found = certify_covariance(TWO_RULES, (10, 20))
    assert (found.verdict, found.missing) == ("certified", "")
    assert found.contraction[20] < found.contraction[10] < 1
    # The same seed finds the same, and a wider range of times is worse.
    assert certify_covariance(TWO_RULES, (10, 20)).contraction == found.contraction
    assert certify_covariance(WIDE, (10,)).contraction[10] > found.contraction[10]


def test_the_search_finds_worse_than_random_sequences():
    shares = np.random.default_rng(3).random((500, 30, 5))
    assert (
        certify_covariance(TWO_RULES, (10,)).contraction[10]
        > contraction(TWO_RULES, shares, 10).max()
    )


@pytest.mark.parametrize(
    ("limits", "missing"),
    [
        (
            CovarianceLimits((0, 2), (1, 4)),
            r"the noise must be above 0 and bounded, and is in \[0, 2\]",
        ),
        (CovarianceLimits((0.1, np.inf), (1, 4)), "the noise must be above 0"),
        (CovarianceLimits((0.1, 2), (0, 4)), "the retention must be above 0"),
        (CovarianceLimits((0.1, 2), (1, np.inf)), r"retention .* is in \[1, inf\]"),
    ],
)
def test_hypotheses_that_do_not_hold(limits, missing):
    found = certify_covariance(limits)
    assert (found.verdict, found.contraction) == ("not decided", {})
    assert re.search(missing, found.missing)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"noise": (2, 1)}, "noise: must be 0 <= least <= largest, got 2, 1"),
        ({"retention": (-1, 1)}, "retention: must be 0 <="),
        ({"delay": -1}, "delay: must be finite and >= 0, got -1"),
        ({"gap": 0}, "gap: must be > 0, got 0"),
        ({"sigma_ratio": 0.5}, "sigma_ratio: must be finite and >= 1, got 0.5"),
    ],
)
def test_bad_limits(changed, message):
    with pytest.raises(ValueError, match=message):
        CovarianceLimits(**{"noise": (0.1, 1), "retention": (1, 2)} | changed)
