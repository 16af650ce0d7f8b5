"""Echoes that a radar cannot resolve."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array

__all__ = ["merged"]


def merged(
    scan: NDArray[np.int64], distance: Array, bearing: Array, range_cell: float, beam: float
) -> tuple[NDArray[np.int64], int]:
    """Number the plots that echoes become.

    Two echoes of a scan that differ by less than the range cell and by less than the beam are in
    one plot; so are those that a chain of such echoes connects, as a plot extractor puts adjacent
    cells together.

    Parameters
    ----------
    scan : ndarray of int, shape (n,)
        Scan of each echo.
    distance, bearing : ndarray, shape (n,)
        Range (m) and bearing (rad).
    range_cell, beam : float
        Resolution (m, rad); with a 0 all echoes are resolved.

    Returns
    -------
    label : ndarray of int, shape (n,)
        Number of the plot of each echo, from 0.
    n_plots : int
    """
    n = len(scan)
    if range_cell == 0 or beam == 0 or n < 2:
        return np.arange(n), n
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    # In units of the cells, the bearing on a circle, and scans two units apart.
    turn = 2 * math.pi / beam
    around = np.mod(np.mod(bearing, 2 * math.pi) / beam, turn)
    places = np.stack([scan * 2.0, distance / range_cell, around], axis=1)
    size = np.array([places[:, 0].max() + 4, places[:, 1].max() + 4, turn])
    pairs = cKDTree(places, boxsize=size).query_pairs(1.0, p=math.inf, output_type="ndarray")
    a, b = pairs.T
    apart = np.abs(around[a] - around[b])
    close = (np.abs(places[a, 1] - places[b, 1]) < 1) & (np.minimum(apart, turn - apart) < 1)
    links = coo_matrix((np.ones(close.sum(), bool), (a[close], b[close])), shape=(n, n))
    count, label = connected_components(links, directed=False)
    return label.astype(np.int64), int(count)
