"""The benchmark suite runs, at sizes of no meaning, and what it compares is the same."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

import fuzzytrack as ft

ROOT = Path(__file__).resolve().parents[1]

# What peers are warned of is not ours to mend.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


@pytest.fixture(scope="module", autouse=True)
def the_suite_can_be_imported():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT)
        yield


@pytest.fixture(scope="module")
def figures(the_suite_can_be_imported):
    from benchmarks.run import measure, plain
    from benchmarks.scale import TINY

    return json.loads(json.dumps(plain(measure(TINY))))


def test_no_job_fails(figures):
    assert [row["why"] for row in figures["rows"] if row["broken"]] == []


def test_every_row_is_measured_or_says_why_not(figures):
    for row in figures["rows"]:
        assert row["section"]
        assert row["what"]
        if row["why"]:
            assert row["value"] is None
            continue
        assert row["value"] >= 0.0
        if row["against"]:
            assert row["base"] > 0.0
            assert 0.0 < row["ratio"]["low"] <= row["ratio"]["median"] <= row["ratio"]["high"]
        assert (row["reached"] is None) == (row["target"] is None)


def test_the_machine_is_described(figures):
    machine = figures["machine"]
    assert machine["cores"] >= 1
    assert machine["processor"]
    assert machine["versions"]["fuzzytrack"] == ft.__version__
    assert figures["bandwidth"]["1"]["best"] >= figures["bandwidth"]["1"]["median"] > 0.0


def test_growth_is_a_curve(figures):
    from benchmarks.scale import TINY

    curve = figures["curves"]["tracks"]
    assert [(point["tracks"], point["steps"]) for point in curve] == list(TINY.growth)
    assert all(point["fixed gains"] > 0.0 for point in curve)


def jobs(tracks=600, steps=25):
    """Irregular times, missed plots from the first on, more tracks than a block has."""
    random = np.random.default_rng(5)
    times = np.cumsum(random.uniform(0.5, 2.0, steps))
    plots = np.cumsum(random.normal(0.0, 10.0, (steps, tracks)), axis=0)
    plots[random.random(plots.shape) < 0.2] = np.nan
    return times, plots


def test_the_fixed_loop_is_the_tracker():
    from benchmarks import handwritten

    times, plots = jobs()
    ours = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2)).run(times, plots[..., None]).predicted
    theirs = handwritten.fixed(times, plots, 0.5, 0.2)
    np.testing.assert_allclose(theirs, ours[..., 0], rtol=0, atol=1e-9)


def test_the_fuzzy_loop_is_the_tracker():
    from benchmarks import handwritten

    times, plots = jobs(tracks=520, steps=15)
    rules = ft.load_rulebase("stiffness-damping")
    ours = ft.AlphaBetaTracker(ft.FuzzyScheduler(rules)).run(times, plots[..., None]).predicted
    np.testing.assert_allclose(handwritten.fuzzy(times, plots), ours[..., 0], rtol=0, atol=1e-9)


def test_the_bare_loop_is_the_recursion():
    from benchmarks import handwritten

    times = np.array([0.0, 1.0, 3.0])
    predicted = handwritten.bare(times, np.array([[4.0], [6.0], [1.0]]), 0.5, 0.2)
    # From 0 at time -1: 4 is half believed, and gives 0.8 a second.
    np.testing.assert_allclose(predicted[:, 0], [0.0, 2.8, 2.8 + 1.6 + 2 * (0.8 + 0.64)])


def test_a_command_is_timed_in_a_new_process():
    from benchmarks import processes
    from benchmarks.scale import TINY

    (row,) = processes.small_file(dataclasses.replace(TINY, processes=1))
    assert row.value > 0.0


def test_a_missing_peer_gives_a_row(monkeypatch):
    from benchmarks import peers, report

    def gone():
        peers.need("no_such_module", "no-such-package")

    (row,) = report.collect("section", "what", gone)
    assert "no-such-package" in row.why
    assert not row.broken


def test_a_failing_job_gives_a_row_that_says_so():
    from benchmarks import report

    (row,) = report.collect("section", "what", lambda: 1 / 0)
    assert row.broken
    assert "ZeroDivisionError" in row.why


def test_a_target_is_held_against_the_ratio_and_else_the_value():
    from benchmarks.report import Row, Target
    from benchmarks.timing import Ratio

    row = Row("s", "w", value=5.0, target=Target(">=", 4.0))
    assert row.reached is True
    assert dataclasses.replace(row, ratio=Ratio(3.0, 2.0, 9.0)).reached is False
    assert dataclasses.replace(row, target=Target("<=", 4.0)).reached is False
    assert dataclasses.replace(row, target=None).reached is None


def test_ratios_are_taken_round_by_round():
    from benchmarks.timing import Timing, ratio

    # The machine is three times as slow in the second round.
    found = ratio(Timing((2.0, 6.0, 2.0)), Timing((1.0, 3.0, 1.0)))
    assert (found.low, found.median, found.high) == (2.0, 2.0, 2.0)


def test_pictures_and_tables_are_written(figures, tmp_path):
    from benchmarks import pictures
    from benchmarks.report import Row, markdown

    for path in pictures.draw(figures, tmp_path):
        assert path.stat().st_size > 5_000
    assert (tmp_path / "speed-tracks.png").exists()
    text = markdown([Row("Section", "one", 2.0, "s"), Row("Section", "two", why="no peer")])
    assert "| one | 2 s |" in text
    assert "not measured: no peer" in text
