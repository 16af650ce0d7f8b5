"""Kind of track: whether a track moves."""

from fuzzytrack.scan.kind.base import Kind, KindKernels, kinds
from fuzzytrack.scan.kind.hypothesis_bank import HypothesisBank
from fuzzytrack.scan.kind.none import NoKind

__all__ = ["HypothesisBank", "Kind", "KindKernels", "NoKind", "kinds"]
