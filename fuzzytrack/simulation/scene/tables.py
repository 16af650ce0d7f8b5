"""Simulated scans and their truth as the columns of tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.io.polar import cartesian_to_polar
from fuzzytrack.simulation.scene.simulate import SimulatedScans

__all__ = ["plot_table", "scan_table", "truth_table"]

Columns = dict[str, Sequence[str] | Array]


def plot_table(
    simulated: SimulatedScans, *, polar: bool = False, own: bool = False, truth_id: bool = False
) -> Columns:
    """Plots, one row each, scan by scan.

    Parameters
    ----------
    simulated : SimulatedScans
    polar : bool
        With ``range`` (m) and ``azimuth`` (degrees, clockwise from y) from where the radar was at
        the time of the scan.
    own : bool
        With this place, ``own_x`` and ``own_y`` (m).
    truth_id : bool
        With the identity of the target, ``truth_id``; 0 is clutter.

    Returns
    -------
    dict of str to sequence
        ``scan`` from 0, ``t`` (s), ``x``, ``y`` (m), and what was asked for.
    """
    scans = simulated.scans
    counts = [len(each) for each in scans]
    places = np.concatenate([each.positions for each in scans])
    times = np.concatenate(
        [np.full(len(each), each.time) if each.times is None else each.times for each in scans]
    )
    radar = np.repeat(np.array([each.own for each in scans]), counts, axis=0)
    found: Columns = {
        "scan": _whole(np.repeat(np.arange(len(scans)), counts)),
        "t": times,
        "x": places[:, 0],
        "y": places[:, 1],
    }
    if polar:
        relative = cartesian_to_polar(places - radar)
        found["range"] = relative.range
        found["azimuth"] = np.mod(np.degrees(relative.azimuth), 360)
    if own:
        found["own_x"], found["own_y"] = radar.T
    if truth_id:
        found["truth_id"] = _whole(simulated.target_id)
    return found


def truth_table(simulated: SimulatedScans) -> Columns:
    """True targets, one row for each target and scan: ``t``, ``id``, ``x``, ``y``, ``vx``, ``vy``.

    ``group`` is the name of the group of the target, and ``visible`` 1 where it was within reach
    and not hidden.
    """
    truth = simulated.truth
    return {
        "t": truth.time,
        "id": _whole(truth.target_id),
        "x": truth.position[:, 0],
        "y": truth.position[:, 1],
        "vx": truth.velocity[:, 0],
        "vy": truth.velocity[:, 1],
        "group": [truth.groups[each - 1] for each in truth.target_id.tolist()],
        "visible": _whole(truth.visible.astype(np.int64)),
    }


def scan_table(simulated: SimulatedScans) -> Columns:
    """Scans, those without plots, too: ``scan`` from 0, ``t``, ``own_x``, ``own_y``, ``plots``."""
    scans = simulated.scans
    places = np.array([each.own for each in scans])
    return {
        "scan": _whole(np.arange(len(scans))),
        "t": np.array([each.time for each in scans]),
        "own_x": places[:, 0],
        "own_y": places[:, 1],
        "plots": _whole(np.array([len(each) for each in scans])),
    }


def _whole(values: np.ndarray[tuple[int, ...], np.dtype[np.int64]]) -> list[str]:
    """Whole numbers as text: columns of numbers have decimals."""
    return [str(each) for each in values.tolist()]
