"""All plots are used as they are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fuzzytrack.scan.extraction.base import Extraction, ExtractionKernels, extractions
from fuzzytrack.scan.setting import Setting

__all__ = ["NoExtraction"]


@extractions.register("none")
@dataclass(frozen=True, repr=False)
class NoExtraction(Extraction):
    """All plots are used as they are."""

    def kernels(self, setting: Setting) -> ExtractionKernels:
        """Kernels of this part."""

        def extract(plots: Any, count: int, integers: Any) -> int:
            return count

        return ExtractionKernels(extract)
