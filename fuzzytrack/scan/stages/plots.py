"""First stages of a scan: its plots are checked, arranged, and given a density of clutter."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fuzzytrack.scan.candidates.base import CandidatesKernels
from fuzzytrack.scan.clock import (
    EARLIEST,
    HAS_COVARIANCES,
    HAS_ROWS,
    HAS_STARTS,
    HAS_TIMES,
    LATEST,
    NEW_SCAN,
    OWN_X,
    OWN_Y,
    PLOTS,
    SCAN_TIME,
    WHERE,
    WIDEST,
)
from fuzzytrack.scan.clutter.base import ClutterKernels
from fuzzytrack.scan.extraction.base import ExtractionKernels
from fuzzytrack.scan.plot_columns import (
    DENSITY,
    LOG_DENSITY,
    NOISE,
    PLOT_ROW,
    PLOT_TIME,
    PLOT_WIDTH,
    PLOT_X,
    PLOT_Y,
    R11,
    R12,
    R22,
    RECORDED,
    STARTS,
)
from fuzzytrack.scan.sensor import NoiseKernel
from fuzzytrack.scan.stages.lookahead import AHEAD, fetch_row

__all__ = [
    "BAD_COVARIANCE", "BAD_POSITION", "BAD_TIME", "DONE", "NO_NOISE", "density_stage",
    "plots_stage",
]  # fmt: skip

#: Answers of a stage: done, or what is wrong with the plot that ``WHERE`` names. It has no noise
#: where it is so far away that along and across differ by more than numbers can hold.
DONE, BAD_POSITION, BAD_COVARIANCE, BAD_TIME, NO_NOISE = 0, 1, 2, 3, 5

#: Coordinates (m) and variances (m²) beyond it are refused: cells are counted in whole numbers.
LARGEST = 1e12


def plots_stage(
    extraction: ExtractionKernels, noise: NoiseKernel, candidates: CandidatesKernels
) -> Callable[..., int]:
    """Stage that checks the plots and puts them into the order of the candidates."""
    extract, arrange = extraction.extract, candidates.arrange

    def plots_stage(
        work: Any, positions: Any, covariances: Any, times: Any, may_start: Any, rows: Any
    ) -> int:
        clock, counts, given, plots = work.clock, work.counts, work.given, work.plots
        count = counts[PLOTS]
        with_covariances, with_times = counts[HAS_COVARIANCES] > 0, counts[HAS_TIMES] > 0
        with_starts, with_rows = counts[HAS_STARTS] > 0, counts[HAS_ROWS] > 0
        own_x, own_y, now = clock[OWN_X], clock[OWN_Y], clock[SCAN_TIME]
        for j in range(count):
            counts[WHERE] = j
            x, y = positions[j, 0], positions[j, 1]
            if not (abs(x) <= LARGEST and abs(y) <= LARGEST):
                return BAD_POSITION
            time = now
            if with_times:
                time = times[j]
                if not (abs(time) <= LARGEST and time <= now):
                    return BAD_TIME
            if with_covariances:
                r11, r12, r22 = covariances[j, 0], covariances[j, 1], covariances[j, 2]
                if not (0.0 < r11 <= LARGEST and 0.0 < r22 <= LARGEST and r12 * r12 < r11 * r22):
                    return BAD_COVARIANCE
            else:
                r11, r12, r22 = noise(x, y, own_x, own_y)
                if not r12 * r12 < r11 * r22:
                    return NO_NOISE
            given[j, PLOT_X], given[j, PLOT_Y], given[j, PLOT_TIME] = x, y, time
            given[j, R11], given[j, R12], given[j, R22] = r11, r12, r22
            given[j, PLOT_ROW] = j
            given[j, RECORDED] = rows[j] if with_rows else j
            given[j, STARTS] = 1.0
            if with_starts and may_start[j] == 0:
                given[j, STARTS] = 0.0
        count = extract(given, count, work.integers)
        counts[PLOTS] = count
        arrange(given, count, clock, work.order, work.integers, work.numbers)
        earliest, latest, widest = now, now, 0.0
        if with_times and count > 0:
            latest = given[0, PLOT_TIME]
        for k in range(count):
            fetch_row(given, work.order[min(k + AHEAD, count - 1)], PLOT_WIDTH)
            j = work.order[k]
            for column in range(PLOT_WIDTH):
                plots[k, column] = given[j, column]
            r11, r12, r22 = plots[k, R11], plots[k, R12], plots[k, R22]
            plots[k, NOISE] = math.sqrt(r11 * r22 - r12 * r12)
            half = 0.5 * (r11 - r22)
            wide = 0.5 * (r11 + r22) + math.sqrt(half * half + r12 * r12)
            widest = wide if wide > widest else widest
            time = plots[k, PLOT_TIME]
            earliest = time if time < earliest else earliest
            latest = time if time > latest else latest
            work.track_of[k] = -1
        clock[EARLIEST], clock[LATEST], clock[WIDEST] = earliest, latest, widest
        return DONE

    return plots_stage


def density_stage(clutter: ClutterKernels) -> Callable[..., int]:
    """Stage that finds the density of clutter at each plot."""
    begin, put, read = clutter.begin, clutter.put, clutter.read

    def density_stage(work: Any) -> int:
        clock, cells, plots = work.clock, work.cells, work.plots
        count = work.counts[PLOTS]
        if work.counts[NEW_SCAN] > 0:
            begin(clock, cells)
        for j in range(count):
            put(plots, j, clock, cells)
        for j in range(count):
            density = read(plots, j, clock, cells)
            plots[j, DENSITY], plots[j, LOG_DENSITY] = density, math.log(density)
        return DONE

    return density_stage
