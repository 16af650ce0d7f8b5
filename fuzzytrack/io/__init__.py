"""Files of plots and tracks: CSV, and Parquet with the extra ``parquet``."""

from fuzzytrack.io.files import check_output, whole_file
from fuzzytrack.io.recording import Piece, find_columns, read_pieces, recording_files
from fuzzytrack.io.table import Table, read_table, write_table
from fuzzytrack.io.tracks import Recording, Track, read_tracks

__all__ = [
    "Piece",
    "Recording",
    "Table",
    "Track",
    "check_output",
    "find_columns",
    "read_pieces",
    "read_table",
    "read_tracks",
    "recording_files",
    "whole_file",
    "write_table",
]
