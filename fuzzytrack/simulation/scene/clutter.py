"""Clutter: plots that come from no target."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.scene.region import Region
from fuzzytrack.simulation.scene.settings import Settings
from fuzzytrack.simulation.scene.streams import Streams

__all__ = ["MOST_PLOTS", "Clutter", "View", "refuse_too_many"]

#: Most plots of a kind of clutter, so that a scene cannot ask for more memory than a computer has.
MOST_PLOTS = 50_000_000

#: Number of the scan of each plot, and its place, shape (n, 2).
ClutterPlots = tuple[NDArray[np.int64], Array]


@dataclass(frozen=True, eq=False)
class View:
    """From where, when and in which region a radar looks.

    Attributes
    ----------
    times : ndarray, shape (n_scans,)
        Times of the scans (s).
    start : float
        When the first one begins (s).
    own : ndarray, shape (n_scans, 2)
        Where the radar is at these times (m).
    region : Region
        Region of the scene.
    """

    times: Array
    start: float
    own: Array
    region: Region

    def __repr__(self) -> str:
        return summary(self, scans=len(self.times))


@dataclass(frozen=True, repr=False)
class Clutter(Settings, ABC):
    """A kind of clutter."""

    #: What it is, for the documentation.
    summary: ClassVar[str] = ""

    @abstractmethod
    def plots(self, view: View, streams: Streams) -> ClutterPlots:
        """Draw its plots in all scans.

        Parameters
        ----------
        view : View
            From where, when and in which region the radar looks.
        streams : Streams
            Random streams of this clutter.

        Returns
        -------
        scan : ndarray of int, shape (n,)
            Number of the scan of each plot.
        place : ndarray, shape (n, 2)
            Its place (m).
        """


def refuse_too_many(expected: float) -> None:
    """ValueError if clutter of this expected number of plots, or of what makes them, is too much.

    Parameters
    ----------
    expected : float
        In all scans together.
    """
    if not expected <= MOST_PLOTS:
        raise ValueError(
            f"the scene has clutter of some {expected:.3g} plots, more than {MOST_PLOTS}; simulate "
            "fewer scans or less clutter"
        )
