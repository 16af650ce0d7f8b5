"""The checks of arguments and words fail kernels that cannot be compiled."""

import math
import random
import re
from dataclasses import dataclass

import numpy as np
import pytest
from subjects import fixed, run_check, scheduler_of

from fuzzytrack.errors import PluginError
from fuzzytrack.schedulers import GainScheduler
from fuzzytrack.trackers import LaneProgram, LaneTracker, Rows, single_axis_step


def of_three(innovation, dt, memory):
    return 0.5, 0.2, 0.0, 1.0, memory


class WithMethod(GainScheduler):
    alpha = 0.5

    def kernel(self, n_axes):
        return self.kernel_of_mine

    def kernel_of_mine(self, innovation, change, dt, sigma, memory):
        return self.alpha, 0.2, 0.0, 1.0, memory


def test_a_kernel_has_five_arguments():
    expected = (
        r"^kernel-takes-five-arguments: the kernel of Made must take the five arguments "
        r"\(innovation, change, dt, sigma, memory\), takes \(innovation, dt, memory\)$"
    )
    with pytest.raises(AssertionError, match=expected):
        run_check("kernel-takes-five-arguments", scheduler_of(of_three))
    with pytest.raises(AssertionError, match="must return a plain function, got method: define"):
        run_check("kernel-takes-five-arguments", WithMethod())
    with pytest.raises(AssertionError, match=r"Made\.kernel must return a function, got None$"):
        run_check("kernel-takes-five-arguments", scheduler_of(None))


@pytest.mark.parametrize("memory", [0.0, None, ("word",)])
@pytest.mark.parametrize(
    "name", ["kernel-answers-in-form", "gains-are-stable", "inputs-left-alone"]
)
def test_the_first_memory_is_a_tuple(memory, name):
    expected = f"{name}: Made.initial_memory must return a tuple of numbers, got {memory!r}"
    with pytest.raises(AssertionError, match=f"^{re.escape(expected)}$") as caught:
        run_check(name, scheduler_of(fixed, memory))
    assert isinstance(caught.value.__cause__, PluginError)

    def of_one_more(innovation, change, dt, sigma, memory, *, alpha=0.5):
        return alpha, 0.2, 0.0, 1.0, memory

    with pytest.raises(AssertionError, match=r"the five arguments .*, takes .* \*, alpha=0.5\)$"):
        run_check("kernel-takes-five-arguments", scheduler_of(of_one_more))


LIMIT = 2.0
TABLE = (0.5, (0.2, "word"), None)
NUMBERS = np.array([0.5, 0.2])


def helper(number):
    return min(abs(number), LIMIT) * math.pi


def deep_helper(number):
    return np.tanh(number)


class WithSelf(GainScheduler):
    alpha = 0.5

    def kernel(self, n_axes):
        alpha, count = self.alpha, 0

        def good(innovation, change, dt, sigma, memory):
            inner = tuple(helper(m) for m in memory)
            scaled = max([helper(m) for m in inner] or [float(NUMBERS[0])])
            return alpha, TABLE[1][0], math.sqrt(scaled) * 0.0, 1.0, memory

        def of_self(innovation, change, dt, sigma, memory):
            return self.alpha, 0.2, 0.0, 1.0, memory

        def of_numpy(innovation, change, dt, sigma, memory):
            return np.clip(innovation, 0.0, 1.0), 0.2, 0.0, 1.0, memory

        def through_a_helper(innovation, change, dt, sigma, memory):
            return deep_helper(innovation), 0.2, 0.0, 1.0, memory

        def of_a_function_of_numpy(innovation, change, dt, sigma, memory):
            return tanh(innovation), 0.2, 0.0, 1.0, memory

        def of_another_module(innovation, change, dt, sigma, memory):
            return (lambda: random.random())(), 0.2, 0.0, 1.0, memory

        def of_a_class(innovation, change, dt, sigma, memory):
            return WithSelf.alpha, 0.2, 0.0, 1.0, memory

        def of_nothing(innovation, change, dt, sigma, memory):
            return no_such_name, 0.2, 0.0, 1.0, memory  # noqa: F821

        def of_later(innovation, change, dt, sigma, memory):
            return later, 0.2, 0.0, 1.0, memory

        def importing(innovation, change, dt, sigma, memory):
            import cmath

            return cmath.phase(innovation), 0.2, 0.0, 1.0, memory

        def counting(innovation, change, dt, sigma, memory):
            nonlocal count
            count += 1
            return 0.5, 0.2, 0.0, 1.0, memory

        def changing(innovation, change, dt, sigma, memory):
            global LIMIT
            LIMIT = innovation
            return 0.5, 0.2, 0.0, 1.0, memory

        tanh = np.tanh
        if n_axes == "never":
            later = 1.0
        return locals()[n_axes] if isinstance(n_axes, str) else of_self


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("of_self", "uses 'self.alpha', where 'self' is a WithSelf"),
        ("of_numpy", "uses 'np.clip' of the module numpy"),
        ("through_a_helper", "uses 'np.tanh' of the module numpy"),
        ("of_a_function_of_numpy", "uses 'tanh' of the module numpy"),
        ("of_another_module", "uses 'random.random' of the module random"),
        ("of_a_class", "uses 'WithSelf.alpha', where 'WithSelf' is a class"),
        ("of_nothing", "uses 'no_such_name', which is not defined"),
        ("of_later", "uses 'later', which is not defined"),
        ("importing", "imports 'cmath'"),
        ("counting", "changes 'count', a variable outside of it"),
        ("changing", "changes the global variable 'LIMIT'"),
    ],
)
def test_a_kernel_uses_numbers_only(name, what):
    kernel = WithSelf().kernel(name)
    where = deep_helper if name == "through_a_helper" else kernel
    first = where.__code__.co_firstlineno
    with pytest.raises(AssertionError) as caught:
        run_check("kernel-uses-numbers-only", scheduler_of(kernel))
    text = str(caught.value)
    line = int(text.removeprefix("kernel-uses-numbers-only: line ").partition(" ")[0])
    assert first < line <= first + 3
    name = where.__name__
    assert f"of test_kernel_words.py: the function {name} {what}; it may use numbers" in text
    assert "\n" not in text


def test_the_step_of_a_tracker_uses_numbers_only():
    @dataclass(frozen=True)
    class OfSelf(LaneTracker):
        alpha: float = 0.5

        def program(self, n_axes):
            rows = Rows(n_axes, 0)

            def correct(b, lane, z, prediction, velocity, dt, gap, sigma, update, starts):
                return prediction, self.alpha * z, velocity, self.alpha, 0.1

            return LaneProgram(rows, (), lambda stride: single_axis_step(rows, stride, correct))

    with pytest.raises(AssertionError, match=r"the function correct uses 'self\.alpha', where"):
        run_check("program-uses-numbers-only", OfSelf())


def test_what_a_kernel_may_use():
    run_check("kernel-uses-numbers-only", scheduler_of(WithSelf().kernel("good")))
