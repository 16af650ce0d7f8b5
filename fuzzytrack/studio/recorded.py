"""Recordings, as a page describes them, and what is in them."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.io.reading import Reading
from fuzzytrack.recordings.used_plots import UsedPlots, read_used_plots
from fuzzytrack.studio.folder import naming
from fuzzytrack.studio.reading_arguments import check_truth
from fuzzytrack.studio.uploads import check_plots

__all__ = ["Recorded", "summary_of"]

# Characters of the first line that are read.
_LINE = 100_000


@dataclass(frozen=True)
class Recorded:
    """A recording, and what a page says of it.

    Attributes
    ----------
    path : Path
    options : mapping of str to value
        See `fuzzytrack.studio.reading_arguments.reading_options`; what is not in it is found by the
        names of the columns, where that is certain, and the noise is estimated.
    true_file : Path or None
        File of true positions; ``truth`` of the options has columns of the recording unless given.
    """

    path: Path
    options: Mapping[str, Any] = field(default_factory=dict)
    true_file: Path | None = None

    @property
    def truth(self) -> str | None:
        """True positions, as functions take them: a file, or columns of the recording.

        Raises
        ------
        ValueError
            If there is no such column.
        """
        columns = self.options.get("truth")
        if self.true_file is not None or columns is None:
            return None if self.true_file is None else str(self.true_file)
        check_truth(self.columns(), columns)
        return ",".join(columns)

    @property
    def reading(self) -> dict[str, Any]:
        """How the file is read, without its truth."""
        return {name: value for name, value in self.options.items() if name != "truth"}

    def columns(self) -> list[str]:
        """Names in the first line of the file."""
        with open(self.path, encoding="utf-8", errors="replace", newline="") as stream:
            return next(csv.reader([stream.readline(_LINE)]), [])

    def read(self) -> UsedPlots:
        """Read the plots as ``fuzzytrack compare`` does.

        Raises
        ------
        ValueError, OSError
            If there are too many plots, or they cannot be read.
        """
        check_plots(self.path)
        with naming(self.path), naming(self.true_file or self.path):
            options = json.dumps(self.reading, sort_keys=True)
            files = [self.path] if self.true_file is None else [self.path, self.true_file]
            return _read(str(self.path), options, self.truth, tuple(map(_version, files)))


# A page asks what is in a recording before it has it tracked.
@lru_cache(maxsize=1)
def _read(path: str, options: str, truth: str | None, versions: tuple[object, ...]) -> UsedPlots:
    """Plots of a file; those of the last one are kept while no file changes."""
    return read_used_plots(path, Reading.of(**json.loads(options)), truth=truth)


def _version(path: Path) -> tuple[int, int, int]:
    found = path.stat()
    return found.st_ino, found.st_mtime_ns, found.st_size


def summary_of(used: UsedPlots) -> dict[str, Any]:
    """What was read, in numbers."""
    columns = used.decoder.columns
    return {
        "found": {
            "time": columns.time,
            "id": columns.id,
            "position": columns.position,
            "places": columns.read,
            "axes": columns.axes,
        },
        "plots": sum(int((~np.isnan(t.plots).any(axis=1)).sum()) for t in used.tracks),
        "tracks": len(used.tracks),
        "axes": used.tracks[0].plots.shape[1] if used.tracks else 0,
        "noise": _noise_as_json(used.decoder),
        "notes": used.notes,
    }


def _noise_as_json(decoder: PlotDecoder) -> list[dict[str, Any]]:
    """Standard deviation of each coordinate, or its column; what is estimated has an error."""
    errors = decoder.noise_errors or (None,) * len(decoder.noise)
    return [
        {
            "sigma": sigma,
            "error": error,
            "unit": "°" if decoder.noise_is_polar and k else "m",
        }
        for k, (sigma, error) in enumerate(zip(decoder.noise, errors, strict=True))
    ]
