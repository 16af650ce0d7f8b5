"""What the parts of a scan tracker may know of each other."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzytrack.scan.sensor import Sensor

__all__ = ["Setting"]


@dataclass(frozen=True)
class Setting:
    """What the kernels of a part are made with, besides its own parameters.

    Attributes
    ----------
    sensor : Sensor
        Noise, detection probability, and the period to which rates belong.
    """

    sensor: Sensor
