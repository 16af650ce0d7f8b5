"""Kalman filters as schedulers, and the trackers beside them, against other libraries."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import fuzzytrack as ft
from benchmarks import peers
from benchmarks.report import NotMeasured, Row, Target
from benchmarks.scale import Scale
from benchmarks.timing import ratio, take_turns
from benchmarks.work import difference, times_and_plots, warm
from fuzzytrack.schedulers import KalmanCA, KalmanCV
from fuzzytrack.schedulers.innovation import InnovationScheduler
from fuzzytrack.trackers.imm import InteractingPair

__all__ = ["acceleration", "imm", "kim_lee", "simd", "velocity"]

SECTION = "Kalman filters, batch of two-axis tracks (µs a plot of a track, one thread)"
UNIT = "µs"
AT_LEAST = Target(">=", 20.0)

QUIET, AGILE, STAY = 1.0, 5.0, (0.95, 0.9)
KNOWN = {"sigma_w": peers.SIGMA_W, "velocity_sigma": peers.VELOCITY_SIGMA}
EXACT = "The same model and start"


def _velocity_tracker() -> ft.AlphaBetaTracker:
    return ft.AlphaBetaTracker(KalmanCV(QUIET, **KNOWN), start="one-point")


def velocity(scale: Scale) -> list[Row]:
    """Nearly constant velocity."""
    model = peers.Model(2, QUIET)
    theirs = {"FilterPy KalmanFilter": lambda: peers.filterpy_kalman(model),
              "Stone Soup Kalman": lambda: peers.stonesoup_kalman(model)}  # fmt: skip
    return _against(scale, "Kalman CV", _velocity_tracker(), theirs, EXACT)


def acceleration(scale: Scale) -> list[Row]:
    """Nearly constant acceleration."""
    scheduler = KalmanCA(QUIET, peers.ACCELERATION_SIGMA, **KNOWN)
    tracker = ft.AlphaBetaTracker(scheduler, start="one-point")
    theirs = {"FilterPy KalmanFilter": lambda: peers.filterpy_kalman(peers.Model(3, QUIET))}
    return _against(scale, "Kalman CA", tracker, theirs, EXACT)


def kim_lee(scale: Scale) -> list[Row]:
    """Gains from the last twelve innovations."""
    tracker = ft.AlphaBetaTracker(InnovationScheduler.as_published(), start="one-point")
    theirs = {"FilterPy KalmanFilter": lambda: peers.filterpy_kalman(peers.Model(2, QUIET))}
    note = (
        "FilterPy has no such filter: its Kalman filter without adaptation is used, which has "
        "less to do; not the same result"
    )
    return _against(scale, "Kim-Lee", tracker, theirs, note, sigma=peers.SIGMA_W)


def imm(scale: Scale) -> list[Row]:
    """Two models of nearly constant velocity."""
    tracker = InteractingPair(QUIET, AGILE, *STAY, maneuver="cv", maneuver_start=1 / 3, **KNOWN)

    def theirs() -> peers.Track:
        models = peers.Model(2, QUIET), peers.Model(2, AGILE)
        return peers.filterpy_imm(*models, STAY, 1 / 3)

    note = "The same models and start; fuzzytrack neglects the correlation of axes by mixing"
    return _against(scale, "IMM", tracker, {"FilterPy IMMEstimator": theirs}, note)


def _against(
    scale: Scale,
    what: str,
    tracker: Any,
    theirs: dict[str, Callable[[], peers.Track]],
    note: str,
    sigma: float | None = None,
) -> list[Row]:
    """Rows of a tracker on a batch against peers that follow one track at a time."""
    times, plots = _plots(scale)
    few = [np.ascontiguousarray(plots[:, k]) for k in range(scale.peer_tracks)]
    warm(scale, tracker, 2)
    works: dict[str, Callable[[], Any]] = {"ours": lambda: _last(tracker, times, plots, sigma)}
    tracks, missing = {}, []
    for name, make in theirs.items():
        try:
            tracks[name] = make()
        except NotMeasured as why:
            missing.append(Row(SECTION, f"{what} against {name}", why=str(why)))
            continue
        works[name] = lambda track=tracks[name]: [track(each) for each in few]
    found = take_turns(works, scale.repeats)
    ours = _last(tracker, times, plots, sigma)
    each = 1e6 / (scale.kalman_tracks * scale.steps)
    theirs_each = 1e6 / (scale.peer_tracks * scale.steps)
    rows = []
    for name, track in tracks.items():
        apart = difference(ours[: len(few)], np.array([track(one) for one in few]))
        extrapolated = (
            f"{note}; last positions differ by {apart:.1g} m at most. {name} follows one track at "
            f"a time: it was given {scale.peer_tracks} of the {scale.kalman_tracks:,}, setting up "
            "included, and the rest is extrapolated."
        )
        rows.append(
            Row(SECTION, what, found["ours"].median * each, UNIT, name,
                found[name].median * theirs_each,
                ratio(found[name], found["ours"], theirs_each / each),
                AT_LEAST if name.startswith("FilterPy") else None, extrapolated)
        )  # fmt: skip
    return rows + missing


def simd(scale: Scale) -> list[Row]:
    """A whole batch against simdkalman."""
    tracker, batch = _velocity_tracker(), peers.simdkalman_batch(peers.Model(2, QUIET))
    times, plots = _plots(scale)
    by_track = np.ascontiguousarray(plots.transpose(1, 0, 2))
    warm(scale, tracker, 2)
    found = take_turns(
        {"ours": lambda: _last(tracker, times, plots, None), "simd": lambda: batch(by_track)},
        max(2, scale.repeats // 2),
    )
    each = 1e6 / (scale.kalman_tracks * scale.steps)
    apart = difference(_last(tracker, times, plots, None), batch(by_track))
    return [
        Row(SECTION, "Kalman CV", found["ours"].median * each, UNIT, "simdkalman",
            found["simd"].median * each, ratio(found["simd"], found["ours"]),
            note=f"{EXACT}; last positions differ by {apart:.1g} m at most. simdkalman also gives "
            "the covariance of every step."),
    ]  # fmt: skip


def _plots(scale: Scale) -> tuple[Any, Any]:
    # FilterPy's matrices hold for one time step.
    _, plots = times_and_plots(scale.kalman_tracks, scale.steps, axes=2)
    return np.arange(float(scale.steps)), plots


def _last(tracker: Any, times: Any, plots: Any, sigma: float | None) -> Any:
    return tracker.run(times, plots, sigma, keep=("filtered",), threads=1).filtered[-1]
