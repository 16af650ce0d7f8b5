"""What predictor, updater and initiator have in common: the tracker, and the state it is in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from stonesoup.base import Base, Property

from fuzzytrack.arrays import Array
from fuzzytrack.interop.stonesoup.plots import position_of
from fuzzytrack.interop.stonesoup.recursion import Recursion

__all__ = ["GainScheduledComponent"]


class GainScheduledComponent(Base):
    """Component with a tracker of this package.

    Its properties are texts and numbers, so that Stone Soup's YAML writes and reads them.

    Raises
    ------
    ValueError, RuleBaseError
        If the text names no alpha-beta tracker, or the mappings do not fit it.
    """

    tracker: str = Property(
        readonly=True,
        doc="Text that names the tracker, such as ``omega-schedule``, ``my.yaml`` or "
        "``fixed:alpha=0.5:beta=0.2``.",
    )
    position_mapping: Sequence[int] = Property(
        readonly=True, doc="Place of the position on each axis in the state vector."
    )
    velocity_mapping: Sequence[int] = Property(
        readonly=True, doc="Place of the velocity on each axis."
    )
    acceleration_mapping: Sequence[int] = Property(
        default=None,
        readonly=True,
        doc="Place of the acceleration on each axis, for a tracker that has one.",
    )

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._recursion = Recursion.of(
            self.tracker, self.position_mapping, self.velocity_mapping, self.acceleration_mapping
        )

    def _position_of(self, detection: Any) -> tuple[Array, Array]:
        """Position of a detection, and its covariance; the component may have a model."""
        layout = self._recursion.layout
        model = self.measurement_model
        position, noise = position_of(detection, model, layout.position, layout.ndim)
        for place, variance in zip(layout.position, noise.diagonal(), strict=True):
            if not variance > 0.0:
                raise ValueError(
                    f"measurement_model: place {place} of position_mapping has the variance "
                    f"{variance:g}, which must be positive; give a noise_covar above 0, and a "
                    "mapping with the places of position_mapping"
                )
        return position, noise
