"""Numbers at the edge of floating point: the right track, or an error; never a silent NaN."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fuzzytrack as ft
from fuzzytrack.lanes import runner as running
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.imm import InteractingPair
from fuzzytrack.trackers.runners import runner

NAMES = [
    "fixed:alpha=0.5:beta=0.2:gamma=0.05",
    "kalman-cv:sigma_v=0.5",
    "kalman-ca:sigma_v=1:acceleration_sigma=1",
    "stiffness-damping",
    "chan-style",
    "omega-schedule",
    "maneuver",
    "maneuver:level=5",
    "imm:quiet_sigma=0.2:maneuver_sigma=3",
    "imm-two:level=3",
    "imm-three",
]
TRACKERS = {name: make_tracker(name) for name in NAMES}
#: Those that are compiled here, too; with numbers of other tests, so that they share the code.
COMPILED = [NAMES[0], NAMES[1], NAMES[7], NAMES[8]]
T = np.arange(8.0)
PLAIN = np.array([0.0, 10.0, 19.0, 31.0, 40.0, 52.0, 60.0, 71.0])


def track(tracker, z, sigma, t=T, **options):
    """The result, or None where numbers are refused in one line; anything else is an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return tracker.run(t, z, sigma, **options)
        except ValueError as error:
            message = str(error)
    assert "\n" not in message
    assert message.startswith(("z:", "sigma", "t:"))
    return None


def finite(result, z):
    """Whether all is a number after the first plot."""
    seen = np.maximum.accumulate(~np.isnan(z))
    return all(
        np.isfinite(getattr(result, name)[seen]).all() for name in ("filtered", "velocity")
    ) and bool(np.isfinite(result.predicted[2:]).all())


EXTREMES = st.sampled_from(
    [0.0, 1.0, -1.0, 5e-324, 1e-300, 1e-160, 1e12, 1e100, -1e150, 1e155, 1e300, -1e300, 1.7e308]
)


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from(NAMES),
    st.lists(EXTREMES, min_size=8, max_size=8),
    st.sampled_from([1e-320, 1e-170, 1e-149, 1e-20, 1.0, 1e20, 1e149, 1e160]),
    st.sampled_from([1e-9, 1.0, 1e9]),
)
def test_plots_of_any_size_are_followed_or_refused(name, plots, sigma, step):
    z = np.array(plots)
    result = track(TRACKERS[name], z, sigma, T * step)
    assert result is None or finite(result, z)


# ---------------------------------------------------------------- interacting models

WILD = [
    [0.0, 10.0, 20.0, 1e300, 40.0, 50.0, 60.0, 70.0],
    [0.0, 10.0, 20.0, 1e300, -1e300, 1e300, 60.0, 70.0],
    [1e300, 1e300, 1e300, 1e300, 1e300, 1e300, 1e300, 1e300],
    [0.0, 1e160, -1e160, 3.0, 40.0, 50.0, 60.0, 70.0],
    [0.0, 10.0, 20.0, 1e155, 40.0, 50.0, np.nan, 70.0],
]
SURE = "imm:quiet_sigma=0.1:maneuver_sigma=1:maneuver_start=0"


@pytest.mark.parametrize("sigma", [1e-149, 1e-9, 1.0, 1e9])
@pytest.mark.parametrize("name", [*NAMES[8:], SURE])
@pytest.mark.parametrize("z", WILD)
def test_interacting_models_survive_any_plot(name, z, sigma):
    tracker, z = make_tracker(name), np.array(z)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = tracker.run(T, z, sigma)
    assert finite(result, z)
    ask = getattr(tracker, "probabilities", None) or tracker.maneuver_probability
    chances = ask(result.state)
    assert ((chances >= 0) & (chances <= 1)).all()
    if chances.ndim:
        assert chances.sum() == pytest.approx(1, abs=1e-5)
    predicted = tracker.predict(result.state, 9.0)
    assert np.isfinite(predicted.position_variance).all()


