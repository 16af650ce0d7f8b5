"""The command that shows and clears compiled code, and commands where nothing can be kept."""

import json
import os
import shutil
import subprocess
import sys
import tempfile

import pytest

from fuzzytrack.kernels import cache
from fuzzytrack.kernels.cache import VARIABLE, KernelFolder


@pytest.fixture
def folder(tmp_path, monkeypatch):
    path = tmp_path / "kernels"
    monkeypatch.setenv(VARIABLE, str(path))
    return KernelFolder(path)


def test_what_is_kept_is_shown(run, folder):
    folder.write("a", 1_500_000 * b"x")
    folder.write("b", 500_000 * b"x")
    assert run("cache").stdout.splitlines() == [
        f"folder:  {folder.path}",
        "kept:    2 files, 2 MB, of 500 files, 100 MB at most",
        "usable:  yes",
    ]
    assert json.loads(run("cache", "--json").stdout) == {
        "folder": str(folder.path),
        "usable": True,
        "problem": None,
        "files": 2,
        "bytes": 2_000_000,
        "most_files": cache.MOST_FILES,
        "most_bytes": cache.MOST_BYTES,
    }


def test_what_is_kept_is_removed(run, folder):
    folder.write("a", 1_500_000 * b"x")
    assert run("cache", "--clear").stdout.splitlines()[:1] == ["removed: 1 file, 1.5 MB"]
    assert folder.files() == []
    again = json.loads(run("cache", "--clear", "--json").stdout)
    assert (again["removed_files"], again["removed_bytes"]) == (0, 0)


def test_why_nothing_is_kept_is_said(run, folder, monkeypatch):
    folder.path.write_text("a file in its place")
    assert run("cache").stdout.splitlines()[-1] == (
        f"usable:  no, {folder.path} cannot be made: File exists"
    )
    monkeypatch.setenv(VARIABLE, "off")
    assert run("cache").stdout.splitlines() == [
        "folder:  none",
        "kept:    0 files, 0 MB, of 500 files, 100 MB at most",
        "usable:  no, FUZZYTRACK_CACHE_DIR says so",
    ]
    assert json.loads(run("cache", "--json").stdout)["folder"] is None


# ---------------------------------------------------------------- nothing can be kept


def stderr_of(*words, home, folder):
    """Run a command of this interpreter in a folder; gives its stderr."""
    done = subprocess.run(
        words,
        env={"HOME": home, "PATH": os.defpath, "PYTHONPATH": os.environ.get("PYTHONPATH", "")},
        cwd=folder,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stderr


needs_posix = pytest.mark.skipif(os.name != "posix", reason="says where caches are by HOME")


@pytest.mark.untraced
@needs_posix
def test_a_home_that_cannot_be_made(tmp_path):
    # A job that is large enough to be compiled, for one tracker.
    said = stderr_of(
        sys.executable, "-m", "fuzzytrack", "testbed", "llinas-m1", "--runs", "6000",
        "--trackers", "fixed:alpha=0.53:beta=0.21", "-o", "out", home="/dev/null/home",
        folder=tmp_path,
    )  # fmt: skip
    assert (tmp_path / "out" / "report.html").is_file()
    assert said.count("warning: compiled code is not kept for other processes: /dev/null/") == 1


COMPILE_TWO = """
from fuzzytrack.kernels.compile import compiled

def made(offset):
    return lambda x: x + offset

assert [compiled(made(offset))(1.0) for offset in (1.0, 2.0)] == [2.0, 3.0]
"""


@pytest.mark.untraced
@needs_posix
def test_a_user_who_can_write_nowhere_else():
    setpriv = shutil.which("setpriv")
    if setpriv is None or os.geteuid() != 0:
        pytest.skip("only root can become another user, and setpriv does it")
    # He may read everything, since the interpreter may be in the home folder of root.
    rights = "-all,+dac_read_search"
    nobody = [
        setpriv, "--reuid=65534", "--regid=65534", "--clear-groups", f"--inh-caps={rights}",
        f"--ambient-caps={rights}", f"--bounding-set={rights}",
    ]  # fmt: skip
    if subprocess.run([*nobody, sys.executable, "-c", "pass"], capture_output=True).returncode:
        pytest.skip("this system does not let root become another user who may read everything")
    # The folders of pytest are closed to others.
    with tempfile.TemporaryDirectory() as folder:
        os.chown(folder, 65534, 65534)
        words = (*nobody, sys.executable, "-c", COMPILE_TWO)
        said = stderr_of(*words, home="/nonexistent", folder=folder)
    assert said.count("compiled code is not kept for other processes: /nonexistent/") == 1
