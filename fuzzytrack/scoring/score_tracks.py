"""Tracks scored against the truth, in one call."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.plurals import counted
from fuzzytrack.scoring.clock_lag import Lag, TrackLag, fitted_lag, lag_of
from fuzzytrack.scoring.close_pairs import ClosePairs
from fuzzytrack.scoring.instants import Timing, added_at_ends, make_scene
from fuzzytrack.scoring.metrics import Settings, evaluate, of_kind
from fuzzytrack.scoring.positions import KINDS, Positions
from fuzzytrack.scoring.scored_scene import ScoredScene
from fuzzytrack.scoring.scores import GroupScores, Scores

__all__ = ["Lag", "Lists", "score", "score_positions"]

#: Which objects the truth lists.
Lists = Literal["all", "moving"]

_MOVING = KINDS.index("moving")


def score(
    tracks: Any,
    truth: Any,
    *,
    cutoff: float = 20.0,
    order: float = 2.0,
    within: float = 15.0,
    match: float | None = None,
    window: int = 10,
    lag: Lag = None,
    scans: ArrayLike | Mapping[Any, ArrayLike] | None = None,
    step: float | None = None,
    max_gap: float | None = None,
    truth_lists: Lists = "all",
    moving_above: float | None = None,
) -> Scores:
    """How well tracks fit true positions.

    Parameters
    ----------
    tracks : path, ScanResult, TrackReports, Positions, mapping or tuple
        Tracks: a table as ``fuzzytrack scan`` writes it, or with columns of time, identity and
        position; what a scan tracker reports; a mapping of arrays ``time`` (s), ``id``,
        ``position`` (m), shape (n, n_axes), and maybe ``velocity`` (m/s), ``kind``, ``group`` and
        ``coasting``; or a tuple (time, id, position). A row without a plot is left out where the
        track has a plot at the same time.
    truth : path, Positions, mapping or tuple
        True positions, in the same ways. They may be sampled at other times.
    cutoff, order : float
        Cut-off c (m) and order p of OSPA, OSPA(2) and GOSPA; the similarity of HOTA is 0 at c, and
        tracks that are farther than c from every true object are false.
    within : float
        Largest distance of a track from its true object (m), for the share tracked, the time to the
        first match, breaks and switches.
    match : float, optional
        The same for CLEAR MOT, IDF1 and SIAP; as `within` unless given.
    window : int
        Instants of a window of OSPA(2).
    lag : float, mapping from groups to float, "auto" or None
        Time by which the clock of the tracks is late against that of the truth (s); "auto" fits it
        for each group.
    scans : array_like, or mapping from groups to array_like, optional
        Instants at which tracks and truth are compared (s): those of all scans, the ones without a
        track included; of a ScanResult they are known. Otherwise the times of the rows of tracks,
        with more of them where they are missing; or a grid, where tracks have times of their own.
    step : float, optional
        Time between the instants of such a grid (s).
    max_gap : float, optional
        Longest time between two samples of the truth over which it is interpolated (s); unless
        given, ten times the usual one, or three times that between rows of a track if it is longer.
    truth_lists : {"all", "moving"}
        Whether the truth lists all objects, or moving ones only: then tracks that are static or
        undecided and farther than `cutoff` from every true object are left out of all metrics but
        false-track times.
    moving_above : float, optional
        Tracks are moving if they get from their first row to their last one faster than this (m/s),
        else static, whatever kind they have.

    Returns
    -------
    Scores

    Raises
    ------
    DataError
        If a file does not hold such columns, or tracks and truth have no time in common.
    ValueError
        If an argument is out of range, or shapes do not fit.
    TypeError
        If tracks or truth are nothing of the kind.

    Notes
    -----
    Every metric is described, with its source, on the page "Score tracks against truth".
    """
    from fuzzytrack.scoring.position_files import read_positions

    settings = Settings(cutoff=cutoff, order=order, within=within, match=match, window=window)
    files = (tracks, truth)
    if isinstance(tracks, str | os.PathLike) and isinstance(truth, str | os.PathLike):
        (given, known), notes = read_positions(tracks, truth)
    elif any(isinstance(each, str | os.PathLike) for each in files):
        raise TypeError("tracks and truth: one is a path; expected both to be paths, or neither")
    else:
        given, known = Positions.of(tracks, "tracks"), Positions.of(truth, "truth")
        notes = ()
    if scans is None and hasattr(tracks, "reports"):
        # What a scan tracker found, with the times of all scans.
        scans = tracks.times
    timing = Timing(step=step, max_gap=max_gap)
    return score_positions(
        given,
        known,
        settings,
        timing,
        lag=lag,
        scans=scans,
        truth_lists=truth_lists,
        moving_above=moving_above,
        notes=notes,
    )


def score_positions(
    tracks: Positions,
    truth: Positions,
    settings: Settings,
    timing: Timing,
    *,
    lag: Lag = None,
    scans: ArrayLike | Mapping[Any, ArrayLike] | None = None,
    truth_lists: Lists = "all",
    moving_above: float | None = None,
    notes: tuple[str, ...] = (),
) -> Scores:
    """Score positions; the parameters are those of `score`."""
    if truth_lists not in ("all", "moving"):
        raise ValueError(f"truth_lists: {truth_lists!r}; expected all or moving")
    if tracks.n_axes != truth.n_axes:
        raise ValueError(
            f"tracks and truth: positions have {tracks.n_axes} and {truth.n_axes} axes; expected "
            "equally many"
        )
    if moving_above is not None:
        tracks = _with_kinds(tracks, moving_above)
    elif truth_lists == "moving" and tracks.kind is None:
        raise ValueError(
            "truth_lists: tracks have no kind, so that moving ones are not known; moving_above "
            "finds it by their speed"
        )
    groups = _groups(tracks, truth)
    found = []
    for group in groups:
        mine = tracks if group is None else tracks.of_group(group)
        true = truth if group is None or truth.group is None else truth.of_group(group)
        when = replace(timing, times=_times_of(scans, group), lag=_lag_of(lag, group))
        one = _scored(mine, true, settings, when, lag == "auto", truth_lists)
        found.append(replace(one, name="" if group is None else str(group)))
    return Scores(tuple(found), settings, (*notes, *_notes(found, timing, tracks, truth)))


def _lag_of(lag: Lag, group: object) -> float:
    """Lag of a group (s); 0 where it is fitted, or there is none."""
    found = lag_of(lag, "" if group is None else str(group))
    return 0.0 if found is None or found == "auto" else found


def _times_of(scans: ArrayLike | Mapping[Any, ArrayLike] | None, group: object) -> Array | None:
    if isinstance(scans, Mapping):
        if group not in scans:
            raise ValueError(f"scans: has no group {str(group)!r}; expected times of every group")
        scans = scans[group]
    return None if scans is None else np.asarray(scans, dtype=np.float64)


def _groups(tracks: Positions, truth: Positions) -> list[Any]:
    """Recordings to be scored, in the order of the truth; only None if there is one."""
    if tracks.group is None and truth.group is None:
        return [None]
    if tracks.group is None:
        raise ValueError("tracks: have no group, but the truth has; expected both, or neither")
    source = tracks.group if truth.group is None else truth.group
    names, first = np.unique(source, return_index=True)
    groups = [names[k] for k in np.argsort(first)]
    others = sorted(set(np.unique(tracks.group).tolist()) - set(names.tolist()))
    if others:
        raise DataError(f"truth: has no group {others[0]!r}, for which there are tracks")
    return groups


def _with_kinds(tracks: Positions, above: float) -> Positions:
    """Tracks with a kind by the speed from their first row to their last one."""
    if not 0 < above < math.inf:
        raise ValueError(f"moving_above: must be a finite speed > 0 m/s, got {above:g}")
    if not len(tracks):
        return replace(tracks, kind=np.empty(0, dtype=np.int64))
    keys: list[NDArray[Any]] = [np.unique(tracks.id, return_inverse=True)[1]]
    if tracks.group is not None:
        keys.append(np.unique(tracks.group, return_inverse=True)[1])
    _, id = np.unique(np.stack(keys), axis=1, return_inverse=True)
    order = np.lexsort((tracks.time, id.ravel()))
    id = id.ravel()[order]
    first = np.unique(id, return_index=True)[1]
    last = np.append(first[1:], len(id)) - 1
    begin, end = order[first], order[last]
    way = np.sqrt(((tracks.position[end] - tracks.position[begin]) ** 2).sum(axis=1))
    moving = way > above * (tracks.time[end] - tracks.time[begin])
    kind = np.empty(len(tracks), dtype=np.int64)
    kind[order] = np.where(moving, _MOVING, KINDS.index("static"))[id]
    return replace(tracks, kind=kind)


def _scored(
    tracks: Positions,
    truth: Positions,
    settings: Settings,
    timing: Timing,
    fits: bool,
    truth_lists: Lists,
) -> GroupScores:
    """Metrics of one recording."""
    fitted: TrackLag | None = None
    if fits:
        fitted = fitted_lag(tracks, truth, settings.cutoff, timing)
        timing = replace(timing, lag=fitted.lag)
    whole = make_scene(tracks, truth, timing)
    scene = _listed(whole, settings.cutoff) if truth_lists == "moving" else whole
    metrics, curves = evaluate(scene, settings)
    if scene is not whole:
        every, _ = evaluate(whole, settings)
        metrics |= {name: every[name] for name in metrics if name.startswith(_FALSE)}
    by_kind = {}
    if whole.tracks.kind is not None:
        seen = [kind for kind in (1, 2, 0) if kind in whole.tracks.kind]
        by_kind = {KINDS[kind]: evaluate(of_kind(whole, kind), settings)[0] for kind in seen}
    return GroupScores(
        name="",
        metrics=metrics,
        by_kind=by_kind,
        time=scene.time,
        curves=curves,
        objects=len(np.unique(scene.truth.id)),
        tracks=len(np.unique(scene.tracks.id)),
        lag=timing.lag,
        fitted=fitted,
        left_out=len(whole.tracks) - len(scene.tracks),
        at_ends=0 if timing.times is not None else added_at_ends(whole, tracks),
    )


# Metrics that count tracks of objects that the truth does not list.
_FALSE = ("false_time", "false_per_minute", "moving_false", "static_false")


def _listed(scene: ScoredScene, cutoff: float) -> ScoredScene:
    """The scene without tracks of objects that the truth does not list."""
    assert scene.tracks.kind is not None
    kept = scene.tracks.kind == _MOVING
    kept[ClosePairs.of(scene, cutoff).track_row] = True
    return replace(scene, tracks=scene.tracks.where(kept))


def _notes(
    groups: list[GroupScores], timing: Timing, tracks: Positions, truth: Positions
) -> tuple[str, ...]:
    notes = []
    if tracks.doubles:
        rows = counted(tracks.doubles, "row")
        notes.append(f"tracks: {rows} without a plot left out, at times at which the track has one")
    for group in groups:
        where = f"{group.name}: " if group.name else ""
        if group.fitted is not None:
            notes.append(where + group.fitted.sentence)
        if group.left_out:
            rows = counted(group.left_out, "row")
            notes.append(f"{where}{rows} of static tracks far from the truth left out")
        if group.at_ends == len(group.time) and len(tracks):
            notes.append(
                f"{where}no track has a row within the time of the truth; `lag`, or another column "
                "of time, may be meant"
            )
        elif group.at_ends:
            notes.append(
                f"{where}{counted(group.at_ends, 'instant')} before the first row of tracks or "
                "after the last one, where the truth is known; `scans` says when there were scans"
            )
    if len(truth):
        gap = timing.truth_gap(tracks, truth)
        notes.append(f"the truth is interpolated over gaps of {gap:.3g} s at most")
    return tuple(notes)
