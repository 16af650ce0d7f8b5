"""Arrays of the caller's that a run writes its results into."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.lanes.layout import GAINS
from fuzzytrack.lanes.plots import PlotLayout
from fuzzytrack.trackers.result import KEPT, TrackResult, checked_keep
from fuzzytrack.trackers.state import Gains

__all__ = ["Out", "OutputArrays"]

#: What `LaneTracker.run` takes as `out`.
Out: TypeAlias = Mapping[str, "NDArray[Any] | Gains"] | TrackResult


@dataclass(frozen=True)
class OutputArrays:
    """Arrays for the results of a run, by names of `fuzzytrack.trackers.result.KEPT`.

    Attributes
    ----------
    given : mapping of str to ndarray or Gains
        The arrays as they were given; not all results need one.
    keep : tuple of str
        Names of all results to keep, in the order of `KEPT`.
    """

    given: Mapping[str, Any]
    keep: tuple[str, ...]

    @classmethod
    def of(cls, out: Out | None, keep: Sequence[str] | None) -> OutputArrays:
        """Arrays from the arguments of a run.

        Raises
        ------
        TypeError
            If `out` is neither a mapping nor a result, or what is given for a name is no array, or
            for the gains no `Gains`.
        ValueError
            If a name is unknown, or is in `out` and not in `keep`.
        """
        if out is None:
            return cls({}, checked_keep(keep))
        given = _by_name(out)
        names = checked_keep(tuple(given), "out")
        if keep is not None:
            names = checked_keep(keep)
            for name in given:
                if name not in names:
                    raise ValueError(
                        f"out: has {name!r}, which is not in keep ({', '.join(names)}); add it "
                        "there, or leave it out of both"
                    )
        if isinstance(out, TrackResult) and "gains" in given and _shared(given["gains"]):
            del given["gains"]
        for name, value in given.items():
            wanted = Gains if name == "gains" else np.ndarray
            if not isinstance(value, wanted) or isinstance(value, np.ma.MaskedArray):
                needed = "a Gains of three arrays" if name == "gains" else "a NumPy array"
                raise TypeError(f"out: {name} must be {needed}, got {type(value).__name__}")
        return cls(given, names)

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of single arrays to keep, those of each gain included."""
        return tuple(part for name in self.keep for part in _parts(name))

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """The given arrays by the names of `parts`."""
        found = {}
        for name, value in self.given.items():
            for part in _parts(name):
                found[part] = getattr(value, part) if name == "gains" else value
        return found

    def check(self, plots: NDArray[Any], **inputs: NDArray[Any]) -> None:
        """Check that results of a run can be written into the arrays.

        Parameters
        ----------
        plots : ndarray
            Their shape and dtype are those of the results.
        **inputs : ndarray
            Plots, times and standard deviations by their names, which must not be overwritten.

        Raises
        ------
        TypeError
            If a gain is no array.
        ValueError
            If an array has another shape, dtype or layout, cannot be written to, or shares memory
            with an input or with another of the arrays.
        """
        arrays = {(f"gains.{n}" if n in GAINS else n): a for n, a in self.arrays.items()}
        for name, array in arrays.items():
            if not isinstance(array, np.ndarray):
                raise TypeError(f"out: {name} must be a NumPy array, got {type(array).__name__}")
            if array.shape != plots.shape:
                raise ValueError(
                    f"out: {name} has shape {array.shape}; results have that of the plots, "
                    f"{plots.shape}"
                )
            if array.dtype != plots.dtype:
                raise ValueError(f"out: {name} is {array.dtype}; this run gives {plots.dtype}")
            if not (array.flags.c_contiguous and array.flags.aligned and array.flags.writeable):
                raise ValueError(
                    f"out: {name} must be C-contiguous, aligned and writeable; give an array as "
                    "from np.empty"
                )
            for other, values in inputs.items():
                if np.shares_memory(array, values):
                    raise ValueError(f"out: {name} shares memory with {other}; give another array")
        for (one, first), (other, second) in combinations(arrays.items(), 2):
            if np.shares_memory(first, second):
                raise ValueError(f"out: {one} and {other} share memory; give two arrays")

    def results(self, raw: Mapping[str, NDArray[Any]], layout: PlotLayout) -> dict[str, Any]:
        """Results of a run by name: the arrays that were given, and new ones for the others.

        Parameters
        ----------
        raw : mapping of str to ndarray
            By the names of `parts`, as the runner returned them: it has written into the given
            arrays, except for gains that the axes of a lane share.
        layout : PlotLayout
            Layout of the plots.
        """
        arrays, results = self.arrays, {}
        for part, values in raw.items():
            shaped = layout.from_lanes(values)
            if part in arrays and arrays[part].size != values.size:
                arrays[part][...] = shaped
            results[part] = arrays.get(part, shaped)
        if "gains" in self.keep:
            gains = Gains(*(results.pop(part) for part in GAINS))
            results["gains"] = self.given.get("gains", gains)
        return results


def _parts(name: str) -> tuple[str, ...]:
    return GAINS if name == "gains" else (name,)


def _shared(gains: Gains) -> bool:
    """Whether gains of a result are views that repeat one number for all axes of a track."""
    return not gains.alpha.flags.writeable


def _by_name(out: Any) -> dict[str, Any]:
    if isinstance(out, TrackResult):
        return {name: getattr(out, name) for name in out.kept if name in KEPT}
    if isinstance(out, Mapping):
        return dict(out)
    raise TypeError(
        f"out must be a mapping from names of results to arrays ({', '.join(KEPT)}), or a "
        f"TrackResult; got {type(out).__name__}"
    )
