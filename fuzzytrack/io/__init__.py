"""Files of plots and tracks: CSV, and Parquet with the extra ``parquet``; readers of others."""

from fuzzytrack.io.cleaning import Cleaner
from fuzzytrack.io.cleaning_rules import Cleaning, CleaningCounts
from fuzzytrack.io.columns import Columns
from fuzzytrack.io.description import PlotDescription
from fuzzytrack.io.files import check_output, whole_file
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.formats import check_table, open_table, read_table, table_writer, write_table
from fuzzytrack.io.geo_track import GeoTrack
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.plot_files import PlotFiles
from fuzzytrack.io.readers import Reader
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import Recording, Track, read_tracks, recording_files
from fuzzytrack.io.source import Source
from fuzzytrack.io.table import Table, Words
from fuzzytrack.io.text_form import TextForm
from fuzzytrack.io.times import Clock
from fuzzytrack.io.track_formats import write_geo_tracks

__all__ = [
    "Cleaner",
    "Cleaning",
    "CleaningCounts",
    "Clock",
    "Columns",
    "Findings",
    "GeoTrack",
    "Piece",
    "PlotDescription",
    "PlotFiles",
    "Reader",
    "Reading",
    "Recording",
    "Source",
    "Table",
    "TextForm",
    "Track",
    "Words",
    "check_output",
    "check_table",
    "open_table",
    "read_table",
    "read_tracks",
    "recording_files",
    "table_writer",
    "whole_file",
    "write_geo_tracks",
    "write_table",
]
