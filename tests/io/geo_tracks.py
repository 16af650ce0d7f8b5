"""Tracks on the earth for tests."""

import numpy as np
from hypothesis import strategies as st

from fuzzytrack.io import GeoTrack

NOON = np.datetime64("2024-05-01T12:00:00", "ns")

#: What is special in XML, JSON or files of text; no pair of surrogates.
ODD_TEXTS = ("a&b", "<i>", "]]>", "\"'", "\\", "\r\n\t", "é", "\U0001f6a2", "007", "", " x ")


def times(seconds, start=NOON):
    return start + np.round(np.asarray(seconds) * 1e9).astype("timedelta64[ns]")


def sample(**changes):
    """Five times of a track that crosses the date line; the first has no speed and course yet."""
    track = {
        "id": "a&b <1>",
        "time": times([0, 1, 2.5, 3.25, 1000.000000001]),
        "latitude": np.array([-17.5, -17.25, -17, -16.75, -16.5]),
        "longitude": np.array([179.0, 179.5, -179.75, -179.5, -179.123456789012]),
        "altitude": np.array([0.0, 1e-7, 12.5, 1e5, -3.0]),
        "speed": np.array([np.nan, 1.0, 2.5, 0.0, 1e-9]),
        "course": np.array([np.nan, 350.0, 359.5, 0.5, 10.0]),
    }
    return GeoTrack(**{**track, **changes})


def empty(**changes):
    none = np.empty(0)
    times = np.empty(0, "datetime64[ns]")
    return GeoTrack(**{"id": "none", "time": times, "latitude": none, "longitude": none, **changes})


def part(track, places, **changes):
    """Some rows of a track."""
    columns = ("time", "latitude", "longitude", "altitude", "speed", "course")
    values = {name: getattr(track, name) for name in columns}
    values = {name: None if value is None else value[places] for name, value in values.items()}
    return GeoTrack(**{"id": track.id, "segment": track.segment, **values, **changes})


@st.composite
def tracks(draw, texts=None):
    """Any track: of no, one or many rows, with and without gaps and optional columns."""
    count = draw(st.integers(0, 6))

    def column(low, high, **extra):
        number = st.floats(low, high, **extra)
        values = draw(st.lists(number | st.just(np.nan), min_size=count, max_size=count))
        return np.array(values, dtype=float)

    def maybe(values):
        return draw(st.none() | st.just(values))

    steps = draw(st.lists(st.integers(1, 10**13), min_size=count, max_size=count))
    return GeoTrack(
        id=draw(texts or (st.sampled_from(ODD_TEXTS) | st.text(max_size=8))),
        segment=draw(st.integers(0, 3)),
        time=NOON + np.cumsum(np.array(steps, dtype=np.int64)).astype("timedelta64[ns]"),
        latitude=column(-90, 90),
        longitude=column(-180, 180, exclude_max=True),
        altitude=maybe(column(-1e7, 1e7)),
        speed=maybe(column(0, 1e4)),
        course=maybe(column(0, 360, exclude_max=True)),
    )


def nothing_if_unknown(values, count):
    """Numbers as a list with None where they are unknown, or for a column that is missing."""
    if values is None:
        return [None] * count
    return [None if np.isnan(value) else value for value in values.tolist()]
