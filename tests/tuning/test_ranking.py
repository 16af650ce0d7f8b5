import math

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from fuzzytrack.schedulers import GainScheduler
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.tuning import VARIANTS, rank
from fuzzytrack.tuning.ranking import Ranking
from fuzzytrack.tuning.scored_plots import scored_plots, squared_errors

SLOW, FAST = "fixed:alpha=0.4:beta=0.1", "fixed:alpha=0.7:beta=0.6"
SETS = ("report", "mixed", "strong")


def test_every_variant_is_ranked():
    shares = []
    found = rank({"slow": SLOW, "fast": FAST}, tracks=4, seed=1, progress=shares.append)
    assert found.names == ("slow", "fast")
    assert found.variants == tuple(VARIANTS)
    assert found.squares.shape == (2, len(VARIANTS), 3, 4)
    assert shares == [pytest.approx(k / 90) for k in range(1, 91)]
    for k, variant in enumerate(VARIANTS):
        for j, name in enumerate(SETS):
            plots = scored_plots(name, VARIANTS[variant], 4, 1)
            assert_array_equal(found.squares[0, k, j], squared_errors(make_tracker(SLOW), plots))
            assert_array_equal(found.plots[k, j], plots.scored.sum(axis=0))


@pytest.mark.parametrize("variant", VARIANTS)
def test_scored_are_the_plots_received(variant):
    for name, first in ("report", 2), ("mixed", 8), ("strong", 8):
        plots = scored_plots(name, VARIANTS[variant], 5, 3)
        mean = (plots.time[-1] - plots.time[0]).mean() / (len(plots.time) - 1)
        begin = max(2, math.ceil(first / mean - 1e-9))
        for track in range(5):
            got = [k for k in range(len(plots.z)) if not np.isnan(plots.z[k, track]).any()]
            expected = [k for k in got[2:] if k >= begin]
            assert np.flatnonzero(plots.scored[:, track]).tolist() == expected


def test_errors_are_those_of_a_loop_over_plots():
    plots = scored_plots("mixed", VARIANTS["jit+Pd.7+sigma"], 3, 5)
    tracker = make_tracker("kalman-cv:sigma_v=0.9")
    found = squared_errors(tracker, plots)
    for track in range(3):
        sigma = plots.sigma[:, track]
        result = tracker.run(plots.time[:, track], plots.z[:, track], sigma)
        squares = [
            math.dist(result.predicted[k], plots.truth[k, track]) ** 2
            for k in range(len(plots.time))
            if plots.scored[k, track]
        ]
        assert found[track] == pytest.approx(sum(squares), rel=1e-9)


def test_variants_have_the_same_tracks_and_sets_their_own():
    often = scored_plots("mixed", VARIANTS["T=.5"], 3, 5)
    usual = scored_plots("mixed", VARIANTS["constant T"], 3, 5)
    np.testing.assert_allclose(often.truth[::2][: len(usual.truth)], usual.truth, atol=1e-9)
    # The noise is not that of the motion, nor of another set or seed.
    noise = {
        (name, seed): scored_plots(name, VARIANTS["constant T"], 3, seed)
        for name in SETS
        for seed in (5, 6)
    }
    first = [each.z[0] - each.truth[0] for each in noise.values()]
    assert len(np.unique(np.round(first, 12))) == 6 * 3 * 2


# ---------------------------------------------------------------- statistics


def ranking(squares, plots=None):
    squares = np.asarray(squares, dtype=float)
    counts = np.full(squares.shape[1:], 2) if plots is None else plots
    return Ranking(("a", "b", "c")[: len(squares)], ("constant T",), SETS, 1, squares, counts)


