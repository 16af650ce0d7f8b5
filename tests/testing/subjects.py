"""Schedulers and trackers that break the contract in one place, for the tests of its checks."""

import random

import fuzzytrack as ft
from fuzzytrack.schedulers import GainScheduler
from fuzzytrack.testing import checks_for


def scheduler_of(kernel, memory=(), **attributes):
    class Made(GainScheduler):
        def initial_memory(self, n_axes):
            return memory

        def kernel(self, n_axes):
            return kernel

        def __eq__(self, other):
            return type(other) is type(self)

        def __hash__(self):
            return 0

    for name, value in attributes.items():
        setattr(Made, name, value)
    return Made()


def run_check(name, subject):
    """Run the one check of that name."""
    (check,) = (check for check in checks_for(subject) if check.name == name)
    check()


def fixed(innovation, change, dt, sigma, memory):
    return 0.5, 0.2, 0.0, 1.0, memory


def divides(innovation, change, dt, sigma, memory):
    return 0.5, 0.2 / innovation, 0.0, 1.0, memory


def forgets_one(innovation, change, dt, sigma, memory):
    return 0.5, 0.2, 0.0, 1.0, ()


def four_answers(innovation, change, dt, sigma, memory):
    return 0.5, 0.2, 0.0, 1.0


def bare_memory(innovation, change, dt, sigma, memory):
    return 0.5, 0.2, 0.0, 1.0, memory[0] + 1.0


def no_answer(innovation, change, dt, sigma, memory):
    pass


def grows_to_infinity(innovation, change, dt, sigma, memory):
    return 0.5, 0.2 + 1e300 * abs(innovation) * 1e300, 0.0, 1.0, memory


def gambles(innovation, change, dt, sigma, memory):
    return random.random(), 0.2, 0.0, 1.0, memory


class Faulty:
    """A good tracker with one method changed."""

    def __init__(self, **changes):
        self.good = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2))
        self.changes = changes

    def run(self, t, z, sigma=None):
        return self.changes.get("run", lambda result, t, z: result)(
            self.good.run(t, z, sigma), t, z
        )

    def start(self, z, t, sigma=None):
        return self.good.start(z, t, sigma)

    def step(self, state, z, t, sigma=None):
        new = self.good.step(state, z, t, sigma)
        return self.changes.get("step", lambda state: state)(new)

    def predict(self, state, t, sigma=None):
        found = self.good.predict(state, t, sigma)
        return self.changes.get("predict", lambda found, state: found)(found, state)
