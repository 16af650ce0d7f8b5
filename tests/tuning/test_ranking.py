import math

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.simulation.published import track_set
from fuzzytrack.trackers import Tracker
from fuzzytrack.tuning.ranking import FAMILIES, prediction_mse, rank, stretched, tune

NONE = {"fixed α-β, published": {}}
FIXED = dict.fromkeys(("report", "mixed", "strong", "all"), (0.5, 0.4))


def test_stretched_limits_move_sets_and_outputs_alike():
    rules = ft.load_rulebase("stiffness-damping")
    assert stretched(rules, {}) == rules
    moved = stretched(rules, {"damping": (0.4, 1.1)})
    before, after = (
        ft.FuzzySystem(base).evaluate(np.array([[0.3, -0.2]])) for base in (rules, moved)
    )
    part = (before["damping"] - 0.54) / (0.89 - 0.54)
    np.testing.assert_allclose(after["damping"], 0.4 + part * 0.7, rtol=1e-12)
    np.testing.assert_array_equal(after["stiffness"], before["stiffness"])
    with pytest.raises(ft.RuleBaseError, match="limits of damping must rise"):
        stretched(rules, {"damping": (1.1, 0.4)})


@pytest.mark.parametrize("name", FAMILIES)
def test_every_family_makes_trackers_at_its_start_and_its_limits(name):
    family = FAMILIES[name]
    assert len(family.start) == len(family.low) == len(family.high)
    assert all(
        low <= x <= high for low, x, high in zip(family.low, family.start, family.high, strict=True)
    )
    for numbers in {family.start, family.low, family.high}:
        assert isinstance(family.make(numbers), Tracker)


def test_the_schedule_at_its_own_numbers_is_the_shipped_one():
    family = FAMILIES["omega-schedule, tuned"]
    tracks = track_set("strong", 3, 5)
    shipped = prediction_mse(FAMILIES["omega-schedule"].make(()), tracks, 1)
    np.testing.assert_allclose(prediction_mse(family.make(family.start), tracks, 1), shipped)
    with pytest.raises(ValueError, match="levels must rise"):
        family.make((0.8, 2.0, 0.5, 0.4, 0.6, 0.7))


def test_the_error_is_that_of_a_loop_over_scans():
    tracks = track_set("mixed", 2, 3)
    tracker = FAMILIES["fixed α-β, published"].make(())
    found = prediction_mse(tracker, tracks, 9)
    plots = tracks.position + np.random.default_rng([9, 1]).standard_normal(tracks.position.shape)
    for track in range(2):
        predicted = tracker.run(tracks.time, plots[:, track]).predicted
        squares = [
            math.dist(predicted[k], tracks.position[k, track]) ** 2
            for k in range(tracks.first_scored, len(tracks.time))
        ]
        assert found[track] == pytest.approx(np.mean(squares), rel=1e-12)


def test_tuning_finds_what_a_grid_finds():
    sets = [track_set("mixed", 4, 3), track_set("strong", 4, 3)]
    family, shares = FAMILIES["fading memory"], []
    (best,) = tune(family, sets, seed=2, evaluations=25, progress=shares.append)

    def loss(xi):
        tracker = family.make((xi,))
        return np.mean([np.log(prediction_mse(tracker, s, 2).mean()) / 2 for s in sets])

    grid = np.linspace(0.1, 0.9, 33)
    assert loss(best) <= min(map(loss, grid)) + 1e-4
    assert shares == sorted(shares)
    assert 0 < shares[-1] <= 1


def test_a_family_without_tracker_at_some_numbers_is_tuned_all_the_same():
    numbers = tune(
        FAMILIES["omega-schedule, tuned"], [track_set("report", 2, 3)], 2, evaluations=12
    )
    assert list(numbers[2:]) == sorted(numbers[2:])


def test_ranks_put_the_best_first():
    shares = []
    found = rank({**NONE, "fixed α-β": FIXED}, tracks=4, seed=1, progress=shares.append)
    assert [each.name for each in found] == ["fixed α-β", "fixed α-β, published"]
    assert shares == [0.5, 1.0]
    tuned, published = found
    assert (tuned.own_change, tuned.single_change, tuned.single_error) == (0.0, 0.0, 0.0)
    ratios = [published.single[name] / tuned.single[name] for name in ("report", "mixed", "strong")]
    assert published.single_change == pytest.approx(math.prod(ratios) ** (1 / 3) - 1)
    assert published.own == published.single
    assert published.single_error > 0


@pytest.mark.parametrize("tuned", [{**NONE, "fixd": FIXED}, NONE])
def test_unknown_families_are_named(tuned):
    with pytest.raises(ValueError, match=r"tuned: needs families out of .*; got 'fix"):
        rank(tuned, tracks=2, seed=1)
