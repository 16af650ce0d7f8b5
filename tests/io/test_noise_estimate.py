"""The noise of plots, estimated without their truth."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from fuzzytrack import DataError
from fuzzytrack.io.noise_estimate import FEWEST, NoiseEstimate, estimate_noise
from fuzzytrack.tuning import VARIANTS
from fuzzytrack.tuning.scored_plots import scored_plots

SEEDS = st.integers(0, 10_000)


def plots_of(seed, n=120, n_tracks=3, n_axes=2, sigma=1.0):
    """Tracks of constant acceleration at irregular times, their rows in any order of tracks."""
    rng = np.random.default_rng(seed)
    tracks = rng.integers(0, n_tracks, n)
    t = np.cumsum(rng.uniform(0.2, 2.0, n))
    start, speed, acceleration = rng.normal(size=(3, n_tracks, n_axes)) * [[[100.0]], [[10]], [[1]]]
    truth = start[tracks] + (speed[tracks] + acceleration[tracks] * t[:, None] / 2) * t[:, None]
    return t, truth + sigma * rng.normal(size=(n, n_axes)), tracks


def of_sets(plots, z=None):
    z = plots.z if z is None else z
    scans, tracks, n_axes = z.shape
    time = np.broadcast_to(plots.time.reshape(scans, -1), (scans, tracks))
    whose = np.broadcast_to(np.arange(tracks), (scans, tracks))
    return estimate_noise(time.ravel(), z.reshape(-1, n_axes), whose.ravel())


# -------------------------------------------------------------------- right


@pytest.mark.parametrize("kind", ["constant T", "jitter"])
@pytest.mark.parametrize("name", ["report", "mixed", "strong"])
def test_sets_of_maneuvering_targets(name, kind):
    plots = scored_plots(name, VARIANTS[kind], 100, 3)
    found = of_sets(plots)
    assert found.pooled == pytest.approx(1, abs=0.06)
    assert found.sigma == pytest.approx(1, abs=0.08)
    assert not found.axes_differ
    assert not found.rounded.any()


@pytest.mark.parametrize("name", ["report", "mixed", "strong"])
def test_missed_plots_and_spikes(name):
    plots, rng = scored_plots(name, VARIANTS["jitter"], 100, 4), np.random.default_rng(4)
    z = plots.z.copy()
    z[rng.random(z.shape[:2]) < 0.2] = math.nan
    z[rng.random(z.shape[:2]) < 0.02] += 50
    assert of_sets(plots, z).pooled == pytest.approx(1, abs=0.1)


def test_the_standard_error_is_the_spread_of_estimates():
    for n, n_tracks in ((40, 1), (400, 1), (400, 20)):
        found = [estimate_noise(*plots_of(seed, n, n_tracks)) for seed in range(150)]
        sigma = np.array([each.pooled for each in found])
        told = math.sqrt(np.mean([each.pooled_error**2 for each in found]))
        assert sigma.std() == pytest.approx(told, rel=0.25)
        assert sigma.mean() == pytest.approx(1, abs=0.04)


def test_the_standard_error_knows_that_tracks_differ():
    """Noise of 1 and of 2, each in half of the tracks: more error than with white noise."""
    found = []
    for seed in range(100):
        t, z, tracks = plots_of(seed, 600, 20, 1)
        factor = np.random.default_rng(seed).choice([1.0, 2.0], 20)
        truth = plots_of(seed, 600, 20, 1, sigma=0.0)[1]
        found.append(estimate_noise(t, truth + (z - truth) * factor[tracks, None], tracks))
    sigma = np.array([each.pooled for each in found])
    told = math.sqrt(np.mean([each.pooled_error**2 for each in found]))
    assert told == pytest.approx(sigma.std(), rel=0.35)


# -------------------------------------------------------------------- properties


@given(seed=SEEDS, factor=st.floats(1e-6, 1e6), shift=st.floats(-1e3, 1e3))
@settings(max_examples=30)
def test_scale_and_shift(seed, factor, shift):
    t, z, tracks = plots_of(seed)
    found, scaled = estimate_noise(t, z, tracks), estimate_noise(t, factor * (z + shift), tracks)
    np.testing.assert_allclose(scaled.sigma, factor * found.sigma, rtol=1e-6)
    np.testing.assert_allclose(scaled.standard_error, factor * found.standard_error, rtol=1e-6)
    assert scaled.pooled == pytest.approx(factor * found.pooled, rel=1e-6)


@given(
    seed=SEEDS, unit=st.sampled_from([1e-9, 1e-3, 60.0, 1e9]), origin=st.integers(-(2**20), 2**20)
)
@settings(max_examples=30)
def test_unit_and_origin_of_time(seed, unit, origin):
    t, z, tracks = plots_of(seed)
    found = estimate_noise(t, z, tracks)
    other = estimate_noise(unit * (t + origin), z, tracks)
    np.testing.assert_allclose(other.sigma, found.sigma, rtol=1e-4)


@given(seed=SEEDS)
@settings(max_examples=30)
def test_order_of_tracks_is_irrelevant(seed):
    t, z, tracks = plots_of(seed, n_tracks=5)
    found = estimate_noise(t, z, tracks)
    grouped = np.argsort(np.array([3, 0, 4, 1, 2])[tracks], kind="stable")
    renamed = np.array([70, 10, 30, 50, 20])[tracks]
    for other in (
        estimate_noise(t[grouped], z[grouped], tracks[grouped]),
        estimate_noise(t, z, renamed),
    ):
        np.testing.assert_allclose(other.sigma, found.sigma, rtol=1e-9)
        assert other.differences == found.differences


@given(
    seed=SEEDS,
    motion=st.lists(st.floats(-1e4, 1e4), min_size=3, max_size=3),
    intervals=st.sampled_from(["regular", "jitter", "log-uniform"]),
)
@settings(max_examples=30)
def test_constant_velocity_and_acceleration_change_nothing(seed, motion, intervals):
    rng = np.random.default_rng(seed)
    steps = {
        "regular": np.ones(200),
        "jitter": rng.uniform(0.2, 1.8, 200),
        "log-uniform": 10 ** rng.uniform(-1, 0, 200),
    }[intervals]
    t, noise, one = np.cumsum(steps), rng.normal(size=(200, 1)), np.zeros(200, dtype=int)
    truth = np.polynomial.Polynomial(motion)(t)[:, None]
    still, moving = (estimate_noise(t, noise + at, one) for at in (0.0, truth))
    assert moving.pooled == pytest.approx(still.pooled, rel=1e-4)
    assert abs(moving.pooled - 1) < 5 * moving.pooled_error


# -------------------------------------------------------------------- axes


def test_axes_that_differ():
    t, z, tracks = plots_of(1, 400)
    found = estimate_noise(t, z * [1.0, 3.0], tracks)
    assert found.axes_differ
    assert found.sigma == pytest.approx([1, 3], rel=0.2)
    assert found.pooled == pytest.approx(math.sqrt((found.sigma**2).mean()))
    assert not estimate_noise(t, z * [1.0, 1.2], tracks).axes_differ
    # Few plots do not tell.
    assert not estimate_noise(t[:12], z[:12] * [1.0, 1.8], 0 * tracks[:12]).axes_differ


def test_axes_are_missed_apart():
    t, z, tracks = plots_of(2, 400)
    z[::3, 1] = math.nan
    found = estimate_noise(t, z, tracks)
    assert found.standard_error[1] > found.standard_error[0]
    alone = estimate_noise(t, z[:, :1], tracks)
    assert alone.sigma[0] == found.sigma[0]
    assert "pooled=" in repr(found)


# -------------------------------------------------------------------- faults of real data


def one_track(z, t=None):
    z = np.asarray(z, dtype=float)[:, None]
    return estimate_noise(np.arange(len(z)) if t is None else t, z, np.zeros(len(z), dtype=int))


@pytest.mark.parametrize("n", [0, 1, 3, 4, FEWEST + 2])
def test_too_few_plots(n):
    with pytest.raises(DataError, match=rf"axis 0 has .* {FEWEST} are needed. `si"):
        one_track(np.random.default_rng(1).normal(size=n))


def test_just_enough_plots():
    found = one_track(np.random.default_rng(1).normal(size=FEWEST + 3))
    assert isinstance(found, NoiseEstimate)
    assert 0.2 < found.pooled_error / found.pooled < 0.8


@pytest.mark.parametrize("z", [7 + 0.1 * np.arange(50), 5.0 * np.arange(50), np.arange(50.0) ** 2])
def test_plots_without_noise_are_named(z):
    with pytest.raises(DataError, match="axis 0 have no noise that could be estimated: more than"):
        one_track(z)


@pytest.mark.parametrize(
    "z", [np.full(50, 3.0), np.repeat(np.random.default_rng(1).normal(size=9), 9)]
)
def test_repeated_plots_are_named(z):
    with pytest.raises(DataError, match=r"\d+ % of those of axis 0 repeat the one before.*`sigma`"):
        one_track(z)


@given(seed=SEEDS, speed=st.floats(0, 20), log_step=st.floats(-1, 0.3))
@settings(max_examples=40)
def test_plots_on_a_grid(seed, speed, log_step):
    """Rounding to a step adds step²/12 to the variance, as long as noise decides on the step."""
    step = 10**log_step
    z = speed * np.arange(400) + np.random.default_rng(seed).normal(size=400)
    found = one_track(np.round(z / step) * step)
    assert found.pooled == pytest.approx(math.sqrt(1 + step**2 / 12), rel=0.3)


def test_noise_below_the_grid_is_that_of_rounding():
    rng = np.random.default_rng(3)
    slow = 0.02 * np.arange(2000) + 0.01 * rng.normal(size=2000)
    found = one_track(np.round(slow))
    assert found.rounded.all()
    assert found.pooled == pytest.approx(1 / math.sqrt(12))
    assert found.pooled_error > 0
    hundredths = one_track(np.round(slow) / 100)
    assert hundredths.pooled == pytest.approx(0.01 / math.sqrt(12))


def test_plots_at_almost_the_same_time_are_one():
    """Two receivers see the same pulse, 10 ms apart: the second tells nothing about the noise."""
    rng = np.random.default_rng(4)
    t = np.arange(600.0)
    z = 3 * t + rng.normal(size=600)
    again = np.sort(rng.choice(600, 150, replace=False))
    both = np.concatenate([t, t[again] + 0.01])
    order = np.argsort(both)
    plots = np.concatenate([z, z[again] + 0.03])[order]
    assert one_track(plots, both[order]).pooled == one_track(z).pooled
    equal = np.repeat(t, 2)
    assert one_track(np.repeat(z, 2), equal).pooled == one_track(z).pooled


def test_fill_values_and_infinite_plots():
    rng = np.random.default_rng(5)
    z = rng.normal(size=500)
    z[::50], z[3], z[4], z[5] = 9.97e36, math.inf, 1e308, -1.7e308
    assert one_track(z).pooled == pytest.approx(1, abs=0.15)


@given(seed=SEEDS, share=st.floats(0, 0.1), size=st.floats(20, 1e9))
@settings(max_examples=30)
def test_spikes_of_any_size(seed, share, size):
    rng = np.random.default_rng(seed)
    z = rng.normal(size=500)
    spikes = rng.random(500) < share
    assume(spikes.mean() < 0.12)
    z[spikes] += size
    assert one_track(z).pooled == pytest.approx(1, abs=0.35)


def test_shapes_that_do_not_fit():
    with pytest.raises(ValueError, match=r"plots: shape must be \(n, n_axes\), got \(3,\)"):
        estimate_noise(np.arange(3), np.arange(3), np.zeros(3, dtype=int))
    with pytest.raises(ValueError, match=r"tracks: shape \(2,\) does not fit"):
        estimate_noise(np.arange(3), np.zeros((3, 1)), np.zeros(2, dtype=int))


def test_motion_is_the_noise_of_what_flies_straight_and_more_of_what_turns():
    rng = np.random.default_rng(8)
    t, noise = np.arange(2000.0), rng.normal(size=(2000, 1))
    straight = estimate_noise(t, 30 * t[:, None] + noise, np.zeros(2000, dtype=int))
    np.testing.assert_allclose(straight.motion, 1, rtol=0.1)
    turning = 500 * np.sin(t[:, None] / 5) + noise
    found = estimate_noise(t, turning, np.zeros(2000, dtype=int))
    # Second differences of the sine, as large as nine in ten of them are.
    bend = 500 * 4 * np.sin(0.1) ** 2 / math.sqrt(6) * np.sin(0.45 * math.pi) / 1.645
    np.testing.assert_allclose(found.motion, bend, rtol=0.1)


def test_single_plots_that_are_far_off_are_no_motion():
    rng = np.random.default_rng(9)
    t, z = np.arange(1000.0), rng.normal(size=(1000, 1))
    z[::20] += 500 * rng.choice([-1, 1], size=(50, 1))
    found = estimate_noise(t, 30 * t[:, None] + z, np.zeros(1000, dtype=int))
    np.testing.assert_array_equal(found.motion, found.sigma)
