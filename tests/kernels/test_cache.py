"""Compiled code is known by its content, and serves another process."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.kernels.cache import KernelCache
from fuzzytrack.kernels.compile import compiled, fingerprint
from fuzzytrack.trackers.lane_tracker import runner

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


def test_values_beside_each_other_are_told_apart():
    assert fingerprint(make(1.0, (1, 23))) != fingerprint(make(1.0, (12, 3)))
    assert fingerprint(make(1.0, ("a", "b"))) != fingerprint(make(1.0, ("a', 'b",)))
    assert fingerprint(make(1.0, ((1, 2), 3))) != fingerprint(make(1.0, (1, (2, 3))))


def test_a_changed_global_shows(monkeypatch):
    before = fingerprint(make(1.0))
    monkeypatch.setitem(globals(), "SCALE", 3.0)
    assert fingerprint(make(1.0)) != before


def test_what_cannot_be_told_has_none():
    assert fingerprint(make(object())) is None
    assert fingerprint(make({"a": 1.0})) is None


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


SCRIPT = """
import numpy as np
import fuzzytrack as ft
from fuzzytrack.lanes import runner
runner.COMPILE_ABOVE = 0
z = np.random.default_rng(3).normal(size=(9, 4)).cumsum(axis=0)
result = ft.AlphaBetaTracker(ft.FixedGains(0.4, 0.1)).run(np.arange(9.0), z)
print(result.filtered.tobytes().hex())
"""


def test_another_process_takes_what_one_has_compiled(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}

    def run():
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        return done.stdout, {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*.nbc")}

    first, files = run()
    assert len(files) == 3  # step, steady, and the passage that is the same for all trackers
    second, same_files = run()
    assert second == first
    assert same_files == files  # nothing was compiled anew
    for file in files:
        file.write_bytes(file.read_bytes()[:1000])
    third, repaired = run()
    assert third == first
    assert all(repaired[file] != files[file] for file in files)


def test_names_of_compiled_functions_follow_their_content():
    def name(function):
        dispatcher = compiled(function)
        dispatcher(1.0)
        return next(iter(dispatcher.overloads.values())).fndesc.mangled_name

    first, again, other = (name(make(offset)).encode() for offset in (1.0, 1.0, 2.0))
    digests = [fingerprint(make(offset))[:24].encode() for offset in (1.0, 1.0, 2.0)]
    for text, digest in zip((first, again, other), digests, strict=True):
        assert digest in text
    assert digests[0] == digests[1] != digests[2]
    # What cannot be told has a name of its own.
    assert name(make(1.0, (np.float64(2.0),))) != name(make(1.0, (np.float64(2.0),)))


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """Function that compiles, with its files in a folder of its own."""
    import numba

    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))

    def compile_and_call(offset):
        function = make(offset)
        dispatcher = compiled(function, fingerprint(function))
        return dispatcher(1.0), Path(dispatcher._cache.cache_path)

    return compile_and_call


def test_only_the_newest_files_stay(kept, monkeypatch):
    monkeypatch.setattr("fuzzytrack.kernels.cache.KEPT", 2)
    for offset in (1.0, 2.0, 3.0):
        value, folder = kept(offset)
        assert value == 2.0 + offset
    assert len(list(folder.glob("kernel-*.nbc"))) == 2
    assert not [p for p in folder.iterdir() if p.suffix != ".nbc"]


def test_a_disk_that_is_full_is_no_harm(kept, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("tempfile.mkstemp", full)
    assert kept(5.0)[0] == 7.0


def test_numba_asks_the_cache_for_no_more():
    cache = KernelCache(helper, "0")
    cache.enable(), cache.disable(), cache.flush()
    assert os.path.isdir(os.path.dirname(cache.cache_path))


SEVERAL = """
import sys
import numpy as np
import fuzzytrack as ft
from fuzzytrack.schedulers import KalmanCV
from fuzzytrack.trackers.lane_tracker import runner

z = np.random.default_rng(3).normal(size=(9, 4, 1)).cumsum(axis=0)
dts, sigmas = np.ones((9, 1)), np.full((1, 1, 1), 2.0)
schedulers = {
    "slow": ft.FixedGains(0.2, 0.02), "fast": ft.FixedGains(0.8, 0.6), "kalman": KalmanCV(0.5)
}
for name in sys.argv[1:]:
    core = runner(ft.AlphaBetaTracker(schedulers[name]), 1)
    plain, native = (core(core.fresh(4), z, dts, sigmas, native=way)[1] for way in (False, True))
    for output in plain:
        assert np.array_equal(plain[output], native[output], equal_nan=True), (name, output)
"""


def test_code_from_disk_and_new_code_are_not_mixed_up(tmp_path):
    """Each process compiles in another order, so that Numba's own counters differ."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    for order in (["slow"], ["fast", "slow"], ["kalman", "slow", "fast"], ["fast", "kalman"]):
        done = subprocess.run(
            [sys.executable, "-c", SEVERAL, *order], env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
    # For each scheduler step and steady, and the passage.
    assert len(list(tmp_path.rglob("kernel-*.nbc"))) == 7
