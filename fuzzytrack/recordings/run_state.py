"""The state of a live run in a file: a NumPy archive of facts and arrays, in which no code is."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.errors import DataError
from fuzzytrack.io.files import PathLike, whole_file
from fuzzytrack.reprs import summary

__all__ = ["RunState"]


@dataclass(frozen=True, eq=False)
class RunState:
    """State of a live run: arrays of numbers, and the rest in the types of JSON.

    Attributes
    ----------
    facts : dict
        Options, what tracks, first lines, counts.
    arrays : dict of ndarray
        Numbers.
    """

    #: What the file says it is, its version, and the run that makes it.
    format: ClassVar[str]
    version: ClassVar[int]
    run: ClassVar[str]

    facts: dict[str, Any]
    arrays: dict[str, NDArray[Any]]

    def __repr__(self) -> str:
        return summary(self, lines=self.lines)

    @property
    def lines(self) -> int:
        """Lines of the feed that were taken."""
        return int(self.facts["lines"])

    @property
    def checksum(self) -> int:
        """CRC-32 of these lines."""
        return int(self.facts["checksum"])

    @property
    def beginning(self) -> tuple[int, int]:
        """How many lines the feed begins with that say how it is read, and their CRC-32."""
        number, checksum = self.facts["beginning"]
        return int(number), int(checksum)

    @property
    def written(self) -> int:
        """Bytes of the output that hold the answers to these lines."""
        return int(self.facts["written"])

    def save(self, path: PathLike) -> None:
        """Write the state to a file, whole or not at all.

        Parameters
        ----------
        path : str or path

        Raises
        ------
        OSError
            If it cannot be written.
        """
        named = {"format": self.format, "version": self.version, **self.facts}
        facts = np.frombuffer(json.dumps(named).encode(), dtype=np.uint8)
        with whole_file(path) as draft, open(draft, "xb") as file:
            np.savez(file, facts=facts, **self.arrays)  # type: ignore[arg-type]

    @classmethod
    def load(cls, path: PathLike) -> Self:
        """Read a state from a file; no code in it is run.

        Parameters
        ----------
        path : str or path

        Raises
        ------
        DataError
            If it is no such file, or one of another version.
        OSError
            If it cannot be read.
        """
        try:
            with open(path, "rb") as stream, np.load(stream, allow_pickle=False) as file:
                arrays = dict(file)
            facts = json.loads(arrays.pop("facts").tobytes())
            is_state = facts["format"] == cls.format
            version = facts["version"]
        except (ValueError, KeyError, TypeError, AttributeError, EOFError, zipfile.BadZipFile):
            is_state, version = False, None
        if not is_state:
            raise DataError(f"{path}: is no state of a live run of {cls.run}; name another file")
        if version != cls.version:
            raise DataError(
                f"{path}: is of version {version}, and this release reads {cls.version}; remove it "
                "to begin anew"
            )
        return cls(facts, arrays)

    def check_options(self, options: Mapping[str, str], path: PathLike) -> None:
        """Check that a run has the options of this state.

        Parameters
        ----------
        options : mapping of str to str
            Those of the run.
        path : str or path
            File of the state, for messages.

        Raises
        ------
        DataError
            If one differs; names it.
        """
        for name, value in options.items():
            before = self.facts["options"].get(name)
            if before != value:
                raise DataError(
                    f"{path}: was made with {name} {before}, and not {value}; give the same "
                    "options, or remove it to begin anew"
                )
