"""Losses of searches, kept in a file so that an interrupted tuning can be continued."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path

from fuzzytrack.io.files import whole_file

__all__ = ["Journal"]


@dataclass(frozen=True, eq=False)
class Journal:
    """Losses of searches in a file, with all that they depend on.

    Attributes
    ----------
    path : Path or None
        The file; nothing is kept without one.
    job : dict of str to str
        Everything that the losses depend on, as text.
    losses : list of list of float
        Losses of each search that were kept before.
    """

    path: Path | None
    job: dict[str, str]
    losses: list[list[float]]

    @classmethod
    def open(
        cls, path: str | os.PathLike[str] | None, job: dict[str, str], resume: bool
    ) -> Journal:
        """Prepare the file, or continue the searches that it holds.

        Raises
        ------
        ValueError
            If the file holds a search and `resume` is False, there is none to resume, or it is
            another search; names the difference.
        """
        if path is None:
            if resume:
                raise ValueError("resume: needs the state file of the search to continue")
            return cls(None, job, [])
        place = Path(path)
        if not place.exists():
            if resume:
                raise ValueError(
                    f"resume: {place} does not exist; leave it out, and a new search begins"
                )
            return cls(place, job, [])
        if not resume:
            raise ValueError(
                f"state: {place} holds an earlier search; resume it or choose another file"
            )
        try:
            found = json.loads(place.read_text(encoding="utf-8"))
            then, losses = (
                dict(found["job"]),
                [[float(x) for x in each] for each in found["losses"]],
            )
        except (ValueError, KeyError, TypeError) as error:
            raise ValueError(f"resume: {place} holds no search: {error}") from error
        for key, now in job.items():
            if then.get(key) != now:
                raise ValueError(
                    f"resume: {key} is {now}, in the search of {place} it was {then.get(key)}; "
                    "give the same or choose another file"
                )
        return cls(place, job, losses)

    def write(self, losses: list[list[float]]) -> None:
        """Keep all losses so far; the file appears whole."""
        if self.path is not None:
            with whole_file(self.path) as draft:
                draft.write_text(json.dumps({"job": self.job, "losses": losses}), encoding="utf-8")
