"""The folder in which compiled code is kept, so that another process need not compile it again.

It handles files only; `fuzzytrack.kernels.llvm` chooses their names and contents.
"""

from __future__ import annotations

import os
import re
import stat
import tempfile
import time
import warnings
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from fuzzytrack.errors import CacheWarning

__all__ = ["MOST_BYTES", "MOST_FILES", "VARIABLE", "KernelFolder"]

#: Environment variable that names another folder; empty or ``off``: nothing is kept.
VARIABLE = "FUZZYTRACK_CACHE_DIR"

#: Files and bytes that are kept; those that were not used for the longest time go first.
MOST_FILES = 500
MOST_BYTES = 100_000_000

_PREFIX = "fuzzytrack-kernel-"
#: Raise it when files of older versions can no longer be read; they are removed then.
_FORMAT = 1
_SUFFIX = f".{_FORMAT}"
_DRAFT = ".draft"
# Names of our files, those of other formats included; nothing else in the folder is ever touched.
_OURS = re.compile(rf"{_PREFIX}\w+(?:\.\d+|{re.escape(_DRAFT)})")
#: Age (s) from which the draft of a file is taken for that of a process that was killed.
_DRAFT_IS_LEFT = 3600.0


@dataclass(frozen=True)
class KernelFolder:
    """A folder of compiled code.

    Code from it is run, so it is used only if nobody but its owner can write there: the folder and
    each file must belong to the current user, and group and others must not have the right to write
    (on systems with such permissions).

    Parameters
    ----------
    path : Path or None
        None if nothing is to be kept.
    """

    path: Path | None

    @classmethod
    def of_user(cls) -> KernelFolder:
        """The folder that the environment names, or else one in the user's cache folder."""
        named = os.environ.get(VARIABLE)
        if named is None:
            import platformdirs

            try:
                home = platformdirs.user_cache_path("fuzzytrack", appauthor=False)
            # Older versions return a path that begins with "~" for a user without a home folder.
            except RuntimeError:
                home = Path("~")
            return cls(home / "kernels")
        return cls(None if named in ("", "off") else Path(named).absolute())

    def read(self, name: str) -> bytes | None:
        """Content of a file, or None if there is none that can be trusted."""
        if self.path is None or self._untrusted(self.path):
            return None
        file = self._file(name)
        try:
            with file.open("rb") as stream:
                if _writable_by_others(os.fstat(stream.fileno())):
                    return None
                content = stream.read()
        except OSError:
            return None
        with suppress(OSError):
            # Files that are used stay longest.
            os.utime(file)
        return content

    def write(self, name: str, content: bytes) -> None:
        """Keep a file; if that is impossible, say so once in a process, with a `CacheWarning`."""
        if self.path is None:
            return
        problem = self._make()
        if problem is None:
            try:
                self._replace(self._file(name), content)
            except OSError as error:
                problem = f"{self.path}: {error.strerror or error}"
        if problem is not None:
            _warn_once(problem)
        else:
            self._tidy()

    def problem(self) -> str | None:
        """Why nothing can be kept, or None. Makes the folder if it does not exist."""
        if self.path is None:
            return f"{VARIABLE} says so"
        problem = self._make()
        if problem is None:
            try:
                tempfile.TemporaryFile(dir=self.path).close()
            except OSError as error:
                return f"{self.path}: {error.strerror or error}"
        return problem

    def files(self) -> list[tuple[Path, os.stat_result]]:
        """The files of compiled code with their sizes and times, the one used last first."""
        return [(file, status) for file, status in self._all() if file.suffix == _SUFFIX]

    def clear(self) -> tuple[int, int]:
        """Remove all files of compiled code; returns how many, and their bytes."""
        removed = [status.st_size for file, status in self._all() if _remove(file)]
        return len(removed), sum(removed)

    def _file(self, name: str) -> Path:
        assert self.path is not None
        return self.path / f"{_PREFIX}{name}{_SUFFIX}"

    def _make(self) -> str | None:
        """Make the folder; returns why it cannot be used, or None."""
        assert self.path is not None
        if self.path.is_absolute():
            try:
                self.path.mkdir(mode=0o700, parents=True, exist_ok=True)
            except OSError as error:
                return f"{self.path} cannot be made: {error.strerror or error}"
        return self._untrusted(self.path)

    @staticmethod
    def _untrusted(path: Path) -> str | None:
        """Why a folder is neither read nor written, or None."""
        if not path.is_absolute():
            return "the user has no home folder"
        try:
            return (
                f"{path}: other users can write there" if _writable_by_others(path.stat()) else None
            )
        except OSError as error:
            return f"{path}: {error.strerror or error}"

    def _replace(self, file: Path, content: bytes) -> None:
        """Write a file whole or not at all, for the owner only."""
        # mkstemp gives rights to the owner only.
        handle, draft = tempfile.mkstemp(_DRAFT, _PREFIX, self.path)
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(content)
            os.replace(draft, file)
        except OSError:
            _remove(Path(draft))
            raise

    def _tidy(self) -> None:
        """Remove what is left over, and what is too much."""
        number = size = 0
        for file, status in self._all():
            if file.suffix == _DRAFT:
                unwanted = time.time() - status.st_mtime > _DRAFT_IS_LEFT
            elif file.suffix != _SUFFIX:
                unwanted = True
            else:
                number, size = number + 1, size + status.st_size
                unwanted = number > MOST_FILES or size > MOST_BYTES
            if unwanted:
                _remove(file)

    def _all(self) -> list[tuple[Path, os.stat_result]]:
        """All files of ours, drafts and other formats included, the one used last first."""
        found = []
        if self.path is not None:
            for file in self.path.glob(f"{_PREFIX}*"):
                # Another process may just have removed it.
                with suppress(OSError):
                    if _OURS.fullmatch(file.name):
                        found.append((file, file.stat()))
        return sorted(found, key=lambda pair: pair[1].st_mtime, reverse=True)


def _writable_by_others(status: os.stat_result) -> bool:
    """Whether a user other than the current one could have written there."""
    if not hasattr(os, "geteuid"):
        return False
    return status.st_uid != os.geteuid() or bool(status.st_mode & (stat.S_IWGRP | stat.S_IWOTH))


def _remove(file: Path) -> bool:
    """Remove a file; False if that is impossible, as when another process was first."""
    try:
        file.unlink()
    except OSError:
        return False
    return True


@cache
def _warn_once(problem: str) -> None:
    warnings.warn(
        f"compiled code is not kept for other processes: {problem}; set {VARIABLE} to a folder of "
        "your own, or to off",
        CacheWarning,
        stacklevel=2,
    )
