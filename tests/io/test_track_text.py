import json
import math
from decimal import Decimal
from xml.etree import ElementTree

import numpy as np
import pytest
from geo_tracks import ODD_TEXTS, times
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.io.track_text import decimals, iso_times, seconds_since, unicode_text, xml_text


@given(st.floats(allow_infinity=False, allow_nan=False))
def test_decimals_read_back_exactly(value):
    (text,) = decimals(np.array([value]))
    assert float(text) == value
    assert not set(text) - set("-.0123456789")


def test_unknown_numbers_are_empty():
    assert decimals(np.array([math.nan, -0.0, 1e22])) == ["", "-0.0", "10000000000000000000000.0"]


@given(st.integers(-(2**62), 2**62))
def test_times_read_back_exactly(nanoseconds):
    time = np.array([nanoseconds], "datetime64[ns]")
    (text,) = iso_times(time)
    assert text.endswith("Z")
    assert np.array([text[:-1]], "datetime64[ns]") == time


def test_times_have_no_more_digits_than_needed():
    found = iso_times(times([0, 0.5, 10.000000001, 100]))
    assert found == [
        "2024-05-01T12:00:00Z",
        "2024-05-01T12:00:00.5Z",
        "2024-05-01T12:00:10.000000001Z",
        "2024-05-01T12:01:40Z",
    ]


def test_seconds_since_the_first():
    assert seconds_since(times([3, 3.5, 1003.000000001])).tolist() == [0, 0.5, 1000.000000001]


def as_in_xml(text):
    """Text with what XML cannot hold replaced, character by character."""
    return "".join(
        c if c in "\t\n\r" or (ord(c) >= 32 and c not in "\ufffe\uffff") else "\ufffd" for c in text
    )


@given(st.text())
def test_texts_read_back_from_xml(text):
    assert (ElementTree.fromstring(f"<a>{xml_text(text)}</a>").text or "") == as_in_xml(text)


@pytest.mark.parametrize("text", ODD_TEXTS)
def test_odd_texts_read_back_from_xml(text):
    assert (ElementTree.fromstring(f"<a>{xml_text(text)}</a>").text or "") == text


def test_half_a_character():
    assert unicode_text("a\ud800b") == xml_text("a\ud800b") == "a�b"
    json.dumps(unicode_text("\udfff")).encode()
    Decimal(decimals(np.array([1e-300]))[0])
