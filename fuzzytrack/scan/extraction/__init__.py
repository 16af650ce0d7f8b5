"""Plot extraction: which plots of a scan are used, and which are one."""

from fuzzytrack.scan.extraction.base import Extraction, ExtractionKernels, extractions
from fuzzytrack.scan.extraction.merging import Merging
from fuzzytrack.scan.extraction.none import NoExtraction

__all__ = ["Extraction", "ExtractionKernels", "Merging", "NoExtraction", "extractions"]
