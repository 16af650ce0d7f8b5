import json
import math
import pickle
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.fuzzy.loading import load_rulebase, loads_rulebase, rulebase_path
from fuzzytrack.gains import kalata
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.compilation import sharing_code
from fuzzytrack.tuning import TuningData, TuningTrack, trial, tuner
from fuzzytrack.tuning.criteria import CRITERIA, RmsError
from fuzzytrack.tuning.folds import Folds
from fuzzytrack.tuning.specifications import specification
from fuzzytrack.tuning.trial import REFUSED, Trials
from fuzzytrack.tuning.tuned import with_head

QUICK = {"runs": 4, "trials": 8, "folds": 2, "seed": 3}
LONGER = {**QUICK, "trials": 20}


def random_walk(tracks, steps, index, seed=5):
    """Targets with an acceleration drawn anew for each step, for which Kalata's gains are best."""
    rng, found = np.random.default_rng(seed), []
    for k in range(tracks):
        a = rng.normal(0, index, steps)
        v = np.concatenate([[0.0], np.cumsum(a)[:-1]])
        x = np.concatenate([[0.0], np.cumsum(v + a / 2)[:-1]])[:, None]
        plots, sigma = x + rng.normal(0, 1, x.shape), np.ones(x.shape)
        found.append(TuningTrack(str(k), np.arange(float(steps)), plots, x, sigma))
    return TuningData("random walk", tuple(found))


def numbers(found):
    return found.to_json_dict()


@pytest.mark.untraced
def test_fixed_gains_come_near_those_of_the_steady_kalman_filter():
    found = ft.tune(random_walk(10, 100, 0.6), "fixed", trials=36, folds=2)
    alpha, beta = kalata(0.6)
    assert found.numbers["alpha"] == pytest.approx(float(alpha), rel=0.1)
    assert found.numbers["beta"] == pytest.approx(float(beta), rel=0.2)
    assert found.tracker == make_tracker(found.text)
    start, kalman, tuned = found.rows
    assert (start.name, kalman.name, tuned.name) == ("start", "Kalman filter (CV)", "tuned")
    # The Kalman filter has the same gains but at the start of a track, where it is better.
    assert kalman.numbers["sigma_v"] == pytest.approx(0.6, rel=0.25)
    assert tuned.held_out == pytest.approx(kalman.held_out, rel=0.1)
    assert found.worth_it == (start.change[2] < 0)
    assert found.units == "tracks"
    # The start itself is not worth it, though the searches on the folds have found better numbers.
    same = replace(found, numbers=found.start)
    assert same.rows[0].is_worse
    assert not same.worth_it
    assert same.verdict.startswith("not worth it: the search on all data found nothing better")


def test_what_is_tuned_already_is_not_worth_it():
    alpha, beta = (float(g) for g in kalata(0.6))
    text = f"fixed:alpha={alpha}:beta={beta}"
    found = ft.tune(random_walk(8, 60, 0.6), text, trials=12, folds=2)
    assert not found.worth_it
    assert found.verdict.startswith("not worth it: held-out change against the start ")
    assert found.start == {"alpha": alpha, "beta": beta}


@pytest.mark.untraced
def test_a_rule_base_is_tuned_and_loads_again_to_the_tuned_tracker(tmp_path):
    found = ft.tune("mixed", "omega-schedule", free=["stiffness", "rho"], **QUICK)
    path = tmp_path / "tuned.yaml"
    found.save(path)
    assert make_tracker(str(path)) == found.tracker
    assert path.read_text(encoding="utf-8") == found.text
    # All but the head and the free numbers is as it was, comments and layout included.
    before = rulebase_path("omega-schedule").read_text(encoding="utf-8").splitlines()
    after = path.read_text(encoding="utf-8").splitlines()
    assert after[0] == before[0]
    head, rest = after[1:4], after[4:]
    differ = [a.split()[0] for a, b in zip(before[1:], rest, strict=True) if a != b]
    assert {"universe:", "Z:", "S:", "M:", "L:", "scheduler:"} >= set(differ) >= {"scheduler:"}
    assert head[0].startswith("# Tuned on mixed with seed 3 by fuzzytrack ")
    assert head[1].startswith("# Objective: RMS of predictions, against the truth, ")
    assert found.rows[0].change_text in head[2]
    names = ["start", "best fixed pair", "Kalman filter (CV)", "tuned"]
    assert [row.name for row in found.rows] == names
    assert found.rows[-1].training <= found.rows[0].training
    # A rule base that was not loaded from a file is tuned as well.
    same = ft.tune("mixed", load_rulebase("omega-schedule"), free=["stiffness", "rho"], **QUICK)
    assert same.numbers == found.numbers
    assert loads_rulebase(same.text) == loads_rulebase(found.text)


