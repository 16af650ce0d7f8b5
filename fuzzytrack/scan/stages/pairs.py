"""Stages that find which plots may be those of which track, and choose among them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fuzzytrack.scan.association.base import AssociationKernels
from fuzzytrack.scan.candidates.base import CandidatesKernels
from fuzzytrack.scan.clock import (
    EARLIEST,
    EDGES,
    HAS_COVARIANCES,
    HAS_DUE,
    HAS_TIMES,
    LATEST,
    OWN_X,
    OWN_Y,
    PLOTS,
    ROWS,
    WIDEST,
)
from fuzzytrack.scan.gate.base import GateKernels
from fuzzytrack.scan.initiation.base import InitiationKernels
from fuzzytrack.scan.plot_columns import PLOT_TIME, PLOT_X, PLOT_Y, R11, R12, R22
from fuzzytrack.scan.sensor import NoiseKernel
from fuzzytrack.scan.stages.lookahead import AHEAD, fetch_row
from fuzzytrack.scan.stages.plots import DONE
from fuzzytrack.scan.track_columns import P22, STATUS, TIME
from fuzzytrack.scan.update.base import UpdateKernels

__all__ = ["MORE_EDGES", "MOST_EDGES", "assignment_stage", "log_likelihood", "pairs_stage"]

#: Answer of a stage: there is no room for all edges.
MORE_EDGES = 4
#: A track keeps this many candidates, those of the least cost.
MOST_EDGES = 16

_LOG_TAU = math.log(2.0 * math.pi)


def log_likelihood(dx: float, dy: float, s11: float, s12: float, s22: float) -> float:
    """Logarithm of the normal density of an innovation (1/m²)."""
    determinant = s11 * s22 - s12 * s12
    square = (s22 * dx * dx - 2.0 * s12 * dx * dy + s11 * dy * dy) / determinant
    return -0.5 * (square + math.log(determinant)) - _LOG_TAU


def pairs_stage(
    update: UpdateKernels, gate: GateKernels, initiation: InitiationKernels,
    candidates: CandidatesKernels, association: AssociationKernels, noise: NoiseKernel,
) -> Callable[..., int]:  # fmt: skip
    """Stage that writes the edges of all tracks."""
    predict, reach, distance = update.predict, gate.reach, gate.distance
    accept, near, cost = initiation.accept, candidates.near, association.cost

    def widest_near(x: float, y: float, size: float, clock: Any) -> float:
        """Largest variance of a plot no farther than `size` from a place, by range and bearing."""
        widest: float = clock[WIDEST]
        dx, dy = x - clock[OWN_X], y - clock[OWN_Y]
        r11, _, r22 = noise(math.sqrt(dx * dx + dy * dy) + size, 0.0, 0.0, 0.0)
        wide = r11 if r11 > r22 else r22
        return wide if wide < widest else widest

    def keep(begin: int, end: int, plot: int, price: float, edge_plot: Any, edge_cost: Any) -> int:
        """Add an edge to those of a track, or put it in place of its worst one; the new end."""
        if end - begin < MOST_EDGES:
            edge_plot[end], edge_cost[end] = plot, price
            return end + 1
        worst = begin
        for e in range(begin + 1, end):
            if edge_cost[e] > edge_cost[worst]:
                worst = e
        if price < edge_cost[worst]:
            edge_plot[worst], edge_cost[worst] = plot, price
        return end

    def pairs_stage(work: Any) -> int:
        tracks, plots, clock, counts = work.tracks, work.plots, work.clock, work.counts
        first, plot_of, found, due = work.first, work.plot_of, work.found, work.due
        edge_plot, edge_cost = work.edge_plot, work.edge_cost
        integers, numbers = work.integers, work.numbers
        rows, count, latest = counts[ROWS], counts[PLOTS], clock[LATEST]
        span = latest - clock[EARLIEST]
        widest, range_noise = clock[WIDEST], counts[HAS_COVARIANCES] == 0
        some_due, own_times = counts[HAS_DUE] > 0, counts[HAS_TIMES] > 0
        end = 0
        for i in range(rows):
            fetch_row(tracks, i + AHEAD, P22 + 1)
            first[i] = end
            plot_of[i] = -1
            if tracks[i, STATUS] == 0.0 or (some_due and due[i] == 0) or count == 0:
                continue
            if len(edge_plot) - end < MOST_EDGES:
                counts[EDGES] = end
                return MORE_EDGES
            dt = latest - tracks[i, TIME]
            if not dt > 0.0:
                continue
            x, y, vx, vy, p11, p12, p22 = predict(tracks, i, dt)
            half = 0.5 * (p11 - p22)
            spread = 0.5 * (p11 + p22) + math.sqrt(half * half + p12 * p12)
            farthest = reach(tracks, i, x, y, clock, spread + widest)
            if range_noise:
                noisy = spread + widest_near(x, y, farthest, clock)
                farthest = reach(tracks, i, x, y, clock, noisy)
            if own_times:
                farthest += span * math.sqrt(vx * vx + vy * vy)
            found[0] = i
            n = near(x, y, farthest, plots, count, clock, integers, numbers, found)
            for k in range(n):
                j = found[k]
                if own_times and plots[j, PLOT_TIME] != latest:
                    dt = plots[j, PLOT_TIME] - tracks[i, TIME]
                    if not dt > 0.0:
                        continue
                    x, y, vx, vy, p11, p12, p22 = predict(tracks, i, dt)
                elif own_times:
                    dt = latest - tracks[i, TIME]
                    x, y, vx, vy, p11, p12, p22 = predict(tracks, i, dt)
                dx, dy = plots[j, PLOT_X] - x, plots[j, PLOT_Y] - y
                if dx * dx + dy * dy > farthest * farthest and not own_times:
                    continue
                s11, s12, s22 = p11 + plots[j, R11], p12 + plots[j, R12], p22 + plots[j, R22]
                away = distance(tracks, i, plots, j, clock, dx, dy, s11, s12, s22)
                if away >= 0.0 and accept(tracks, i, plots, j, dt, dx, dy):
                    likelihood = log_likelihood(dx, dy, s11, s12, s22)
                    price = cost(tracks, i, plots, j, away, likelihood)
                    end = keep(first[i], end, j, price, edge_plot, edge_cost)
        first[rows] = end
        counts[EDGES] = end
        return DONE

    return pairs_stage


def assignment_stage(association: AssociationKernels) -> Callable[..., int]:
    """Stage that chooses pairs among the edges."""
    assign = association.assign

    def assignment_stage(work: Any) -> int:
        assign(
            work.counts[ROWS], work.counts[PLOTS], work.first, work.edge_plot, work.edge_cost,
            work.plot_of, work.track_of, work.integers, work.numbers,
        )  # fmt: skip
        return DONE

    return assignment_stage
