"""Stone Soup's Kalman filter as a referee of the Kalman schedulers.

Stone Soup is optional: ``pip install stonesoup``. It is given the matrices of each step, since its
own constant-velocity model drives the target with continuous noise.
"""

import warnings
from datetime import datetime, timedelta

import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker
from fuzzytrack.schedulers import KalmanCA, KalmanCV

with warnings.catch_warnings():
    # What it warns of while it is imported is its own affair.
    warnings.simplefilter("ignore")
    pytest.importorskip("stonesoup", reason="Stone Soup is not installed")
    from stonesoup.models.measurement.linear import LinearGaussian
    from stonesoup.models.transition.linear import LinearGaussianTimeInvariantTransitionModel
    from stonesoup.predictor.kalman import KalmanPredictor
    from stonesoup.types.detection import Detection
    from stonesoup.types.hypothesis import SingleHypothesis
    from stonesoup.types.state import GaussianState
    from stonesoup.updater.kalman import KalmanUpdater

CASES = {2: KalmanCV(0.7, velocity_sigma=9.0), 3: KalmanCA(0.7, 0.4, velocity_sigma=9.0)}


@pytest.mark.parametrize("order", CASES)
def test_same_track_at_any_times_noise_and_gaps(order):
    random = np.random.default_rng(6)
    times = np.cumsum(random.uniform(0.3, 3.0, 60))
    sigma = random.uniform(1.0, 30.0, 60)
    plots = 0.2 * times**2 - 5 * times + sigma * random.normal(size=60)
    plots[random.random(60) < 0.2] = np.nan
    plots[0] = 0.0
    result = AlphaBetaTracker(CASES[order], start="one-point", missed="step").run(
        times, plots, sigma
    )

    begin = datetime(2000, 1, 1)
    covariance = np.diag([sigma[0] ** 2, 81.0, 0.16][:order])
    state = GaussianState(np.zeros((order, 1)), covariance, timestamp=begin)
    states = [np.zeros(order)]
    for k in range(1, 60):
        dt = times[k] - times[k - 1]
        push = np.array([[dt * dt / 2], [dt], [1.0]])[:order]
        model = LinearGaussianTimeInvariantTransitionModel(
            transition_matrix=np.array([[1, dt, dt * dt / 2], [0, 1, dt], [0, 0, 1]])[
                :order, :order
            ],
            covariance_matrix=push @ push.T * 0.49,
        )
        now = begin + timedelta(seconds=k)
        state = KalmanPredictor(model).predict(state, timestamp=now)
        if not np.isnan(plots[k]):
            sensor = LinearGaussian(order, [0], np.array([[sigma[k] ** 2]]))
            plot = Detection(np.array([[plots[k]]]), timestamp=now, measurement_model=sensor)
            state = KalmanUpdater(sensor).update(SingleHypothesis(state, plot))
        states.append(np.asarray(state.state_vector, dtype=float)[:, 0])
    ours = np.stack([result.filtered, result.velocity, result.acceleration], axis=1)[:, :order]
    assert ours == pytest.approx(np.array(states), rel=1e-9, abs=1e-8)
