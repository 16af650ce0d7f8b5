"""Role: which plots of a scan are used, and which are one."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

from fuzzytrack.plugins import Registry
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.setting import Setting

__all__ = ["Extraction", "ExtractionKernels", "extractions"]


class ExtractionKernels(NamedTuple):
    """Kernels of an extraction.

    Attributes
    ----------
    extract : callable
        ``extract(plots, count, integers) -> count``: keeps the plots that are used in the first
        rows of the array of plots, in their order, and returns how many these are. Columns are
        those of `fuzzytrack.scan.plot_columns`; position, time, covariance, row and starts are
        filled. `integers` has room for 4 numbers a plot, for the kernel's own use.
    """

    extract: Callable[[Any, int, Any], int]


class Extraction(Part):
    """Chooses the plots of a scan that are used, and may merge some of them.

    Attributes
    ----------
    merges : bool
        Whether it makes one plot of several. Plots of a turning antenna that wait for a later
        sector would then be given again without those that were merged into them, so such a part
        is refused sector by sector.
    """

    merges: ClassVar[bool] = False

    @abstractmethod
    def kernels(self, setting: Setting) -> ExtractionKernels:
        """Kernels of this part."""


extractions: Registry[type[Extraction]] = Registry(
    "plot extraction", "fuzzytrack.scan.extraction", Extraction
)
