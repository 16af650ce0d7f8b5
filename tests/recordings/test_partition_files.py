import numpy as np
import pytest

from fuzzytrack.io import Piece, Words
from fuzzytrack.recordings.partition_files import partition_of, read_partition, write_partitions


def table(pieces):
    """Rows of pieces: number, identity, time, plots."""
    return [
        (int(row), piece.ids.names[code], time, tuple(plot))
        for piece in pieces
        for row, code, time, plot in zip(
            piece.rows, piece.ids.codes, piece.time, piece.plots, strict=True
        )
    ]


@pytest.mark.parametrize("rows", [1, 4, 100])
def test_partitions_hold_every_row_once(tmp_path, rows):
    rng = np.random.default_rng(3)
    whole = Piece.of(rng.integers(0, 20, 60), np.arange(60), rng.normal(size=(60, 2)))
    ids = whole.ids
    pieces = [
        Piece(Words(ids.names, ids.codes[cut]), whole.time[cut], whole.plots[cut], whole.rows[cut])
        for cut in (slice(0, 7), slice(7, 8), slice(8, 60))
    ]
    path = tmp_path / "p.parquet"
    write_partitions(path, pieces, 2, 3)
    seen = []
    for partition in range(3):
        found = list(read_partition(path, 2, partition, 3, file="f.parquet", rows=rows))
        assert all(piece.file == "f.parquet" and len(piece.time) for piece in found)
        rows_found = table(found)
        assert rows_found == sorted(rows_found)
        assert {partition_of(row[1], 3) for row in rows_found} <= {partition}
        seen += rows_found
    assert sorted(seen) == table([whole])


def test_partitions_are_the_same_everywhere():
    # The check value of CRC-32, as its specifications have it.
    assert partition_of("123456789", 2**32) == 0xCBF43926
    assert partition_of("é", 16) in range(16)