def test_a_pair_recovers_from_a_wild_plot():
    tracker = InteractingPair(0.1, 1.0, sigma_w=1.0)
    t = np.arange(60.0)
    z = 10.0 * t
    z[20] = 1e200
    z[21:] = 10.0 * t[21:]
    last = tracker.run(t, z)
    # Velocity is thrown far off and comes back by a constant factor each plot.
    assert np.isfinite(last.filtered).all()
    assert abs(last.filtered[-1] - z[-1]) < 1e180


def test_single_precision_survives_too():
    z = np.array([0.0, 10.0, 20.0, 1e15, 40.0, 50.0, 60.0, 70.0])
    result = make_tracker("imm-two:level=3").run(T, z, 1.0, dtype=np.float32)
    assert finite(result, z)


# ---------------------------------------------------------------- plain and compiled


@pytest.fixture
def both(monkeypatch):
    """A run in plain Python, and a compiled one."""

    def run(tracker, *args, **options):
        results = []
        for limit in (10**9, -1):
            monkeypatch.setattr(running, "COMPILE_ABOVE", limit)
            results.append(track(tracker, *args, **options))
        return results

    return run


SIGMAS = [1e-320, 1e-200, 1e-162, 0.9e-150, 1.1e-150, 1.0, 0.9e150, 1.1e150, 1e300]


@pytest.mark.parametrize("name", COMPILED)
def test_plain_and_compiled_agree_at_any_sigma(both, name):
    for sigma in SIGMAS:
        plain, compiled = both(TRACKERS[name], PLAIN, sigma)
        assert (plain is None) == (compiled is None)
        assert 1e-150 <= sigma <= 1e150 or plain is None
        if plain is not None:
            np.testing.assert_array_equal(plain.filtered, compiled.filtered)


@pytest.mark.parametrize("name", COMPILED)
def test_plain_and_compiled_agree_at_any_plot(both, name):
    for z in [*WILD, [1.7e308, -1.7e308] * 4, [0.0, 1.0, 1e308, 0, 1e308, -1e308, 0, 1]]:
        plain, compiled = both(TRACKERS[name], np.array(z), 1.0)
        assert (plain is None) == (compiled is None)
        if plain is not None:
            np.testing.assert_array_equal(plain.filtered, compiled.filtered)


def test_a_compiled_step_refuses_what_a_run_refuses():
    tracker = make_tracker(NAMES[0])
    tracker.compile()
    assert runner(tracker, 1).native
    state = tracker.run(T[:3], [-1.7e308, -1.7e308, -1.7e308]).state
    with pytest.raises(ft.DataError, match="z: track cannot be followed with floating-point"):
        tracker.step(state, 1.7e308, 3.0)
    with pytest.raises(ValueError, match="sigma must be positive and finite, from 1e-150 to"):
        tracker.step(state, 0.0, 3.0, 1e-170)
    assert tracker.step(state, np.nan, 3.0).position == -1.7e308


def test_the_error_names_sigma_and_its_place():
    tracker = TRACKERS["kalman-cv:sigma_v=0.5"]
    with pytest.raises(ValueError, match=r"since it is squared, .* at index \(2,\) it is 1e-170"):
        tracker.run(T[:3], PLAIN[:3], [1.0, 1.0, 1e-170])
    # Of a missed plot it may be anything.
    missed = [0.0, 10.0, np.nan]
    assert tracker.run(T[:3], missed, [1.0, 1.0, 1e-170]).filtered[2] == 20
    with pytest.raises(ValueError, match="from 1e-18 to 1e\\+18 since"):
        tracker.run(T[:3], PLAIN[:3], 1e-25, dtype=np.float32)


@pytest.mark.parametrize("value", [1e-151, 1e151, 1e300, 5e-324])
@pytest.mark.parametrize(
    "name",
    [
        "maneuver:level={}",
        "imm-two:level={}",
        "kalman-cv:sigma_v=1:sigma_w={}",
        "kalman-cv:sigma_v={}",
        "imm:quiet_sigma=0.1:maneuver_sigma={}",
        "innovation:sigma_d={}",
        "fixed:alpha=0.5:beta=0.2:covariance={}",
    ],
)
def test_parameters_that_are_squared_have_limits(name, value):
    with pytest.raises(ValueError, match="from 1e-150 to 1e\\+150, since it is squared"):
        make_tracker(name.format(value))