def test_errors_are_those_of_the_trackers_run_alone():
    data = random_walk(4, 70, 0.5)
    found = ft.tune(data, "kalman-cv", trials=6, folds=2)
    total = 0.0
    for track in data.tracks:
        predicted = make_tracker("kalman-cv:sigma_v=0.5").run(track.time, track.plots, 1.0)
        total += float(((predicted.predicted - track.truth)[2:] ** 2).sum())
    expected = math.sqrt(total / (4 * 68))
    assert found.rows[0].held_out == pytest.approx(expected, rel=1e-9)
    # The mean over folds, each of which holds out the other half.
    assert found.rows[0].training == pytest.approx(expected, rel=0.01)
    assert found.start == {"sigma_v": 0.5}


@pytest.mark.untraced
def test_the_number_of_workers_does_not_matter():
    alone = ft.tune("mixed", "kalman-cv", **QUICK)
    with ThreadPoolExecutor(3) as pool:
        apart = ft.tune("mixed", "kalman-cv", executor=pool, **QUICK)
    assert numbers(apart) == numbers(alone)


def test_errors_of_compiled_trials_are_the_same_to_the_bit(monkeypatch):
    monkeypatch.setattr(trial, "_COORDINATES", 0)
    data = random_walk(4, 70, 0.5)
    candidates = tuner._candidates("fixed", None, data)
    trials = [(0.5, 0.2), (0.7, 0.3), (1.0, 3.0), (0.31, 0.04)]
    plain, compiled = (
        Trials(data, tuner.make_folds(data, 2, 0), RmsError(), compiled).sums(candidates, trials)
        for compiled in (False, True)
    )
    np.testing.assert_array_equal(compiled, plain)
    # Another process has all that it needs.
    again = pickle.loads(
        pickle.dumps(Trials(data, tuner.make_folds(data, 2, 0), RmsError(), False))
    )
    np.testing.assert_array_equal(again.sums(candidates, trials), plain)


@pytest.mark.untraced
def test_a_search_that_is_interrupted_goes_on_to_the_same_end(tmp_path):
    state, shares = tmp_path / "search.json", []
    whole = ft.tune("mixed", "fixed", progress=shares.append, **LONGER)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0

    def interrupt(share):
        if share > 0.7:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ft.tune("mixed", "fixed", state=state, progress=interrupt, **LONGER)
    with pytest.raises(ValueError, match=r"state: .* holds an earlier search; resume it or"):
        ft.tune("mixed", "fixed", state=state, **LONGER)
    with pytest.raises(ValueError, match=r"resume: seed is 4, in the search of .* it was 3"):
        ft.tune("mixed", "fixed", state=state, resume=True, **{**LONGER, "seed": 4})
    done = sum(map(len, json.loads(state.read_text())["losses"]))
    assert done > 0
    shares.clear()
    resumed = ft.tune("mixed", "fixed", state=state, resume=True, progress=shares.append, **LONGER)
    assert numbers(resumed) == numbers(whole)
    # What was kept is done at once.
    assert max(after - before for before, after in pairwise(shares)) > 0.3
    # Of a search that is finished nothing is left to do.
    assert numbers(ft.tune("mixed", "fixed", state=state, resume=True, **LONGER)) == numbers(whole)
    state.write_text("[]")
    with pytest.raises(ValueError, match=r"resume: .*search\.json holds no search"):
        ft.tune("mixed", "fixed", state=state, resume=True, **LONGER)
    with pytest.raises(ValueError, match="resume: needs the state file"):
        ft.tune("mixed", "fixed", resume=True, **LONGER)


@pytest.mark.untraced
def test_a_search_is_not_resumed_with_other_parameters(tmp_path):
    # A rule base does not hold its level.
    given = {**QUICK, "trials": 3, "free": ["delay"], "state": tmp_path / "search.json"}
    whole = ft.tune("mixed", "maneuver:level=3", **given)
    message = r"resume: parameters is level=9, in the search of .* it was level=3"
    with pytest.raises(ValueError, match=message):
        ft.tune("mixed", "maneuver:level=9", resume=True, **given)
    with pytest.raises(ValueError, match="resume: parameters is none, in"):
        ft.tune("mixed", "maneuver", resume=True, **given)
    again = ft.tune("mixed", "maneuver:level=3", resume=True, **given)
    assert numbers(again) == numbers(whole)


def test_numbers_without_an_effect_are_told_and_left_alone():
    # Weighted centers: how wide a set of an output is does not matter, where it is does.
    text = rulebase_path("omega-schedule").read_text(encoding="utf-8")
    rules = loads_rulebase(text.replace("M: {singleton: [0.556]}", "M: {gaussmf: [0.556, 0.05]}"))
    found = ft.tune("mixed", rules, free=["stiffness.M"], **QUICK)
    assert found.unused == ("stiffness.M.sigma",)
    assert list(found.numbers) == ["stiffness.M"]
    assert loads_rulebase(found.text).output("stiffness").sets[2].parameters[1] == 0.05
    with pytest.raises(ValueError, match=r"free: stiffness\.M\.sigma: without an effect on these"):
        ft.tune("mixed", rules, free=["stiffness.M.sigma"], **QUICK)


