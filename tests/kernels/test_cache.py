"""The folder of compiled code: who may write there, how much it holds, what happens without it."""

import os
import re
import stat
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from fuzzytrack.errors import CacheWarning
from fuzzytrack.kernels import cache
from fuzzytrack.kernels.cache import VARIABLE, KernelFolder

HAS_OWNERS = hasattr(os, "geteuid")
needs_owners = pytest.mark.skipif(not HAS_OWNERS, reason="files have no owner")


@pytest.fixture
def folder(tmp_path):
    return KernelFolder(tmp_path / "deep" / "kernels")


@pytest.fixture(autouse=True)
def nothing_said_yet():
    cache._warn_once.cache_clear()


def ages(folder, *seconds):
    """Let files, in order of their names, be that old."""
    for (file, status), age in zip(sorted(folder.files()), seconds, strict=True):
        os.utime(file, (status.st_atime, status.st_mtime - age))


def contents(folder):
    return {file.read_bytes() for file, _ in folder.files()}


def test_what_is_written_is_read(folder):
    assert folder.read("a") is None
    folder.write("a", b"code")
    folder.write("a", b"newer code")
    assert (folder.read("a"), folder.read("b")) == (b"newer code", None)
    assert [status.st_size for _, status in folder.files()] == [10]


@needs_owners
def test_files_are_for_their_owner_only(folder):
    before = os.umask(0)
    try:
        folder.write("a", b"code")
    finally:
        os.umask(before)
    ((file, status),) = folder.files()
    assert stat.S_IMODE(status.st_mode) == 0o600
    assert stat.S_IMODE(file.parent.stat().st_mode) == 0o700


@needs_owners
@pytest.mark.parametrize("right", [stat.S_IWGRP, stat.S_IWOTH])
def test_what_others_can_write_is_not_read(folder, right):
    folder.write("a", b"code")
    ((file, _),) = folder.files()
    file.chmod(0o600 | right)
    assert folder.read("a") is None
    # What is compiled then takes its place.
    folder.write("a", b"code")
    assert folder.read("a") == b"code"
    folder.path.chmod(0o700 | right)
    assert folder.read("a") is None
    with pytest.warns(CacheWarning, match="kernels: other users can write there; set FUZZYTRACK_C"):
        folder.write("b", b"code")
    assert len(folder.files()) == 1
    assert folder.problem() == f"{folder.path}: other users can write there"


@needs_owners
def test_what_belongs_to_another_user_is_not_read(folder, monkeypatch):
    folder.write("a", b"code")
    user = os.geteuid()
    monkeypatch.setattr(os, "geteuid", lambda: user + 1)
    assert folder.read("a") is None
    monkeypatch.delattr(os, "geteuid")
    # A system without owners.
    assert folder.read("a") == b"code"


def test_those_used_last_stay(folder, monkeypatch):
    monkeypatch.setattr(cache, "MOST_FILES", 3)
    for name in "abc":
        folder.write(name, name.encode())
    ages(folder, 300, 200, 100)
    assert folder.read("a") == b"a"
    folder.write("d", b"d")
    assert contents(folder) == {b"a", b"c", b"d"}


def test_the_size_is_bounded(folder, monkeypatch):
    monkeypatch.setattr(cache, "MOST_BYTES", 250)
    for name in "abc":
        folder.write(name, 100 * name.encode())
        ages(folder, *range(100, 100 * len(folder.files()) + 1, 100))
    assert len(folder.files()) == 2
    assert 100 * b"c" in contents(folder)


