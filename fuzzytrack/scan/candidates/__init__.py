"""Candidates: which plots may be those of a track."""

from fuzzytrack.scan.candidates.all_pairs import AllPairs
from fuzzytrack.scan.candidates.base import Candidates, CandidatesKernels, candidates
from fuzzytrack.scan.candidates.grid import GridCandidates
from fuzzytrack.scan.candidates.kd_tree import KdTree
from fuzzytrack.scan.candidates.sectors import SectorCandidates

__all__ = [
    "AllPairs",
    "Candidates",
    "CandidatesKernels",
    "GridCandidates",
    "KdTree",
    "SectorCandidates",
    "candidates",
]
