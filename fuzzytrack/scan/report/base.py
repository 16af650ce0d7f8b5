"""Role: which confirmed tracks are reported."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzytrack.plugins import Registry
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.setting import Setting

__all__ = ["Report", "ReportKernels", "reports"]


class ReportKernels(NamedTuple):
    """Kernels of a report.

    Attributes
    ----------
    shown : callable
        ``shown(tracks, i, clock) -> bool``: whether a confirmed track is reported after this scan.
    """

    shown: Callable[[Any, int, Any], bool]


class Report(Part):
    """Decides which confirmed tracks are reported."""

    @abstractmethod
    def kernels(self, setting: Setting, at: int) -> ReportKernels:
        """Kernels of this part; its memory of a track begins at column `at`."""


reports: Registry[type[Report]] = Registry("report", "fuzzytrack.scan.report", Report)
