"""Result of a run over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.html_reprs import as_text, block, facts
from fuzzytrack.trackers.state import Gains, TrackState

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["KEPT", "ON_REQUEST", "TrackResult", "checked_keep", "velocity_over_ground"]


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
        # Their properties end here if something was not kept.
        if name in ("speed", "course", "_over_ground"):
            raise AttributeError(
                "speed and course need predicted, filtered and velocity; run with these in keep"
            )
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __repr__(self) -> str:
        return f"TrackResult(shape={self.measured.shape}, kept={self.kept})"

    def plot(self, truth: ArrayLike | None = None, **options: Any) -> Figure:
        """Picture of one track, or of all tracks of a batch.

        Parameters
        ----------
        truth : array_like, optional
            True positions, shaped as the plots, of one track.
        **options
            As for `fuzzytrack.plotting.plot_track`: track (of a batch), axes_names, unit, gains;
            for a batch without `track` as for `fuzzytrack.plotting.plot_tracks`.
        """
        from fuzzytrack.plotting import plot_track, plot_tracks

        if self.measured.ndim > 2 and truth is None and "track" not in options:
            return plot_tracks(self, **options)[0]
        return plot_track(self, truth, **options)[0]

    def _repr_html_(self) -> str:
        """Number of plots, and what was made of them, for notebooks."""
        steps, *batch, n_axes = self.measured.shape
        seen = ~np.isnan(self.measured).any(axis=-1)
        told = {
            "steps": f"{steps}",
            "tracks": " × ".join(map(str, batch)) or "1",
            "axes": f"{n_axes}",
            "plots": f"{int(seen.sum())}, {int((~seen).sum())} missed",
        }
        if steps:
            told["time (s)"] = f"{as_text(np.min(self.time))} to {as_text(np.max(self.time))}"
        if "innovation" in self.kept:
            squares = np.square(self.innovation).sum(axis=-1)
            known = squares[~np.isnan(squares)]
            told["RMS of innovations"] = as_text(np.sqrt(known.mean())) if len(known) else ""
        if "gains" in self.kept:
            for letter, gain in (("α", self.gains.alpha), ("β", self.gains.beta)):
                used = gain[~np.isnan(gain)]
                told[f"mean {letter}"] = as_text(used.mean()) if len(used) else ""
        return block("Tracks" if batch else "Track", facts(told))

    @property
    def kept(self) -> tuple[str, ...]:
        """Names of the outputs that were kept."""
        return tuple(name for name in KEPT + ON_REQUEST if name in self.__dict__)

    @property
    def coasted(self) -> NDArray[np.bool_]:
        """Where the track was carried on without a plot."""
        return np.isnan(self.innovation) & ~np.isnan(self.predicted)

    @property
    def _over_ground(self) -> Array:
        return velocity_over_ground(self.predicted, self.filtered, self.velocity)

    @property
    def speed(self) -> Array:
        """Speed over ground (m/s), shape (n_steps, ...batch): of the first two axes.

        NaN if it is unknown. Needs `predicted`, `filtered` and `velocity`, and two axes.
        """
        from fuzzytrack.io import motion

        return motion.speed(self._over_ground)

    @property
    def course(self) -> Array:
        """Course over ground, shape (n_steps, ...batch): degrees clockwise from north, [0, 360).

        The first two axes point east and north. NaN if it is unknown, or the target stands still.
        Needs `predicted`, `filtered` and `velocity`, and two axes.
        """
        from fuzzytrack.io import motion

        return motion.course(self._over_ground)


def velocity_over_ground(predicted: Array, filtered: Array, velocity: Array) -> Array:
    """Velocity on the first two axes, NaN where it is not known yet.

    Parameters
    ----------
    predicted, filtered, velocity : ndarray, shape (..., n_axes)
        Of a result.

    Raises
    ------
    ValueError
        If there are fewer than two axes.
    """
    if velocity.ndim < 2 or velocity.shape[-1] < 2:
        raise ValueError(
            f"velocity: shape {velocity.shape}; speed and course need two axes, east and north"
        )
    ground, none = velocity[..., :2], np.isnan(predicted[..., :2])
    # Of an axis that has just started; the two may start at different plots.
    still = none & (ground == 0)
    unknown = still.all(axis=-1) | (still.any(axis=-1) & ~none.all(axis=-1))
    unknown |= np.isnan(filtered[..., :2]).any(axis=-1)
    return np.where(unknown[..., None], np.nan, ground)


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
