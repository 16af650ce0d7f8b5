"""Random functions in C give the same bits as in Python."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from random_kernels import functions, made

from fuzzytrack.interop.c99.build import CompilerError, find_compiler
from fuzzytrack.interop.c99.compiled import compiled_functions
from fuzzytrack.interop.c99.translation import translated

try:
    find_compiler("gcc")
except CompilerError as error:
    pytest.skip(str(error), allow_module_level=True)

pytestmark = pytest.mark.untraced

#: The same strict build as everywhere, and stopped by undefined behavior.
STRICT = (
    "-O0", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-Werror",
    "-fsanitize=undefined", "-fno-sanitize-recover=all",
)  # fmt: skip
FORMS = ("number", "number", "number", ("number", "number"))
VALUES = (0.0, -0.0, 1.0, -2.5, 0.125, 3.0, 1e-300, -7.3, 1e4, 123456.7, math.inf, math.nan)
#: Larger integers in Python would not fit into C.
LARGEST = 1000


class TooLargeError(ArithmeticError):
    pass


def bounded(function):
    """A function to integers that gives up where they are large: Python's have no limit."""

    def of(x):
        found = function(x)
        if abs(found) > LARGEST:
            raise TooLargeError
        return found

    return of


def reference(text):
    """The function of a text in Python, on numbers that raise nothing by themselves."""
    near = {name: bounded(getattr(math, name)) for name in ("floor", "ceil", "trunc")}
    others = {name: getattr(math, name) for name in ("fabs", "sqrt", "isnan", "isfinite")}
    return made(
        text, math=SimpleNamespace(**near, **others), int=bounded(int), round=bounded(round)
    )


def flat(answer):
    return [float(x) for part in answer for x in (part if isinstance(part, tuple) else (part,))]


def rows(count, seed):
    random = np.random.default_rng(seed)
    drawn = random.choice(VALUES, (count, 5))
    return np.where(random.random(drawn.shape) < 0.5, drawn, random.normal(0.0, 5.0, drawn.shape))


# A failing example names its function; to make all of them smaller would take hours.
@settings(max_examples=10, phases=(Phase.explicit, Phase.generate))
@given(st.lists(functions(), min_size=8, max_size=8))
def test_random_functions(texts):
    translations = [
        translated(made(text), name=f"f{k}", arguments=FORMS) for k, text in enumerate(texts)
    ]
    compared = 0
    inputs = rows(60, 3)
    for text, function in zip(
        texts, compiled_functions(translations, compiler="gcc", flags=STRICT), strict=True
    ):
        found, python = function(inputs), reference(text)
        for row, mine in zip(inputs.tolist(), found.tolist(), strict=True):
            try:
                theirs = flat(python(*row[:3], tuple(row[3:])))
            except (ArithmeticError, ValueError):
                # C goes on where Python raises: a division by zero, the integer of NaN.
                continue
            np.testing.assert_array_equal(mine, theirs, err_msg=f"{text}\n{row}")
            # Zeros have the same sign, too.
            signs = (np.where(np.isnan(x), 1.0, np.copysign(1.0, x)) for x in (mine, theirs))
            np.testing.assert_array_equal(*signs, err_msg=text)
            compared += 1
    assert compared > 50