def test_rmse_and_change_by_hand():
    a = [[[8.0, 10.0], [2.0, 16.0], [32.0, 40.0]]]
    b = [[[2.0, 2.5], [8.0, 64.0], [8.0, 10.0]]]
    plots = np.array([[[1, 1], [4, 4], [10, 10]]])
    found = ranking([a, b], plots)
    assert found.rmse("a", "constant T") == pytest.approx(
        {"report": 3.0, "mixed": 1.5, "strong": math.sqrt(3.6)}
    )
    # Ratios of the RMSE: 1/2, 2, 1/2. In each set a is a multiple of b, track by track.
    change = found.change("b", "a", "constant T")
    assert change.value == pytest.approx(0.5 ** (1 / 3) - 1)
    assert change.error == pytest.approx(0.0, abs=1e-15)
    assert found.change("a", "a", "constant T").value == 0.0
    assert (found.tracks, found.seed) == (2, 1)


def test_the_error_of_a_change_is_that_of_many_samples():
    rng = np.random.default_rng(4)

    def draw():
        common = rng.gamma(2.0, size=(1, 3, 400))
        return ranking([common, common * rng.uniform(0.5, 1.0, size=common.shape)])

    changes = [draw().change("b", "a", "constant T") for _ in range(400)]
    spread = np.std([each.value for each in changes])
    assert np.mean([each.error for each in changes]) == pytest.approx(spread, rel=0.12)


def test_what_diverges_is_infinite():
    well = np.ones((1, 3, 2))
    lost = well.copy()
    lost[0, 1, 0] = np.inf
    found = ranking([well, lost])
    assert found.rmse("b", "constant T")["mixed"] == math.inf
    assert found.change("b", "a", "constant T").value == math.inf
    assert math.isnan(found.change("a", "b", "constant T").error)


class Exploding(GainScheduler):
    def kernel(self, n_axes):
        def gains(e, dz, dt, sigma, memory):
            return 1e6, 1e9, 0.0, 1.0, memory

        return gains


def test_a_tracker_without_numbers_is_infinitely_wrong():
    plots = scored_plots("strong", VARIANTS["constant T"], 2, 5)
    found = squared_errors(AlphaBetaTracker(Exploding()), plots)
    assert_array_equal(found, np.inf)


def test_other_sets():
    found = rank([SLOW], 3, 2, ["jitter"], ["weaving"])
    assert found.sets == ("weaving",)
    plots = scored_plots("weaving", VARIANTS["jitter"], 3, 2)
    total = squared_errors(make_tracker(SLOW), plots).sum()
    assert found.rmse(SLOW, "jitter") == {
        "weaving": pytest.approx(math.sqrt(total / plots.scored.sum()))
    }


def test_json():
    found = rank([SLOW, FAST], 3, 2, ["jitter", "told x2"])
    plain = found.to_json_dict([FAST])
    assert plain["tracks"] == 3
    assert plain["seed"] == 2
    assert plain["sets"] == SETS
    assert plain["variants"]["jitter"].startswith('Variant(sampling=Sampling(pattern="jitter"')
    assert plain["rmse"][SLOW]["told x2"] == found.rmse(SLOW, "told x2")
    assert list(plain["changes"]) == [FAST]
    for name in (SLOW, FAST):
        for variant in ("jitter", "told x2"):
            change = found.change(name, FAST, variant)
            assert plain["changes"][FAST][name][variant] == [change.value, change.error]
    assert change.value == change.error == 0.0


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (([SLOW], 2, 1, ["jiter"]), r"unknown variant 'jiter'; did you mean 'jitter'\?"),
        (([SLOW], 2, 1, ["jitter"], ["weave"]), r"unknown set 'weave'; did you mean 'weaving'\?"),
        (([SLOW], 0, 1), "tracks must be at least 1, got 0"),
        (([SLOW], 2, -1), "seed must not be negative, got -1"),
        ((["fixd"], 2, 1), "no such tracker"),
    ],
)
def test_impossible_rankings(arguments, complaint):
    with pytest.raises(ValueError, match=complaint):
        rank(*arguments)


def test_unknown_trackers_of_a_ranking():
    found = ranking(np.ones((2, 1, 3, 2)))
    with pytest.raises(ValueError, match="unknown tracker 'd'; allowed: a, b"):
        found.change("a", "d", "constant T")
