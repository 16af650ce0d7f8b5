"""All targets of a scene, and where they are at the times of its scans."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.scene.clutter import View
from fuzzytrack.simulation.scene.paths import Paths
from fuzzytrack.simulation.scene.scene import Scene
from fuzzytrack.simulation.scene.streams import Streams

__all__ = ["MOST_STATES", "Population"]

Whole = NDArray[np.int64]

#: Most targets times scans, so that a scene cannot ask for more memory than a computer has.
MOST_STATES = 20_000_000


@dataclass(frozen=True, eq=False)
class Population:
    """All targets of a scene; a *state* is one of them at the time of a scan.

    Attributes
    ----------
    paths : Paths
        How they move.
    born : ndarray, shape (n_targets,)
        When they appeared (s).
    group : ndarray of int, shape (n_targets,)
        Number of the group of each, from 0.
    names : tuple of str
        Names of the groups.
    scan, target : ndarray of int, shape (n_states,)
        States, scan by scan: number of the scan, and of the target, from 0.
    position, velocity : ndarray, shape (n_states, 2)
        Of each state (m, m/s).
    """

    paths: Paths
    born: Array
    group: Whole
    names: tuple[str, ...]
    scan: Whole
    target: Whole
    position: Array
    velocity: Array

    def __repr__(self) -> str:
        return summary(self, targets=len(self.born), states=len(self.scan))

    @classmethod
    def drawn(cls, scene: Scene, view: View, seed: int) -> Population:
        """Draw the targets of a scene.

        Raises
        ------
        ValueError
            If they are too many for the number of scans.
        """
        end, scans = float(view.times[-1]), len(view.times)
        _refuse_too_many(scene, end - view.start, scans)
        parts = [
            group.targets(Streams(seed, "traffic", name), view.start, end, view.region)
            for name, group in scene.traffic.items()
        ]
        counts = [len(part) for part in parts]
        born = np.concatenate([part.born for part in parts])
        gone = np.concatenate([part.gone for part in parts])
        paths = Paths.joined([part.paths for part in parts])
        group = np.repeat(np.arange(len(parts)), counts)
        # Scan by scan, since the targets of a scan belong together from here on.
        there = (born <= view.times[:, None]) & (view.times[:, None] < gone)
        scan, target = np.nonzero(there)
        position, velocity = paths.at(target, view.times[scan])
        leaves = np.array([each.leaves == "yes" for each in scene.traffic.values()], bool)
        if leaves.any():
            start, _ = paths.at(np.arange(len(born)), born)
            began_inside = view.region.holds(start)
            stays = _stays(view, scan, target, position, leaves[group], began_inside)
            scan, target = scan[stays], target[stays]
            position, velocity = position[stays], velocity[stays]
        return cls(paths, born, group, tuple(scene.traffic), scan, target, position, velocity)


def _refuse_too_many(scene: Scene, duration: float, scans: int) -> None:
    expected = sum(group.at_start + group.births * duration for group in scene.traffic.values())
    if expected * scans > MOST_STATES:
        raise ValueError(
            f"the scene has {scans} scans of some {expected:.0f} targets, more than {MOST_STATES} "
            "states; simulate fewer scans or targets"
        )


def _stays(
    view: View,
    scan: Whole,
    target: Whole,
    position: Array,
    leaves: NDArray[np.bool_],
    began_inside: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """Which states come before their target, having been in the region, left it."""
    inside = view.region.holds(position)
    first_inside = np.where(began_inside, -1, len(view.times))
    np.minimum.at(first_inside, target[inside], scan[inside])
    out = ~inside & (scan > first_inside[target]) & leaves[target]
    left = np.full(len(leaves), len(view.times))
    np.minimum.at(left, target[out], scan[out])
    return np.asarray(scan < left[target])
