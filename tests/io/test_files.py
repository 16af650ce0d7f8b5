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
