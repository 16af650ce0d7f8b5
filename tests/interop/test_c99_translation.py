"""Kernels and rule bases written in C and compiled give what Python gives."""

import math

import numpy as np
import pytest
from test_conformance import SCHEDULERS

from fuzzytrack.interop.c99.build import CompilerError, find_compiler
from fuzzytrack.interop.c99.compiled import compiled_functions
from fuzzytrack.interop.c99.translation import translated_kernel

try:
    find_compiler()
except CompilerError as error:
    pytest.skip(str(error), allow_module_level=True)

WARNINGS = (
    "-O1", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-Wshadow",
    "-Werror",
)  # fmt: skip
AXES = 2


def flat(answer):
    return [x for part in answer for x in (part if isinstance(part, tuple) else (part,))]


def calls(scheduler, n_axes, count, random):
    """Arguments of a kernel along tracks, with starts, missed plots and zeros among them."""
    kernel, memory = scheduler.kernel(n_axes), scheduler.initial_memory(n_axes)
    given, found = [], []
    follows = scheduler.sees_starts or scheduler.sees_misses
    for k in range(count):
        memory = scheduler.initial_memory(n_axes) if k % 40 == 0 else memory
        innovation, change = random.normal(0.0, 50.0, n_axes), random.normal(0.0, 100.0, n_axes)
        sigma, dt = random.uniform(0.5, 30.0, n_axes), float(random.uniform(0.2, 20.0))
        if random.random() < 0.1:
            innovation, change = innovation * 0.0, change * 0.0
        if follows and random.random() < 0.15:
            innovation, change, sigma = innovation * 0.0, change * 0.0, sigma * math.inf
        arguments = [innovation, change, dt, sigma]
        given.append([*innovation, *change, dt, *sigma, *memory])
        answer = kernel(
            *(tuple(a.tolist()) if scheduler.coupled else float(np.sum(a)) for a in arguments[:2]),
            dt,
            tuple(sigma.tolist()) if scheduler.coupled else float(sigma[0]),
            memory,
        )
        found.append(flat(answer))
        memory = answer[4]
    return np.array(given), np.array(found)


@pytest.fixture(scope="module", params=["gcc", "clang"])
def kernels(request):
    """The kernels of all schedulers, compiled together without a warning."""
    try:
        find_compiler(request.param)
    except CompilerError as error:
        pytest.skip(str(error))
    translations = [
        translated_kernel(s, name=f"k{k}", n_axes=AXES if s.coupled else 1)
        for k, s in enumerate(SCHEDULERS.values())
    ]
    functions = compiled_functions(translations, compiler=request.param, flags=WARNINGS)
    return dict(zip(SCHEDULERS, functions, strict=True))


@pytest.mark.parametrize("name", SCHEDULERS)
def test_a_kernel_gives_the_same_bits(kernels, name):
    scheduler = SCHEDULERS[name]
    random = np.random.default_rng(7)
    given, found = calls(scheduler, AXES if scheduler.coupled else 1, 400, random)
    np.testing.assert_array_equal(kernels[name](given), found)
