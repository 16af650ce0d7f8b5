"""Interacting models of any number, with times in seconds and accelerations in m/s²."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import nonnegative, nonnegative_deviation, number, positive_deviation
from fuzzytrack.lanes.program import LaneProgram
from fuzzytrack.trackers.interacting_step import step_function
from fuzzytrack.trackers.lane_tracker import LaneTracker, check_missed
from fuzzytrack.trackers.markov_chain import MarkovChain, Rates
from fuzzytrack.trackers.model_mixing import predicted_variance
from fuzzytrack.trackers.model_set import UNITS, ModelRows, ModelSet, MotionModel
from fuzzytrack.trackers.state import TrackState, check_origin

__all__ = ["InteractingModels", "MotionModel"]

#: A plot takes half as many multiplications; with more, Student's distribution is a Gaussian.
_MOST_FREEDOM = 1000


@dataclass(frozen=True, repr=False)
class InteractingModels(LaneTracker):
    """Kalman filters for targets that move in different ways, and their probabilities.

    Each model has its own noise and its own time for which an acceleration is retained. A target
    changes from model to model as a Markov chain in continuous time. Each filter starts a step from
    a mixture of all estimates, and each plot raises the probabilities of the models that predicted
    it better. Estimates are means over the models. All axes of a track have one covariance and
    the same probabilities; a plot with one NaN counts as missed on all axes.

    `fuzzytrack.trackers.two_model_imm` and `fuzzytrack.trackers.three_model_imm` make trackers of
    two and three models that were tuned on many kinds of targets.

    Parameters
    ----------
    models : tuple of MotionModel
        At least one. The unit of noise is a0 = `level`/3, and that of times τ0 = √(σ/a0), with the
        standard deviation σ of the first plot of a track (m).
    rates : tuple of tuple of float
        Rate of the transition from each model (rows) to each (columns), per τ0, >= 0; 0 on the
        diagonal.
    start_probabilities : tuple of float
        Probabilities of the models of a new track, >= 0; their sum is 1.
    level : float, optional
        The strongest maneuver to be expected (m/s²), > 0. Unless given, τ0 is the mean of the
        intervals between the plots of a track, and a0 = σ/τ0².
    gap : float
        Time step (in τ0) at which the noise is halved, > 0: a maneuver does not last through a long
        gap. Infinity for a noise that does not depend on it.
    start_acceleration : float
        Standard deviation of the acceleration of a new track (in a0), >= 0.
    freedom : float
        Degrees of freedom of Student's distribution, which is the likelihood of a plot: an even
        number from 2 to 1000, or infinity for a Gaussian one. The fewer they are, the less an
        outlier says about the models.
    sigma_w : float, optional
        Standard deviation of all plots (m), > 0. Unless given, the `sigma` of each plot is used.
    missed : {"elapsed", "step"}
        As for `fuzzytrack.AlphaBetaTracker`.

    Raises
    ------
    ValueError
        If a parameter is out of its range, or their numbers of models differ.

    Notes
    -----
    Blom & Bar-Shalom (1988) with the decaying accelerations of Singer (1970); Bar-Shalom, Li &
    Kirubarajan (2001), section 11.6.6. For the transitions see
    `fuzzytrack.trackers.markov_chain.MarkovChain`. The covariance is that of a mean axis: the
    variance of a plot and the spread between models are means over the axes. A model predicts with
    φ = `fuzzytrack.gains.singer.fade` (Δt/τ) and the process noise
    (1 - φ²)/(1 + Δt/gap)·σ²GGᵀ, where G = (Δt²/2, Δt, 1); 1 takes the place of 1 - φ² in models
    that have no acceleration, or always keep it.

    The likelihood is S^(-n/2)·(1 + e'e/(νS))^(-(ν+n)/2) for n axes and ν degrees of freedom. After
    a plot every probability is raised by 1e-7, so that no model is lost. Velocity starts from the
    first two plots.

    The gains of a result are means over the models with the probabilities after the plot:
    α = Σp K₁, β = Σp K₂Δt, γ = 2Σp K₃Δt². They describe the response of the tracker. The memory of
    a lane holds the variance of the first plot, 1/τ0, a0², the number of intervals that τ0 is the
    mean of, the probabilities, and then for each model its mean (x, v and a of all axes) and P₁₁,
    P₁₂, P₁₃, P₂₂, P₂₃, P₃₃.

    Examples
    --------
    >>> from fuzzytrack.trackers import InteractingModels, MotionModel
    >>> straight, turning = MotionModel(0.03), MotionModel(1.6, retention=10.0)
    >>> rates = ((0.0, 0.1), (0.11, 0.0))
    >>> tracker = InteractingModels((straight, turning), rates, (0.98, 0.02), level=3.0)
    >>> result = tracker.run([0, 1, 2, 3, 4, 5], [0, 10, 20, 30, 43, 59], sigma=1.0)
    >>> result.predicted.round(2)
    array([ nan,  nan, 20. , 30. , 40. , 52.9])
    >>> tracker.probabilities(result.state).round(2)
    array([0.18, 0.82])
    """

    source: ClassVar[str] = "Blom & Bar-Shalom (1988), with Singer (1970)"
    coupled = True
    one_recursion = False  # its gains are means over the models

    models: tuple[MotionModel, ...]
    rates: Rates
    start_probabilities: tuple[float, ...]
    level: float | None = None
    gap: float = math.inf
    start_acceleration: float = 1.0
    freedom: float = 6.0
    sigma_w: float | None = None
    missed: str = "elapsed"

    def __post_init__(self) -> None:
        check_missed(self.missed)
        checked = {
            "models": _models(self.models),
            "start_probabilities": _distribution(self.start_probabilities, len(self.models)),
            "rates": _rates(self.rates, len(self.models)),
            "gap": _gap(self.gap),
            "start_acceleration": number(
                "start_acceleration",
                nonnegative_deviation("start_acceleration", self.start_acceleration),
            ),
            "freedom": _degrees(self.freedom),
        }
        for name in ("level", "sigma_w"):
            if (value := getattr(self, name)) is not None:
                checked[name] = number(name, positive_deviation(name, value))
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    @property
    def uses_acceleration(self) -> bool:  # type: ignore[override]
        """Whether a model has an acceleration."""
        return any(model.accelerates for model in self.models)

    @property
    def needs_sigma(self) -> bool:  # type: ignore[override]
        """Whether plots need a standard deviation: unless `sigma_w` is given."""
        return self.sigma_w is None

    def program(self, n_axes: int) -> LaneProgram:
        """Memory and step of a lane; see `LaneTracker.program`."""
        places, numbers = ModelRows(n_axes, len(self.models)), self._numbers
        start = (*(0.0,) * UNITS, *self.start_probabilities)
        memory = (*start, *(0.0,) * (places.n_memory - len(start)))
        return LaneProgram(
            places.rows, memory, lambda stride: step_function(numbers, places, stride)
        )

    @property
    def _numbers(self) -> ModelSet:
        return ModelSet(
            models=self.models,
            chain=MarkovChain.of(self.rates),
            start_acceleration=self.start_acceleration,
            gap_rate=1.0 / self.gap,
            acceleration=None if self.level is None else self.level / 3.0,
            half_freedom=None if math.isinf(self.freedom) else int(self.freedom) // 2,
            plot_variance=None if self.sigma_w is None else self.sigma_w**2,
        )

    def probabilities(self, state: TrackState) -> Array:
        """Probabilities of the models.

        Parameters
        ----------
        state : TrackState
            From this tracker.

        Returns
        -------
        ndarray
            Shape (...batch, n_models), (n_models,) for a track alone; in the order of `models`.

        Raises
        ------
        ValueError
            If the state is that of another kind of tracker.
        """
        n = len(self.models)
        places = ModelRows(state.rows.n_axes, n)
        check_origin(state, places.rows, self._origin)
        found: Array = state.lanes[places.probability : places.probability + n].T
        return found.reshape((*state.shape[:-1], n)).copy()

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of a predicted position; see `LaneTracker.prediction_variance`.

        The mean of all axes: that of the models, and the spread between them.
        """
        places = ModelRows.of_memory(len(memory), len(self.models))
        return predicted_variance(self._numbers, places, memory, dt)


def _models(models: Any) -> tuple[MotionModel, ...]:
    found = tuple(models)
    if not found:
        raise ValueError("models: at least one is needed")
    for k, model in enumerate(found):
        if not isinstance(model, MotionModel):
            raise TypeError(f"models[{k}] must be a MotionModel, got {type(model).__name__}")
    return found


def _distribution(probabilities: Any, count: int) -> tuple[float, ...]:
    name = "start_probabilities"
    found = nonnegative(name, probabilities)
    if found.shape != (count,):
        raise ValueError(f"{name} must be one for each of {count} models, got shape {found.shape}")
    if abs(found.sum() - 1.0) > 1e-9:
        raise ValueError(f"{name} must add up to 1, got {found.sum():g}")
    return tuple(found.tolist())


def _rates(rates: Any, count: int) -> Rates:
    found = nonnegative("rates", rates)
    if found.shape != (count, count):
        raise ValueError(
            f"rates must be a row for each of {count} models, with {count} numbers each, got shape "
            f"{found.shape}"
        )
    if found.diagonal().any():
        raise ValueError("rates must be 0 on the diagonal: no model changes into itself")
    return tuple(map(tuple, found.tolist()))


def _gap(gap: float) -> float:
    found = float(gap)
    if not found > 0.0:
        raise ValueError(f"gap must be > 0, or infinity, got {found:g}")
    return found


def _degrees(freedom: float) -> float:
    found = float(freedom)
    if not (found == math.inf or (2.0 <= found <= _MOST_FREEDOM and found % 2.0 == 0.0)):
        raise ValueError(
            f"freedom must be an even number from 2 to {_MOST_FREEDOM}, or infinity for a "
            f"Gaussian, got {found:g}"
        )
    return found
