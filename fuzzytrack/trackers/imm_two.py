"""Two interacting models: a straight course, and an acceleration that decays."""

from __future__ import annotations

from fuzzytrack.trackers.base import trackers
from fuzzytrack.trackers.interacting_models import InteractingModels
from fuzzytrack.trackers.model_set import MotionModel

__all__ = ["two_model_imm"]


@trackers.register("imm-two")
def two_model_imm(
    level: float | None = None,
    straight_noise: float = 0.03,
    maneuver_noise: float = 1.6,
    retention: float = 10.0,
    begin_rate: float = 0.1,
    end_rate: float = 0.11,
    gap: float = 2.0,
    start_acceleration: float = 1.0,
    maneuver_start: float = 0.02,
    freedom: float = 6.0,
    sigma_w: float | None = None,
    missed: str = "elapsed",
) -> InteractingModels:
    """Interacting models for a straight course and for a maneuver.

    The defaults are the result of a search over simulated targets of many kinds, at regular and
    irregular times and with missed plots. Times are in τ0 and accelerations in a0, see
    `fuzzytrack.trackers.InteractingModels`, so that the same numbers fit ships and aircraft.

    Parameters
    ----------
    level : float, optional
        The strongest maneuver to be expected (m/s²), > 0; found from the intervals between plots
        unless given.
    straight_noise, maneuver_noise : float
        Noise of either model (in a0), >= 0.
    retention : float
        Time for which a maneuvering target keeps its acceleration (in τ0), > 0.
    begin_rate, end_rate : float
        How often a maneuver begins, and ends (per τ0), >= 0.
    gap : float
        Time step (in τ0) at which the noise is halved, > 0.
    start_acceleration : float
        Standard deviation of the acceleration of a new track (in a0), >= 0.
    maneuver_start : float
        Probability, 0 to 1, that a new track maneuvers.
    freedom : float
        Degrees of freedom of the likelihood, an even number from 2 to 1000, or infinity.
    sigma_w : float, optional
        Standard deviation of all plots (m), > 0; otherwise the `sigma` of each.
    missed : {"elapsed", "step"}
        As for `fuzzytrack.AlphaBetaTracker`.

    Returns
    -------
    InteractingModels
        The straight course is its first model.

    Raises
    ------
    ValueError
        If a parameter is out of its range.

    Examples
    --------
    >>> from fuzzytrack.trackers import two_model_imm
    >>> two_model_imm(level=3.0).models
    (MotionModel(0.03), MotionModel(1.6, retention=10.0))
    """
    return InteractingModels(
        (MotionModel(straight_noise), MotionModel(maneuver_noise, retention)),
        ((0.0, begin_rate), (end_rate, 0.0)),
        (1.0 - maneuver_start, maneuver_start),
        level,
        gap,
        start_acceleration,
        freedom,
        sigma_w,
        missed,
    )


# What a class declares as `source`.
vars(two_model_imm)["source"] = InteractingModels.source
