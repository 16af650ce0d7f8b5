"""Trackers written in C and compiled give what the library gives."""

import importlib
import math
from pathlib import Path

import numpy as np
import pytest
from test_conformance import SCHEDULERS, TRACKERS

import fuzzytrack as ft
from fuzzytrack.fuzzy.loading import rulebase_path
from fuzzytrack.interop.c99.build import CompilerError, find_compiler
from fuzzytrack.interop.c99.compiled_filter import compiled_c
from fuzzytrack.interop.c99.compiled_lanes import FAST, CompiledLanes

try:
    find_compiler()
except CompilerError as error:
    pytest.skip(str(error), allow_module_level=True)

pytestmark = pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning")

STRICT = (
    "-O1", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-Wshadow",
    "-Werror",
)  # fmt: skip
EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "plugin"
VECTORS = ("filtered", "velocity", "acceleration", "predicted", "innovation")
#: Every tracker in another mode, and on another number of axes, to keep the number of builds small.
MODES = [
    {}, {"missed": "step"}, {"start": "one-point"}, {"covariance": 3.0},
]  # fmt: skip


def tracker_of(name, k):
    if name in TRACKERS:
        return TRACKERS[name]
    mode = MODES[k % len(MODES)]
    own = SCHEDULERS[name].own_gains
    return ft.AlphaBetaTracker(SCHEDULERS[name], **({} if own and "covariance" in mode else mode))


def plots(axes, count, coupled, seed=5, noise=10.0):
    """A turning target at irregular times, a fifth of the plots missing."""
    random = np.random.default_rng(seed)
    t = np.cumsum(random.uniform(0.3, 3.0, count))
    angle = np.cumsum(random.normal(0.0, 0.01, count)) + 0.02 * t
    z = 2e3 * np.stack([np.cos(angle + k) for k in range(axes)], axis=-1)
    sigma = random.uniform(0.5 * noise, 1.5 * noise, z.shape)
    z = z + random.normal(size=z.shape) * sigma
    z[random.random(count) < 0.2] = np.nan
    if not coupled:
        z[random.random(z.shape) < 0.1] = np.nan
    return t, z, sigma


def largest_difference(run, reference):
    pairs = [(getattr(run, name), getattr(reference, name)) for name in VECTORS]
    found = 0.0
    for mine, theirs in pairs:
        np.testing.assert_array_equal(np.isnan(mine), np.isnan(theirs))
        found = max(found, float(np.nanmax(np.abs(mine - theirs), initial=0.0)))
    gains = reference.gains
    for name in ("alpha", "beta", "gamma"):
        mine, theirs = np.broadcast_arrays(getattr(run, name), getattr(gains, name))
        np.testing.assert_array_equal(np.isnan(mine), np.isnan(theirs))
        found = max(found, float(np.nanmax(np.abs(mine - theirs), initial=0.0)))
    return found


@pytest.mark.untraced
@pytest.mark.parametrize(("k", "name"), list(enumerate([*SCHEDULERS, *TRACKERS])))
def test_a_tracker_gives_the_same_numbers(k, name):
    tracker, axes = tracker_of(name, k), 1 + k % 3
    t, z, sigma = plots(axes, 500, tracker.coupled)
    compiled = compiled_c(tracker, axes=axes, flags=STRICT)
    difference = largest_difference(compiled.run(t, z, sigma), tracker.run(t, z, sigma))
    # A bank of trackers needs an exponential function, whose last bit differs.
    assert difference <= (1e-9 if name.startswith("bank") else 0.0)
    # The struct has the size that is stated.
    assert compiled.start().shape[1] == compiled.translation.state_bytes


@pytest.mark.untraced
def test_ten_thousand_plots_stay_the_same():
    tracker = ft.AlphaBetaTracker("stiffness-damping")
    t, z, sigma = plots(2, 10_000, False)
    run = compiled_c(tracker, axes=2, flags=("-O0",)).run(t, z, sigma)
    assert largest_difference(run, tracker.run(t, z, sigma)) == 0.0


@pytest.fixture(scope="module")
def maneuver():
    return compiled_c("maneuver", axes=2, flags=("-O0",))


def test_streaming_and_batches_agree(maneuver):
    tracker = ft.AlphaBetaTracker("maneuver")
    given = [plots(2, 60, True, seed) for seed in range(5)]
    t = np.stack([g[0] for g in given], axis=1)
    z, sigma = (np.stack([g[k] for g in given], axis=1) for k in (1, 2))
    batch = maneuver.run(t, z, sigma)
    states = maneuver.start(5)
    for k in range(len(t)):
        step = maneuver.run(t[k : k + 1], z[k : k + 1], sigma[k : k + 1], states=states)
        np.testing.assert_array_equal(step.filtered[0], batch.filtered[k])
        np.testing.assert_array_equal(step.alpha[0], batch.alpha[k])
    np.testing.assert_array_equal(batch.filtered, tracker.run(t, z, sigma).filtered)


