"""Copies of functions, and what a function is recognized by."""

import math
import re
import types

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.kernels.rebuild import fingerprint, rebuilt, rounded, table
from fuzzytrack.trackers.runners import runner

SCALE = 2.0


def helper(x):
    return x * SCALE


def make(offset, table=(), call=helper):
    def function(x):
        return call(x) + offset + (table[0] if table else 0.0)

    return function


def other_helper(x):
    return x / SCALE


def test_equal_functions_have_one_fingerprint():
    assert fingerprint(make(1.0)) == fingerprint(make(1.0))


@pytest.mark.parametrize(
    "other",
    [
        make(1.5),
        make(1),
        make(-0.0),
        make(True),
        make(1.0, (3.0,)),
        make(1.0, ((3.0, 4.0),)),
        make(1.0, np.array([3.0])),
        make(1.0, call=other_helper),
        make(1.0, call=make(1.0)),
        helper,
    ],
)
def test_whatever_differs_shows(other):
    assert fingerprint(other) != fingerprint(make(1.0))
    assert fingerprint(other) is not None


def test_values_beside_each_other_are_told_apart():
    assert fingerprint(make(1.0, (1, 23))) != fingerprint(make(1.0, (12, 3)))
    assert fingerprint(make(1.0, ("a", "b"))) != fingerprint(make(1.0, ("a', 'b",)))
    assert fingerprint(make(1.0, ((1, 2), 3))) != fingerprint(make(1.0, (1, (2, 3))))


def test_a_changed_global_shows(monkeypatch):
    before = fingerprint(make(1.0))
    monkeypatch.setitem(globals(), "SCALE", 3.0)
    assert fingerprint(make(1.0)) != before


class Settings:
    FACTOR = 2.0


class Number(float):
    def __repr__(self):
        return "a number"


def test_what_another_module_or_class_holds_cannot_be_told():
    """Only the name of a module is at hand, and its constants may change without it."""
    settings = types.ModuleType("settings")
    settings.FACTOR = 2.0

    def of_module(x):
        return x * settings.FACTOR

    def of_class(x):
        return x * Settings.FACTOR

    def of_math(x):
        return math.sqrt(x) * math.pi

    assert fingerprint(of_module) is None
    assert fingerprint(of_class) is None
    # Also where a helper does it.
    assert fingerprint(make(1.0, call=of_module)) is None
    assert fingerprint(of_math) is not None


@pytest.mark.parametrize(
    "value",
    [object(), {"a": 1.0}, np.array([object()]), np.float64(1.0), Number(1.0), np, [].append],
    ids=lambda value: type(value).__name__,
)
def test_what_cannot_be_told_has_none(value):
    assert fingerprint(make(value)) is None
    assert fingerprint(make((value,))) is None


@pytest.mark.untraced
def test_every_scheduler_of_ours_can_be_told():
    for tracker in (
        ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2)),
        ft.AlphaBetaTracker(ft.FuzzyScheduler(ft.load_rulebase("chan-style"))),
        ft.AlphaBetaTracker(ft.FuzzyScheduler(ft.load_rulebase("stiffness-damping"), "table")),
    ):
        for n_axes in (1, 2):
            step = runner(tracker, n_axes).program.step(8)
            again = type(tracker)(tracker.scheduler).program(n_axes).step(8)
            assert fingerprint(step) == fingerprint(again) is not None


def test_a_copy_refers_to_other_values():
    def tripled(value):
        return 3.0 * value if isinstance(value, float) else value

    original = make(1.0)
    copy = rebuilt(original, tripled)
    # 5 * 2 + 3 * 1 + 3 * 0
    assert (copy(5.0), original(5.0)) == (13.0, 11.0)

    def with_literal(x):
        return x + 1.0

    assert rebuilt(with_literal, tripled)(5.0) == 8.0
    assert rebuilt(with_literal, tripled, literals=False)(5.0) == 6.0
    # Of its globals a copy has what it names, and still finds what is built in.
    assert set(rebuilt(helper, tripled).__globals__) == {"SCALE", "__name__", "__builtins__"}
    assert rebuilt(helper, tripled)(5.0) == 30.0


def test_numbers_of_single_precision():
    assert rounded(0.1, np.float32) == np.float32(0.1)
    assert float(rounded(0.1, np.float32)) != 0.1
    assert math.isinf(rounded(math.inf, np.float32))
    for lacking in (1e300, 1e-300):
        with pytest.raises(ValueError, match=re.escape(f"{lacking:g}, which float32 lacks")):
            rounded(lacking, np.float32)
    np.testing.assert_array_equal(table((1e-300, 2.0), np.float32), [0.0, 2.0])
    with pytest.raises(ValueError, match=r"1e\+300, which float32 lacks"):
        table((1.0, 1e300), np.float32)