def test_recorded_plots_without_truth_are_compared_with_themselves(tmp_path):
    path = tmp_path / "plots.csv"
    many = np.random.default_rng(1).normal(0, 1, (250, 2)).cumsum(axis=0)
    path.write_text("t,x,y\n" + "\n".join(f"{k},{x},{y}" for k, (x, y) in enumerate(many)))
    found = ft.tune(path, "fixed", trials=8, folds=2)
    assert found.units == "blocks of time"
    assert found.objective == "RMS of innovations"
    # Without a sigma, the Kalman filter has an estimate of it.
    assert math.isfinite(found.rows[1].held_out)
    with pytest.raises(
        ValueError, match="output: a tuned tracker of this kind has no file; type f"
    ):
        found.save(tmp_path / "x.yaml")


@pytest.mark.untraced
def test_several_sources_are_tuned_on_together():
    found = ft.tune(["report", "mixed"], "kalman-cv", runs=12, trials=6, folds=2)
    assert found.data == "report, mixed"
    tracker, errors = make_tracker("kalman-cv:sigma_v=0.5"), []
    for name in ("report", "mixed"):
        data = tuner.simulated(tuner.load_scenario(name), 12, 0)
        squares = []
        for track in data.tracks:
            predicted = tracker.run(track.time, track.plots, track.sigma).predicted
            assert track.start == (8 if name == "mixed" else 2)
            squares.append(((predicted - track.truth)[track.start :] ** 2).sum(axis=1))
        errors.append(math.sqrt(np.concatenate(squares).mean()))
    # In these scenarios σ/T² is 1.
    assert found.start == {"sigma_v": 0.5}
    assert found.rows[0].held_out == pytest.approx(math.sqrt(math.prod(errors)))
    with pytest.raises(ValueError, match="data: at least one file or scenario is needed"):
        ft.tune([], "fixed")
    bare = random_walk(3, 100, 0.5)
    with pytest.raises(ValueError, match=r"random walk and mixed cannot .* differ in their number"):
        ft.tune([bare, "mixed"], "fixed", runs=12)


def test_numbers_that_make_no_tracker_are_refused():
    data = random_walk(4, 70, 0.5)
    run = Trials(data, tuner.make_folds(data, 2, 0), RmsError(), compiled=False)
    candidates = tuner._candidates("fixed", None, data)
    good, bad = run.losses(candidates, [(0.5, 0.2), (1.0, 3.0)], -1)
    assert bad == REFUSED > good
    assert "compiled=False" in repr(run)


def test_a_rule_base_is_tuned_as_its_name_is():
    for differ in (False, True):
        data = replace(random_walk(3, 90, 0.5), axes_differ=differ)
        named, loaded = (
            tuner._candidates(tracker, None, data)
            for tracker in ("maneuver", load_rulebase("maneuver"))
        )
        assert named.tracker(named.space.start) == loaded.tracker(loaded.space.start)
        assert dict(loaded.options) == ({"axes": "own"} if differ else {})


def test_the_change_is_that_of_paired_errors():
    rng = np.random.default_rng(2)
    other = rng.gamma(3.0, 1.0, 400)
    tuned = 0.81 * other * np.exp(rng.normal(0, 0.1, 400))
    units = np.arange(400)
    folds = Folds("tracks", (), units % 2, np.full(400, 7), 0 * units)
    middle, low, high = RmsError().compare(tuned, other, folds)
    assert middle == pytest.approx(math.sqrt(tuned.sum() / other.sum()) - 1, rel=1e-12)
    # Brute force: the bootstrap.
    draws = rng.integers(0, 400, (4000, 400))
    ratios = np.sqrt(tuned[draws].sum(axis=1) / other[draws].sum(axis=1)) - 1
    assert (low, high) == pytest.approx(tuple(np.quantile(ratios, [0.025, 0.975])), abs=0.001)
    nothing = np.full(400, np.inf)
    for name, least in (("rms", -1.0), ("likelihood", -math.inf)):
        assert CRITERIA[name].compare(tuned, nothing, folds) == (least, least, least)
        assert CRITERIA[name].compare(nothing, other, folds)[0] == math.inf
    middle, low, high = CRITERIA["likelihood"].compare(tuned, other, folds)
    means = (tuned - other)[draws].mean(axis=1) / 7
    assert middle == pytest.approx((tuned - other).mean() / 7)
    assert (low, high) == pytest.approx(tuple(np.quantile(means, [0.025, 0.975])), abs=0.002)


