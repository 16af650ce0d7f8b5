"""Recorded tracks of any lengths, as many as there are: at once, in pieces, or in partitions."""

from fuzzytrack.recordings.ragged import run_tracks
from fuzzytrack.recordings.streaming import run_iter
from fuzzytrack.recordings.track_writer import write_tracks

__all__ = ["run_iter", "run_tracks", "write_tracks"]
