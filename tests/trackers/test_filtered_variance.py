import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker, FixedGains
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.covariance import track_covariance

WITH_VARIANCE = (
    "maneuver",
    "maneuver:axes=own",
    "kalman-cv:sigma_v=1:sigma_w=2",
    "kalman-cv:sigma_v=1:sigma_w=2:start=one-point",
    "imm:quiet_sigma=1:maneuver_sigma=10",
    "imm-two:level=10",
    "imm-three:level=10",
    "fixed:alpha=0.5:beta=0.2:covariance=1",
    "fixed:alpha=0.5:beta=0.2:covariance=1:missed=step",
    "fixed:alpha=0.5:beta=0.2:gamma=0.1:covariance=1",
)
KEEP = ("filtered", "position_variance")


def plots(n=60, seed=3):
    """Times and plots of two axes, of which some are missed in whole or in part."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(0.5, 1.5, n))
    z = np.stack([10 * t, 5 * t], axis=1) + rng.normal(0, 2, (n, 2))
    z[rng.random(n) < 0.2] = np.nan
    z[7, 0] = z[20, 1] = np.nan
    return t, z


@pytest.mark.parametrize("name", WITH_VARIANCE)
def test_it_is_that_of_a_prediction_over_no_time(name):
    """By the state after each step, which `predict` takes a nanosecond ahead."""
    tracker, (t, z) = make_tracker(name), plots()
    found = tracker.run(t, z, 2.0, keep=KEEP).position_variance
    state = tracker.start(z[0], t[0], 2.0)
    known = 0
    for k in range(1, len(t)):
        state = tracker.step(state, z[k], t[k], 2.0)
        predicted = tracker.predict(state, t[k] + 1e-9).position_variance
        np.testing.assert_allclose(found[k], predicted, rtol=1e-7)
        known += not np.isnan(found[k]).any()
    assert known >= len(t) - 3
    # After its first plot a track is where that is.
    assert found[0].tolist() == [4.0, 4.0]


@pytest.mark.parametrize("name", WITH_VARIANCE)
def test_pieces_have_the_same_bits(name):
    tracker, (t, z) = make_tracker(name), plots()
    whole = tracker.run(t, z, 2.0, keep=KEEP).position_variance
    first = tracker.run(t[:21], z[:21], 2.0, keep=KEEP)
    rest = tracker.run(t[21:], z[21:], 2.0, keep=KEEP, state=first.state)
    parts = np.concatenate([first.position_variance, rest.position_variance])
    np.testing.assert_array_equal(parts, whole)


@pytest.mark.parametrize("name", ["maneuver", "imm:quiet_sigma=1:maneuver_sigma=10"])
def test_compiled_runs_have_the_same_bits(name):
    """One tracker keeps the state itself over missed plots, the other has it restored."""
    tracker, (t, z) = make_tracker(name), plots()
    whole = tracker.run(t, z, 2.0, keep=KEEP).position_variance
    many = np.repeat(z[:, None], 2000, axis=1)
    compiled = tracker.run(t, many, 2.0, keep=KEEP).position_variance
    np.testing.assert_array_equal(compiled[:, [0, 1999]], np.stack([whole, whole], axis=1))


def test_it_is_that_of_the_recursion_for_any_gains():
    tracker = AlphaBetaTracker(FixedGains(0.5, 0.2), covariance=1.5)
    t, z = plots()
    z[7, 0] = z[20, 1] = 0.0
    sigma = np.linspace(1, 3, 60)[:, None]
    found = tracker.run(t, z, sigma, keep=KEEP).position_variance
    used = ~np.isnan(z)
    wanted = track_covariance(tracker.run(t, z, sigma), sigma, 1.5).filtered[..., 0, 0]
    np.testing.assert_allclose(found[used][2:], wanted[used][2:], rtol=1e-9)
    assert found[0].tolist() == [1.0, 1.0]


def test_a_kalman_filter_has_alpha_times_the_variance_of_the_plot():
    tracker, (t, z) = make_tracker("maneuver"), plots()
    result = tracker.run(t, z, 3.0, keep=(*KEEP, "gains"))
    used = ~np.isnan(result.gains.alpha)
    np.testing.assert_allclose(result.position_variance[used], 9 * result.gains.alpha[used])


def test_trackers_without_a_covariance_have_none():
    for name in ("stiffness-damping", "fixed:alpha=0.5:beta=0.2", "omega-schedule"):
        tracker, (t, z) = make_tracker(name), plots()
        assert np.isnan(tracker.run(t, z, 2.0, keep=KEEP).position_variance).all()
        assert not tracker.knows_variance(2)
    for name in WITH_VARIANCE:
        assert make_tracker(name).knows_variance(3)


@pytest.mark.parametrize("shape", [(0, 2), (1, 2), (4, 2), (4,), (4, 3, 2), (4, 0, 2)])
def test_shapes(shape):
    tracker = make_tracker("maneuver")
    result = tracker.run(np.arange(shape[0]), np.ones(shape), 1.0, keep=KEEP)
    assert result.position_variance.shape == shape
    assert result.kept == KEEP


def test_velocity_that_is_not_known_yet():
    tracker = make_tracker("kalman-cv:sigma_v=1:sigma_w=2")
    z = np.array([np.nan, 5.0, np.nan, 6.0, np.nan])
    found = tracker.run(np.arange(5.0), z, keep=KEEP).position_variance
    np.testing.assert_array_equal(np.isnan(found), [True, False, True, False, False])
    assert found[1] == 4.0


def test_it_is_kept_on_request_only():
    tracker, (t, z) = make_tracker("maneuver"), plots()
    result = tracker.run(t, z, 2.0)
    assert "position_variance" not in result.kept
    with pytest.raises(AttributeError, match="position_variance was not kept"):
        _ = result.position_variance
    with pytest.raises(ValueError, match="out: unknown 'position_variance'"):
        tracker.run(t, z, 2.0, out={"position_variance": np.empty(z.shape)})
    again = tracker.run(t, z, 2.0, keep="position_variance")
    assert again.kept == ("position_variance",)
    # The memory of a result is used again, without what was kept on request.
    more = tracker.run(t, z, 2.0, keep=KEEP)
    assert tracker.run(t, z, 2.0, out=more).kept == ("filtered",)
