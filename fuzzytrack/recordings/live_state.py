"""The state of a live run in a file: all that is needed to go on as if it had never stopped."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.errors import DataError
from fuzzytrack.io.files import PathLike
from fuzzytrack.recordings.live import LiveTracks
from fuzzytrack.recordings.live_feed import LiveFeed
from fuzzytrack.recordings.recent_rows import RecentRows, Row
from fuzzytrack.recordings.run_state import RunState

__all__ = ["LiveState"]

# Bytes of the digest of an answer.
_DIGEST = 8


class LiveState(RunState):
    """State of a live run of tracks with identities, see `RunState`."""

    format = "fuzzytrack live state"
    version = 2
    run = "track"

    @classmethod
    def of(cls, feed: LiveFeed, written: int) -> LiveState:
        """State of a feed that has begun; the feed can go on meanwhile.

        Parameters
        ----------
        feed : LiveFeed
        written : int
            Bytes of the output so far.
        """
        tracks = feed.tracks
        assert tracks is not None
        read = feed.read
        facts: dict[str, Any] = {
            "options": feed.options,
            "tracker": tracks.prepared.spec,
            "digest": feed.digest,
            "head": feed.head,
            "beginning": feed.beginning,
            "lines": feed.lines,
            "checksum": feed.checksum,
            "written": written,
            "faults": dict(feed.faults.counts),
            "read": {"unnamed": read.unnamed, "impossible": dict(read.impossible)},
            "counts": tracks.counts,
            "ids": tracks.ids,
        }
        ids = facts["ids"]
        arrays = {"numbers": tracks.numbers(ids), **tracks.common()}
        if tracks.lateness:
            arrays |= _rows_of(tracks, ids)
        return cls(json.loads(json.dumps(facts)), arrays)

    def resume(self, feed: LiveFeed, path: PathLike) -> None:
        """Make a feed that has not begun go on from this state.

        Parameters
        ----------
        feed : LiveFeed
        path : str or path
            File of the state, for messages.

        Raises
        ------
        DataError
            If the state is that of another tracker or of other options, or is damaged.
        """
        self.check_options(feed.options, path)
        feed.start(self.facts["head"])
        assert feed.tracks is not None
        if feed.digest != self.facts["digest"]:
            raise DataError(
                f"{path}: was made with the tracker {self.facts['tracker']}, which is not this "
                f"{feed.tracks.prepared.spec}; give the same, or remove it to begin anew"
            )
        try:
            self._put(feed, feed.tracks)
        except (ValueError, KeyError, TypeError, IndexError):
            raise DataError(f"{path}: is damaged; remove it to begin anew") from None

    def _put(self, feed: LiveFeed, tracks: LiveTracks) -> None:
        facts, arrays = self.facts, self.arrays
        ids: list[str] = facts["ids"]
        feed.lines, feed.checksum = self.lines, self.checksum
        feed.beginning = self.beginning
        feed.faults.counts.update(facts["faults"])
        feed.read.unnamed = int(facts["read"]["unnamed"])
        feed.read.impossible = Counter(facts["read"]["impossible"])
        tracks.counts.update(facts["counts"])
        if ids:
            tracks.put(ids, arrays["numbers"])
        tracks.set_common(arrays)
        if tracks.lateness:
            tracks.recent.update(_recent_of(ids, arrays))


def _rows_of(tracks: LiveTracks, ids: Sequence[str]) -> dict[str, NDArray[Any]]:
    """The last rows of tracks as arrays."""
    counts = [len(tracks.recent[id].rows) if id in tracks.recent else 0 for id in ids]
    rows = [row for id in ids if id in tracks.recent for row in tracks.recent[id].rows]
    sigmas = [row.sigma for row in rows if row.sigma is not None]
    cells = json.dumps([row.cell for row in rows]).encode()
    return {
        "row_counts": np.array(counts, dtype=np.int64),
        "row_time": np.array([row.time for row in rows], dtype=np.float64),
        "row_plot": np.array([row.plot for row in rows], dtype=np.float64),
        "row_sigma": np.array(sigmas, dtype=np.float64),
        "row_line": np.array([row.line for row in rows], dtype=np.int64),
        "row_revision": np.array([row.revision for row in rows], dtype=np.int64),
        "row_answer": np.frombuffer(b"".join([row.answer for row in rows]), dtype=np.uint8),
        "row_kept": np.array([row.before is not None for row in rows], dtype=np.bool_),
        "row_before": np.frombuffer(b"".join([row.before or b"" for row in rows])),
        "row_cells": np.frombuffer(cells, dtype=np.uint8),
    }


def _recent_of(ids: Sequence[str], arrays: Mapping[str, NDArray[Any]]) -> dict[str, RecentRows]:
    """The last rows of tracks, out of the arrays of `_rows_of`."""
    times = arrays["row_time"].tolist()
    sigmas: list[Any] = list(map(tuple, arrays["row_sigma"].tolist())) or [None] * len(times)
    answers = arrays["row_answer"].tobytes()
    kept = arrays["row_kept"]
    befores = iter(arrays["row_before"].reshape(int(kept.sum()), -1)) if kept.any() else iter(())
    cells = json.loads(arrays["row_cells"].tobytes())
    rows = [
        Row(
            time,
            tuple(plot),
            sigma,
            cell,
            line,
            answers[k * _DIGEST : (k + 1) * _DIGEST],
            revision,
            next(befores).tobytes() if has else None,
        )
        for k, (time, plot, sigma, cell, line, revision, has) in enumerate(
            zip(
                times,
                arrays["row_plot"].tolist(),
                sigmas,
                cells,
                arrays["row_line"].tolist(),
                arrays["row_revision"].tolist(),
                kept.tolist(),
                strict=True,
            )
        )
    ]
    found, start = {}, 0
    for id, count in zip(ids, arrays["row_counts"].tolist(), strict=True):
        if count:
            found[id] = RecentRows.of(rows[start : start + count])
        start += count
    return found
