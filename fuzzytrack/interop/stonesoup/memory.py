"""What a state of Stone Soup carries of a tracker of this package."""

from __future__ import annotations

from datetime import datetime

import numpy as np
from stonesoup.base import Base, Property
from stonesoup.types.array import CovarianceMatrix

__all__ = ["TrackMemory"]


class TrackMemory(Base):
    """State of a tracker, in values that Stone Soup's YAML writes.

    It is a value: each step makes another one, so that states may be kept, and hypotheses tried and
    dropped.
    """

    tracker: str = Property(doc="Text that names the tracker.")
    digest: str = Property(doc="Digest of its parameters.")
    epoch: datetime = Property(doc="Time of the first plot, from which times are counted.")
    time: float = Property(doc="Time of the last step (s).")
    plot_time: float = Property(doc="Time of the last plot (s).")
    plots: int = Property(doc="Number of plots, counted up to 2.")
    numbers: np.ndarray = Property(
        doc="The tracker's numbers, shape (rows, lanes), see `fuzzytrack.trackers.TrackState`."
    )
    covar: CovarianceMatrix = Property(
        doc="Covariance at the last plot; of a tracker with ``missed=step`` at the last step."
    )
