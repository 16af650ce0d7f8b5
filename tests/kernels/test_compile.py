"""Compiled functions, and how another process finds their code again."""

import ctypes
import os
import subprocess
import sys

import numpy as np
import pytest

from fuzzytrack.kernels.cache import VARIABLE, KernelFolder
from fuzzytrack.kernels.compile import compiled, entry_point
from fuzzytrack.kernels.rebuild import fingerprint

pytestmark = pytest.mark.untraced


def make(offset):
    def function(x):
        return 2.0 * x + offset

    return function


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Folder in which this process keeps compiled code."""
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    return KernelFolder(tmp_path)


def python(code, *words, **environment):
    done = subprocess.run(
        [sys.executable, "-c", code, *words],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_code_is_kept_once_a_content(folder):
    for offset in (1.0, 2.0, 1.0):
        assert compiled(make(offset))(3.0) == 6.0 + offset
    assert len(folder.files()) == 2


def test_damaged_files_are_replaced(folder):
    compiled(make(1.0))(3.0)
    ((file, _),) = folder.files()
    whole = file.read_bytes()
    middle = len(whole) // 2
    for damaged in (b"", whole[:1000], whole[:middle] + b"fuzzy" + whole[middle + 5 :]):
        file.write_bytes(damaged)
        assert compiled(make(1.0))(3.0) == 7.0
        assert len(file.read_bytes()) > 1000


def test_files_under_another_name_are_replaced(folder):
    for offset in (1.0, 2.0):
        compiled(make(offset))(3.0)
    (one, _), (other, _) = folder.files()
    one.write_bytes(other.read_bytes())
    for offset in (1.0, 2.0):
        assert compiled(make(offset))(3.0) == 6.0 + offset
    assert one.read_bytes() != other.read_bytes()


def test_code_that_needs_what_is_no_longer_there_is_replaced(folder, monkeypatch):
    compiled(make(1.0))(3.0)
    ((file, _),) = folder.files()
    whole = file.read_bytes()
    with monkeypatch.context() as change:
        change.setattr("pickle.loads", lambda code: [])
        assert compiled(make(1.0))(3.0) == 7.0
    assert len(file.read_bytes()) == len(whole)


def test_names_of_compiled_functions_follow_their_content():
    def name(function):
        dispatcher = compiled(function)
        dispatcher(1.0)
        return next(iter(dispatcher.overloads.values())).fndesc.qualname

    def untellable(x):
        return x * np.pi

    first, again, other = (name(make(offset)) for offset in (1.0, 1.0, 2.0))
    assert fingerprint(make(1.0))[:24] in first
    assert first == again != other
    # What cannot be told has a name of its own.
    assert name(untellable) != name(untellable)


def test_a_full_disk_does_no_harm(folder, monkeypatch):
    said = []

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("tempfile.mkstemp", full)
    monkeypatch.setattr("fuzzytrack.kernels.cache._warn_once", said.append)
    assert [compiled(make(offset))(1.0) for offset in (5.0, 6.0)] == [7.0, 8.0]
    assert said == [f"{folder.path}: No space left on device"] * 2


def test_nothing_is_kept_on_request(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for value in ("", "off"):
        monkeypatch.setenv(VARIABLE, value)
        assert compiled(make(7.0))(1.0) == 9.0
    assert list(tmp_path.iterdir()) == []


RUN = """
import numpy as np
import fuzzytrack as ft
from fuzzytrack.lanes import runner
runner.COMPILE_ABOVE = 0
z = np.random.default_rng(3).normal(size=(9, 4)).cumsum(axis=0)
result = ft.AlphaBetaTracker(ft.FixedGains(0.4, 0.1)).run(np.arange(9.0), z)
print(result.filtered.tobytes().hex())
"""


def test_another_process_takes_what_one_has_compiled(folder, tmp_path):
    def run():
        found = python(RUN)
        return found, {file.name: file.stat().st_ino for file in tmp_path.iterdir()}

    first, files = run()
    assert len(files) == 3  # step, steady, and the loop over blocks that all trackers share
    second, same_files = run()
    assert second == first
    assert same_files == files  # nothing was compiled anew


SEVERAL = """
import sys
import numpy as np
import fuzzytrack as ft
from fuzzytrack.schedulers import KalmanCV
from fuzzytrack.trackers.runners import runner

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


def test_code_from_disk_and_new_code_are_not_mixed_up(folder):
    """Each process compiles in another order, so that Numba's own counters differ."""
    for order in (["slow"], ["fast", "slow"], ["kalman", "slow", "fast"], ["fast", "kalman"]):
        python(SEVERAL, *order)
    # For each scheduler step and steady, and the loop over blocks.
    assert len(folder.files()) == 7


CONSTANT = """
import settings
from fuzzytrack.kernels.compile import compiled

def by_module(x):
    return x * settings.FACTOR


print(compiled(by_module)(3.0))
"""


def test_a_constant_of_another_module_may_change_between_processes(folder, tmp_path):
    home = tmp_path / "modules"
    home.mkdir()
    path = os.pathsep.join([str(home), os.environ.get("PYTHONPATH", "")])
    for factor in (2.0, 5.0):
        (home / "settings.py").write_text(f"FACTOR = {factor}\n")
        found = python(CONSTANT, PYTHONPATH=path, PYTHONDONTWRITEBYTECODE="1")
        assert float(found) == 3.0 * factor
    assert folder.files() == []


def test_functions_called_by_address():
    def power(numbers, count):
        for i in range(count):
            numbers[i] = numbers[i] * numbers[i]

    made = entry_point(power, "vpi")
    numbers = (ctypes.c_double * 3)(1.5, 2.0, 3.0)
    ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_ssize_t)(made.address)(numbers, 2)
    assert list(numbers) == [2.25, 4.0, 3.0]


def test_code_for_another_type_of_number_is_other_code(folder):
    """Also where the types of the arguments do not show it."""

    def more(count):
        return count + int(large)

    large = 16_777_217.0
    for dtype, expected in ((np.float64, 16_777_217), (np.float32, 16_777_216)) * 2:
        made = entry_point(more, "ii", dtype)
        function = ctypes.CFUNCTYPE(ctypes.c_ssize_t, ctypes.c_ssize_t)(made.address)
        assert function(3) == expected + 3
    assert len(folder.files()) == 2
