"""Reports of Monte Carlo experiments as HTML pages with pictures."""

from fuzzytrack.reports.html_report import write_report

__all__ = ["write_report"]
