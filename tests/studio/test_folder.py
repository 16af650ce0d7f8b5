"""Files of one folder by name."""

import os

import pytest

from fuzzytrack.studio.folder import MAX_DRAFTS, FileEntry, Folder, FolderError


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "inside").mkdir()
    return Folder(tmp_path / "inside")


def test_files_are_listed(folder):
    for name in ("b.yaml", "A b.yml", "c.csv", ".hidden.yaml", "x.txt"):
        (folder.path / name).write_text("x")
    (folder.path / "d.yaml").mkdir()
    (folder.path / "link.yaml").symlink_to("b.yaml")
    assert folder.list() == [FileEntry("A b.yml", 1), FileEntry("b.yaml", 1), FileEntry("c.csv", 1)]


@pytest.mark.parametrize(
    "name",
    [
        *("../x.yaml", "/etc/x.yaml", "a/b.yaml", "a\\b.yaml", ".x.yaml", "x", "x.py", "", ".."),
        *("a\0.yaml", "x.yaml\n", "x" * 200 + ".yaml", "C:x.yaml", None, 3),
    ],
)
def test_other_names_are_refused(folder, name):
    for call in (folder.open, folder.place, lambda n: folder.save(n, "x")):
        with pytest.raises(FolderError, match="must be the name of a file"):
            call(name)
    assert os.listdir(folder.path.parent) == ["inside"]


def test_links_pipes_and_folders_are_not_opened(folder, tmp_path):
    (tmp_path / "secret.yaml").write_text("secret")
    (folder.path / "link.yaml").symlink_to(tmp_path / "secret.yaml")
    for call in (folder.open, lambda n: folder.save(n, "x", overwrite=True)):
        with pytest.raises(FolderError, match=r"link\.yaml: is a symbolic link"):
            call("link.yaml")
    os.mkfifo(folder.path / "pipe.yaml")
    (folder.path / "sub.yaml").mkdir()
    with pytest.raises(FolderError, match=r"pipe\.yaml: is not an ordinary file"):
        folder.open("pipe.yaml")
    with pytest.raises(FolderError, match=r"sub\.yaml: "):
        folder.open("sub.yaml")
    assert (tmp_path / "secret.yaml").read_text() == "secret"


def test_texts_are_kept_byte_for_byte(folder):
    text = "\ufeffa: é\r\nb: 1"
    version = folder.save("a.yaml", text)
    assert (folder.path / "a.yaml").read_bytes() == text.encode()
    assert folder.open("a.yaml").text == text
    assert folder.open("a.yaml").version == version


def test_two_sessions_do_not_overwrite_each_other(folder):
    first = folder.save("a.yaml", "1")
    second = folder.save("a.yaml", "2", {first})
    with pytest.raises(FolderError, match=r"a\.yaml: has been changed since it was opened"):
        folder.save("a.yaml", "3", {first})
    with pytest.raises(FolderError, match=r"a\.yaml: exists already"):
        folder.save("a.yaml", "3")
    assert folder.open("a.yaml").text == "2"
    folder.save("a.yaml", "3", {first, second})
    folder.save("a.yaml", "4", {first}, overwrite=True)
    assert folder.open("a.yaml").text == "4"
    (folder.path / "a.yaml").unlink()
    folder.save("a.yaml", "5", {first})
    assert os.listdir(folder.path) == ["a.yaml"]


def test_large_and_odd_files_are_refused(folder):
    (folder.path / "large.yaml").write_bytes(b"x" * (128 * 1024 + 1))
    (folder.path / "odd.yaml").write_bytes(b"\xff")
    with pytest.raises(FolderError, match=r"large\.yaml: is larger than 128 KiB"):
        folder.open("large.yaml")
    with pytest.raises(FolderError, match=r"odd\.yaml: is not UTF-8"):
        folder.open("odd.yaml")
    with pytest.raises(FolderError, match=r"new\.yaml: the text is longer"):
        folder.save("new.yaml", "x" * (128 * 1024 + 1))
    with pytest.raises(FolderError, match=r"none\.yaml: cannot be opened: No such file"):
        folder.open("none.yaml")
    with pytest.raises(FolderError, match="there is no folder"):
        Folder(folder.path / "none")


def test_drafts(folder):
    for number in range(MAX_DRAFTS + 2):
        folder.save_draft(str(number), f"text {number}")
        os.utime(folder.path / f".draft-{number}.json", (number, number))
    assert folder.drafts()[:2] == ("9", "8")
    assert len(folder.drafts()) == MAX_DRAFTS
    assert folder.draft("9") == "text 9"
    assert folder.list() == []
    folder.drop_draft("9")
    with pytest.raises(FolderError, match="draft 9: cannot be opened"):
        folder.draft("9")
    with pytest.raises(FolderError, match="must be up to 32 digits and small letters"):
        folder.draft("../x")
