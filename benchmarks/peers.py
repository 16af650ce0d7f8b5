"""Other trackers, each optional, set up for the same model and the same plots."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.report import NotMeasured

__all__ = [
    "Model", "filterpy_fixed", "filterpy_imm", "filterpy_kalman", "need", "simdkalman_batch",
    "stonesoup_kalman",
]  # fmt: skip

Array = NDArray[np.float64]
Track = Callable[[Array], Array]

SIGMA_W, VELOCITY_SIGMA, ACCELERATION_SIGMA = 10.0, 20.0, 2.0


def need(module: str, package: str) -> ModuleType:
    """A module of a peer."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise NotMeasured(f"{package} cannot be imported ({error})") from error


class Model:
    """Matrices of a target in two axes that keeps its velocity or its acceleration.

    The state is (x, vx[, ax], y, vy[, ay]), with process noise Q = GGᵀσ_v² for each axis.
    """

    def __init__(self, order: int, sigma_v: float, dt: float = 1.0) -> None:
        half = 0.5 * dt * dt
        if order == 2:
            one, gain = np.array([[1.0, dt], [0.0, 1.0]]), np.array([half, dt])
            start = [SIGMA_W**2, VELOCITY_SIGMA**2]
        else:
            one = np.array([[1.0, dt, half], [0.0, 1.0, dt], [0.0, 0.0, 1.0]])
            gain = np.array([half, dt, 1.0])
            start = [SIGMA_W**2, VELOCITY_SIGMA**2, ACCELERATION_SIGMA**2]
        both = np.eye(2)
        self.order = order
        self.transition = np.kron(both, one)
        self.noise = np.kron(both, np.outer(gain, gain) * sigma_v**2)
        self.observation = np.kron(both, np.eye(1, order))
        self.plot_noise = both * SIGMA_W**2
        self.start_covariance = np.kron(both, np.diag(start))

    @property
    def size(self) -> int:
        return 2 * self.order

    def start(self, plot: Array) -> Array:
        """State from a first plot."""
        state = np.zeros(self.size)
        state[:: self.order] = plot
        return state


def _filter(model: Model, plot: Array) -> Any:
    one = need("filterpy.kalman", "filterpy").KalmanFilter(dim_x=model.size, dim_z=2)
    one.x, one.P = model.start(plot), model.start_covariance.copy()
    one.F, one.H, one.Q, one.R = (
        model.transition, model.observation, model.noise, model.plot_noise,
    )  # fmt: skip
    return one


def filterpy_fixed(alpha: float, beta: float) -> Track:
    """FilterPy's g-h filter over a vector of two axes, T = 1."""
    module = need("filterpy.gh", "filterpy")

    def track(plots: Array) -> Array:
        one = module.GHFilter(x=plots[0].copy(), dx=np.zeros(2), dt=1.0, g=alpha, h=beta)
        for plot in plots[1:]:
            one.update(plot)
        return one.x

    return track


def filterpy_kalman(model: Model) -> Track:
    """FilterPy's Kalman filter, predict and update plot by plot."""
    need("filterpy.kalman", "filterpy")

    def track(plots: Array) -> Array:
        one = _filter(model, plots[0])
        for plot in plots[1:]:
            one.predict()
            one.update(plot)
        return one.x[:: model.order]

    return track


def filterpy_imm(quiet: Model, agile: Model, stay: tuple[float, float], start: float) -> Track:
    """FilterPy's interacting multiple models over two of its Kalman filters."""
    module = need("filterpy.kalman", "filterpy")
    moves = np.array([[stay[0], 1.0 - stay[0]], [1.0 - stay[1], stay[1]]])

    def track(plots: Array) -> Array:
        filters = [_filter(model, plots[0]) for model in (quiet, agile)]
        one = module.IMMEstimator(filters, np.array([1.0 - start, start]), moves)
        for plot in plots[1:]:
            one.predict()
            one.update(plot)
        return one.x[:: quiet.order]

    return track


def stonesoup_kalman(model: Model) -> Track:
    """Stone Soup's linear Kalman predictor and updater, plot by plot."""
    import datetime

    package = "stonesoup"
    linear = need("stonesoup.models.transition.linear", package)
    observed = need("stonesoup.models.measurement.linear", package)
    states = need("stonesoup.types.state", package)
    detections = need("stonesoup.types.detection", package)
    hypotheses = need("stonesoup.types.hypothesis", package)
    predictor = need("stonesoup.predictor.kalman", package).KalmanPredictor(
        linear.LinearGaussianTimeInvariantTransitionModel(
            transition_matrix=model.transition, covariance_matrix=model.noise
        )
    )
    measured = observed.LinearGaussian(
        ndim_state=model.size, mapping=(0, model.order), noise_covar=model.plot_noise
    )
    updater = need("stonesoup.updater.kalman", package).KalmanUpdater(measured)
    first = datetime.datetime(2000, 1, 1)
    second = datetime.timedelta(seconds=1)

    def track(plots: Array) -> Array:
        state = states.GaussianState(
            model.start(plots[0])[:, None], model.start_covariance, timestamp=first
        )
        for k, plot in enumerate(plots[1:], start=1):
            found = detections.Detection(plot[:, None], timestamp=first + k * second)
            prediction = predictor.predict(state, timestamp=found.timestamp)
            state = updater.update(hypotheses.SingleHypothesis(prediction, found))
        return np.asarray(state.state_vector, dtype=float).ravel()[:: model.order]

    return track


def simdkalman_batch(model: Model) -> Track:
    """simdkalman over a batch: plots of shape (n_tracks, n_steps, 2) to the last positions."""
    module = need("simdkalman", "simdkalman")
    one = module.KalmanFilter(
        state_transition=model.transition,
        process_noise=model.noise,
        observation_model=model.observation,
        observation_noise=model.plot_noise,
    )

    def batch(plots: Array) -> Array:
        tracks = len(plots)
        starts = np.zeros((tracks, model.size))
        starts[:, :: model.order] = plots[:, 0]
        # It does not predict before the first plot, so the start is predicted for it.
        covariance = model.transition @ model.start_covariance @ model.transition.T + model.noise
        result = one.compute(
            plots[:, 1:],
            0,
            initial_value=(starts @ model.transition.T)[:, :, None],
            initial_covariance=covariance,
            smoothed=False,
            filtered=True,
            states=True,
            observations=False,
        )
        return result.filtered.states.mean[:, -1, :: model.order]

    return batch
