"""Stages that follow tracks, end them, and start new ones."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fuzzytrack.scan.clock import (
    FREE,
    HAS_DUE,
    NEXT_ID,
    PLOTS,
    ROWS,
    SCAN_TIME,
)
from fuzzytrack.scan.clutter.base import ClutterKernels
from fuzzytrack.scan.confirmation.base import CONFIRM, END, ConfirmationKernels
from fuzzytrack.scan.identity.base import IdentityKernels
from fuzzytrack.scan.initiation.base import InitiationKernels
from fuzzytrack.scan.kind.base import KindKernels
from fuzzytrack.scan.plot_columns import (
    INNOVATION_X,
    INNOVATION_Y,
    LOG_DENSITY,
    LOG_LIKELIHOOD,
    PLOT_TIME,
    PLOT_WIDTH,
    PLOT_X,
    PLOT_Y,
    R11,
    R12,
    R22,
    RECORDED,
    STARTS,
    STRENGTH,
)
from fuzzytrack.scan.quality.base import QualityKernels
from fuzzytrack.scan.stages.lookahead import AHEAD, fetch_row
from fuzzytrack.scan.stages.pairs import log_likelihood
from fuzzytrack.scan.stages.plots import DONE
from fuzzytrack.scan.track_columns import (
    FIXED,
    HITS,
    ID,
    LOOKED,
    MISSES,
    PLOT,
    STATUS,
    TIME,
)
from fuzzytrack.scan.update.base import UpdateKernels

__all__ = ["CONFIRMED", "follow_stage", "start_stage"]

TENTATIVE, CONFIRMED = 1.0, 2.0
#: Columns after the fixed ones that most tracks need: those of the kind, and the first of clutter.
_MEMORY = 15


def follow_stage(
    update: UpdateKernels, quality: QualityKernels, kind: KindKernels,
    initiation: InitiationKernels, confirmation: ConfirmationKernels, identity: IdentityKernels,
    clutter: ClutterKernels, detection: float,
) -> Callable[..., int]:  # fmt: skip
    """Stage that updates tracks by their plots, confirms and ends them."""
    predict, update_hit, second = update.predict, update.hit, initiation.second
    quality_hit, quality_miss = quality.hit, quality.miss
    kind_hit, kind_miss = kind.hit, kind.miss
    confirmation_hit, decide = confirmation.hit, confirmation.decide
    identity_end, identity_confirm = identity.end, identity.confirm
    clutter_hit, clutter_miss, clutter_end = clutter.hit, clutter.miss, clutter.end
    log_detection = math.log(detection)

    def judge_plot(tracks: Any, i: int, plots: Any, j: int) -> float:
        """Innovation and likelihood of the plot of a track; the time since its last one."""
        dt = plots[j, PLOT_TIME] - tracks[i, TIME]
        x, y, _, _, p11, p12, p22 = predict(tracks, i, dt)
        dx, dy = plots[j, PLOT_X] - x, plots[j, PLOT_Y] - y
        likelihood = log_likelihood(
            dx, dy, p11 + plots[j, R11], p12 + plots[j, R12], p22 + plots[j, R22]
        )
        plots[j, INNOVATION_X], plots[j, INNOVATION_Y] = dx, dy
        plots[j, LOG_LIKELIHOOD] = likelihood
        plots[j, STRENGTH] = log_detection + likelihood - plots[j, LOG_DENSITY]
        return dt  # type: ignore[no-any-return]

    def hit(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
        dt = judge_plot(tracks, i, plots, j)
        tracks[i, HITS] += 1.0
        tracks[i, MISSES] = 0.0
        # The update goes by the quality that the track had before, which its gate went by, too.
        if tracks[i, HITS] != 2.0 or not second(tracks, i, plots, j, dt):
            update_hit(tracks, i, plots, j, clock)
        quality_hit(tracks, i, plots, j, clock)
        kind_hit(tracks, i, plots, j, clock)
        confirmation_hit(tracks, i, plots, j, clock)
        tracks[i, TIME] = tracks[i, LOOKED] = plots[j, PLOT_TIME]
        tracks[i, PLOT] = plots[j, RECORDED]

    def miss(tracks: Any, i: int, clock: Any) -> None:
        tracks[i, MISSES] += 1.0
        quality_miss(tracks, i, clock)
        kind_miss(tracks, i, clock)
        tracks[i, LOOKED] = clock[SCAN_TIME]
        tracks[i, PLOT] = -1.0

    def follow_stage(work: Any) -> int:
        tracks, plots, clock, counts = work.tracks, work.plots, work.clock, work.counts
        cells, kept, plot_of, due = work.cells, work.kept, work.plot_of, work.due
        rows, some_due, free = counts[ROWS], counts[HAS_DUE] > 0, work.free
        n, width = 0, min(tracks.shape[1], FIXED + _MEMORY)
        for i in range(rows):
            fetch_row(tracks, i + AHEAD, width)
            fetch_row(plots, plot_of[min(i + AHEAD, rows - 1)], PLOT_WIDTH)
            status = tracks[i, STATUS]
            if status == 0.0:
                free[n] = i
                n += 1
                continue
            if some_due and due[i] == 0:
                tracks[i, PLOT] = -1.0
                continue
            j = plot_of[i]
            if j >= 0:
                hit(tracks, i, plots, j, clock)
            else:
                miss(tracks, i, clock)
            answer = decide(tracks, i, clock)
            if answer == CONFIRM:
                tracks[i, STATUS] = CONFIRMED
                tracks[i, ID] = identity_confirm(tracks, i, clock, kept)
            if j >= 0:
                clutter_hit(tracks, i, plots, j, status, clock, cells)
            else:
                clutter_miss(tracks, i, clock, cells)
            if answer == END:
                clutter_end(tracks, i, clock, cells)
                if status == CONFIRMED:
                    identity_end(tracks, i, clock, kept)
                tracks[i, STATUS] = 0.0
                free[n] = i
                n += 1
        counts[FREE] = n
        return DONE

    return follow_stage


def start_stage(
    update: UpdateKernels, quality: QualityKernels, kind: KindKernels,
    initiation: InitiationKernels, confirmation: ConfirmationKernels, identity: IdentityKernels,
    clutter: ClutterKernels,
) -> Callable[..., int]:  # fmt: skip
    """Stage that starts tracks at the plots that are left."""
    initiation_start, update_start = initiation.start, update.start
    quality_start, kind_start = quality.start, kind.start
    confirmation_start, decide = confirmation.start, confirmation.decide
    identity_confirm = identity.confirm
    clutter_start, clutter_leave, clutter_drop = clutter.start, clutter.leave, clutter.drop

    def begin(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> int:
        tracks[i, STATUS], tracks[i, HITS], tracks[i, MISSES] = TENTATIVE, 1.0, 0.0
        tracks[i, TIME] = tracks[i, LOOKED] = plots[j, PLOT_TIME]
        tracks[i, PLOT] = plots[j, RECORDED]
        initiation_start(tracks, i, plots, j, clock)
        quality_start(tracks, i, plots, j, clock)
        kind_start(tracks, i, plots, j, clock)
        update_start(tracks, i, plots, j, clock)
        confirmation_start(tracks, i, plots, j, clock)
        return decide(tracks, i, clock)

    def start_stage(work: Any) -> int:
        tracks, plots, clock, counts = work.tracks, work.plots, work.clock, work.counts
        cells, free, due = work.cells, work.free, work.due
        track_of, order, some_due = work.track_of, work.order, counts[HAS_DUE] > 0
        number = work.found
        used, n_free, confirmed = 0, counts[FREE], 0
        # Free rows at the end are forgotten.
        while n_free > 0 and free[n_free - 1] == counts[ROWS] - 1:
            n_free -= 1
            counts[ROWS] -= 1
        for j in range(counts[PLOTS]):
            number[order[j]] = 0
            if track_of[j] >= 0:
                continue
            if plots[j, STARTS] == 0.0:
                clutter_leave(plots, j, clock, cells)
                continue
            i = free[used] if used < n_free else counts[ROWS]
            answer = begin(tracks, i, plots, j, clock)
            if answer == END:
                tracks[i, STATUS] = 0.0
                clutter_drop(plots, j, clock, cells)
                continue
            if used < n_free:
                used += 1
            else:
                counts[ROWS] = i + 1
            track_of[j] = i
            if answer == CONFIRM:
                tracks[i, STATUS] = CONFIRMED
                confirmed += 1
            clutter_start(tracks, i, plots, j, clock, cells)
            number[order[j]] = 1
            if some_due:
                due[i] = 1
        counts[FREE] = n_free - used
        number_new(work, confirmed)
        return DONE

    def number_new(work: Any, confirmed: int) -> None:
        """Give new tracks their identities in the order of the plots that were given."""
        tracks, counts, track_of = work.tracks, work.counts, work.track_of
        number, order, count = work.found, work.order, counts[PLOTS]
        for k in range(count):
            if number[k] > 0:
                number[k] = counts[NEXT_ID]
                counts[NEXT_ID] += 1
        for j in range(count):
            if number[order[j]] > 0:
                tracks[track_of[j], ID] = number[order[j]]
        if confirmed == 0:
            return
        for j in range(count):
            number[order[j]] = track_of[j] if number[order[j]] > 0 else -1
        for k in range(count):
            i = number[k]
            if i >= 0 and tracks[i, STATUS] == CONFIRMED:
                tracks[i, ID] = identity_confirm(tracks, i, work.clock, work.kept)

    return start_stage