def test_leftovers_are_removed(folder):
    folder.write("a", b"code")
    for name, age in (("1.draft", 4000), ("2.draft", 1000), ("a.0", 0)):
        path = folder.path / f"fuzzytrack-kernel-{name}"
        path.write_bytes(b"rest")
        os.utime(path, (0, path.stat().st_mtime - age))
    (folder.path / "letter.txt").write_text("not ours")
    folder.write("b", b"code")
    names = {path.name for path in folder.path.iterdir()} - {f.name for f, _ in folder.files()}
    assert names == {"fuzzytrack-kernel-2.draft", "letter.txt"}
    assert len(folder.files()) == 2
    assert folder.clear() == (3, 12)
    assert [path.name for path in folder.path.iterdir()] == ["letter.txt"]
    assert folder.clear() == (0, 0)


@pytest.mark.parametrize(
    "name", ["kernel-6.1", "kernel-notes.txt", "fuzzytrack-kernel-notes.txt", "fuzzytrack-kernel-"]
)
def test_files_of_others_are_never_removed(folder, name):
    folder.path.mkdir(mode=0o700, parents=True)
    for other in (name, f"{name}.draft.txt"):
        (folder.path / other).write_text("mine")
        os.utime(folder.path / other, (0, 0))
    folder.write("a", b"code")
    assert len(folder.files()) == 1
    assert folder.clear() == (1, 4)
    assert sorted(file.name for file in folder.path.iterdir()) == [name, f"{name}.draft.txt"]


def test_a_full_disk_leaves_no_draft(folder, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.warns(CacheWarning, match="kernels: No space left on device; set FUZZYTRACK_CACHE"):
        folder.write("a", b"code")
    assert list(folder.path.iterdir()) == []
    monkeypatch.setattr("tempfile.TemporaryFile", full)
    assert folder.problem() == f"{folder.path}: No space left on device"


def test_several_may_write_and_remove_at_once(folder, monkeypatch):
    monkeypatch.setattr(cache, "MOST_FILES", 2)

    def work(number):
        name, content = str(number % 5), bytes([number % 5]) * 1000
        folder.write(name, content)
        return folder.read(name) in (content, None)

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(work, range(200)))
    folder.write("last", b"")
    assert len(folder.files()) <= 2
    assert not list(folder.path.glob("*.draft"))


def test_the_environment_names_the_folder(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    assert KernelFolder.of_user() == KernelFolder(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(VARIABLE, "here")
    assert KernelFolder.of_user() == KernelFolder(tmp_path / "here")
    for value in ("", "off"):
        monkeypatch.setenv(VARIABLE, value)
        nothing = KernelFolder.of_user()
        assert nothing.path is None
        nothing.write("a", b"code")
        assert (nothing.read("a"), nothing.files(), nothing.clear()) == (None, [], (0, 0))
        assert nothing.problem() == "FUZZYTRACK_CACHE_DIR says so"
    monkeypatch.delenv(VARIABLE)
    assert "fuzzytrack" in KernelFolder.of_user().path.parts


@pytest.mark.parametrize("older", [False, True], ids=["platformdirs raises", "platformdirs: ~"])
def test_a_user_without_a_home_keeps_nothing(tmp_path, monkeypatch, older):
    def cache_path(name, appauthor):
        if older:
            return Path("~", ".cache", name)
        raise RuntimeError("no home")

    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setattr("platformdirs.user_cache_path", cache_path)
    folder = KernelFolder.of_user()
    assert folder.problem() == "the user has no home folder"
    with pytest.warns(CacheWarning, match="no home folder"):
        folder.write("a", b"code")
    assert folder.read("a") is None
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_made_is_said_once(tmp_path):
    (tmp_path / "file").write_text("")
    folder = KernelFolder(tmp_path / "file" / "kernels")
    words = (
        f"compiled code is not kept for other processes: {folder.path} cannot be made: Not a "
        "directory; set FUZZYTRACK_CACHE_DIR to a folder of your own, or to off"
    )
    with pytest.warns(CacheWarning, match=f"^{re.escape(words)}$"):
        folder.write("a", b"code")
    # A second warning would be an error here.
    folder.write("b", b"code")
    assert folder.read("a") is None
    assert folder.problem() == f"{folder.path} cannot be made: Not a directory"
