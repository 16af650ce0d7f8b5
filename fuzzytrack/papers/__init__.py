"""Experiments of published papers, rebuilt, with published and own numbers side by side.

One module for each paper, with a function ``reproduce(runs, seed, progress)``; `PAPERS` names them.
"""

from fuzzytrack.papers.catalog import PAPERS, reproduce
from fuzzytrack.papers.reproduction import Reproduction, Row

__all__ = ["PAPERS", "Reproduction", "Row", "reproduce"]