def test_the_error_names_the_track():
    z = np.tile(PLAIN[:, None, None, None], (1, 2, 3, 2))
    z[:, 1, 2, 0] = [1.7e308, -1.7e308] * 4
    with pytest.raises(ft.DataError, match=r"z: track \(1, 2\) cannot be followed .*FixedGains"):
        TRACKERS[NAMES[0]].run(T, z)
    with pytest.raises(ft.DataError, match="z: track 1 cannot be followed"):
        TRACKERS["stiffness-damping"].run(T, z[:, 1, 1:])


# ---------------------------------------------------------------- masks


@pytest.mark.parametrize("name", [NAMES[0], "kalman-cv:sigma_v=0.5"])
def test_masks_count_in_times_and_sigmas(name):
    tracker = TRACKERS[name]
    mask = [False, False, True, False]
    hidden = np.ma.array(PLAIN[:4], mask=mask)
    sigma = np.ma.array([1.0, 1.0, 2.0, 1.0], mask=mask)
    times = np.ma.array(T[:4], mask=mask)
    with pytest.raises(ft.DataError, match="t: time at index 2 is masked; leave such rows out"):
        tracker.run(times, PLAIN[:4], 1.0)
    with pytest.raises(ValueError, match=r"sigma must be .* at index \(2,\) it is masked"):
        tracker.run(T[:4], PLAIN[:4], sigma)
    expected = tracker.run(T[:4], [0.0, 10.0, np.nan, 31.0], 1.0).filtered
    np.testing.assert_array_equal(tracker.run(T[:4], hidden, sigma).filtered, expected)
    whole = np.ma.array(T[:4]), np.ma.array(PLAIN[:4]), np.ma.array([1.0] * 4)
    np.testing.assert_array_equal(
        tracker.run(*whole).filtered, tracker.run(T[:4], PLAIN[:4], 1.0).filtered
    )


def test_masks_count_in_single_steps():
    tracker = TRACKERS["kalman-cv:sigma_v=0.5"]
    state = tracker.start([0.0, 0.0], 0.0, 1.0)
    with pytest.raises(ft.DataError, match="t: time at index 0 is masked"):
        tracker.step(state, [1.0, 1.0], np.ma.masked, 1.0)
    masked = np.ma.array([1.0, 1.0], mask=[False, True])
    with pytest.raises(ValueError, match=r"at index \(0, 1\) it is masked"):
        tracker.step(state, [1.0, 1.0], 1.0, masked)
    assert np.isfinite(tracker.step(state, masked, 1.0, masked).position).all()
    batch = tracker.start(np.zeros((2, 1)), np.zeros(2), 1.0)
    with pytest.raises(ft.DataError, match=r"t: time at index \(0, 1\) is masked"):
        tracker.step(batch, np.ones((2, 1)), np.ma.array([1.0, 2.0], mask=[False, True]), 1.0)


@given(
    st.lists(st.booleans(), min_size=8, max_size=8), st.lists(st.booleans(), min_size=8, max_size=8)
)
def test_no_number_under_a_mask_is_used(no_plot, no_sigma):
    tracker = TRACKERS["kalman-cv:sigma_v=0.5"]
    sigma = np.ma.array(np.full(8, 7.0), mask=no_sigma)
    z = np.ma.array(PLAIN, mask=no_plot)
    if (np.array(no_sigma) & ~np.array(no_plot)).any():
        with pytest.raises(ValueError, match="it is masked"):
            tracker.run(T, z, sigma)
    else:
        expected = tracker.run(T, np.where(no_plot, np.nan, PLAIN), 7.0)
        np.testing.assert_array_equal(tracker.run(T, z, sigma).filtered, expected.filtered)
