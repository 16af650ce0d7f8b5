"""The reader of docs/formats.md, for fuzzytrack's entry points."""

import io
from contextlib import contextmanager

from fuzzytrack.io import PlotDescription
from fuzzytrack.io.byte_stream import open_bytes
from fuzzytrack.io.readers import Reader
from fuzzytrack.io.record_source import Losses, RecordSource


class SonarLog(Reader):
    """Lines of time (s), track, range (m) and bearing (deg), such as ``12.5 A7 1520 44.5``."""

    suffixes = (".slog",)

    @contextmanager
    def open_source(self, file):
        types = {"time": "number", "id": "text", "range": "number", "bearing": "number"}
        description = PlotDescription(time="time", id="id", polar=("range", "bearing"))
        losses = Losses()
        with open_bytes(file) as stream:
            yield RecordSource(stream, types, description, rows(stream, losses), losses)


def rows(stream, losses):
    for number, line in enumerate(io.BufferedReader(stream), 1):
        try:
            time, track, distance, bearing = line.decode("ascii").split()
            yield number, (float(time), track, float(distance), float(bearing))
        except ValueError:
            losses.add("lines that are no plot", f"line {number}")
