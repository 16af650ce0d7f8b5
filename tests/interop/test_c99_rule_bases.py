"""Shipped rule bases in C, and filters with them, over 100,000 random inputs each."""

import warnings

import numpy as np
import pytest
from fuzz_c99 import filters, rule_bases

import fuzzytrack as ft
from fuzzytrack.fuzzy.loading import shipped_rulebases
from fuzzytrack.interop.c99.build import CompilerError, find_compiler
from fuzzytrack.interop.c99.compiled_filter import compiled_c

try:
    find_compiler()
except CompilerError as error:
    pytest.skip(str(error), allow_module_level=True)

pytestmark = pytest.mark.untraced

COUNT = 100_000
#: Largest differences of float from double (m, m/s) on a track 2 km wide with a noise of 10 m.
FLOAT = {"filtered": 0.02, "predicted": 0.03, "velocity": 0.01}


def test_rule_bases_as_functions():
    found = list(rule_bases(COUNT, np.random.default_rng(1)))
    assert {what.partition(",")[0] for what, _, _ in found} == set(shipped_rulebases())
    assert [row for row in found if not row[1] <= row[2]] == []


def test_filters():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ft.TrackWarning)
        found = list(filters(COUNT, np.random.default_rng(1)))
    assert len(found) == sum(bool(ft.load_rulebase(name).scheduler) for name in shipped_rulebases())
    assert [row for row in found if not row[1] <= row[2]] == []


@pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning")
@pytest.mark.parametrize("name", ["stiffness-damping", "maneuver", "omega-schedule", "chan-style"])
def test_single_precision_over_ten_thousand_plots(name):
    random = np.random.default_rng(3)
    tracker = ft.AlphaBetaTracker(name)
    t = np.cumsum(random.uniform(0.5, 1.5, 10_000))
    z = 2e3 * np.stack([np.cos(0.02 * t), np.sin(0.02 * t)], axis=-1)
    z = z + random.normal(0.0, 10.0, z.shape)
    z[random.random(len(t)) < 0.2] = np.nan
    single = z.astype(np.float32)
    run = compiled_c(tracker, axes=2, number="float").run(t, single, 10.0)
    double = tracker.run(t, single, 10.0)
    for vector, bound in FLOAT.items():
        error = np.nanmax(np.abs(getattr(run, vector) - getattr(double, vector)))
        assert 0.0 < error < bound
    # The library's own single precision, in the same order of operations.
    library = tracker.run(t, single, 10.0, dtype=np.float32)
    assert np.nanmax(np.abs(run.filtered - library.filtered)) < FLOAT["filtered"]
