"""Names become identifiers of C that no compiler or header means something else by."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.interop.c99.c_text import array_lines, comment_lines, literal
from fuzzytrack.interop.c99.identifiers import Identifiers, ascii_text, c_identifier, is_free_name


@given(st.text())
def test_any_text_becomes_an_identifier(text):
    word = c_identifier(text)
    assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,31}", word, re.ASCII)
    assert "__" not in word
    assert c_identifier(word) == word


@given(st.lists(st.sampled_from(["a b", "a-b", "a_b", "E", "e", "int", "a_b_2", "", "é"])))
def test_identifiers_of_a_scope_differ(words):
    scope = Identifiers("E")
    found = [scope.unique(word) for word in words]
    assert len({*found, "E"}) == len(found) + 1


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("dE", "dE"),
        ("double", "double_"),
        ("class", "class_"),
        ("INT16_MAX", "INT16_MAX_"),
        ("int16_t", "int16_t_"),
        ("NAN", "NAN_"),
        ("M_PI", "M_PI_"),
        ("2nd", "x_2nd"),
        ("_Bool", "Bool"),
        ("α-rate", "alpha_rate"),
        ("größe", "grosse"),
        ("温度", "x"),
        ("a" * 40, "a" * 31),
    ],
)
def test_reserved_and_foreign_words(text, word):
    assert c_identifier(text.replace("ß", "ss")) == word


@given(st.text("ab_é1", max_size=40))
def test_every_identifier_is_free(text):
    assert is_free_name(c_identifier(text))
    assert is_free_name(f"{c_identifier(text)}_filter")


@pytest.mark.parametrize("name", ["", "_", "a b", "double", "a__b", "_a", "M_PI", "größe"])
def test_other_words_are_not_free(name):
    assert not is_free_name(name)


def test_text_in_ascii():
    assert ascii_text("a₀ – τ₀, naïve Δ →") == "a0 - tau0, naive Delta ?"


@given(st.text(), st.text(max_size=8))
def test_no_text_ends_a_comment(text, name):
    lines = comment_lines([("", text), (c_identifier(name), text)])
    whole = "\n".join(lines)
    assert whole.isascii()
    assert whole.startswith("/*")
    assert whole.index("*/") == len(whole) - 2
    assert whole.count("/*") == 1
    assert "??" not in whole
    assert max(map(len, lines)) <= 100


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_a_float_is_written_so_that_it_reads_as_itself(value):
    import numpy as np

    text = literal(np.float32(value))
    assert re.fullmatch(r"-?\d(\.\d+|\d*\.\d+)?(e[-+]\d+)?f", text), text
    assert "." in text or "e" in text
    assert np.float32(text[:-1]) == np.float32(value)
    assert float(literal(np.float64(value))) == value


def test_columns_of_an_array_are_aligned():
    import numpy as np

    lines = array_lines("float", "t", list(np.array([1, 0.25, 10, 3], np.float32)), row=2)
    assert lines == [
        "static const float t[4] = {",
        "     1.0f, 0.25f,",
        "    10.0f,  3.0f",
        "};",
    ]
