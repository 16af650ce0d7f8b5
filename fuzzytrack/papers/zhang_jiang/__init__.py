"""Zhang & Jiang: gains and gates of vessels from the quality factor of their tracks."""

from fuzzytrack.papers.zhang_jiang.reproduction import RUNS, reproduce
from fuzzytrack.papers.zhang_jiang.theory import gate_factor

__all__ = ["RUNS", "gate_factor", "reproduce"]
