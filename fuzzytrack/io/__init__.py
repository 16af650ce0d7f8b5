"""Files of plots and tracks: CSV, and Parquet with the extra ``parquet``."""

from fuzzytrack.io.files import check_output, whole_file
from fuzzytrack.io.tables import Table, read_table, write_table
from fuzzytrack.io.tracks import Recording, Track, read_tracks, write_tracks

__all__ = [
    "Recording",
    "Table",
    "Track",
    "check_output",
    "read_table",
    "read_tracks",
    "whole_file",
    "write_table",
    "write_tracks",
]
