"""FilterPy's Kalman filter as a referee of the Kalman schedulers.

FilterPy is optional: ``pip install filterpy``.
"""

import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker
from fuzzytrack.schedulers import KalmanCA, KalmanCV

kalman = pytest.importorskip("filterpy.kalman", reason="FilterPy is not installed")

CASES = {2: KalmanCV(0.7, velocity_sigma=9.0), 3: KalmanCA(0.7, 0.4, velocity_sigma=9.0)}


@pytest.mark.parametrize("order", CASES)
def test_same_track_at_any_times_noise_and_gaps(order):
    random = np.random.default_rng(5)
    times = np.cumsum(random.uniform(0.3, 3.0, 80))
    sigma = random.uniform(1.0, 30.0, 80)
    plots = 0.2 * times**2 + 5 * times + sigma * random.normal(size=80)
    plots[random.random(80) < 0.2] = np.nan
    plots[0] = 0.0
    result = AlphaBetaTracker(CASES[order], start="one-point", missed="step").run(
        times, plots, sigma
    )

    referee = kalman.KalmanFilter(dim_x=order, dim_z=1)
    referee.H = np.eye(order)[:1]
    referee.x = np.zeros((order, 1))
    referee.P = np.diag([sigma[0] ** 2, 81.0, 0.16][:order])
    states = [referee.x[:, 0].copy()]
    for k in range(1, 80):
        dt = times[k] - times[k - 1]
        push = np.array([[dt * dt / 2], [dt], [1.0]])[:order]
        referee.F = np.array([[1, dt, dt * dt / 2], [0, 1, dt], [0, 0, 1]])[:order, :order]
        referee.predict(Q=push @ push.T * 0.49)
        referee.update(None if np.isnan(plots[k]) else plots[k], R=sigma[k] ** 2)
        states.append(referee.x[:, 0].copy())
    expected = np.array(states)
    ours = np.stack([result.filtered, result.velocity, result.acceleration], axis=1)[:, :order]
    assert ours == pytest.approx(expected, rel=1e-9, abs=1e-9)
    rows = result.state.rows
    memory = result.state.lanes[rows.memory : rows.state, 0]
    assert memory[1:-1] == pytest.approx(referee.P[np.triu_indices(order)], rel=1e-9)
