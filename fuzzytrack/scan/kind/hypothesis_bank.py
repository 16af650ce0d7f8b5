"""Four explanations of the plots of a track that does not move, against one that does."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.clock import OWN_X, OWN_Y
from fuzzytrack.scan.kind.base import MOVING, STATIC, UNDECIDED, Kind, KindKernels, kinds
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.plot_columns import (
    LOG_DENSITY,
    LOG_LIKELIHOOD,
    PLOT_TIME,
    PLOT_X,
    PLOT_Y,
)
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import HITS, KIND, MOTION, SCORE, TIME, X, Y

__all__ = ["HypothesisBank"]

#: Places in the memory: log-likelihood ratios of moving to each hypothesis, mean of the plots,
#: smoothed logarithm of the density, hit ratio, last plot, and position of the radar then.
_STEADY, _LOOSE, _WANDER, _ARC, _MEAN_X, _MEAN_Y, _CLUTTER, _RATIO = range(8)
_LAST_X, _LAST_Y, _LAST_OWN_X, _LAST_OWN_Y, _MEMORY = range(8, 13)
_LOG_TAU = math.log(2.0 * math.pi)
#: Log-likelihood of an arc where the position of the radar is not known; a number, so that sums of
#: it are numbers.
_NEVER = -1e300
#: Log-density (plots/m² and scan) at which clutter says nothing of the kind.
_NEUTRAL = math.log(1e-5)


def normal(dx: float, dy: float, variance: float) -> float:
    """Logarithm of a normal density of two axes with one variance."""
    return -0.5 * (dx * dx + dy * dy) / variance - _LOG_TAU - math.log(variance)


@kinds.register("hypothesis-bank")
@dataclass(frozen=True, repr=False)
class HypothesisBank(Kind):
    """Whether a track moves, by the likelihood of its plots if it does not.

    At each plot after the first, ``E ← fade·E + ln N(ν; 0, S) - ln N(plot | hypothesis)`` for a
    steady echo, a loose one, an echo that wanders, and one on an arc around the radar. With
    ``B = ln Σ exp(-E) + clutter_weight·(smoothed ln λ - ln 1e-5)`` and the hit ratio ρ, it is
    moving if ``B + miss_weight·(1 - ρ)`` falls below ``-moving``, and no longer if it exceeds
    `withdrawn`. The evidence of motion is -B. Where the position of the radar is not known, there
    is no hypothesis of an arc.

    An echo that is steadier than all four counts as moving by its likelihood, and is confirmed and
    kept as such. It is reported as static from `static_hits` plots on while its position is within
    `rest` of their mean.
    """

    source: ClassVar[str] = "first study, step 10; second study, changes (c) and (d)"

    steady: float = parameter(2.31, "spread of a steady echo", "m", least=0, above=True)
    loose: float = parameter(3.44, "spread of a loose echo", "m", least=0, above=True)
    wander: float = parameter(9.68, "way of an echo that wanders, in a period", "m", least=0,
                              above=True)  # fmt: skip
    arc_range: float = parameter(2.11, "change of range on an arc", "m", least=0, above=True)
    arc_way: float = parameter(7.63, "way along an arc, in a period", "m", least=0, above=True)
    fade: float = parameter(0.996, "share of the evidence that is kept at a plot", "", least=0,
                            most=1)  # fmt: skip
    clutter_weight: float = parameter(0.3, "weight of the density of clutter", "", least=0)
    moving: float = parameter(0.5, "evidence from which a track is moving", "nats")
    withdrawn: float = parameter(1.5, "evidence against it from which it is no longer", "nats")
    miss_weight: float = parameter(20.0, "weight of missed plots", "nats", least=0)
    ratio_rate: float = parameter(0.12, "rate of the hit ratio", "", least=0, most=1)
    static_margin: float = parameter(-0.25, "margin by which a steady echo explains best", "nats")
    static_score: float = parameter(11.1, "score above which a track can be static", "nats")
    static_hits: int = parameter(13, "plots from which a track can be static", "", least=2,
                                 whole=True)  # fmt: skip
    rest: float = parameter(3.0, "distance from the mean of its plots within which a moving track "
                            "is reported as static", "m", least=0)  # fmt: skip

    @property
    def memory(self) -> int:
        """See the places at the top of the module."""
        return _MEMORY

    def kernels(self, setting: Setting, at: int) -> KindKernels:
        """Kernels of this part."""
        sensor = setting.sensor
        period, noise = sensor.period, 2.0 * sensor.range_noise * sensor.range_noise
        steady, loose = self.steady * self.steady, self.loose * self.loose
        wander = self.wander * self.wander / period
        along, around = self.arc_range * self.arc_range, self.arc_way * self.arc_way / period
        fade, clutter_weight = self.fade, self.clutter_weight
        moving, withdrawn = -self.moving, self.withdrawn
        miss_weight, ratio_rate, rest = self.miss_weight, self.ratio_rate, self.rest
        margin, static_score, static_hits = (
            self.static_margin, self.static_score, float(self.static_hits),
        )  # fmt: skip

        def keep(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            tracks[i, at + _LAST_X], tracks[i, at + _LAST_Y] = plots[j, PLOT_X], plots[j, PLOT_Y]
            tracks[i, at + _LAST_OWN_X] = clock[OWN_X]
            tracks[i, at + _LAST_OWN_Y] = clock[OWN_Y]

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            tracks[i, KIND], tracks[i, MOTION] = UNDECIDED, 0.0
            for k in range(4):
                tracks[i, at + k] = 0.0
            tracks[i, at + _MEAN_X], tracks[i, at + _MEAN_Y] = plots[j, PLOT_X], plots[j, PLOT_Y]
            tracks[i, at + _CLUTTER] = plots[j, LOG_DENSITY]
            tracks[i, at + _RATIO] = 1.0
            keep(tracks, i, plots, j, clock)

        def on_arc(tracks: Any, i: int, plots: Any, j: int, dt: float, clock: Any) -> float:
            """Logarithm of the likelihood of a plot on an arc around the radar."""
            x, y = plots[j, PLOT_X] - clock[OWN_X], plots[j, PLOT_Y] - clock[OWN_Y]
            last_x = tracks[i, at + _LAST_X] - tracks[i, at + _LAST_OWN_X]
            last_y = tracks[i, at + _LAST_Y] - tracks[i, at + _LAST_OWN_Y]
            r, last = math.sqrt(x * x + y * y), math.sqrt(last_x * last_x + last_y * last_y)
            if not (r >= 0.0 and last >= 0.0):
                return _NEVER
            product = r * last
            turn = (last_x * y - last_y * x) / product if product > 0.0 else 0.0
            way = 0.5 * turn * (r + last)
            range_variance = along * (1.0 + 0.3 * dt / period)
            way_variance = around * dt + noise
            change = r - last
            return (
                -0.5 * (change * change / range_variance + way * way / way_variance)
                - _LOG_TAU
                - 0.5 * math.log(range_variance * way_variance)
            )

        def withdraw(tracks: Any, i: int) -> float:
            """Take back that a track moves where evidence is against it; returns the evidence."""
            against = miss_weight * (1.0 - tracks[i, at + _RATIO]) - tracks[i, MOTION]
            if tracks[i, KIND] == MOVING and against > withdrawn:
                tracks[i, KIND] = UNDECIDED
            return against  # type: ignore[no-any-return]

        def decide(tracks: Any, i: int) -> None:
            against = withdraw(tracks, i)
            if against < moving:
                tracks[i, KIND] = MOVING
            if tracks[i, KIND] == MOVING:
                return
            others = min(tracks[i, at + _LOOSE], tracks[i, at + _WANDER])
            if (
                others - tracks[i, at + _STEADY] > margin
                and tracks[i, SCORE] > static_score
                and tracks[i, HITS] >= static_hits
            ):
                tracks[i, KIND] = STATIC

        def reported(tracks: Any, i: int) -> float:
            dx, dy = tracks[i, X] - tracks[i, at + _MEAN_X], tracks[i, Y] - tracks[i, at + _MEAN_Y]
            rests = tracks[i, HITS] >= static_hits and dx * dx + dy * dy < rest * rest
            if rests and tracks[i, KIND] == MOVING:
                return STATIC
            return tracks[i, KIND]  # type: ignore[no-any-return]

        def hit(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            dt = plots[j, PLOT_TIME] - tracks[i, TIME]
            seen = min(tracks[i, HITS] - 1.0, 20.0)
            x, y = plots[j, PLOT_X], plots[j, PLOT_Y]
            from_x, from_y = x - tracks[i, at + _MEAN_X], y - tracks[i, at + _MEAN_Y]
            way_x, way_y = x - tracks[i, at + _LAST_X], y - tracks[i, at + _LAST_Y]
            spread, moved = 1.0 + 1.0 / seen, plots[j, LOG_LIKELIHOOD]
            e1 = fade * tracks[i, at + _STEADY] + moved - normal(from_x, from_y, steady * spread)
            e2 = fade * tracks[i, at + _LOOSE] + moved - normal(from_x, from_y, loose * spread)
            e3 = fade * tracks[i, at + _WANDER] + moved
            e3 -= normal(way_x, way_y, wander * dt + noise)
            e4 = fade * tracks[i, at + _ARC] + moved - on_arc(tracks, i, plots, j, dt, clock)
            tracks[i, at + _STEADY], tracks[i, at + _LOOSE] = e1, e2
            tracks[i, at + _WANDER], tracks[i, at + _ARC] = e3, e4
            rate = max(1.0 / (seen + 1.0), 0.05)
            tracks[i, at + _MEAN_X] += rate * from_x
            tracks[i, at + _MEAN_Y] += rate * from_y
            clutter = 0.7 * tracks[i, at + _CLUTTER] + 0.3 * plots[j, LOG_DENSITY]
            tracks[i, at + _CLUTTER] = clutter
            tracks[i, at + _RATIO] += ratio_rate * (1.0 - tracks[i, at + _RATIO])
            best = min(min(e1, e2), min(e3, e4))
            total = math.exp(best - e1) + math.exp(best - e2)
            total += math.exp(best - e3) + math.exp(best - e4)
            evidence = math.log(total) - best + clutter_weight * (clutter - _NEUTRAL)
            tracks[i, MOTION] = -evidence
            keep(tracks, i, plots, j, clock)
            decide(tracks, i)

        def miss(tracks: Any, i: int, clock: Any) -> None:
            tracks[i, at + _RATIO] -= ratio_rate * tracks[i, at + _RATIO]
            withdraw(tracks, i)

        return KindKernels(start, hit, miss, reported)
