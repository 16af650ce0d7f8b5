"""Recordings that a page was given, and those of the folder, by name."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

from fuzzytrack.studio.folder import Folder, FolderError
from fuzzytrack.studio.limits import MOST_PLOTS
from fuzzytrack.yamltree import quoted

__all__ = ["MOST_UPLOADS", "Uploads", "check_plots"]

#: Recordings that the server holds, of all pages; then the oldest is dropped.
MOST_UPLOADS = 16
_NAME = re.compile(r"\w[\w ()+.-]{0,95}\.csv", re.IGNORECASE)
_PIECE = 2**20


class Uploads:
    """Recordings of pages, kept until the server ends.

    Parameters
    ----------
    folder : Folder
        Where recordings are looked for that a page has not given.
    """

    def __init__(self, folder: Folder) -> None:
        self._folder = folder
        self._kept: dict[tuple[str, str], Path] = {}
        self._place: tempfile.TemporaryDirectory[str] | None = None

    def put(self, page: str, name: str, text: str) -> Path:
        """Keep a recording under its name, for one page.

        Raises
        ------
        FolderError
            If it is not named like a CSV file.
        """
        if not _NAME.fullmatch(name):
            raise FolderError(
                f"name: {quoted(name)} must be the name of a file that ends in .csv, up to 100 "
                "letters, digits, blanks and ._()+-"
            )
        if self._place is None:
            self._place = tempfile.TemporaryDirectory(prefix="fuzzytrack-studio-")
        self._kept.pop((page, name), None)
        while len(self._kept) >= MOST_UPLOADS:
            self._kept.pop(next(iter(self._kept))).unlink(missing_ok=True)
        path = Path(self._place.name) / page / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="")
        self._kept[page, name] = path
        return path

    def path(self, page: str, name: str) -> Path:
        """Path of a recording that a page has given, or of one of the folder.

        Raises
        ------
        FolderError
            If there is none.
        """
        found = self._kept.get((page, name)) or self._folder.place(name)
        if not found.is_file():
            raise FolderError(f"{name}: is not in the folder; drop the file on the page")
        return found

    def close(self) -> None:
        """Remove what was kept."""
        if self._place is not None:
            self._place.cleanup()


def check_plots(path: Path) -> None:
    """Refuse a recording with more plots than the studio takes, before it is read.

    Raises
    ------
    ValueError
    """
    lines = 0
    with open(path, "rb") as stream:
        while piece := stream.read(_PIECE):
            lines += piece.count(b"\n")
            if lines > MOST_PLOTS + 1:
                raise ValueError(
                    f"{path.name}: has more than {MOST_PLOTS} plots; use the command line, or a "
                    "part of it"
                )
