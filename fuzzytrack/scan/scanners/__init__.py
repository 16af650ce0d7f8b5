"""Configurations of scan trackers: files that name the parts and their numbers."""

from fuzzytrack.scan.scanners.catalog import (
    as_scanner,
    dumps_scanner,
    load_scanner,
    loads_scanner,
    make_scanner,
    save_scanner,
)
from fuzzytrack.scan.scanners.loading import scanner_path, shipped_scanners

__all__ = [
    "as_scanner",
    "dumps_scanner",
    "load_scanner",
    "loads_scanner",
    "make_scanner",
    "save_scanner",
    "scanner_path",
    "shipped_scanners",
]
