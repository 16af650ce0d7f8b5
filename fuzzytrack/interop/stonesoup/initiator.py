"""Initiator of Stone Soup."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import datetime
from typing import Any

from stonesoup.base import Property
from stonesoup.initiator.base import GaussianInitiator
from stonesoup.models.measurement import MeasurementModel
from stonesoup.types.hypothesis import SingleHypothesis
from stonesoup.types.track import Track

from fuzzytrack.gains.checks import nonnegative_deviation, number, positive_deviation
from fuzzytrack.interop.stonesoup.component import GainScheduledComponent
from fuzzytrack.interop.stonesoup.states import ScheduledGaussianStateUpdate

__all__ = ["GainScheduledInitiator"]


class GainScheduledInitiator(GainScheduledComponent, GaussianInitiator):
    """Starts a track from each detection, as the tracker does it.

    With the start ``two-point``, which is usual, position is that of the second plot, and velocity
    the difference of the first two; `GainScheduledUpdater` does that when the second plot comes.
    Until then velocity is 0, and its variance, which the second plot removes, is that of
    `velocity_deviation`: it is for gates.

    Raises
    ------
    ValueError, RuleBaseError
        If the text names no alpha-beta tracker, the mappings do not fit it, or a standard deviation
        is missing or out of its range.
    """

    velocity_deviation: float = Property(
        readonly=True,
        doc="Standard deviation of a new target's velocity on each axis (m/s), > 0, about 0.",
    )
    acceleration_deviation: float = Property(
        default=None,
        readonly=True,
        doc="Standard deviation of a new target's acceleration on each axis (m/s²), >= 0, for a "
        "tracker that has one. Without it that of the tracker is taken, which then needs one.",
    )
    measurement_model: MeasurementModel = Property(
        default=None, doc="Used for detections that have none."
    )

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        name = "velocity_deviation"
        self._velocity = number(name, positive_deviation(name, self.velocity_deviation))
        self._acceleration = self._first_acceleration()

    def _first_acceleration(self) -> float:
        if not self.acceleration_mapping:
            return 0.0
        given = self.acceleration_deviation
        if given is None:
            given = self._recursion.first_acceleration
        if given is None:
            raise ValueError(
                f"acceleration_deviation: {self.tracker!r} has none of its own; give the standard "
                "deviation of a new target's acceleration (m/s²)"
            )
        name = "acceleration_deviation"
        return number(name, nonnegative_deviation(name, given))

    def initiate(self, detections: Iterable[Any], timestamp: datetime, **kwargs: Any) -> set[Track]:
        """Start a track from each detection.

        Parameters
        ----------
        detections : iterable of Detection
            Those that no track has taken.
        timestamp : datetime
            Time of detections that have none.

        Returns
        -------
        set of Track

        Raises
        ------
        ValueError
            If a detection is no position.
        """
        return {
            self._track(detection, detection.timestamp or timestamp) for detection in detections
        }

    def _track(self, detection: Any, when: datetime) -> Track:
        recursion = self._recursion
        position, noise = self._position_of(detection)
        memory = recursion.started(position, noise, when, self._velocity, self._acceleration)
        state = ScheduledGaussianStateUpdate(
            recursion.vector(memory),
            memory.covar,
            timestamp=when,
            hypothesis=SingleHypothesis(None, detection),
            memory=memory,
        )
        return Track([state])
