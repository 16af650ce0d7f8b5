"""YAML files that come with fuzzytrack, by name, and other files by path."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from fuzzytrack.errors import FileError
from fuzzytrack.yamltree import MAX_BYTES, Document, quoted, suggestion

__all__ = ["Shipped"]

PathOrName = str | os.PathLike[str]


@dataclass(frozen=True)
class Shipped:
    """Shipped files of one kind.

    Attributes
    ----------
    what : str
        What they are, for messages: "rule base".
    folder : str
        Folder that holds them: inside an installed package, beside it in a source checkout.
    marker : str
        A file by which the folder is distinguished from another of the same name.
    failure : type
        The error to raise.
    endings : str
        How paths of such files end, for messages.
    """

    what: str
    folder: str
    marker: str
    failure: type[FileError]
    endings: str = ".yaml"

    def names(self) -> tuple[str, ...]:
        """Names of the files, without suffix, in alphabetical order."""
        return tuple(sorted(path.stem for path in self._directory().glob("*.yaml")))

    def path(self, name_or_path: PathOrName) -> Path:
        """Path of a shipped file by name, or the path that was given.

        Parameters
        ----------
        name_or_path : str or path
            A name, or a path: anything that ends in ``.yaml`` or ``.yml``, holds a separator or is
            a path object. The file need not exist.

        Raises
        ------
        FileError
            Of the kind `failure`, if it is the name of no shipped file.
        TypeError
            If it is neither.
        """
        if not isinstance(name_or_path, str | os.PathLike):
            raise TypeError(
                f"a {self.what} needs a name or a path, got {type(name_or_path).__name__}"
            )
        if not isinstance(name_or_path, str) or _is_path(name_or_path):
            return Path(name_or_path)
        names = self.names()
        if name_or_path not in names:
            raise self.failure(
                f"unknown {self.what} {quoted(name_or_path)}{suggestion(name_or_path, names)}; "
                f"or a path that ends in {self.endings}"
            )
        return self._directory() / f"{name_or_path}.yaml"

    def spelled(self, name_or_path: PathOrName) -> str:
        """Name or path as a text that `path` reads the same way."""
        text = os.fspath(name_or_path)
        is_name = isinstance(name_or_path, str) or _is_path(text)
        return text if is_name else os.path.join(os.curdir, text)

    def document(self, name_or_path: PathOrName) -> Document:
        """Document of a shipped file by name, or of the file at a path.

        Raises
        ------
        FileError
            Of the kind `failure`, if there is no such name, or the file cannot be read or is not
            YAML.
        """
        path = self.path(name_or_path)
        try:
            with open(path, "rb") as stream:
                # One byte more than allowed is enough to refuse the rest.
                text = stream.read(MAX_BYTES + 1)
        except (OSError, ValueError) as error:
            why = error.strerror if isinstance(error, OSError) else str(error)
            raise self.failure(f"cannot read {self.what} {quoted(str(path))}: {why}") from error
        return Document(text, str(path), failure=self.failure)

    def _directory(self) -> Path:
        package = Path(__file__).resolve().parent
        for directory in (package / self.folder, package.parent / self.folder):
            if (directory / self.marker).is_file():
                return directory
        raise self.failure(f"the shipped {self.what}s are missing; they belong in {package}")


def _is_path(text: str) -> bool:
    separators = {"/", os.sep}
    return text.endswith((".yaml", ".yml")) or any(s in text for s in separators)