def test_groups_count_alike():
    rng = np.random.default_rng(3)
    group = np.repeat([0, 1], [300, 40])
    other = np.where(group == 0, 1.0, 1e4) * rng.gamma(3.0, 1.0, 340)
    tuned = np.where(group == 0, 0.5, 2.0) * other * np.exp(rng.normal(0, 0.3, 340))
    folds = Folds("tracks", (), group, np.full(340, 5), group)

    def ratio(a, b):
        logs = [0.5 * np.log(a[m].sum() / b[m].sum()) for m in (slice(300), slice(300, None))]
        return math.expm1(np.mean(logs))

    middle, low, high = RmsError().compare(tuned, other, folds)
    assert middle == pytest.approx(ratio(tuned, other))
    draws = np.hstack([rng.integers(0, 300, (3000, 300)), rng.integers(300, 340, (3000, 40))])
    ratios = [ratio(tuned[each], other[each]) for each in draws]
    assert (low, high) == pytest.approx(tuple(np.quantile(ratios, [0.025, 0.975])), abs=0.006)
    every = np.ones(340, dtype=bool)
    assert RmsError().levels(other, folds, every) == pytest.approx(
        0.25 * (np.log(other[:300].sum() / 1500) + np.log(other[300:].sum() / 200))
    )


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_comments_come_after_the_one_that_names_the_schema(end):
    head = "# yaml-language-server: $schema=x.json"
    lines = ["one", "two\x07"]
    comments = [f"# one{end}", f"# two?{end}"]
    assert with_head(f"{head}{end}a: 1{end}", lines) == "".join(
        [head, end, *comments, f"a: 1{end}"]
    )
    assert with_head(f"\ufeffa: 1{end}", lines) == "".join(["\ufeff", *comments, f"a: 1{end}"])


@pytest.mark.untraced
def test_the_likelihood_finds_the_noise_of_plots_and_target():
    data = random_walk(5, 60, 0.6)
    bare = TuningData("bare", tuple(replace(t, truth=None, sigma=None) for t in data.tracks))
    found = ft.tune(
        bare, "kalman-cv:sigma_w=1.7:sigma_v=1", free=["sigma_v", "sigma_w"],
        criterion="likelihood", trials=36, folds=2,
    )  # fmt: skip
    # An RMS error could only tell their ratio.
    assert found.numbers["sigma_w"] == pytest.approx(1.0, rel=0.15)
    assert found.numbers["sigma_v"] == pytest.approx(0.6, rel=0.35)
    assert found.objective == "negative log likelihood of the plots"
    assert [row.name for row in found.rows] == ["start", "tuned"]
    # The sum over plots, by hand.
    tracker = make_tracker("kalman-cv:sigma_w=1.7:sigma_v=1")
    total = 0.0
    for track in bare.tracks:
        state = tracker.run(track.time[:2], track.plots[:2]).state
        for t, z in zip(track.time[2:], track.plots[2:], strict=True):
            ahead = tracker.predict(state, t)
            s = float(ahead.innovation_variance[0])
            e = float(z[0] - ahead.position[0])
            total += 0.5 * (e * e / s + math.log(2 * math.pi * s))
            state = tracker.step(state, z, t)
    assert found.rows[0].held_out == pytest.approx(total / (5 * 58), rel=1e-9)
    with pytest.raises(ValueError, match="criterion: fixed does not keep the variance of its"):
        ft.tune(bare, "fixed", criterion="likelihood")
    with pytest.raises(ValueError, match="criterion: unknown 'mse'; one of rms, likelihood"):
        ft.tune(bare, "fixed", criterion="mse")


@pytest.mark.untraced
def test_what_runs_often_is_compiled_for_all_that_differ_in_numbers(monkeypatch):
    data = random_walk(3, 90, 0.5)
    family = specification("fixed", None, 1.0)
    run = Trials(data, tuner.make_folds(data, 3, 0), RmsError(), compiled=True)
    trials, compiled = [(0.5, 0.2), (0.4, 0.1)], []

    def sharing(tracker, n_axes, code):
        compiled.append(tracker)
        return sharing_code(tracker, n_axes, code)

    monkeypatch.setattr(trial, "sharing_code", sharing)
    monkeypatch.setattr(trial, "_COORDINATES", 3 * data.coordinates - 1)
    trial._forms.cache_clear()
    plain = run.sums(family, trials)
    assert compiled == []
    # The third of them.
    np.testing.assert_array_equal(run.sums(family, trials), plain)
    assert compiled == [family.tracker(numbers) for numbers in trials]
    # A rule table has a form for each order of its levels, and code of each takes memory.
    trial._forms.cache_clear()
    monkeypatch.setattr(trial, "_FORMS", 0)
    for _ in range(2):
        np.testing.assert_array_equal(run.sums(family, trials), plain)
    assert len(compiled) == 2
