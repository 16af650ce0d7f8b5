"""Positions of objects over time, as tracks and as the truth have them: flat columns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary

__all__ = ["KINDS", "Positions"]

#: Words for `Positions.kind`, in the order of its numbers, which are those of a scan tracker.
KINDS = ("undecided", "moving", "static")

# What a user may give, the first three in any case.
_COLUMNS = ("time", "id", "position", "velocity", "kind", "group", "coasting")


@dataclass(frozen=True, eq=False)
class Positions:
    """Where objects were: one row for each object and time, in any order.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Times (s).
    id : ndarray, shape (n,)
        Identity of the object, number or text. It may come back after a while.
    position : ndarray, shape (n, n_axes)
        Positions (m). A row with NaN in it is as if it were not there.
    velocity : ndarray, shape (n, n_axes), optional
        Velocities (m/s); NaN where unknown.
    kind : ndarray of int, shape (n,), optional
        Numbers of the words of `KINDS`.
    group : ndarray, shape (n,), optional
        Recording to which the row belongs, number or text; recordings are scored one by one.
    coasting : ndarray of bool, shape (n,), optional
        Whether a track has no plot in this row, but is predicted.
    doubles : int
        Coasting rows that were left out, since the track has a plot at the same time. A track that
        coasts to the end of a scan may get a plot at that very time in the next one.
    """

    time: Array
    id: NDArray[Any]
    position: Array
    velocity: Array | None = None
    kind: NDArray[np.int64] | None = None
    group: NDArray[Any] | None = None
    coasting: NDArray[np.bool_] | None = None
    doubles: int = 0

    def __repr__(self) -> str:
        return summary(self, rows=len(self), objects=len(np.unique(self.id)))

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.time)

    @property
    def n_axes(self) -> int:
        """Number of coordinates of a position."""
        return int(self.position.shape[1])

    @classmethod
    def make(
        cls,
        name: str,
        time: ArrayLike,
        id: ArrayLike,
        position: ArrayLike,
        velocity: ArrayLike | None = None,
        kind: ArrayLike | None = None,
        group: ArrayLike | None = None,
        coasting: ArrayLike | None = None,
    ) -> Positions:
        """Make them of array-likes, with checks; rows without a position are left out.

        So is a coasting row of a track that has a plot at the same time.

        Parameters
        ----------
        name : str
            What they are, ``tracks`` or ``truth``: the argument that messages name.
        time, id, position, velocity, kind, group, coasting : array_like
            The attributes. Words are allowed as `kind`, and one coordinate as a flat `position`.

        Raises
        ------
        ValueError
            If shapes do not fit, a time is not finite, a position is infinite, a kind is none, or
            an object is at two places at one time.
        """
        times = np.asarray(time, dtype=np.float64)
        if times.ndim != 1:
            raise ValueError(f"{name}: time has shape {times.shape}; expected (n,)")
        columns: dict[str, Any] = {"position": _vectors(name, "position", position, len(times))}
        if velocity is not None:
            columns["velocity"] = _vectors(name, "velocity", velocity, len(times))
            if columns["velocity"].shape != columns["position"].shape:
                raise ValueError(f"{name}: velocity and position have different numbers of axes")
        columns |= {"id": np.asarray(id), "group": None if group is None else np.asarray(group)}
        columns["kind"] = None if kind is None else _kinds(name, np.asarray(kind))
        columns["coasting"] = None if coasting is None else np.asarray(coasting, dtype=np.bool_)
        for each in ("id", "kind", "group", "coasting"):
            found = columns[each]
            if found is not None and found.shape != times.shape:
                raise ValueError(
                    f"{name}: {each} has shape {found.shape}, time {times.shape}; expected as many"
                )
        if not np.isfinite(times).all():
            row = int(np.argmin(np.isfinite(times)))
            raise ValueError(f"{name}: time of row {row} is {times[row]}; expected a finite number")
        if np.isinf(columns["position"]).any():
            row = int(np.argmax(np.isinf(columns["position"]).any(axis=1)))
            raise ValueError(f"{name}: position of row {row} is infinite; expected m, or NaN")
        every = cls(times, **columns)
        known: NDArray[np.bool_] = np.asarray(~np.isnan(every.position).any(axis=1))
        found = every if known.all() else every.where(known)
        return _one_at_a_time(name, found)

    @classmethod
    def of(cls, value: Any, name: str) -> Positions:
        """Positions of what a user has.

        Parameters
        ----------
        value : Positions, mapping, tuple, or object with such attributes
            A mapping from ``time``, ``id``, ``position`` and maybe ``velocity``, ``kind``,
            ``group`` and ``coasting``; a tuple (time, id, position); or what a scan tracker
            reports, or its result, whose tentative tracks are left out.
        name : str
            The argument, for messages.

        Raises
        ------
        TypeError
            If it is none of these.
        ValueError
            As `make`.
        """
        value = getattr(value, "reports", value)
        if isinstance(value, cls):
            made = cls.make(name, *(getattr(value, each) for each in _COLUMNS))
            return replace(made, doubles=value.doubles + made.doubles)
        if isinstance(value, Mapping):
            return cls._of_mapping(value, name)
        if isinstance(value, tuple) and 3 <= len(value) <= len(_COLUMNS):
            return cls.make(name, *value)
        if all(hasattr(value, each) for each in ("time", "track_id", "position", "status")):
            shown = value.where(np.asarray(value.status) > 0)
            return cls.make(
                name,
                shown.time,
                shown.track_id,
                shown.position,
                shown.velocity,
                shown.kind,
                coasting=np.asarray(shown.plot) < 0,
            )
        raise TypeError(
            f"{name}: {type(value).__name__}; expected a path, a mapping of time, id and position, "
            "a tuple (time, id, position), or the reports of a scan tracker"
        )

    @classmethod
    def _of_mapping(cls, value: Mapping[str, Any], name: str) -> Positions:
        wrong = [key for key in value if key not in _COLUMNS]
        missing = [key for key in _COLUMNS[:3] if key not in value]
        if wrong or missing:
            what = f"no {missing[0]!r}" if missing else f"{wrong[0]!r}, which is not known"
            raise ValueError(f"{name}: has {what}; expected {', '.join(_COLUMNS)}")
        return cls.make(name, **value)

    def where(self, rows: NDArray[Any]) -> Positions:
        """Only some rows, by a mask or by numbers."""
        values: dict[str, Any] = {name: getattr(self, name) for name in _COLUMNS}
        chosen: dict[str, Any] = {
            name: None if each is None else each[rows] for name, each in values.items()
        }
        return replace(self, **chosen)

    def of_group(self, group: object) -> Positions:
        """Rows of a recording."""
        assert self.group is not None
        return self.where(self.group == group)


def _vectors(name: str, what: str, values: ArrayLike, rows: int) -> Array:
    found = np.asarray(values, dtype=np.float64)
    if found.ndim == 1 and found.size == rows:
        found = found[:, None]
    if found.ndim != 2 or len(found) != rows or not found.shape[1]:
        raise ValueError(f"{name}: {what} has shape {found.shape}; expected ({rows}, n_axes)")
    return found


def _kinds(name: str, kind: NDArray[Any]) -> NDArray[np.int64]:
    if kind.dtype.kind in "iub":
        wrong: NDArray[np.bool_] = np.asarray((kind < 0) | (kind >= len(KINDS)))
        numbers = kind.astype(np.int64)
    else:
        words = kind.astype(str)
        matches = np.stack([words == word for word in KINDS]) if len(words) else np.ones((3, 0))
        numbers = np.argmax(matches, axis=0).astype(np.int64)
        wrong = np.asarray(~matches.astype(bool).any(axis=0))
    if wrong.any():
        found = kind[int(np.argmax(wrong))]
        raise ValueError(f"{name}: kind {found!r}; expected one of {', '.join(KINDS)}")
    return numbers


def _one_at_a_time(name: str, every: Positions) -> Positions:
    """Leave out coasting rows beside a plot at the same time; refuse other doubles."""
    keys = [np.unique(every.id, return_inverse=True)[1]]
    if every.group is not None:
        keys.append(np.unique(every.group, return_inverse=True)[1])
    coasting = np.zeros(len(every), np.bool_) if every.coasting is None else every.coasting
    # Of an object and a time, rows with a plot are first.
    order = np.lexsort((coasting, every.time, *keys))
    before, after = order[:-1], order[1:]
    same = np.logical_and.reduce([key[after] == key[before] for key in (every.time, *keys)])
    beside = same & coasting[after] & ~coasting[before]
    if (same & ~beside).any():
        row = after[int(np.argmax(same & ~beside))]
        told = ", or a column status that says which row is coasting"
        raise ValueError(
            f"{name}: {every.id[row]} has two positions at time {every.time[row]:.15g}; "
            f"expected one for each object and time{told if every.coasting is None else ''}"
        )
    if not beside.any():
        return every
    kept = np.ones(len(every), np.bool_)
    kept[after[beside]] = False
    return replace(every.where(kept), doubles=int(beside.sum()))
