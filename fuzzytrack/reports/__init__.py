"""Reports as HTML pages: Monte Carlo experiments, and the tracks of a scan tracker."""

from fuzzytrack.reports.html_report import write_report
from fuzzytrack.reports.scan_page import write_scan_page

__all__ = ["write_report", "write_scan_page"]
