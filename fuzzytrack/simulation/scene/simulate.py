"""Scans of a scene, simulated, with the truth beside them."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.scan.scan import Scan
from fuzzytrack.simulation.noise import check_runs
from fuzzytrack.simulation.scene.clutter import View
from fuzzytrack.simulation.scene.echoes import Echoes
from fuzzytrack.simulation.scene.measurement import clutter_echoes, polar_from, target_echoes
from fuzzytrack.simulation.scene.population import Population
from fuzzytrack.simulation.scene.resolution import merged
from fuzzytrack.simulation.scene.scene import Scene
from fuzzytrack.simulation.scene.streams import Streams
from fuzzytrack.simulation.scene.truth import Truth

__all__ = ["SimulatedScans", "simulate_scans"]

Whole = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SimulatedScans:
    """Simulated scans, and what is true about them.

    Attributes
    ----------
    scans : list of Scan
        What a radar gives: plots without identities, those of a scan in the order of their
        bearings. `Scan.rows` numbers the plots of all scans from 0.
    target_id : ndarray of int, shape (n_plots,)
        Target of each plot; 0 for clutter. Of a merged plot the smallest identity: `truth.plot` has
        all.
    n_echoes : ndarray of int, shape (n_plots,)
        Number of echoes in each plot: more than 1 if they were not resolved.
    clutter : ndarray of int, shape (n_plots,)
        Number of the clutter in the scene, from 0, that a plot comes from; -1 for targets.
    truth : Truth
        Where the targets were at the times of the scans.
    """

    scans: list[Scan]
    target_id: Whole
    n_echoes: Whole
    clutter: Whole
    truth: Truth

    def __repr__(self) -> str:
        return summary(
            self, scans=len(self.scans), plots=len(self.target_id), targets=self.truth.n_targets
        )


def simulate_scans(scene: Scene, seed: int = 0) -> SimulatedScans:
    """Simulate the scans of a scene.

    Parameters
    ----------
    scene : Scene
    seed : int
        Seed of everything that is random, not negative.

    Returns
    -------
    SimulatedScans

    Raises
    ------
    ValueError
        If `seed` is negative, or the scene is too large.

    Examples
    --------
    >>> from fuzzytrack.simulation.scene import (
    ...     Radar, Region, ScanTimes, Scene, TargetGroup, UniformClutter, simulate_scans
    ... )
    >>> scene = Scene(
    ...     "bay",
    ...     ScanTimes(count=20, period=2.5),
    ...     Radar(reach=(50, 5000), sigma_range=5, sigma_bearing=0.003, detection=0.9),
    ...     {"boats": TargetGroup(count=10, speed=(2, 8))},
    ...     {"sea": UniformClutter(count=15)},
    ... )
    >>> simulated = simulate_scans(scene, seed=1)
    >>> len(simulated.scans), simulated.truth.n_targets
    (20, 10)
    """
    check_runs(1, seed)
    clock = Streams(seed, "scans")
    times, durations = scene.scans.times(clock.stream("times"))
    view = View(
        times, scene.scans.start, scene.own.places(scene.scans.start, times), scene.surroundings
    )
    population = Population.drawn(scene, view, seed)
    found, visible = target_echoes(scene, population, view, durations, seed)
    echoes = Echoes.joined([found, *clutter_echoes(scene, view, durations, seed)])
    if scene.scans.lost:
        lost = clock.stream("lost").random(len(times)) < scene.scans.lost
        echoes = echoes.where(~lost[echoes.scan])
    plots = _Plots.of(echoes, scene, view)
    truth_plot = np.full(len(population.scan), -1)
    own = echoes.state >= 0
    truth_plot[echoes.state[own]] = plots.row[own]
    truth = Truth(
        population.scan,
        times[population.scan],
        population.target + 1,
        population.position,
        population.velocity,
        visible,
        truth_plot,
        tuple(population.names[k] for k in population.group),
    )
    first = plots.first
    return SimulatedScans(
        _scans(scene, view, plots),
        echoes.target_id[first],
        plots.count,
        echoes.clutter[first],
        truth,
    )


@dataclass(frozen=True, eq=False)
class _Plots:
    """Plots that echoes became, scan by scan, in the order in which the beam passed them."""

    first: Whole  # the first echo of each plot
    count: Whole  # the number of its echoes
    row: Whole  # the plot of each echo
    scan: Whole
    time: Array
    place: Array

    @classmethod
    def of(cls, echoes: Echoes, scene: Scene, view: View) -> _Plots:
        """Put echoes together that the radar does not resolve."""
        n = len(echoes.scan)
        if scene.radar.resolves_all:
            first = label = np.arange(n)
            count, place = np.ones(n, np.int64), echoes.place + echoes.noise
        else:
            distance, bearing = polar_from(view.own[echoes.scan], echoes.place)
            label, n = merged(
                echoes.scan, distance, bearing, scene.radar.range_cell, scene.radar.beam
            )
            # Echoes of targets come first: a merged plot has the noise of a target if one is in it.
            first = np.full(n, len(label), np.int64)
            np.minimum.at(first, label, np.arange(len(label)))
            count = np.bincount(label, minlength=n)
            sums = [np.bincount(label, axis, minlength=n) for axis in echoes.place.T]
            place = np.stack(sums, axis=1) / count[:, None] + echoes.noise[first]
        scan, time = echoes.scan[first], echoes.time[first]
        # Of an antenna that sees all at once, too, the order must not tell the targets.
        within = (time - view.start) if scene.scans.turning else _bearing(view.own[scan], place)
        order = np.argsort(scan * (2 * within.max(initial=1.0)) + within, kind="stable")
        row_of = np.empty(n, np.int64)
        row_of[order] = np.arange(n)
        return cls(
            first[order], count[order], row_of[label], scan[order], time[order], place[order]
        )


def _bearing(own: Array, places: Array) -> Array:
    return polar_from(own, places)[1]


def _scans(scene: Scene, view: View, plots: _Plots) -> list[Scan]:
    ends = np.searchsorted(plots.scan, np.arange(len(view.times) + 1))
    return [
        Scan(
            float(view.times[k]),
            plots.place[low:high],
            times=plots.time[low:high] if scene.scans.turning else None,
            own=(float(view.own[k, 0]), float(view.own[k, 1])),
            rows=np.arange(low, high),
        )
        for k, (low, high) in enumerate(itertools.pairwise(ends))
    ]
