"""What the parts of a scan tracker promise that work on plots: from extraction to association."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from fuzzytrack.scan import plot_columns as p
from fuzzytrack.scan import track_columns as t
from fuzzytrack.scan.association.base import Association
from fuzzytrack.scan.candidates.base import Candidates
from fuzzytrack.scan.clutter.base import Clutter
from fuzzytrack.scan.extraction.base import Extraction
from fuzzytrack.scan.gate.base import Gate
from fuzzytrack.scan.kind.base import MOVING
from fuzzytrack.scan.part import Part
from fuzzytrack.testing.part_samples import World
from fuzzytrack.testing.samples import expect

__all__ = ["PLOT_PART_CHECKS"]

#: Innovations (m).
_OFFSETS = ((0.0, 0.0), (0.3, -0.2), (3.0, 4.0), (-30.0, 10.0), (1e3, 1e3), (0.0, 1e7))
_SCANS = 60


def extraction_keeps_plots_in_front(part: Extraction, seed: int) -> None:
    """As many plots as it says are in front, all of them finite, and none comes of none."""
    world = World(part, seed)
    extract = part.kernels(world.setting).extract
    for count in (0, 1, 2, 40):
        plots = world.sample_plots(count)
        if count == 40:
            plots[20:, :2] = plots[:20, :2] + 1e-3
        given = plots.copy()
        left = extract(plots, count, np.zeros(4 * max(count, 1), dtype=np.int64))
        expect(
            left == int(left) and min(count, 1) <= left <= count,
            f"extract must keep 1 to {count} of {count} plots, got {left}",
        )
        kept = plots[: int(left)]
        expect(bool(np.isfinite(kept).all()), "extract must leave finite plots")
        rows, before = kept[:, p.PLOT_ROW], set(given[:, p.PLOT_ROW].tolist())
        expect(
            len(set(rows.tolist())) == len(rows) and set(rows.tolist()) <= before,
            "extract must keep the row of a plot that was given, of each one once",
        )


def candidates_miss_none_within_reach(part: Candidates, seed: int) -> None:
    """Each plot within reach is found once, and the order holds each plot once."""
    world = World(part, seed)
    arrange, near = part.kernels(world.setting)
    for count in (0, 1, 40):
        plots = world.sample_plots(count)
        integers = np.zeros(part.integers(count), dtype=np.int64)
        numbers, order = np.zeros(part.numbers(count)), np.full(count, -1, dtype=np.int64)
        arrange(plots, count, world.clock, order, integers, numbers)
        expect(
            sorted(order.tolist()) == list(range(count)),
            "arrange must write each plot to the order once",
        )
        plots = plots[order]
        for x, y, reach in (*world.random.uniform(-500, 500, (20, 3)), (1e6, 0.0, 50.0)):
            reach = abs(reach)
            found = np.full(max(count, 1), -1, dtype=np.int64)
            n = near(x, y, reach, plots, count, world.clock, integers, numbers, found)
            rows = found[: int(n)].tolist()
            expect(
                0 <= n <= count and len(set(rows)) == n and all(0 <= j < count for j in rows),
                f"near must write rows of plots, each once, got {rows}",
            )
            distance = np.hypot(plots[:, p.PLOT_X] - x, plots[:, p.PLOT_Y] - y)
            missing = set(np.flatnonzero(distance < reach).tolist()) - set(rows)
            expect(
                not missing or part.may_miss,
                f"near must find all plots within reach; missing are {sorted(missing)}",
            )


def gate_accepts_its_own_plot(part: Gate, seed: int) -> None:
    """A plot at the predicted position is accepted, and none beyond the reach or far away."""
    world = World(part, seed)
    reach, distance = world.kernels
    for number, j in enumerate(range(0, 40, 4)):
        world.begin_scan(number)
        world.begin_track(j)
        # As much noise as a track has after some, or many, scans.
        for spread in (1.0, 30.0):
            plot = world.plots[j]
            own = spread * world.tracks[0, t.P11]
            world.tracks[0, t.P11] = own
            s = plot[p.R11] + own, plot[p.R12], plot[p.R22] + own
            middle, half = 0.5 * (s[0] + s[2]), 0.5 * (s[0] - s[2])
            largest = middle + math.hypot(half, s[1])
            x, y = world.tracks[0, t.X], world.tracks[0, t.Y]
            bound = reach(world.tracks, 0, x, y, world.clock, largest)
            expect(bound >= 0.0, f"reach must be a distance >= 0, got {bound}")
            for dx, dy in _OFFSETS:
                far = distance(world.tracks, 0, world.plots, j, world.clock, dx, dy, *s)
                expect(
                    far == -1.0 or (far >= 0.0 and math.isfinite(far)),
                    f"distance must be finite and >= 0, or -1 where it is refused; got {far}",
                )
                size = math.hypot(dx, dy)
                if size == 0.0:
                    expect(far >= 0.0, "a plot at the predicted position must be accepted")
                expect(
                    far < 0.0 or size <= bound * (1 + 1e-12),
                    f"a plot at {size:g} m is accepted, farther than the reach of {bound:g} m",
                )


def association_is_one_to_one(part: Association, seed: int) -> None:
    """Each track gets one plot at most, each plot one track, along the edges that are given."""
    world = World(part, seed)
    assign = part.kernels(world.setting).assign
    for rows, count, first, plot, cost in _edges(world.random):
        answers = []
        for _ in range(2):
            edges = first.copy(), plot.copy(), cost.copy()
            plot_of, track_of = (np.full(n, -1, dtype=np.int64) for n in (rows, count))
            integers = np.zeros(part.integers(rows, count, len(plot)), dtype=np.int64)
            numbers = np.zeros(part.numbers(rows, count, len(plot)))
            assign(rows, count, *edges, plot_of, track_of, integers, numbers)
            answers.append((plot_of, track_of))
        expect(all(map(np.array_equal, *answers)), "the same edges must give the same pairs twice")
        pairs = {(i, int(plot_of[i])) for i in range(rows) if plot_of[i] >= 0}
        back = {(int(track_of[j]), j) for j in range(count) if track_of[j] >= 0}
        expect(pairs == back, "plot_of and track_of must hold the same pairs")
        allowed = {(i, int(j)) for i in range(rows) for j in plot[first[i] : first[i + 1]]}
        expect(pairs <= allowed, f"pairs must be edges; {sorted(pairs - allowed)} are none")
        expect(bool(pairs) or not allowed, "some track must get a plot where there is an edge")


def association_costs_are_gains(part: Association, seed: int) -> None:
    """The cost of a pair is finite and below 0, which a track without a plot costs."""
    world = World(part, seed)
    cost = part.kernels(world.setting).cost
    world.begin_scan(1)
    world.begin_track()
    for status in (1.0, 2.0):
        world.tracks[0, t.STATUS] = status
        for far in (0.0, 1.0, 15.9):
            for likelihood in (-300.0, -10.0, -1.0, 5.0):
                found = cost(world.tracks, 0, world.plots, 0, far, likelihood)
                expect(-math.inf < found < 0.0, f"cost must be finite and below 0, got {found}")


def _edges(random: Any) -> Iterator[tuple[int, int, Any, Any, Any]]:
    """Random problems, also of many tracks at few plots, and empty ones."""
    for rows, count, share in ((0, 0, 0), (0, 3, 1), (3, 0, 1), (1, 1, 1), (12, 15, 0.2),
                               (40, 4, 0.9), (5, 60, 0.9), (30, 30, 0.0)):  # fmt: skip
        there = random.random((rows, count)) < share
        first = np.concatenate([[0], np.cumsum(there.sum(axis=1))]).astype(np.int64)
        plot = np.nonzero(there)[1].astype(np.int64)
        yield rows, count, first, plot, -random.uniform(0.001, 20.0, len(plot))


def density_is_positive(part: Clutter, seed: int) -> None:
    """The density is finite and positive at every plot and place, whatever became of the plots."""
    world = World(part, seed)
    kernels, cells = world.kernels, np.zeros(part.numbers)
    for number in range(_SCANS):
        world.begin_scan(number)
        world.plots = world.sample_plots(40)
        world.begin_scan(number)
        kernels.begin(world.clock, cells)
        for j in range(40):
            kernels.put(world.plots, j, world.clock, cells)
        for j in range(40):
            _expect_density(kernels.read(world.plots, j, world.clock, cells))
        for x, y in ((0.0, 0.0), (-1e7, 1e7), *world.random.uniform(-1e3, 1e3, (5, 2))):
            _expect_density(kernels.density(x, y, world.clock, cells))
        _fates(world, kernels, cells, number)


def _fates(world: World, kernels: Any, cells: Any, number: int) -> None:
    """All that may become of plots and tracks."""
    clock, tracks, plots = world.clock, world.tracks, world.plots
    if number % 6 == 0:
        world.begin_track(0)
        tracks[0, t.SCORE] = -3.0
        kernels.start(tracks, 0, plots, 0, clock, cells)
    elif number % 6 in (1, 2, 4):
        before = tracks[0, t.STATUS]
        tracks[0, t.SCORE] += 4.0
        if number % 12 == 4:
            tracks[0, t.STATUS], tracks[0, t.KIND] = 2.0, MOVING
        kernels.hit(tracks, 0, plots, 0, before, clock, cells)
    else:
        tracks[0, t.SCORE] -= 2.0
        kernels.miss(tracks, 0, clock, cells)
        if number % 6 == 5:
            kernels.end(tracks, 0, clock, cells)
    for j in range(1, 40, 3):
        kernels.drop(plots, j, clock, cells)


def _expect_density(density: float) -> None:
    expect(
        0.0 < density < math.inf,
        f"a density of clutter must be finite and > 0, got {density}",
    )


#: Checks of the parts of each role, by the base class of the role.
PLOT_PART_CHECKS: dict[type[Part], dict[str, Callable[[Any, int], None]]] = {
    Extraction: {"extraction-keeps-plots-in-front": extraction_keeps_plots_in_front},
    Clutter: {"density-is-positive": density_is_positive},
    Candidates: {"candidates-miss-none-within-reach": candidates_miss_none_within_reach},
    Gate: {"gate-accepts-own-plot": gate_accepts_its_own_plot},
    Association: {
        "association-is-one-to-one": association_is_one_to_one,
        "association-costs-are-gains": association_costs_are_gains,
    },
}
