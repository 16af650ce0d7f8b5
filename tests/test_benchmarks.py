"""The benchmark suite runs, at sizes of no meaning, and what it compares is the same."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

import fuzzytrack as ft

ROOT = Path(__file__).resolve().parents[1]

pytestmark = [
    # What peers are warned of is not ours to mend.
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]


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


def jobs(tracks=600, steps=25, axes=1):
    """Irregular times, missed plots from the first on, more tracks than a block has.

    At some steps no plot is missed, so that all tracks have the same time step.
    """
    random = np.random.default_rng(5)
    times = np.cumsum(random.uniform(0.5, 2.0, steps))
    plots = np.cumsum(random.normal(0.0, 10.0, (steps, tracks, axes)), axis=0)
    missed = random.random((steps, tracks)) < 0.2
    missed[[4, 5, 8, 9, 10, -1]] = False
    plots[missed] = np.nan
    return times, plots


def test_the_fixed_loop_is_the_tracker():
    from benchmarks import handwritten

    times, plots = jobs()
    ours = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2)).run(times, plots).predicted
    theirs = handwritten.fixed(times, plots[..., 0], 0.5, 0.2)
    np.testing.assert_allclose(theirs, ours[..., 0], rtol=0, atol=1e-9)


def test_the_fuzzy_loop_is_the_tracker():
    from benchmarks import handwritten

    times, plots = jobs(tracks=520, steps=15)
    rules = ft.load_rulebase("stiffness-damping")
    ours = ft.AlphaBetaTracker(ft.FuzzyScheduler(rules)).run(times, plots).predicted
    theirs = handwritten.fuzzy(times, plots[..., 0])
    np.testing.assert_allclose(theirs, ours[..., 0], rtol=0, atol=1e-9)


def test_the_maneuver_loop_is_the_tracker():
    from benchmarks import handwritten_maneuver

    times, plots = jobs(tracks=350, axes=2)
    # Some tracks turn, so that all rules fire.
    plots[12:, ::3, 1] += 60.0 * (times[12:, None] - times[12])
    sigmas = np.random.default_rng(6).uniform(2.0, 30.0, 350)
    ours = ft.AlphaBetaTracker(ft.FuzzyScheduler("maneuver", level=3.0))
    theirs = handwritten_maneuver.maneuver(times, plots, sigmas, 3.0)
    expected = ours.run(times, plots, sigmas[:, None]).predicted
    np.testing.assert_allclose(theirs, expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", ["fixed", "bare", "vectorized"])
def test_loops_write_into_existing_arrays(name):
    from benchmarks import handwritten

    times, plots = jobs(tracks=5, steps=12)
    given = np.nan_to_num(plots) if name == "vectorized" else np.nan_to_num(plots[..., 0])
    out = np.full_like(given, 77.0)
    work = getattr(handwritten, name)
    assert work(times, given, 0.5, 0.2, out) is out
    np.testing.assert_array_equal(out, work(times, given, 0.5, 0.2))


def test_the_bare_loop_is_the_recursion():
    from benchmarks import handwritten

    times = np.array([0.0, 1.0, 3.0])
    predicted = handwritten.bare(times, np.array([[4.0], [6.0], [1.0]]), 0.5, 0.2)
    # From 0 at time -1: 4 is half believed, and gives 0.8 a second.
    np.testing.assert_allclose(predicted[:, 0], [0.0, 2.8, 2.8 + 1.6 + 2 * (0.8 + 0.64)])


@pytest.fixture
def small():
    """A little of a full run, in one block and a bit."""
    from benchmarks.scale import TINY

    return dataclasses.replace(TINY, name="full", tracks=250, steps=8, compiles=True)


def test_a_tracker_is_measured_in_single_precision(small):
    from benchmarks import batch, work

    row = batch.single(small, "fixed gains", work.fixed_tracker())
    assert row.base > 0.0
    # Rounded to 7 digits, so not the same, but near.
    apart = float(row.note.partition("differ by ")[2].split()[0])
    assert 0.0 < apart < 1e-3


def test_the_parts_of_a_batch_are_the_batch(small):
    from benchmarks import profile, work

    tracker = work.fixed_tracker()
    times, plots = work.times_and_plots(small.tracks, small.steps, missed=0.1)
    result = np.zeros(plots.size)
    loop = profile._loop(tracker, times, plots, result)
    for _ in range(2):
        loop()
        np.testing.assert_array_equal(
            result.reshape(plots.shape), work.predictions(tracker, times, plots)
        )
    rows = profile.parts(small, "fixed gains", tracker)
    assert [row.value > 0.0 for row in rows] == [True] * 6
    assert [row.base for row in rows] == [None] + [rows[0].value] * 5


def test_the_steady_step_alone_tracks():
    from benchmarks import profile, work
    from fuzzytrack.lanes.layout import BLOCK, aligned
    from fuzzytrack.trackers.runners import runner

    core = runner(work.fixed_tracker(), 1)
    buffer, predicted = aligned(core.rows.total * BLOCK), aligned(BLOCK)
    steady = core.steady_code(False, True).address
    profile._go_round(steady, buffer, np.full(profile.ROUND * BLOCK, 8.0), predicted, 1)
    # Position and velocity from 0 toward a plot at 8 that stays, one second a step.
    x = v = 0.0
    for _ in range(profile.ROUND):
        before = x + v
        x, v = before + work.ALPHA * (8.0 - before), v + work.BETA * (8.0 - before)
    np.testing.assert_allclose(predicted, before)


def test_the_work_of_the_machine_is_done_by_all_threads():
    from benchmarks import machine

    whole = machine.Arithmetic(6)
    shared = machine.Arithmetic(6, 2)
    whole()
    shared()
    assert [rounds for _, rounds in whole.parts + shared.parts] == [6, 3, 3]
    once = machine.Arithmetic(3)
    once()
    for numbers, _ in shared.parts:
        np.testing.assert_array_equal(numbers, once.parts[0][0])
    copy = machine.Copy(5, 2)
    for target, _ in copy.parts:
        target[:] = 0.0
    copy()
    assert [len(target) for target, _ in copy.parts] == [3, 2]
    assert all((target == 1.0).all() for target, _ in copy.parts)


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