@pytest.mark.parametrize(
    ("plot", "time", "sigma", "words"),
    [
        ((math.inf, 0.0), 2.0, 1.0, "^z: at index 0: a coordinate is infinite"),
        ((0.0, -math.inf), 2.0, 1.0, "^z: at index 0: a coordinate is infinite"),
        ((0.0, 0.0), 1.0, 1.0, "^t: at index 0: .*not later"),
        ((0.0, 0.0), math.nan, 1.0, "^t: .*not finite"),
        ((0.0, 0.0), math.inf, 1.0, "^t: .*not finite"),
        ((0.0, 0.0), 2.0, math.nan, "^sigma: .*standard deviation"),
        ((0.0, 0.0), 2.0, 0.0, "^sigma: .*standard deviation"),
        ((0.0, 0.0), 2.0, math.inf, "^sigma: .*standard deviation"),
    ],
)
def test_a_step_refuses_what_the_library_refuses(maneuver, plot, time, sigma, words):
    states = maneuver.start()
    maneuver.run([1.0], [[0.0, 1.0]], 1.0, states=states)
    before = states.copy()
    with pytest.raises(ft.DataError, match=words):
        maneuver.run([time], [plot], sigma, states=states)
    with pytest.raises(ValueError, match=r"infinite|increas|finite|sigma|later"):
        ft.AlphaBetaTracker("maneuver").run([1.0, time], [(0.0, 1.0), plot], [[1.0], [sigma]])
    # Nothing was done.
    np.testing.assert_array_equal(states, before)


def curved_schedule():
    """A rule base whose sets need numbers beyond the range of floats."""
    text = rulebase_path("omega-schedule").read_text()
    return ft.loads_rulebase(
        text.replace(
            "{trimf: [-0.6866666666666666, 0, 0.6866666666666666]}", "{gbellmf: [0.5, 3, 0]}"
        )
    )


@pytest.mark.untraced
@pytest.mark.parametrize("of", ["imm", "gbellmf"])
def test_floats_around_a_step_in_double_err_by_a_rounding(of):
    tracker = (
        TRACKERS["imm"]
        if of == "imm"
        else ft.AlphaBetaTracker(ft.FuzzyScheduler(curved_schedule()))
    )
    t, z, sigma = plots(2, 300, tracker.coupled)
    z, sigma = z.astype(np.float32), sigma.astype(np.float32)
    compiled = compiled_c(tracker, axes=2, number="float", flags=(*STRICT, "-Wdouble-promotion"))
    assert (compiled.translation.number, compiled.translation.inside) == ("float", "double")
    assert compiled.start().shape[1] == compiled.translation.state_bytes
    found, exact = compiled.run(t, z, sigma), tracker.run(t, z.astype(float), sigma.astype(float))
    for name in VECTORS:
        np.testing.assert_array_max_ulp(
            getattr(found, name), getattr(exact, name).astype(np.float32), 0
        )


def test_a_track_beyond_all_numbers_is_said():
    tracker = compiled_c("fixed:alpha=1:beta=1", flags=("-O0",))
    with pytest.raises(ft.DataError, match="start it again"):
        tracker.run([0.0, 1.0, 2.0], [1e308, -1e308, 1e308])
    # Finite in double, where the step calculates, but not among the results.
    tracker = compiled_c(TRACKERS["bank, best"], number="float", flags=("-O0",))
    with pytest.raises(ft.DataError, match="start it again"):
        tracker.run([0.0, 1.0, 2.0], [3e38, -3e38, 3e38], 1.0)


def test_misses_need_no_standard_deviation_and_tracks_may_have_no_plot(maneuver):
    run = maneuver.run([0.0, 1.0], np.full((2, 2), np.nan), np.nan)
    assert np.isnan(run.filtered).all()
    assert maneuver.run([], np.empty((0, 2)), 1.0).filtered.shape == (0, 2)


def test_plug_ins_are_exported(monkeypatch):
    monkeypatch.syspath_prepend(EXAMPLES)
    plugin = importlib.import_module("fuzzytrack_two_speed")
    for tracker in (ft.AlphaBetaTracker(plugin.TwoSpeed()), plugin.Averaged()):
        t, z, sigma = plots(2, 200, False)
        run = compiled_c(tracker, axes=2, flags=STRICT).run(t, z, sigma)
        assert largest_difference(run, tracker.run(t, z, sigma)) == 0.0


def test_wrong_shapes_are_refused(maneuver):
    with pytest.raises(ValueError, match="does not fit a filter of 2 axes"):
        maneuver.run([0.0], [[1.0, 2.0, 3.0]], 1.0)
    with pytest.raises(ValueError, match="t: shape"):
        maneuver.run([0.0, 1.0], [[1.0, 2.0]], 1.0)
    with pytest.raises(ValueError, match="states: shape"):
        maneuver.run([0.0], [[1.0, 2.0]], 1.0, states=maneuver.start(2))
    with pytest.raises(ValueError, match="axes must be a whole number"):
        compiled_c("maneuver", axes=0)
    assert "tracker" in repr(maneuver)
    assert "filtered" in repr(maneuver.run([0.0], [[1.0, 2.0]], 1.0))


@pytest.mark.parametrize(
    "tracker",
    [
        ft.AlphaBetaTracker("stiffness-damping"),
        ft.AlphaBetaTracker("maneuver", missed="step"),
        TRACKERS["imm-two"],
    ],
    ids=lambda tracker: tracker.name,
)
def test_lanes_side_by_side_give_the_same_bits(tracker):
    given = [plots(2, 40, True, seed) for seed in range(300)]
    t = given[0][0]
    z, sigma = (np.stack([g[k] for g in given], axis=1) for k in (1, 2))
    lanes = CompiledLanes(tracker, axes=2, flags=("-O1", *FAST[2:]))
    np.testing.assert_array_equal(lanes(t, z, sigma), tracker.run(t, z, sigma).predicted)
