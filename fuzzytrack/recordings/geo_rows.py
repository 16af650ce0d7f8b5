"""Rows of the table of tracks put together as tracks on the earth."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.io.geo_track import GeoTrack
from fuzzytrack.io.piece import Piece
from fuzzytrack.recordings.track_table import TrackRows, TrackTable

__all__ = ["GeoRows"]

_NAMES = ("latitude", "longitude", "altitude", "speed", "course")


class GeoRows:
    """Tracks on the earth out of pieces, in order of first appearance.

    Holds all rows, with 40 to 70 bytes each: formats of maps have one track after the other.

    Parameters
    ----------
    table : TrackTable
        Of tracks whose place on the earth is known.
    """

    def __init__(self, table: TrackTable) -> None:
        self._table, self._rows = table, TrackRows(table)
        self._codes: dict[str, int] = {}
        self._parts: list[dict[str, Any]] = []

    def add(self, piece: Piece, outputs: Mapping[str, Array]) -> None:
        """Take one more piece in; see `TrackRows.values`."""
        values = self._rows.values(piece, outputs)
        codes = [self._codes.setdefault(name, len(self._codes)) for name in piece.ids.names]
        part = {name: values[name] for name in _NAMES if name in values}
        part["id"] = np.array(codes, dtype=np.int64)[piece.ids.codes]
        none = np.zeros(len(piece.time), dtype=np.int64)
        part["segment"] = none if piece.segments is None else piece.segments
        if self._table.epoch is not None:
            since = np.round(piece.time * 1e9).astype(np.int64)
            part["time"] = (since + self._table.epoch).astype("datetime64[ns]")
        self._parts.append(part)

    def tracks(self) -> Iterator[GeoTrack]:
        """All tracks, and the parts of each that has several, one after the other."""
        if not self._parts:
            return
        rows = {
            name: np.concatenate([part[name] for part in self._parts]) for name in self._parts[0]
        }
        self._parts.clear()
        ids, segments = rows.pop("id"), rows.pop("segment")
        order = np.lexsort((segments, ids))
        cuts = np.flatnonzero((np.diff(ids[order]) != 0) | (np.diff(segments[order]) != 0)) + 1
        names = list(self._codes)
        for places in np.split(order, cuts) if len(order) else ():
            first = places[0]
            columns = {name: values[places] for name, values in rows.items()}
            yield GeoTrack(id=names[ids[first]], segment=int(segments[first]), **columns)
