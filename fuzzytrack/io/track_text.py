"""Numbers, times and names as the texts of which files of tracks consist."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array

__all__ = ["decimals", "iso_times", "seconds_since", "unicode_text", "xml_text"]

# What XML 1.0 cannot hold, not even escaped. These are compiled when they are used: it takes 15 ms.
_NOT_XML = "[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]"
_SURROGATES = "[\ud800-\udfff]"
_REPLACEMENT = "\ufffd"
# `xml.sax.saxutils` does the same, but imports the network with it, which takes 70 ms.
_ESCAPED = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;", "\r": "&#13;"})


def decimals(values: Array) -> list[str]:
    """Numbers without an exponent, which read back exactly; NaN is empty.

    Parameters
    ----------
    values : ndarray, shape (n,)

    Examples
    --------
    >>> import numpy as np
    >>> decimals(np.array([52.1, 1e-7, np.nan]))
    ['52.1', '0.0000001', '']
    """
    return [_decimal(value) for value in values.tolist()]


def _decimal(value: float) -> str:
    text = repr(value)
    if "e" in text:
        return str(np.format_float_positional(value, trim="0"))
    return "" if text == "nan" else text


def iso_times(times: NDArray[np.datetime64]) -> list[str]:
    """Times as ISO 8601 in UTC, exact to 1 ns, with no more digits than needed.

    Parameters
    ----------
    times : ndarray of datetime64, shape (n,)

    Examples
    --------
    >>> import numpy as np
    >>> iso_times(np.array(["2024-05-01T12:00:00", "2024-05-01T12:00:00.25"], "datetime64[ns]"))
    ['2024-05-01T12:00:00Z', '2024-05-01T12:00:00.25Z']
    """
    texts: list[str] = np.datetime_as_string(times.astype("datetime64[ns]")).tolist()
    return [text.rstrip("0").rstrip(".") + "Z" for text in texts]


def seconds_since(times: NDArray[np.datetime64]) -> Array:
    """Times since the first of them (s), of at least one."""
    elapsed = (times - times[0]).astype("timedelta64[ns]").astype(np.int64)
    seconds: Array = elapsed / 1e9
    return seconds


def unicode_text(text: str) -> str:
    """Text with what UTF-8 cannot hold replaced."""
    return re.sub(_SURROGATES, _REPLACEMENT, text)


def xml_text(text: str) -> str:
    """Text as the content of an element of XML; what XML cannot hold is replaced."""
    # A reader would take a carriage return for a line feed.
    return re.sub(_NOT_XML, _REPLACEMENT, text).translate(_ESCAPED)
