"""Examples of properties are the same in every run, whatever ran before."""

import importlib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st


def drawn():
    """Examples as texts, since NaN is not equal to itself."""
    found = []

    @given(st.integers(), st.floats(), st.text())
    @settings(max_examples=200)
    def draw(number, place, text):
        found.append(repr((number, place, text)))

    draw()
    return found


def test_examples_do_not_depend_on_the_modules_that_are_loaded(tmp_path, monkeypatch):
    if not settings().derandomize:
        pytest.skip("examples are new in every run")
    before = drawn()
    (tmp_path / "loaded_later.py").write_text("NUMBERS, NAME = (1234567, 76.54321), 'a name'")
    monkeypatch.syspath_prepend(tmp_path)
    importlib.import_module("loaded_later")
    assert drawn() == before
