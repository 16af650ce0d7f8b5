import errno
import os
import sys

import numpy as np
import pytest
from data_files import written

from fuzzytrack.io import check_output, write_table
from fuzzytrack.io.files import check_output_folder, whole_file, whole_folder


def test_replacing_keeps_the_mode_and_follows_links(tmp_path):
    path = written(tmp_path, "old", "out.csv")
    path.chmod(0o640)
    (tmp_path / "link.csv").symlink_to(path)
    write_table(tmp_path / "link.csv", {"a": np.array([1.0])})
    assert path.read_text() == "a\n1.0\n"
    assert path.stat().st_mode & 0o777 == 0o640
    assert (tmp_path / "link.csv").is_symlink()


def test_only_ordinary_files_are_written():
    with pytest.raises(OSError, match="ordinary file"):
        check_output("/dev/null")


@pytest.mark.skipif(sys.version_info >= (3, 13), reason="such links are replaced")
def test_links_to_one_another_are_refused(tmp_path):
    (tmp_path / "a.csv").symlink_to(tmp_path / "b.csv")
    (tmp_path / "b.csv").symlink_to(tmp_path / "a.csv")
    for check in (check_output, check_output_folder):
        with pytest.raises(OSError, match="is a loop of symbolic links; remove it"):
            check(tmp_path / "a.csv")


def test_a_folder_that_cannot_be_written_to(tmp_path, monkeypatch):
    monkeypatch.setattr("os.access", lambda path, mode: False)
    with pytest.raises(PermissionError, match="cannot be written to"):
        write_table(tmp_path / "a.csv", {"a": np.array([1.0])})


@pytest.mark.parametrize("whole", [whole_file, whole_folder])
def test_a_full_disk_is_said_of_the_file(tmp_path, whole):
    path = tmp_path / "out.csv"
    for number in (errno.ENOSPC, errno.EDQUOT):
        with pytest.raises(OSError, match="nothing was written") as caught, whole(path):
            raise OSError(number, "write error")
        assert caught.value.filename == str(path)
        assert caught.value.strerror.startswith(os.strerror(number))
    # An error of another file, as one that is read meanwhile, stays what it is.
    with pytest.raises(OSError, match="Input/output error") as caught, whole(path):
        raise OSError(errno.EIO, "Input/output error", "plots.csv")
    assert caught.value.filename == "plots.csv"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("whole", "name", "left"),
    [
        (whole_file, "a[1].csv", ".a[1].0123abcd.part.csv"),
        (whole_folder, "tracks", ".tracks.0123abcd.part"),
    ],
)
def test_what_a_killed_run_has_left_is_removed_a_day_later(tmp_path, whole, name, left):
    def make(path, hours):
        if whole is whole_folder:
            path.mkdir()
            inner = written(path, "half", "0.parquet")
            os.utime(path, (0, 0))
        else:
            inner = written(tmp_path, "half", path.name)
        when = os.stat(inner).st_mtime - 3600 * hours
        os.utime(inner, (when, when))

    others = (".b.0123abcd.part.csv", left.replace("abcd", "wxyz"))
    for other in others:
        make(tmp_path / other, 30)
    make(tmp_path / left, 30)
    # Another run may be writing this one.
    at_work = left.replace("0123", "4567")
    make(tmp_path / at_work, 20)
    with whole(tmp_path / name) as draft:
        if whole is whole_file:
            draft.write_text("all")
    assert {path.name for path in tmp_path.iterdir()} == {name, at_work, *others}
