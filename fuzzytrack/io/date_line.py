"""The date line, at which the longitudes of a track jump from 180 to -180."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array

__all__ = ["cut_at_date_line"]


def cut_at_date_line(longitude: Array) -> list[tuple[Array, Array]]:
    """Cut a track where it crosses the date line.

    Parameters
    ----------
    longitude : ndarray, shape (n,)
        In [-180, 180).

    Returns
    -------
    list of (rows, longitude)
        For each part the rows of its vertices, and their longitudes. A crossing, the end of one
        part and the begin of the next one, is between two rows, or at one on the date line.
    """
    if len(longitude) < 2:
        return [(np.arange(len(longitude), dtype=np.float64), longitude)] * len(longitude)
    step = np.diff(longitude)
    turns = np.where(step > 180, -1, np.where(step < -180, 1, 0))
    # How many times the track has gone round the earth eastward, at each row.
    world = np.concatenate([[0], np.cumsum(turns)])
    crossed = np.flatnonzero(turns)
    share = np.zeros(len(step))
    to_line = 180 - np.abs(longitude)
    share[crossed] = to_line[crossed] / (to_line[crossed] + to_line[crossed + 1])
    crossings = crossed + share[crossed]
    between = crossings[(crossings > crossed) & (crossings < crossed + 1)]
    rows = np.sort(np.concatenate([np.arange(len(longitude)), between]))
    # From each vertex to the next one; a track that leaves the date line is already beyond.
    before = rows[:-1].astype(np.int64)
    beyond = (rows[:-1] > before) | ((turns[before] != 0) & (before + share[before] == before))
    worlds = np.where(beyond, world[before + 1], world[before])
    cuts = [0, *(np.flatnonzero(np.diff(worlds)) + 1).tolist(), len(worlds)]
    return [
        (part := rows[begin : end + 1], _longitude(longitude, world, part, worlds[begin]))
        for begin, end in pairwise(cuts)
    ]


def _longitude(longitude: Array, world: NDArray[np.int64], rows: Array, own: int) -> Array:
    """Longitudes of the vertices of a part, which is in the world `own`."""
    before = rows.astype(np.int64)
    after = np.minimum(before + 1, len(world) - 1)
    # A crossing is between this world and the other one.
    crossing = world[before] + world[after] - own
    other = np.where(rows == before, world[before], crossing)
    line = np.where(other > own, 180.0, -180.0)
    return np.where(other == own, longitude[before], line)
