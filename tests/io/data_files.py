"""Files of plots for the tests of this folder."""

import pyarrow as pa
import pyarrow.parquet as pq

from fuzzytrack.io import Columns, PlotFiles, Reading

#: Columns of the files that `parquet` makes.
XY = Columns("t", "id", ("x", "y"))


def plot_files(*files, **options):
    """Files that are read with some options."""
    return PlotFiles.of([str(file) for file in files], Reading.of(**options))


def pieces_of(*files, rows=None, progress=None, **options):
    """Pieces of such files."""
    return list(plot_files(*files, **options).pieces(rows=rows, progress=progress))


def written(tmp_path, text, name="f.csv"):
    """Write a file; gives its path."""
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def parquet(path, ids, t, x, y=None, row_group_size=None):
    """Write a Parquet file of tracks; gives its path."""
    y = x if y is None else y
    pq.write_table(pa.table({"id": ids, "t": t, "x": x, "y": y}), path, row_group_size)
    return str(path)
