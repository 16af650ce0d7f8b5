"""Reports of experiments, as HTML with pictures."""

from fuzzytrack.reports.html_report import write_report

__all__ = ["write_report"]
