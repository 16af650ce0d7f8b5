"""Report: which confirmed tracks are reported."""

from fuzzytrack.scan.report.base import Report, ReportKernels, reports
from fuzzytrack.scan.report.recent import Recent

__all__ = ["Recent", "Report", "ReportKernels", "reports"]
