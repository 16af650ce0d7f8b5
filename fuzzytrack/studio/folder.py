"""The one folder whose files a session opens and saves, by name."""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import stat
import threading
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

from fuzzytrack.io.files import whole_file
from fuzzytrack.plurals import counted
from fuzzytrack.yamltree import MAX_BYTES, quoted

__all__ = ["MAX_DRAFTS", "FileEntry", "FileText", "Folder", "FolderError", "naming"]

#: Drafts in a folder; one for each session.
MAX_DRAFTS = 8
_MAX_FILES = 1000
_MAX_DRAFT = 8 * MAX_BYTES

_NAME = re.compile(r"\w[\w ()+.-]{0,95}\.(?:yaml|yml|csv)", re.IGNORECASE)
_KEY = re.compile(r"[0-9a-z]{1,32}")


class FolderError(ValueError):
    """A file of the folder that cannot be opened or saved; says what to do."""


@dataclass(frozen=True)
class FileEntry:
    """A file of the folder: its name, and its size in bytes."""

    name: str
    size: int


@dataclass(frozen=True)
class FileText:
    """Text of a file, byte for byte, and the version of the file: a digest of its bytes."""

    text: str
    version: str


class Folder:
    """Files of one folder, by name: no other folder is reached, and no symbolic link followed.

    Parameters
    ----------
    path : str or path
        The folder; it must exist.

    Raises
    ------
    FolderError
        If there is no such folder.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path).resolve()
        if not self.path.is_dir():
            raise FolderError(f"folder: there is no folder {path}; make it, or name another")
        # Between the check of a version and the writing no other session may write.
        self._writing = threading.Lock()

    def list(self) -> list[FileEntry]:
        """Files that a session can open, in alphabetical order.

        Raises
        ------
        FolderError
            If there are more than 1,000, or the folder is no longer there.
        """
        found = []
        try:
            entries = list(os.scandir(self.path))
        except OSError as error:
            raise FolderError(
                f"the folder {self.path.name} cannot be read any more: {error.strerror}; put it "
                "back, or start the studio with another"
            ) from error
        for entry in entries:
            # A file may be removed meanwhile.
            with contextlib.suppress(FileNotFoundError):
                if _NAME.fullmatch(entry.name) and entry.is_file(follow_symlinks=False):
                    found.append(FileEntry(entry.name, entry.stat(follow_symlinks=False).st_size))
        if len(found) > _MAX_FILES:
            raise FolderError(
                f"the folder has {counted(len(found), 'file')}; at most {_MAX_FILES} can be "
                "listed: move some to another folder"
            )
        return sorted(found, key=lambda file: file.name.casefold())

    def without_path(self, text: str) -> str:
        """A message with the names of files of the folder in place of their paths."""
        return text.replace(f"{self.path}{os.sep}", "")

    def place(self, name: str) -> Path:
        """Path of a file of the folder, which need not exist.

        Raises
        ------
        FolderError
            If the name is not that of a YAML or CSV file in the folder itself, or the file is a
            symbolic link.
        """
        if not isinstance(name, str) or not _NAME.fullmatch(name):
            raise FolderError(
                f"name: {quoted(str(name))} must be the name of a file that ends in .yaml, .yml or "
                ".csv, up to 100 letters, digits, blanks and ._()+-, with no folder before it"
            )
        path = self.path / name
        if path.is_symlink():
            raise FolderError(f"{name}: is a symbolic link, which is not followed; copy the file")
        return path

    def open(self, name: str) -> FileText:
        """Read a file of the folder that is text.

        Raises
        ------
        FolderError
            If there is no such file, it is larger than 128 KiB, or is no UTF-8.
        """
        return _file_text(name, _read(name, self.place(name), MAX_BYTES))

    def save(
        self, name: str, text: str, versions: Collection[str] = (), *, overwrite: bool = False
    ) -> str:
        """Write a file of the folder, whole or not at all.

        Parameters
        ----------
        name : str
            Name of the file.
        text : str
            Its text, at most 128 KiB.
        versions : collection of str
            Versions of the file that the text replaces: the one that it was made from, and those
            that the same session has saved. Empty for a file that is not there yet.
        overwrite : bool
            Whether a file of another version is replaced.

        Returns
        -------
        str
            The new version.

        Raises
        ------
        FolderError
            If the file has been changed since by another session or program, the text is too long,
            or the file cannot be written; it is then as it was.
        """
        path, raw = self.place(name), text.encode("utf-8")
        if len(raw) > MAX_BYTES:
            raise FolderError(f"{name}: the text is longer than {MAX_BYTES // 1024} KiB")
        with self._writing:
            if not overwrite:
                self._check_version(name, path, versions)
            try:
                with whole_file(path) as draft:
                    draft.write_bytes(raw)
            except OSError as error:
                why = (error.strerror or str(error)).replace(str(self.path), self.path.name)
                raise FolderError(f"{name}: cannot be saved: {why}; export the text") from error
        return _version(raw)

    def _check_version(self, name: str, path: Path, versions: Collection[str]) -> None:
        if not path.exists():
            return
        if not versions:
            raise FolderError(f"{name}: exists already; choose another name, or replace it")
        if _version(_read(name, path, MAX_BYTES)) not in versions:
            raise FolderError(
                f"{name}: has been changed since it was opened, by another session or program; "
                "save under another name, open it again, or replace it"
            )

    # ---------------------------------------------------------------- drafts

    def drafts(self) -> tuple[str, ...]:
        """Keys of the drafts, the latest first."""
        found = []
        for path in self.path.glob(".draft-*.json"):
            key = path.name.removeprefix(".draft-").removesuffix(".json")
            # Another server may remove one meanwhile.
            with contextlib.suppress(FileNotFoundError):
                if _KEY.fullmatch(key) and not path.is_symlink():
                    found.append((path.stat().st_mtime, key))
        return tuple(key for _, key in sorted(found, reverse=True))

    def draft(self, key: str) -> str:
        """Text of a draft.

        Raises
        ------
        FolderError
            If there is none, or it is no text that a session has written.
        """
        return _file_text(f"draft {key}", _read(f"draft {key}", self._draft(key), _MAX_DRAFT)).text

    def draft_time(self, key: str) -> float:
        """When a draft was written (s since 1970).

        Raises
        ------
        OSError
            If there is none.
        """
        return self._draft(key).stat().st_mtime

    def save_draft(self, key: str, text: str) -> None:
        """Write a draft; of more than 8 in the folder the oldest are removed.

        Parameters
        ----------
        key : str
            Up to 32 digits and small letters.
        text : str
            What `draft` returns later.
        """
        with self._writing:
            with whole_file(self._draft(key)) as draft:
                draft.write_bytes(text.encode("utf-8"))
            for old in self.drafts()[MAX_DRAFTS:]:
                self._draft(old).unlink(missing_ok=True)

    def drop_draft(self, key: str) -> None:
        """Remove a draft, if it is there."""
        self._draft(key).unlink(missing_ok=True)

    def _draft(self, key: str) -> Path:
        if not isinstance(key, str) or not _KEY.fullmatch(key):
            raise FolderError(
                f"draft: {quoted(str(key))} must be up to 32 digits and small letters"
            )
        path = self.path / f".draft-{key}.json"
        if path.is_symlink():
            raise FolderError(f"draft {key}: is a symbolic link, which is not followed; remove it")
        return path


def _read(name: str, path: Path, limit: int) -> bytes:
    """Bytes of an ordinary file that is not too large."""
    try:
        # A link that has come since, a pipe and a device are not opened, or not read.
        flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
        with open(os.open(path, flags | getattr(os, "O_BINARY", 0)), "rb") as stream:
            if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
                raise FolderError(f"{name}: is not an ordinary file; choose another")
            raw = stream.read(limit + 1)
    except OSError as error:
        raise FolderError(f"{name}: cannot be opened: {error.strerror}") from error
    if len(raw) > limit:
        raise FolderError(f"{name}: is larger than {limit // 1024} KiB, too large to be edited")
    return raw


def _file_text(name: str, raw: bytes) -> FileText:
    try:
        return FileText(raw.decode("utf-8"), _version(raw))
    except UnicodeDecodeError:
        raise FolderError(f"{name}: is not UTF-8; save it as UTF-8 with another program") from None


def _version(raw: bytes) -> str:
    return hashlib.sha256(raw).hexdigest()[:32]


@contextlib.contextmanager
def naming(path: Path) -> Iterator[None]:
    """Name a file in messages without its folder, which means nothing to the page."""
    try:
        yield
    except ValueError as failure:
        raise ValueError(str(failure).replace(str(path), path.name)) from None
