"""A large recording to be tracked, and two outputs held against each other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from fuzzytrack.io.recording import recording_files
from fuzzytrack.recordings.partition_files import partition_of

__all__ = ["LIVE", "compare", "make"]

Progress = Callable[[float], None]

#: Tracks that are there at a time.
LIVE = 20_000
# Scans that a track lasts, at least and at most.
LIFE = 200, 800
# Seconds from scan to scan.
SCAN = 4.0
# Share of the plots that are there without a position, and of those that are not there at all.
BLANK, ABSENT = 0.05, 0.05
# Standard deviations: of a plot (m), of the change of velocity from scan to scan (m/s).
NOISE, TURN = 50.0, 5.0
# Rows of a row group; plain bytes of a row, with the length of its identity.
GROUP, ROW = 250_000, 64

_SCHEMA = pa.schema(
    [("track", pa.string()), ("time", pa.float64()), ("x", pa.float64()), ("y", pa.float64())]
)
_HEX = np.array([list(f"{value:02x}".encode()) for value in range(256)], dtype=np.uint8)
_DASHES = [8, 13, 18, 23]
# Pieces of columns as they are needed, and nothing ahead of them.
_READING: dict[str, Any] = {"buffer_size": 1 << 16, "pre_buffer": False}
# Rows of a batch of the file; there are as many of the folder.
_BATCH = 1 << 16


# -------------------------------------------------------------------- making


def make(
    folder: Path, size: float, files: int, live: int, seed: int, progress: Progress
) -> dict[str, Any]:
    """Write a recording of at least so many bytes.

    Its rows are in order of time over all files: scan after scan of `live` tracks. A track lasts
    200 to 800 scans, then another takes its place; so nearly all tracks end, and at 10 GB in 32
    files each goes through one to five of them. Of 100 plots five have no position and five are
    not there at all.

    Nothing is compressed and no column has a dictionary: a row takes 64 bytes, of which 24 are
    time and position, and 40 the identity, of 36 characters as a UUID has. 10 GB are then 158
    million rows of 0.35 million tracks: their states, some 330 bytes each, fit into one process,
    and the output, 1.7 times as large, can be held twice by a disk of 60 GB.
    """
    folder.mkdir(parents=True)
    share = size / files
    rows = written = tracks = 0
    blocks = _blocks(live, seed, int(min(GROUP, share / ROW)))
    for number in range(files):
        path = folder / f"plots-{number:04d}.parquet"
        with (
            open(path, "xb") as stream,
            pq.ParquetWriter(stream, _SCHEMA, compression="none", use_dictionary=False) as writer,
        ):
            while written + stream.tell() < (number + 1) * share:
                table, tracks = next(blocks)
                writer.write_table(table)
                rows += len(table)
                progress((written + stream.tell()) / size)
        written += path.stat().st_size
    return {
        "files": files, "rows": rows, "tracks": tracks, "bytes": written,
        "bytes a row": written / rows,
    }  # fmt: skip


def _blocks(live: int, seed: int, least: int) -> Iterator[tuple[pa.Table, int]]:
    """Whole scans of at least so many rows, and the number of tracks so far."""
    waiting, length = [], 0
    for scan, tracks in _scans(live, seed):
        waiting.append(scan)
        length += len(scan)
        if length >= least:
            yield pa.concat_tables(waiting).combine_chunks(), tracks
            waiting, length = [], 0


def _scans(live: int, seed: int) -> Iterator[tuple[pa.Table, int]]:
    random = np.random.default_rng(seed)
    left = np.zeros(live, dtype=np.int64)
    names = np.empty((live, 36), dtype=np.uint8)
    place, velocity = np.empty((2, live, 2))
    tracks = 0
    for scan in count():
        new = np.flatnonzero(left == 0)
        left[new] = random.integers(LIFE[0], LIFE[1] + 1, len(new))
        names[new] = _names(random, len(new))
        place[new] = random.uniform(-2e5, 2e5, (len(new), 2))
        velocity[new] = random.normal(0.0, 150.0, (len(new), 2))
        tracks += len(new)
        left -= 1
        velocity += random.normal(0.0, TURN, velocity.shape)
        place += SCAN * velocity
        plots = place + random.normal(0.0, NOISE, place.shape)
        plots[random.random(live) < BLANK] = np.nan
        time = SCAN * (scan + np.arange(live) / live)
        seen = random.random(live) >= ABSENT
        yield _table(names[seen], time[seen], plots[seen]), tracks


def _names(random: np.random.Generator, number: int) -> np.ndarray:
    """Identities as UUIDs have them, of random bits."""
    letters = np.full((number, 36), ord("-"), dtype=np.uint8)
    digits = _HEX[random.integers(0, 256, (number, 16))].reshape(number, 32)
    letters[:, np.delete(np.arange(36), _DASHES)] = digits
    return letters


def _table(names: np.ndarray, time: np.ndarray, plots: np.ndarray) -> pa.Table:
    ends = np.arange(0, names.size + 1, 36, dtype=np.int32)
    words = pa.StringArray.from_buffers(len(names), pa.py_buffer(ends), pa.py_buffer(names))
    numbers = [pa.array(values, from_pandas=True) for values in (time, plots[:, 0], plots[:, 1])]
    return pa.Table.from_arrays([words, *numbers], schema=_SCHEMA)


# -------------------------------------------------------------------- comparing


def compare(one: Path, folder: Path, id: str, progress: Progress) -> dict[str, Any]:
    """Whether a file of all tracks and a folder of partitions hold the same, to the last bit.

    Both have their rows in the order of the recording, the folder partition by partition. So both
    are read once, side by side, a batch at a time: the rows of a batch of the file, partition by
    partition, are the next ones of that partition. This asks for more than the same rows by
    identity and time. Numbers are compared as 64 bits: -0.0 is not 0.0.
    """
    parts = [_Rows(Path(path)) for path in recording_files(folder)]
    rows = 0
    with pq.ParquetFile(one, **_READING) as source:
        total = source.metadata.num_rows
        for batch in source.iter_batches(_BATCH):
            shares = _by_partition(batch, id, len(parts))
            for part, wanted in zip(parts, shares, strict=True):
                what = _difference(wanted, part.next(len(wanted)))
                if what:
                    return {"identical": False, "why": f"{part.path.name}: {what}"}
            rows += len(batch)
            progress(rows / total)
    for part in parts:
        if len(part.next(1)):
            return {"identical": False, "why": f"{part.path.name}: has rows that {one.name} lacks"}
    return {"identical": True, "rows": rows, "partitions": len(parts)}


class _Rows:
    """Rows of a Parquet file, any number at a time."""

    def __init__(self, path: Path) -> None:
        self.path = path
        source = pq.ParquetFile(path, **_READING)
        self._batches = source.iter_batches(_BATCH // 8)
        self._ready = source.schema_arrow.empty_table()

    def next(self, number: int) -> pa.Table:
        """The next rows; fewer at the end."""
        while len(self._ready) < number and (batch := next(self._batches, None)) is not None:
            self._ready = pa.concat_tables([self._ready, pa.Table.from_batches([batch])])
        found = self._ready.slice(0, number)
        self._ready = self._ready.slice(number)
        return found


def _by_partition(batch: pa.RecordBatch, id: str, partitions: int) -> Iterator[pa.Table]:
    words = batch.column(id).dictionary_encode()
    of_name = np.array([partition_of(name, partitions) for name in words.dictionary.to_pylist()])
    of_row = of_name[words.indices.to_numpy()]
    ordered = pa.Table.from_batches([batch.take(np.argsort(of_row, kind="stable"))])
    ends = np.cumsum(np.bincount(of_row, minlength=partitions)).tolist()
    for start, end in zip([0, *ends[:-1]], ends, strict=True):
        yield ordered.slice(start, end - start)


def _difference(wanted: pa.Table, found: pa.Table) -> str:
    """The first difference in words; empty if there is none."""
    if not wanted.schema.equals(found.schema):
        return f"columns are {found.schema.names}, not {wanted.schema.names}, or of other types"
    if len(found) < len(wanted):
        return f"ends before {_row(wanted, len(found))}"
    for name in wanted.schema.names:
        ours, theirs = _bits(wanted[name]), _bits(found[name])
        if not ours.equals(theirs):
            pairs = zip(ours.to_pylist(), theirs.to_pylist(), strict=True)
            row = next(k for k, (a, b) in enumerate(pairs) if a != b)
            return f"{name}: {_row(found, row)} in place of {_row(wanted, row)}"
    return ""


def _row(table: pa.Table, row: int) -> str:
    return str(table.slice(row, 1).to_pylist()[0])


def _bits(column: pa.ChunkedArray) -> pa.ChunkedArray:
    if column.type != pa.float64():
        return column
    return pa.chunked_array([chunk.view(pa.int64()) for chunk in column.chunks], pa.int64())
