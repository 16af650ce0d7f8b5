"""Tracks that their gate has started again: each start is a new segment of its track."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from fuzzytrack.arrays import Mask
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.recording import Track
from fuzzytrack.recordings.judged import Judged
from fuzzytrack.trackers.result import TrackResult
from fuzzytrack.trackers.state import Gains

__all__ = ["Restarts", "divided", "part_of"]


class Restarts:
    """Counts the starts of every track, from piece to piece."""

    def __init__(self) -> None:
        self._so_far: Counter[str] = Counter()

    def of(self, ids: Sequence[str]) -> list[int]:
        """Starts of some identities so far."""
        return [self._so_far[id] for id in ids]

    def total(self) -> int:
        """Starts of all identities so far."""
        return self._so_far.total()

    def put(self, ids: Sequence[str], starts: Sequence[int]) -> None:
        """Set the starts of some identities; those of none take no memory."""
        for id, count in zip(ids, starts, strict=True):
            if count:
                self._so_far[id] = count
            else:
                self._so_far.pop(id, None)

    def advance(self, piece: Piece, begins: Mask) -> Piece:
        """Number the segments of a piece anew.

        Parameters
        ----------
        piece : Piece
            The rows of each track in order of time.
        begins : ndarray of bool, shape (n_rows,)
            Rows at which a track starts again.
        """
        if not self._so_far and not begins.any():
            return piece
        codes, names = piece.ids.codes, piece.ids.names
        order = np.argsort(codes, kind="stable")
        # Starts up to each row, over all tracks, less those of the tracks before.
        running = np.cumsum(begins[order])
        starts = np.searchsorted(codes[order], np.arange(len(names)))
        before = np.concatenate([[0], running])[starts]
        more = np.empty(len(codes), dtype=np.int64)
        more[order] = running - before[codes[order]]
        known = np.array([self._so_far[name] for name in names], dtype=np.int64)
        segments = known[codes] + more + (0 if piece.segments is None else piece.segments)
        counts = np.bincount(codes[begins], minlength=len(names))
        self._so_far.update({names[k]: int(counts[k]) for k in np.flatnonzero(counts).tolist()})
        return replace(piece, segments=segments)


def divided(
    tracks: Sequence[Track], judged: Sequence[Judged], findings: Findings
) -> tuple[tuple[Track, ...], tuple[TrackResult, ...]]:
    """Divide tracks where they start again, and number the segments of each identity anew.

    Parameters
    ----------
    tracks : sequence of Track
        The segments of an identity in order.
    judged : sequence of Judged
        Result of each.
    findings : Findings
        Gets the counts of plots that were rejected and of tracks that started again.
    """
    parts, results = [], []
    for track, one in zip(tracks, judged, strict=True):
        findings.rejected += int(one.rejected.sum())
        findings.restarts += int(one.begins.sum())
        edges = [0, *np.flatnonzero(one.begins).tolist(), len(track.time)]
        for start, end in pairwise(edges):
            rows = slice(start, end)
            parts.append(track.part(rows))
            results.append(part_of(one.result, rows))
    seen: Counter[str] = Counter()
    numbered = []
    for part in parts:
        numbered.append(replace(part, segment=seen[part.id]))
        seen[part.id] += 1
    return tuple(numbered), tuple(results)


def part_of(result: TrackResult, rows: slice) -> TrackResult:
    """Some rows of a result that follow each other, without a state."""
    if rows == slice(0, len(result.time)):
        return result
    kept: dict[str, Any] = {
        name: getattr(result, name)[rows] for name in result.kept if name != "gains"
    }
    if "gains" in result.kept:
        gains = result.gains
        kept["gains"] = Gains(gains.alpha[rows], gains.beta[rows], gains.gamma[rows])
    return TrackResult.of(result.time[rows], result.measured[rows], None, kept)
