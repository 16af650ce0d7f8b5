"""Recorded tracks of any lengths, in any number: run as a whole, in pieces, or in partitions."""

from fuzzytrack.recordings.ragged import run_tracks
from fuzzytrack.recordings.streaming import TrackedPiece, run_iter
from fuzzytrack.recordings.totals import Totals
from fuzzytrack.recordings.track_writer import write_tracks

__all__ = ["Totals", "TrackedPiece", "run_iter", "run_tracks", "write_tracks"]
