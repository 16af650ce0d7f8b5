"""Finished chunks of a Monte Carlo job, kept in a folder."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import pickle
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.io.files import whole_file
from fuzzytrack.simulation.scenario import Scenario
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.version import __version__

__all__ = ["ChunkStore", "remove_chunks"]


_FOLDER, _JOB = "chunks", "job.json"
# Parts of a scenario that have no effect on the numbers.
_WITHOUT_EFFECT = ("name", "source", "trackers", "first_scored")


@dataclasses.dataclass(frozen=True)
class ChunkStore:
    """Finished chunks of one job; made by `open`.

    A file is complete or does not exist, and names its job.

    Attributes
    ----------
    folder : Path
        Where the files are.
    mark : str
        Of the job: everything that its numbers depend on, but for the number of runs.
    """

    folder: Path
    mark: str

    @classmethod
    def open(
        cls,
        folder: str | os.PathLike[str],
        scenario: Scenario,
        trackers: Mapping[str, Tracker],
        seed: int,
        size: int,
        *,
        resume: bool,
    ) -> ChunkStore:
        """Prepare the folder of a job, or continue the job whose chunks it holds.

        Parameters
        ----------
        folder : str or path
            Folder of the results; chunks are below it.
        scenario, trackers, seed, resume
            As for `fuzzytrack.testbed.montecarlo.monte_carlo`.
        size : int
            Runs a chunk.

        Raises
        ------
        ValueError
            If the folder holds chunks and `resume` is False, or they are of another job.
        OSError
            If the folder cannot be written to.
        """
        place = Path(folder) / _FOLDER
        job = _job(scenario, trackers, seed, size)
        if any(place.glob("*.npz")):
            if not resume:
                raise ValueError(
                    f"folder: {folder} holds results of an earlier run; "
                    "resume it or choose another folder"
                )
            _check_same(job, _earlier(place), folder)
        place.mkdir(parents=True, exist_ok=True)
        for draft in place.glob(".*.part.*"):  # of a process that was killed
            draft.unlink(missing_ok=True)
        with whole_file(place / _JOB) as draft:
            draft.write_text(json.dumps(job, indent=1) + "\n", encoding="utf-8")
        return cls(place, _digest(job))

    def load(self, runs: range) -> dict[str, Array] | None:
        """Arrays of a chunk by name; None if there is no complete file of just these runs."""
        try:
            # Opened here, since numpy leaves a file open that is not an archive.
            with self._path(runs).open("rb") as file:
                arrays = dict(np.load(file, allow_pickle=False))
        except (OSError, EOFError, ValueError, zipfile.BadZipFile):
            return None
        mark = arrays.pop("mark", None)
        return arrays if mark is not None and str(mark) == self.mark else None

    def save(self, runs: range, arrays: Mapping[str, Array]) -> None:
        """Keep a chunk."""
        with whole_file(self._path(runs)) as draft, draft.open("wb") as file:
            np.savez(file, mark=np.array(self.mark), **arrays)  # type: ignore[arg-type]

    def _path(self, runs: range) -> Path:
        return self.folder / f"runs-{runs.start:09d}-{len(runs)}.npz"


def remove_chunks(folder: str | os.PathLike[str]) -> None:
    """Remove the finished chunks of the job in a folder, if there are any."""
    for file in (Path(folder) / _FOLDER).glob("*.npz"):
        file.unlink(missing_ok=True)


def _job(
    scenario: Scenario, trackers: Mapping[str, Tracker], seed: int, size: int
) -> dict[str, str]:
    """Everything that the numbers of a job depend on, as text."""
    job = {
        "fuzzytrack": __version__,
        "numpy": np.__version__,
        "seed": str(seed),
        "runs a chunk": str(size),
        "trackers": ", ".join(trackers),
    }
    for field in dataclasses.fields(scenario):
        if field.name not in _WITHOUT_EFFECT:
            job[f"scenario.{field.name}"] = _words(getattr(scenario, field.name))
    return job | {f"tracker {name}": _words(tracker) for name, tracker in trackers.items()}


def _check_same(job: Mapping[str, str], earlier: Mapping[str, str], folder: object) -> None:
    for key in (*job, *(key for key in earlier if key not in job)):
        now, then = job.get(key, "not there"), earlier.get(key, "not there")
        if now != then:
            raise ValueError(
                f"resume: {key} is {now}, in the earlier run of {folder} it was {then}; "
                "give the same or choose another folder"
            )


def _earlier(place: Path) -> dict[str, str]:
    try:
        found = json.loads((place / _JOB).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ValueError(f"resume: {place / _JOB} cannot be read: {error}") from error
    if not isinstance(found, dict):
        raise ValueError(f"resume: {place / _JOB} does not describe a job")
    return {str(key): str(value) for key, value in found.items()}


def _words(value: Any) -> str:
    """Text of a short value; of any other its type and a digest."""
    if value is None or isinstance(value, bool | int | float | str):
        return str(value)
    return f"{type(value).__name__} {_digest(value)[:16]}"


def _digest(value: Any) -> str:
    """Digest of the contents of a value, the same in every process."""
    state = hashlib.sha256()
    _feed(state, value)
    return state.hexdigest()


def _feed(state: Any, value: Any) -> None:
    """Feed a value to a hash, each part with its kind and length so that no two look alike."""
    parts: list[Any] = []
    if isinstance(value, np.ndarray) and value.dtype != object:
        kind = f"array {value.dtype.str} {value.shape}"
        content = np.ascontiguousarray(value).tobytes()
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        kind, content = f"{type(value).__module__}.{type(value).__qualname__}", b""
        parts = [(f.name, getattr(value, f.name)) for f in dataclasses.fields(value)]
    elif isinstance(value, Mapping):
        kind, content, parts = "mapping", b"", list(value.items())
    elif isinstance(value, tuple | list):
        kind, content, parts = "sequence", b"", list(value)
    elif isinstance(value, set | frozenset):
        kind, content, parts = "set", b"", sorted(map(_digest, value))
    elif isinstance(value, str):
        kind, content = "text", value.encode()
    elif value is None or isinstance(value, bool | int | float | bytes):
        kind, content = type(value).__name__, repr(value).encode()
    else:
        kind, content = f"{type(value).__module__}.{type(value).__qualname__}", pickle.dumps(value)
    state.update(f"{kind} {len(content)} {len(parts)}\n".encode())
    state.update(content)
    for part in parts:
        _feed(state, part)
