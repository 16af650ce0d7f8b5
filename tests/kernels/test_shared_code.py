"""Code that trackers share which differ only in numbers."""

import numpy as np
import pytest

from fuzzytrack.kernels import shared_code
from fuzzytrack.kernels.shared_code import SharedCode
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.compilation import learn_code, sharing_code
from fuzzytrack.trackers.runners import runner

RNG = np.random.default_rng(4)
TIMES = np.cumsum(RNG.uniform(0.5, 2.0, 40))
PLOTS = 30 * TIMES[:, None, None] + RNG.normal(0, 10, (40, 5, 2))
PLOTS[7, 1] = PLOTS[20:23, 4] = np.nan


@pytest.fixture
def compilations(monkeypatch):
    """What was compiled, by the number of floats that it reads from memory."""
    made, compiled = [], shared_code._compiled

    def count(function, arguments, memory, differ):
        made.append(len(differ))
        return compiled(function, arguments, memory, differ)

    monkeypatch.setattr(shared_code, "_compiled", count)
    return made


@pytest.mark.parametrize(
    "texts",
    [
        ["kalman-cv:sigma_v=0.5", "kalman-cv:sigma_v=3", "kalman-cv:sigma_v=0.01"],
        ["imm:quiet_sigma=0.1:maneuver_sigma=2", "imm:quiet_sigma=0.3:maneuver_sigma=1"],
        ["stiffness-damping:period=1", "stiffness-damping:period=2"],
    ],
)
def test_results_are_those_of_plain_python_to_the_bit(texts, compilations):
    code = SharedCode()
    trackers = [make_tracker(text) for text in texts]
    for tracker in trackers:
        learn_code(tracker, 2, code)
    for tracker in (*trackers, *trackers):
        plain = tracker.run(TIMES, PLOTS, 10.0)
        with sharing_code(tracker, 2, code):
            shared = tracker.run(TIMES, PLOTS, 10.0, keep=("predicted",), threads=1)
        np.testing.assert_array_equal(shared.predicted, plain.predicted)
        # The code is that of the last tracker: this one must not go on using it.
        assert not runner(tracker, 2 if tracker.coupled else 1).native
    steady = runner(tracker, 2 if tracker.coupled else 1).program.steady
    # The step, and for lanes that have all started one with a common time step and one without.
    assert len(compilations) == (1 if steady is None else 3)


def test_a_number_that_differs_for_the_first_time_is_compiled_in(compilations):
    code, makes = SharedCode(), []

    def scaled(factor, offset):
        def function(b, count):
            for i in range(count):
                b[i] = factor * b[i] + offset

        return function

    for factor, offset in ((2.0, 1.0), (3.0, 1.0), (4.0, 1.0), (4.0, -1.0), (5.0, 7.0)):
        entry = code.entry_point(scaled(factor, offset), "vpi")
        makes.append(entry.address)
        numbers = np.arange(3.0)
        _call(entry, numbers)
        np.testing.assert_array_equal(numbers, factor * np.arange(3.0) + offset)
    # The first code is that of the function alone.
    assert compilations == [1, 2]
    assert makes[1] == makes[2]
    assert makes[3] == makes[4]


def _call(entry, numbers):
    import ctypes

    signature = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_ssize_t)
    signature(entry.address)(numbers.ctypes.data, len(numbers))


def test_numbers_of_tuples_tables_and_defaults():
    long = tuple(float(k) for k in range(20))

    def made(pair, table, flat):
        def helper(x, shift=flat):
            return x + shift

        def function(b, count):
            for i in range(count):
                b[i] = helper(b[i] * pair[i % 2] + table[i], flat)

        return function

    code = SharedCode()
    for pair, table, flat in (
        ((1.5, 2.0), long, 0.5),
        ((1.5, 3.0), long, 0.25),
        ((1.5, 3.0), long[::-1], 0.25),
    ):
        numbers = np.arange(1.0, 6.0)
        _call(code.entry_point(made(pair, table, flat), "vpi"), numbers)
        expected = [k * pair[i % 2] + table[i] + flat for i, k in enumerate(range(1, 6))]
        np.testing.assert_array_equal(numbers, expected)


def test_what_cannot_be_told_apart_is_compiled_for_itself(compilations):
    def function(b, count):
        for i in range(count):
            b[i] = np.pi * b[i]

    code, numbers = SharedCode(), np.ones(2)
    code.learn(function)
    _call(code.entry_point(function, "vpi"), numbers)
    np.testing.assert_array_equal(numbers, [np.pi, np.pi])
    # Numbers of functions in single precision are rounded; they share nothing.
    tracker = make_tracker("fixed:alpha=0.5:beta=0.3")
    alone = tracker.run(TIMES, PLOTS, dtype=np.float32, threads=1)
    with sharing_code(tracker, 2, code):
        single = tracker.run(TIMES, PLOTS, dtype=np.float32, threads=1)
    np.testing.assert_array_equal(single.predicted, alone.predicted)
    assert compilations == []


def test_other_trackers_share_nothing():
    code = SharedCode()
    learn_code(object(), 2, code)
    with sharing_code(object(), 2, code):
        pass


def test_functions_of_arrays_share_code():
    code = SharedCode()

    def made(factor, offset, power):
        def value(x):
            return factor * x**power + offset

        def fill(array):
            for k in range(len(array)):
                array[k] = value(array[k])

        return fill

    functions = [made(0.5, 1.0, 2.0), made(3.0, 1.0, 2.5), made(-1.0, 1.0, 2.0)]
    for function in functions:
        code.learn(function)
    for function in functions:
        plain, shared = np.linspace(0.1, 2.0, 7), np.linspace(0.1, 2.0, 7)
        function(plain)
        compiled = code.compiled(function)
        compiled(shared)
        np.testing.assert_array_equal(plain, shared)
    # What `learn` has seen is compiled once; a single function as any other.
    assert code.compiled(functions[0]) is compiled
    alone = SharedCode()
    alone.compiled(functions[1])(shared)


def test_a_function_of_arrays_that_is_unknown_is_compiled_for_itself():
    def made(factor, table):
        def fill(array):
            array[0] = factor * table[0]

        return fill

    code = SharedCode()
    array = np.zeros(1)
    for factor in (2.0, 3.0):
        code.compiled(made(factor, np.array([5.0])))(array)
        assert array[0] == 5.0 * factor
