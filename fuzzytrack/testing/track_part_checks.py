"""What the parts of a scan tracker promise that work on tracks: from update to report."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from fuzzytrack.scan import plot_columns as p
from fuzzytrack.scan import track_columns as t
from fuzzytrack.scan.confirmation.base import CONFIRM, END, KEEP, Confirmation
from fuzzytrack.scan.identity.base import Identity
from fuzzytrack.scan.initiation.base import Initiation
from fuzzytrack.scan.kind.base import MOVING, STATIC, UNDECIDED, Kind
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.quality.base import Quality
from fuzzytrack.scan.report.base import Report
from fuzzytrack.scan.update.base import Update
from fuzzytrack.testing.part_samples import PERIOD, World
from fuzzytrack.testing.samples import expect

__all__ = ["TRACK_PART_CHECKS"]

_SCANS = 40


def update_predicts_from_the_last_plot(part: Update, seed: int) -> None:
    """A prediction over no time is the state; it changes nothing, and has a covariance."""
    for world, kernels, j in _lives(part, seed):
        before = world.tracks.copy()
        now = kernels.predict(world.tracks, 0, 0.0)
        row = world.tracks[0]
        expect(
            np.allclose(now[:4], row[[t.X, t.Y, t.VX, t.VY]], rtol=1e-12, atol=1e-12),
            f"a prediction over 0 s must be the state, got {now[:4]}",
        )
        for dt in (0.0, PERIOD, 10 * PERIOD):
            found = kernels.predict(world.tracks, 0, dt)
            expect(bool(np.isfinite(found).all()), f"a prediction over {dt} s must be finite")
            p11, p12, p22 = found[4:]
            expect(
                p11 > 0.0 and p22 > 0.0 and p11 * p22 >= p12 * p12,
                f"the covariance of a position must be positive, got {found[4:]}",
            )
            speeds = kernels.velocity_variance(world.tracks, 0, dt)
            expect(min(speeds) >= 0.0, f"variances of velocities must not be < 0, got {speeds}")
        expect(np.array_equal(before, world.tracks), "a prediction must not change the track")
        kernels.hit(world.tracks, 0, world.plots, j, world.clock)
        state = world.tracks[0, [t.X, t.Y, t.VX, t.VY, t.P11, t.P12, t.P22]]
        expect(bool(np.isfinite(state).all()), f"an updated track must be finite, got {state}")


def quality_goes_with_plots(part: Quality, seed: int) -> None:
    """A likely plot does not make a track worse, a missed one not better."""
    for world, kernels, j in _lives(part, seed):
        before = world.tracks[0, t.SCORE]
        hit = j % 3 != 0
        if hit:
            kernels.hit(world.tracks, 0, world.plots, j, world.clock)
        else:
            world.tracks[0, t.HITS] -= 1.0
            world.tracks[0, t.MISSES] += 1.0
            kernels.miss(world.tracks, 0, world.clock)
        after, existence = world.tracks[0, t.SCORE], kernels.existence(world.tracks, 0)
        expect(math.isfinite(after), f"the score must be finite, got {after}")
        expect(
            after >= before if hit else after <= before,
            f"the score goes from {before:g} to {after:g} "
            f"{'by a likely plot' if hit else 'in a scan without a plot'}",
        )
        expect(
            math.isnan(existence) or 0.0 <= existence <= 1.0,
            f"existence must be a probability, or NaN; got {existence}",
        )


def kind_is_one_of_three(part: Kind, seed: int) -> None:
    """A track is undecided, moving or static, and the evidence that it moves is a number."""
    for world, kernels, j in _lives(part, seed):
        if j % 5:
            kernels.hit(world.tracks, 0, world.plots, j, world.clock)
        else:
            world.tracks[0, t.MISSES] += 1.0
            kernels.miss(world.tracks, 0, world.clock)
        found, evidence = world.tracks[0, t.KIND], world.tracks[0, t.MOTION]
        expect(found in (UNDECIDED, MOVING, STATIC), f"KIND must be 0, 1 or 2, got {found}")
        told = kernels.reported(world.tracks, 0)
        expect(told in (UNDECIDED, MOVING, STATIC), f"reported must be 0, 1 or 2, got {told}")
        expect(not math.isnan(evidence), "MOTION must be a number")


def initiation_starts_at_the_plot(part: Initiation, seed: int) -> None:
    """A new track is at its plot with a covariance, and its next plot may be there again."""
    for world, kernels, j in _lives(part, seed):
        world.begin_track(j)
        world.tracks[0, t.X : t.P22 + 1] = np.nan
        kernels.start(world.tracks, 0, world.plots, j, world.clock)
        row = world.tracks[0]
        expect(
            (row[t.X], row[t.Y]) == (world.plots[j, p.PLOT_X], world.plots[j, p.PLOT_Y]),
            "a track must begin at its plot",
        )
        expect(bool(np.isfinite(row[t.VX : t.P22 + 1]).all()), "a new track must be finite")
        p11, p12, p22 = row[t.P11 : t.P22 + 1]
        expect(
            p11 > 0.0 and p22 >= 0.0 and p11 * p22 >= p12 * p12,
            f"the covariance of a new track must be positive, got {(p11, p12, p22)}",
        )
        answer = kernels.accept(world.tracks, 0, world.plots, j, PERIOD, 0.0, 0.0)
        expect(bool(answer), "a plot at the predicted position must be accepted")
        world.tracks[0, t.HITS] = 2.0
        kernels.second(world.tracks, 0, world.plots, j, PERIOD)
        expect(bool(np.isfinite(world.tracks[0]).all()), "a track of two plots must be finite")


def confirmation_ends_what_is_lost(part: Confirmation, seed: int) -> None:
    """Every track is kept, confirmed or ended, and one that is never seen again ends."""
    for world, kernels, j in _lives(part, seed):
        kernels.hit(world.tracks, 0, world.plots, j, world.clock)
        for status in (1.0, 2.0):
            world.tracks[0, t.STATUS] = status
            answer = kernels.decide(world.tracks, 0, world.clock)
            expect(answer in (KEEP, CONFIRM, END), f"decide must answer 0, 1 or 2, got {answer!r}")
    for status in (1.0, 2.0):
        world = World(part, seed)
        kernels = world.kernels
        world.begin_scan(0)
        world.begin_track()
        kernels.start(world.tracks, 0, world.plots, 0, world.clock)
        world.tracks[0, t.STATUS] = status
        ends = False
        for number in range(1, 1001):
            world.begin_scan(number)
            world.tracks[0, t.MISSES] += 1.0
            world.tracks[0, t.SCORE] -= 1.0
            ends = ends or kernels.decide(world.tracks, 0, world.clock) == END
        expect(ends, "a track without a plot in 1,000 scans must end, or memory has no bound")


def identity_is_its_own_or_of_a_lost_track(part: Identity, seed: int) -> None:
    """A confirmed track gets its own identity or that of a track that has ended, each once."""
    world = World(part, seed)
    end, confirm = world.kernels
    kept = np.zeros(part.numbers)
    lost: set[float] = set()
    for number in range(60):
        world.begin_scan(number)
        world.begin_track(number % 40)
        own = float(number + 1)
        world.tracks[0, t.ID], world.tracks[0, t.STATUS] = own, 2.0
        got = float(confirm(world.tracks, 0, world.clock, kept))
        expect(
            got == own or got in lost,
            f"the identity must be that of the track, {own:g}, or of one that has ended; got {got}",
        )
        lost.discard(got)
        world.tracks[0, t.ID] = got
        if number % 2:
            end(world.tracks, 0, world.clock, kept)
            lost.add(got)


def report_answers_yes_or_no(part: Report, seed: int) -> None:
    """Whether a track is shown depends on the track alone."""
    for world, kernels, _ in _lives(part, seed):
        world.tracks[0, t.STATUS] = 2.0
        for kind in (UNDECIDED, MOVING, STATIC):
            world.tracks[0, t.KIND] = kind
            before = world.tracks.copy()
            answers = {bool(kernels.shown(world.tracks, 0, world.clock)) for _ in range(2)}
            expect(len(answers) == 1, "the same track must give the same answer")
            expect(np.array_equal(before, world.tracks), "a report must not change the track")


def _lives(part: Part, seed: int) -> Iterator[tuple[World, Any, int]]:
    """A track from scan to scan: what the kernels of a part see at each plot, before they do."""
    world = World(part, seed)
    kernels = world.kernels
    world.begin_scan(0)
    world.begin_track()
    if hasattr(kernels, "start"):
        kernels.start(world.tracks, 0, world.plots, 0, world.clock)
    for number in range(1, _SCANS):
        j = number % 40
        world.begin_scan(number)
        world.put_plot(j, *world.random.normal(0.0, 2.0, 2))
        world.count_hit(j)
        yield world, kernels, j
        if world.tracks[0, t.MISSES] > 0.0:
            world.end_miss()
        else:
            world.end_hit(j)


#: Checks of the parts of each role, by the base class of the role.
TRACK_PART_CHECKS: dict[type[Part], dict[str, Callable[[Any, int], None]]] = {
    Update: {"update-predicts-from-last-plot": update_predicts_from_the_last_plot},
    Quality: {"quality-goes-with-plots": quality_goes_with_plots},
    Kind: {"kind-is-one-of-three": kind_is_one_of_three},
    Initiation: {"initiation-starts-at-plot": initiation_starts_at_the_plot},
    Confirmation: {"confirmation-ends-what-is-lost": confirmation_ends_what_is_lost},
    Identity: {"identity-is-own-or-of-lost-track": identity_is_its_own_or_of_a_lost_track},
    Report: {"report-answers-yes-or-no": report_answers_yes_or_no},
}
