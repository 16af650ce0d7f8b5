"""Any tracker of the package updates the tracks of a scan."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.part import parameter, word
from fuzzytrack.scan.plot_columns import INNOVATION_X, INNOVATION_Y, NOISE, PLOT_TIME
from fuzzytrack.scan.process_noise import process_noise
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import P11, P12, P22, TIME, VX, VY, X, Y
from fuzzytrack.scan.update.base import Predicted, Update, UpdateKernels, updates
from fuzzytrack.scan.update.tracked_states import MEMORY, NEXT, PREDICTED, SLOT, TrackedStates
from fuzzytrack.trackers.catalog import as_tracker

__all__ = ["TrackerUpdate"]


@updates.register("tracker")
@dataclass(frozen=True, repr=False)
class TrackerUpdate(Update):
    """Tracks are those of a tracker of the package: fixed gains, a rule base, Kalman, IMM.

    A scan's predictions and corrections are one call of the tracker each. Between the time of the
    latest plot of a scan and those of others, its prediction is carried on by its velocity. The
    gate uses the tracker's own variance of the prediction where it knows one; else a covariance
    that is corrected in the Joseph form, with the gains that the tracker used, found by what the
    plot changed.
    """

    source: ClassVar[str] = "any gains fit here; second study, section 4, step 7"

    tracker: str = word("kalman-cv:sigma_v=0.117", "tracker, as it is written on the command line")
    acceleration: float = parameter(
        0.117, "standard deviation of the acceleration of a target, for the covariance", "m/s²",
        least=0, above=True,
    )  # fmt: skip

    def __post_init__(self) -> None:
        super().__post_init__()
        as_tracker(self.tracker)

    @property
    def memory(self) -> int:
        """See `fuzzytrack.scan.update.tracked_states`."""
        return MEMORY

    def companion(self, at: int) -> TrackedStates:
        """States of the tracks, in a store of the tracker."""
        return TrackedStates(self.tracker, at)

    def kernels(self, setting: Setting, at: int) -> UpdateKernels:
        """Kernels of this part."""
        noise = process_noise(self.acceleration, setting.sensor.period)
        ahead, after = at + PREDICTED, at + NEXT

        def covariance(tracks: Any, i: int, dt: float) -> tuple[float, float, float]:
            q11, q12, q22 = noise(dt)
            p12, p22 = tracks[i, P12], tracks[i, P22]
            p11 = tracks[i, P11] + dt * (2.0 * p12 + dt * p22) + q11
            return p11, p12 + dt * p22 + q12, p22 + q22

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            tracks[i, at + SLOT], tracks[i, ahead] = -1.0, -math.inf

        def predict(tracks: Any, i: int, dt: float) -> Predicted:
            vx, vy = tracks[i, VX], tracks[i, VY]
            x, y = tracks[i, X] + dt * vx, tracks[i, Y] + dt * vy
            p11, _, _ = covariance(tracks, i, dt)
            p22 = p11
            time = tracks[i, TIME] + dt
            if dt > 0.0 and tracks[i, ahead] > tracks[i, TIME]:
                vx, vy = tracks[i, ahead + 3], tracks[i, ahead + 4]
                more = time - tracks[i, ahead]
                x, y = tracks[i, ahead + 1] + more * vx, tracks[i, ahead + 2] + more * vy
                if tracks[i, ahead + 5] > 0.0 and tracks[i, ahead + 6] > 0.0:
                    # What the tracker knows, which grows in time as the covariance does.
                    there, _, _ = covariance(tracks, i, tracks[i, ahead] - tracks[i, TIME])
                    share = p11 / there
                    p11, p22 = share * tracks[i, ahead + 5], share * tracks[i, ahead + 6]
            return x, y, vx, vy, p11, 0.0, p22

        def velocity_variance(tracks: Any, i: int, dt: float) -> tuple[float, float]:
            _, _, p22 = covariance(tracks, i, dt)
            return p22, p22

        def hit(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            dt = plots[j, PLOT_TIME] - tracks[i, TIME]
            p11, p12, p22 = covariance(tracks, i, dt)
            x, y, vx, vy, _, _, _ = predict(tracks, i, dt)
            dx, dy = plots[j, INNOVATION_X], plots[j, INNOVATION_Y]
            r, square = plots[j, NOISE], dx * dx + dy * dy
            # Gains by what the plot has changed; without an innovation, those of the covariance.
            alpha, g = p11 / (p11 + r), p12 / (p11 + r)
            if square > 1e-12 * r:
                moved = (tracks[i, after] - x) * dx + (tracks[i, after + 1] - y) * dy
                turned = (tracks[i, after + 2] - vx) * dx + (tracks[i, after + 3] - vy) * dy
                alpha, g = moved / square, turned / square
            tracks[i, X], tracks[i, Y] = tracks[i, after], tracks[i, after + 1]
            tracks[i, VX], tracks[i, VY] = tracks[i, after + 2], tracks[i, after + 3]
            kept = 1.0 - alpha
            tracks[i, P11] = kept * kept * p11 + alpha * alpha * r
            # Not negative, so that the gate never shrinks while a track is not seen.
            tracks[i, P12] = max(kept * (p12 - g * p11) + alpha * g * r, 0.0)
            tracks[i, P22] = p22 - 2.0 * g * p12 + g * g * (p11 + r)
            # What was predicted is of no use after the plot.
            tracks[i, ahead] = -math.inf

        return UpdateKernels(start, predict, velocity_variance, hit)
