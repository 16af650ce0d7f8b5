"""Result of a run over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.trackers.state import Gains, TrackState

__all__ = ["KEPT", "ON_REQUEST", "TrackResult", "checked_keep"]


#: Outputs that a run can keep.
KEPT = ("predicted", "filtered", "velocity", "acceleration", "innovation", "gains")
#: Outputs that a run keeps only if they are named.
ON_REQUEST = ("position_variance",)


@dataclass(frozen=True, eq=False, repr=False)
class TrackResult:
    """Tracks over time, as arrays: time first, axis of space last, batch between.

    Outputs that the run did not keep are missing; reading one raises an AttributeError.

    Attributes
    ----------
    time : ndarray, shape (n_steps,) or (n_steps, ...batch)
        Times (s).
    measured : ndarray, shape (n_steps, ...batch, n_axes)
        The plots (m) as they were given, not a copy; NaN where missed. All that follows has this
        shape.
    predicted : ndarray
        Position before the plot is used (m); NaN until the tracker has started.
    filtered : ndarray
        Position after the plot is used (m); the prediction where it was missed.
    velocity, acceleration : ndarray
        After the plot is used (m/s, m/s²); 0 before they are known.
    innovation : ndarray
        Plot minus prediction (m); NaN where there is no prediction or no plot.
    gains : Gains
        The gains used; NaN where none were.
    state : TrackState
        State after the last step, from which a run can continue; None if there was no step.
    position_variance : ndarray
        Variance of the filtered position (m²), as the tracker has it; NaN where it has none. Only
        if it is named in `keep`.
    """

    time: Array
    measured: Array
    predicted: Array
    filtered: Array
    velocity: Array
    acceleration: Array
    innovation: Array
    gains: Gains
    state: TrackState | None

    @classmethod
    def of(
        cls, time: Array, measured: Array, state: TrackState | None, kept: Mapping[str, Any]
    ) -> TrackResult:
        """Result that holds some of `KEPT` and `ON_REQUEST`, by their names."""
        result = cls.__new__(cls)
        fields = {"time": time, "measured": measured, "state": state, **kept}
        for name, value in fields.items():
            object.__setattr__(result, name, value)
        return result

    # Called only for what is not there.
    def __getattr__(self, name: str) -> Any:
        if name in KEPT + ON_REQUEST:
            raise AttributeError(f"{name} was not kept; run with keep=(..., {name!r})")
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __repr__(self) -> str:
        return f"TrackResult(shape={self.measured.shape}, kept={self.kept})"

    @property
    def kept(self) -> tuple[str, ...]:
        """Names of the outputs that were kept."""
        return tuple(name for name in KEPT + ON_REQUEST if name in self.__dict__)

    @property
    def coasted(self) -> NDArray[np.bool_]:
        """Where the track was carried on without a plot."""
        return np.isnan(self.innovation) & ~np.isnan(self.predicted)


def checked_keep(keep: Sequence[str] | None, argument: str = "keep") -> tuple[str, ...]:
    """Names of outputs to keep, in the order of `KEPT`, then of `ON_REQUEST`.

    A single word is one of them. As `out`, only those of `KEPT` can be given.

    Parameters
    ----------
    keep : sequence of str or None
        None is all of `KEPT`.
    argument : str
        Name of the argument, for messages.

    Raises
    ------
    ValueError
        If a name is unknown.
    """
    if keep is None:
        return KEPT
    # A word is a sequence of letters.
    names = (keep,) if isinstance(keep, str) else tuple(keep)
    allowed = KEPT if argument == "out" else KEPT + ON_REQUEST
    for name in names:
        if name not in allowed:
            raise ValueError(f"{argument}: unknown {name!r}; out of {', '.join(allowed)}")
    return tuple(name for name in KEPT + ON_REQUEST if name in names)
