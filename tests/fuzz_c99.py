"""Compare exported C with the library on many random inputs.

Run as ``python tests/fuzz_c99.py --count 1000000 --seed 1``: functions of arithmetic against long
double, shipped rule bases as functions against the fuzzy engine's arrays, and whole filters against
compiled runs. It prints the largest differences, and fails where they are larger than is stated.
"""

from __future__ import annotations

import argparse
import math
import sys
import warnings
from collections.abc import Iterator

import numpy as np

import fuzzytrack as ft
from fuzzytrack.fuzzy.kernel import infer_function
from fuzzytrack.fuzzy.loading import shipped_rulebases
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.interop.c99.arithmetic import BOUNDS
from fuzzytrack.interop.c99.compiled import compiled_functions
from fuzzytrack.interop.c99.compiled_filter import compiled_c
from fuzzytrack.interop.c99.translation import translated

VECTORS = ("filtered", "velocity", "acceleration", "predicted", "innovation")
#: Largest error of a rule base in double precision, as a part of the range of its output.
RULES = 1e-14


def exponential(x):
    return math.exp(x)


def logarithm(x):
    return math.log(x)


def cosine(x):
    return math.cos(x)


def power(x, y):
    return x**y


def arithmetic(count: int, random: np.random.Generator) -> Iterator[tuple[str, float, float]]:
    """Errors of functions in units of the last place, and their bounds."""
    wide = random.uniform(-80.0, 80.0, (count, 1))
    pairs = [np.exp(random.uniform(-8.0, 8.0, count)), random.uniform(-9.0, 9.0, count)]
    cases = {
        "exp": (exponential, np.exp, wide), "log": (logarithm, np.log, np.exp(wide)),
        "cos": (cosine, np.cos, 1e3 * wide), "pow": (power, np.power, np.stack(pairs, axis=1)),
    }  # fmt: skip
    for (name, number), bound in BOUNDS.items():
        function, exact, x = cases[name]
        dtype = np.float64 if number == "double" else np.float32
        x = x.astype(dtype)
        (in_c,) = compiled_functions([translated(function, name="f", number=number)])
        precise = exact(*x.T.astype(np.longdouble))
        errors = np.abs((in_c(x)[:, 0].astype(np.longdouble) - precise) / precise)
        yield f"{name}, {number}", float(errors.max() / np.finfo(dtype).eps), bound


def rule_bases(count: int, random: np.random.Generator) -> Iterator[tuple[str, float, float]]:
    """Errors of rule bases as parts of the ranges of their outputs."""
    for name in shipped_rulebases():
        rules = ft.load_rulebase(name)
        try:
            infer = infer_function(FuzzySystem(rules, "exact"))
        except ValueError:
            continue
        lows, highs = np.transpose([(v.universe.low, v.universe.high) for v in rules.inputs])
        inside = random.uniform(lows, highs, (count, len(lows)))
        beyond = inside + random.normal(0.0, 1.0, inside.shape) * (highs - lows)
        x = np.where(random.random((count, 1)) < 0.2, beyond, inside)
        forms = (("number",) * len(lows),)
        (in_c,) = compiled_functions([translated(infer, name="f", arguments=forms)])
        found = in_c(x)
        values = FuzzySystem(rules, "exact").evaluate(x)
        for k, output in enumerate(rules.outputs):
            width = output.universe.high - output.universe.low
            same = np.isnan(values[output.name]) == np.isnan(found[:, k])
            error = np.nanmax(np.abs(found[:, k] - values[output.name])) / width
            yield f"{name}, {output.name}", math.inf if not same.all() else float(error), RULES


def filters(count: int, random: np.random.Generator) -> Iterator[tuple[str, float, float]]:
    """Differences of whole filters from compiled runs (m, m/s); in double there are none."""
    steps = 250
    tracks = max(1, count // (2 * steps))
    t = np.cumsum(random.uniform(0.5, 1.5, steps))
    angle = 0.02 * t[:, None] + random.uniform(0.0, 6.3, tracks)
    truth = 2e3 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    sigma = random.uniform(5.0, 15.0, truth.shape)
    z = truth + random.normal(size=truth.shape) * sigma
    z[random.random(truth.shape[:2]) < 0.2] = np.nan
    for name in shipped_rulebases():
        if not ft.load_rulebase(name).scheduler:
            continue
        tracker = ft.AlphaBetaTracker(name)
        reference = tracker.run(t, z, sigma)
        run = compiled_c(tracker, axes=2).run(t, z, sigma)
        pairs = [(getattr(run, vector), getattr(reference, vector)) for vector in VECTORS]
        same = all(np.array_equal(np.isnan(mine), np.isnan(theirs)) for mine, theirs in pairs)
        error = max(float(np.nanmax(np.abs(mine - theirs))) for mine, theirs in pairs)
        yield (
            f"filter with {name}, {tracks * steps * 2} coordinates",
            error if same else math.inf,
            0.0,
        )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=None)
    given = parser.parse_args()
    random = np.random.default_rng(given.seed)
    wrong = 0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ft.TrackWarning)
        warnings.simplefilter("ignore", ft.NoRuleFiresWarning)
        for check in (arithmetic, rule_bases, filters):
            for what, error, bound in check(given.count, random):
                wrong += not error <= bound
                print(f"{what:60} {error:9.3g} of {bound:g}", flush=True)
    print("all within their bounds" if not wrong else f"{wrong} beyond their bounds")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
