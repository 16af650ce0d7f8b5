"""The covariance of states: against other computations, and against the errors of tracks."""

import numpy as np
import pytest
from scipy.stats import chi2
from stonesoup.models.measurement.nonlinear import (
    CartesianToBearingRange,
    CartesianToElevationBearingRange,
)
from stonesoup.models.transition.linear import (
    LinearGaussianTimeInvariantTransitionModel,
)
from stonesoup.predictor.kalman import KalmanPredictor
from stonesoup.types.detection import Detection
from stonesoup.types.hypothesis import SingleHypothesis
from stonesoup.types.state import GaussianState
from stonesoup.updater.kalman import KalmanUpdater
from stonesoup_scenes import (
    SIGMA,
    at,
    components,
    detected,
    followed,
    linear,
    mappings,
    plots,
    states,
)

from fuzzytrack.interop.stonesoup import (
    GainScheduledInitiator,
    GainScheduledPredictor,
    GainScheduledUpdater,
)
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.covariance import track_covariance

NOISE = 1.5


def blocks(covar, places):
    """Covariance of each axis, shape (n_axes, order, order)."""
    return np.array([covar[np.ix_(own, own)] for own in zip(*places.values(), strict=True)])


@pytest.mark.parametrize(
    "spec",
    [
        "fixed:alpha=0.5:beta=0.2",
        "fixed:alpha=0.5:beta=0.2:gamma=0.05",
        "fixed:alpha=0.5:beta=0.2:missed=step",
        "fixed:alpha=0.5:beta=0.2:gamma=0.05:missed=step",
        "kalman-cv:sigma_v=1.5",
        "kalman-ca:sigma_v=1.5:acceleration_sigma=1.5",
        "omega-schedule",
        "fixed:alpha=0.5:beta=0.2:start=one-point",
    ],
)
def test_covariances_are_those_of_the_gains(spec):
    tracker = make_tracker(spec)
    t, z = plots(4)
    places = mappings(2, tracker.uses_acceleration)
    track = followed(
        components(spec, noise=NOISE),
        detected(t, z, linear(places["position_mapping"], 2 * len(places))),
    )
    expected = track_covariance(
        tracker.run(t, z, SIGMA),
        SIGMA,
        NOISE,
        velocity_sigma=30.0 if tracker.start_mode == "one-point" else None,
        acceleration_sigma=NOISE if tracker.uses_acceleration else None,
        missed=tracker.missed,
    )
    seen = ~np.isnan(z[:, 0])
    for k in range(2, len(t)):
        # Where a plot was missed, a state is the prediction.
        wanted = expected.filtered[k] if seen[k] else expected.predicted[k]
        found = np.asarray(track[k].covar)
        np.testing.assert_allclose(blocks(found, places), wanted, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(found[0, len(places) :], 0.0, atol=1e-9)


def test_a_decaying_acceleration_is_followed():
    """Against the covariance that the tracker carries axis by axis."""
    spec = f"maneuver:level=5:covariance={NOISE}"
    tracker = make_tracker(spec)
    t, z = plots(5)
    places = mappings(2, True)
    track = followed(components(spec, noise=NOISE), detected(t, z, linear((0, 3), 6)))
    state = tracker.start(z[0], t[0], SIGMA)
    for k in range(1, len(t)):
        if k > 2:
            expected = tracker.predict(state, t[k]).position_variance
            prediction = getattr(track[k], "hypothesis", None)
            prediction = prediction.prediction if prediction else track[k]
            found = np.diag(prediction.covar)[list(places["position_mapping"])]
            np.testing.assert_allclose(found, expected, rtol=1e-9)
        state = tracker.step(state, z[k], t[k], SIGMA)


def test_a_kalman_filter_is_that_of_stone_soup():
    """From the third plot on, with its own predictor and updater."""
    rng = np.random.default_rng(6)
    model = linear((0, 2), 4)
    z = 10.0 * np.arange(12.0)[:, None] + rng.normal(0.0, SIGMA, (12, 2))
    track = followed(
        components(f"kalman-cv:sigma_v={NOISE}", noise=NOISE), detected(range(12), z, model)
    )
    push = np.kron(np.eye(2), [[0.5], [1.0]])
    transition = LinearGaussianTimeInvariantTransitionModel(
        transition_matrix=np.kron(np.eye(2), [[1.0, 1.0], [0.0, 1.0]]),
        covariance_matrix=NOISE**2 * push @ push.T,
    )
    predictor, updater = KalmanPredictor(transition), KalmanUpdater()
    state = GaussianState(track[1].state_vector, track[1].covar, timestamp=at(1))
    for k in range(2, 12):
        detection = Detection(z[k], timestamp=at(k), measurement_model=model)
        prediction = predictor.predict(state, timestamp=at(k))
        state = updater.update(SingleHypothesis(prediction, detection))
        np.testing.assert_allclose(np.asarray(track[k].state_vector, float), state.state_vector)
        np.testing.assert_allclose(track[k].covar, state.covar, rtol=1e-9, atol=1e-9)


def test_normalized_errors_are_in_their_interval():
    """200 targets whose accelerations are drawn anew for each plot; 20 % of the plots missed."""
    rng = np.random.default_rng(7)
    runs, steps = 200, 8
    predictor, updater, initiator = components(f"kalman-cv:sigma_v={NOISE}", noise=NOISE)
    model = linear((0, 2), 4)
    errors = np.empty((runs, steps))
    for run in range(runs):
        x = np.array([*rng.normal(0.0, 100.0, 2), *rng.normal(0.0, 10.0, 2)])[[0, 2, 1, 3]]
        t, state, seen = 0.0, None, 0
        while seen < steps:
            if state is not None:
                dt = round(float(rng.uniform(0.5, 2.0)), 3) * (1 + int(rng.random() < 0.2))
                t += dt
                push = np.array([0.5 * dt * dt, dt])
                x = np.kron(np.eye(2), [[1.0, dt], [0.0, 1.0]]) @ x
                x = x + np.kron(rng.normal(0.0, NOISE, 2), push)
            plot = x[[0, 2]] + rng.normal(0.0, SIGMA, 2)
            detection = Detection(plot, timestamp=at(t), measurement_model=model)
            if state is None:
                (track,) = initiator.initiate({detection}, at(t))
                state = track.state
            else:
                prediction = predictor.predict(state, timestamp=at(t))
                state = updater.update(SingleHypothesis(prediction, detection))
            error = np.asarray(state.state_vector, float).ravel() - x
            errors[run, seen] = error @ np.linalg.solve(np.asarray(state.covar), error)
            seen += 1
    # The velocity after one plot is a guess.
    low, high = chi2.ppf([0.0005, 0.9995], 4 * runs) / runs
    means = errors[:, 1:].mean(axis=0)
    assert ((means > low) & (means < high)).all(), (low, means, high)
    # The interval is narrow enough to see a variance that is 20 % off.
    assert high < 4 * 1.2


POLAR = {
    2: (
        CartesianToBearingRange(
            4, (0, 2), np.diag([0.01**2, 5.0**2]), translation_offset=np.array([[300.0], [-200.0]])
        ),
        (0, 2),
    ),
    3: (
        CartesianToElevationBearingRange(6, (0, 2, 4), np.diag([0.01**2, 0.02**2, 5.0**2])),
        (0, 2, 4),
    ),
}


@pytest.mark.parametrize("n_axes", POLAR)
@pytest.mark.parametrize("spec", ["fixed:alpha=0.5:beta=0.2", "omega-schedule"])
def test_polar_plots_are_positions_with_the_noise_of_their_place(spec, n_axes):
    model, mapping = POLAR[n_axes]
    t, z = plots(8, n_axes, steps=25, missed=0.0)
    vector = np.zeros((2 * n_axes, 1))
    positions, noises, scans = [], [], []
    for when, place in zip(t, z, strict=True):
        vector[list(mapping), 0] = place
        state = GaussianState(vector.copy(), np.eye(2 * n_axes))
        detection = Detection(model.function(state), timestamp=at(when), measurement_model=model)
        # An inverse matrix in place of the derivative of an inverse function.
        inverse = np.linalg.inv(np.asarray(model.jacobian(state), float)[:, list(mapping)])
        noises.append(inverse @ model.covar() @ inverse.T)
        positions.append(place)
        scans.append((at(when), {detection}))
    track = followed(components(spec, n_axes), iter(scans))
    variances = np.array([np.diag(each) for each in noises])
    expected = make_tracker(spec).run(t, positions, np.sqrt(variances))
    found = states(track)[:, list(mapping)]
    np.testing.assert_allclose(found, expected.filtered, atol=1e-5)
    places = np.ix_(mapping, mapping)
    first = np.asarray(track[0].covar)[places]
    np.testing.assert_allclose(first, noises[0], rtol=1e-6)
    assert abs(first[0, 1]) > 1.0
    # The second plot is the position, whatever the noise of the first.
    np.testing.assert_allclose(np.asarray(track[1].covar)[places], noises[1], rtol=1e-6)


@pytest.mark.parametrize(
    "spec",
    [
        "fixed:alpha=0.5:beta=0.2",
        "fixed:alpha=0.5:beta=0.2:missed=step",
        "fixed:alpha=0.5:beta=0.2:gamma=0.05",
        "fixed:alpha=0.5:beta=0.2:start=one-point",
    ],
)
def test_without_maneuvers_the_covariance_is_that_of_the_plots_noise(spec):
    """A track with fixed gains is linear in its plots: their noise goes through the responses."""
    tracker = make_tracker(spec)
    order = 3 if tracker.uses_acceleration else 2
    places = mappings(2, tracker.uses_acceleration)
    model = CartesianToBearingRange(
        2 * order, places["position_mapping"], np.diag([0.01**2, 5.0**2])
    )
    t, z = plots(11, steps=14)
    z[-1] = 1100.0, 1200.0
    scans, noises = [], {}
    for k, (when, place) in enumerate(zip(t, z, strict=True)):
        detections = set()
        if not np.isnan(place).any():
            vector = np.zeros((2 * order, 1))
            vector[list(places["position_mapping"]), 0] = place
            seen = model.function(GaussianState(vector, np.eye(2 * order)))
            detections.add(Detection(seen, timestamp=at(when), measurement_model=model))
            x, y = place
            r = np.hypot(x, y)
            turn = np.array([[x, -y], [y, x]]) / r
            noises[k] = turn @ np.diag([25.0, (0.01 * r) ** 2]) @ turn.T
        scans.append((at(when), detections))
    assert len(noises) < len(t)
    common = {"tracker": spec, **places}
    first = {"acceleration_deviation": 0.0} if order == 3 else {}
    parts = (
        GainScheduledPredictor(**common, acceleration_noise=0.0),
        GainScheduledUpdater(**common),
        GainScheduledInitiator(**common, velocity_deviation=30.0, **first),
    )
    track = followed(parts, iter(scans))
    values = {"position": "filtered", "velocity": "velocity", "acceleration": "acceleration"}

    def last(positions):
        result = tracker.run(t, positions, SIGMA)
        found = np.zeros(2 * order)
        for name, attribute in values.items():
            if f"{name}_mapping" in places:
                found[list(places[f"{name}_mapping"])] = getattr(result, attribute)[-1]
        return found

    def response(row, column):
        moved = z.copy()
        moved[row, column] += 1.0
        return last(moved) - last(z)

    expected = np.zeros((2 * order, 2 * order))
    for k, noise in noises.items():
        responses = np.stack([response(k, axis) for axis in range(2)], axis=-1)
        expected += responses @ noise @ responses.T
    # And that of the velocity of a new target, which the second plot may remove.
    for axis, (x, v) in enumerate(zip(*list(places.values())[:2], strict=True)):
        moved, error = z.copy(), np.zeros(2 * order)
        moved[:, axis] += t
        error[[x, v]] = t[-1], 1.0
        error -= last(moved) - last(z)
        expected += 30.0**2 * np.outer(error, error)
    np.testing.assert_allclose(track.covar, expected, rtol=1e-5, atol=1e-6)
