"""FilterPy's interacting multiple models as a referee of ours, axis by axis.

FilterPy is optional: ``pip install filterpy``. Three of its ways are gone round here:

- its prediction is a mean with the probabilities before the step, where the book has those after
  the switch, so it is taken from its filters;
- a missed plot would shift the odds by what the last one said, so `update` is left out there, and
  the probabilities are moved on by hand;
- its filters have no start of their own: they begin with the track of a one-point start.
"""

import numpy as np
import pytest

from fuzzytrack.trackers.imm import InteractingPair

kalman = pytest.importorskip("filterpy.kalman", reason="FilterPy is not installed")

STAY = 0.94, 0.87


def plots():
    random = np.random.default_rng(11)
    times = np.cumsum(random.uniform(0.3, 2.0, 120))
    sigma = random.uniform(0.5, 4.0, 120)
    bend = np.where(times > times[60], (times - times[60]) ** 2, 0.0)
    z = 6 * times + bend + sigma * random.normal(size=120)
    z[random.random(120) < 0.2] = np.nan
    z[0] = 0.0
    return times, z, sigma


def model(accelerates, dt, sigma):
    f = np.array([[1, dt, dt * dt / 2], [0, 1, dt], [0, 0, 1]])
    push = np.array([dt * dt / 2, dt, 1.0])
    if not accelerates:
        f[:, 2] = push[2] = 0.0
    return f, np.outer(push, push) * sigma**2


@pytest.mark.parametrize("joint", [True, False])
@pytest.mark.parametrize("maneuver", ["ca", "cv"])
def test_same_track_at_any_times_noise_and_gaps(maneuver, joint):
    times, z, sigma = plots()
    ours = InteractingPair(
        0.1, 1.5, *STAY, maneuver=maneuver, joint=joint, velocity_sigma=9.0, missed="step"
    )
    result = ours.run(times, z[:, None], sigma[:, None])

    accelerates = [False, maneuver == "ca"]
    filters = []
    for has in accelerates:
        one = kalman.KalmanFilter(dim_x=3, dim_z=1)
        one.H = np.array([[1.0, 0.0, 0.0]])
        one.x = np.zeros((3, 1))
        one.P = np.diag([sigma[0] ** 2, 81.0, 1.5**2 * has])
        filters.append(one)
    leave, settle = 1 - STAY[0], 1 - STAY[1]
    chain = np.array([[STAY[0], leave], [settle, STAY[1]]])
    start = np.array([settle, leave]) / (leave + settle)
    referee = kalman.IMMEstimator(filters, start, chain)
    predicted, states = [np.nan], [np.zeros(3)]
    for k in range(1, 120):
        for one, has, noise in zip(filters, accelerates, (0.1, 1.5), strict=True):
            one.F, one.Q = model(has, times[k] - times[k - 1], noise)
            one.R = sigma[k] ** 2
        odds = referee.cbar.copy()
        referee.predict()
        predicted.append(sum(p * one.x[0, 0] for p, one in zip(odds, filters, strict=True)))
        if np.isnan(z[k]):
            referee.mu = odds
            referee._compute_mixing_probabilities()
            referee._compute_state_estimate()
        else:
            referee.update(z[k])
        states.append(referee.x[:, 0].copy())

    expected = np.array(states)
    found = np.stack([result.filtered, result.velocity, result.acceleration], axis=-1)[:, 0]
    for order in range(3):
        scale = np.abs(expected[:, order]).max()
        assert found[:, order] == pytest.approx(expected[:, order], rel=1e-9, abs=1e-9 * scale)
    assert result.predicted[:, 0] == pytest.approx(predicted, rel=1e-9, abs=1e-9, nan_ok=True)
    assert ours.maneuver_probability(result.state).item() == pytest.approx(referee.mu[1], rel=1e-9)
    assert ours.position_variance(result.state).item() == pytest.approx(referee.P[0, 0], rel=1e-9)
