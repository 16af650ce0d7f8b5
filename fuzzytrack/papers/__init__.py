"""Experiments of published papers, rebuilt: their numbers beside ours.

One module a paper, each with a function ``reproduce(runs, seed, progress)``; `PAPERS` names them.
"""

from fuzzytrack.papers.reproduction import PAPERS, Reproduction, Row, reproduce

__all__ = ["PAPERS", "Reproduction", "Row", "reproduce"]
