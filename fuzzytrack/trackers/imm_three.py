"""Three interacting models: a straight course, and two accelerations that decay."""

from __future__ import annotations

from fuzzytrack.trackers.base import trackers
from fuzzytrack.trackers.interacting_models import InteractingModels
from fuzzytrack.trackers.model_set import MotionModel

__all__ = ["three_model_imm"]


@trackers.register("imm-three")
def three_model_imm(
    level: float | None = None,
    straight_noise: float = 0.01,
    moderate_noise: float = 0.35,
    strong_noise: float = 2.0,
    moderate_retention: float = 20.0,
    strong_retention: float = 4.0,
    moderate_rate: float = 1 / 12,
    strong_rate: float = 1 / 18,
    weaken_rate: float = 1 / 14,
    end_rate: float = 1 / 10,
    gap: float = 3.0,
    start_acceleration: float = 0.4,
    moderate_start: float = 0.005,
    strong_start: float = 0.005,
    freedom: float = 6.0,
    sigma_w: float | None = None,
    missed: str = "elapsed",
) -> InteractingModels:
    """Interacting models for a straight course, a moderate maneuver and a strong one.

    A strong maneuver becomes a moderate one before the course is straight again. The defaults are
    the result of a search over simulated targets of many kinds, at regular and irregular times and
    with missed plots. Times are in τ0 and accelerations in a0, see
    `fuzzytrack.trackers.InteractingModels`, so that the same numbers fit ships and aircraft.

    Parameters
    ----------
    level : float, optional
        The strongest maneuver to be expected (m/s²), > 0; found from the intervals between plots
        unless given.
    straight_noise, moderate_noise, strong_noise : float
        Noise of the models (in a0), >= 0.
    moderate_retention, strong_retention : float
        Time for which a maneuvering target keeps its acceleration (in τ0), > 0.
    moderate_rate, strong_rate : float
        How often a moderate maneuver begins on a straight course, and a strong one (per τ0), >= 0.
    weaken_rate, end_rate : float
        How often a strong maneuver becomes a moderate one, and a moderate one ends (per τ0), >= 0.
    gap : float
        Time step (in τ0) at which the noise is halved, > 0.
    start_acceleration : float
        Standard deviation of the acceleration of a new track (in a0), >= 0.
    moderate_start, strong_start : float
        Probabilities of the maneuvers for a new track, >= 0; their sum is at most 1.
    freedom : float
        Degrees of freedom of the likelihood, an even number from 2 to 1000, or infinity.
    sigma_w : float, optional
        Standard deviation of all plots (m), > 0; otherwise the `sigma` of each.
    missed : {"elapsed", "step"}
        As for `fuzzytrack.AlphaBetaTracker`.

    Returns
    -------
    InteractingModels
        Its models are in the order straight, moderate, strong.

    Raises
    ------
    ValueError
        If a parameter is out of its range.

    Examples
    --------
    >>> from fuzzytrack.trackers import three_model_imm
    >>> three_model_imm(level=3.0, freedom=4).freedom
    4.0
    """
    return InteractingModels(
        (
            MotionModel(straight_noise),
            MotionModel(moderate_noise, moderate_retention),
            MotionModel(strong_noise, strong_retention),
        ),
        ((0.0, moderate_rate, strong_rate), (end_rate, 0.0, 0.0), (0.0, weaken_rate, 0.0)),
        (1.0 - moderate_start - strong_start, moderate_start, strong_start),
        level,
        gap,
        start_acceleration,
        freedom,
        sigma_w,
        missed,
    )


# What a class declares as `source`.
vars(three_model_imm)["source"] = InteractingModels.source
