"""What a format of another program lacks, carried in comments that the program skips.

A comment of its own line, ``% fuzzytrack grids {"E": [41, "ends"]}`` in FIS and with ``#`` in FLL,
holds one part as JSON. The readers of this package take it, so that a rule base that is written and
read again computes the same.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from fuzzytrack.errors import Location, RuleBaseError, Word
from fuzzytrack.fuzzy.formats.source_text import SourceText
from fuzzytrack.fuzzy.rulebase import RuleBase, TableLayout
from fuzzytrack.fuzzy.variable import GRIDS, MAX_POINTS
from fuzzytrack.yamltree import quoted

__all__ = ["Carried"]

_LINE = re.compile(r"\s*[%#]+ fuzzytrack ([a-z]+) (.*\S)\s*")
_LONGEST = 100_000
_DEEPEST = 4

#: Keys, and the type of what they carry.
_KEYS: dict[str, type] = {
    "grids": dict, "defaults": dict, "labels": dict, "units": dict, "description": str,
    "source": str, "scheduler": dict, "table": dict,
}  # fmt: skip


@dataclass
class Carried:
    """Parts of a rule base by key, as JSON, each with its place.

    Attributes
    ----------
    parts : dict of str to JSON
    places : dict of str to Location
    """

    parts: dict[str, Any] = field(default_factory=dict)
    places: dict[str, Location] = field(default_factory=dict)

    @classmethod
    def read(cls, source: SourceText) -> Carried:
        """Find the comments in a text.

        Raises
        ------
        RuleBaseError
            If one is not understood.
        """
        found = cls()
        for number, line in enumerate(source.lines, start=1):
            match = _LINE.fullmatch(line)
            if match is None:
                continue
            key, text = match.groups()
            place = source.place(number, match.start(1) + 1)
            if key not in _KEYS or key in found.parts:
                allowed = ", ".join(_KEYS)
                raise RuleBaseError(
                    f"unknown part {quoted(key)} of fuzzytrack, or one given twice; allowed: "
                    f"{allowed}",
                    place,
                )
            found.parts[key] = _json(text, _KEYS[key], place)
            found.places[key] = place
        return found

    @classmethod
    def of(cls, rules: RuleBase, defaults: Mapping[str, float | None]) -> Carried:
        """What other programs lack of a rule base.

        Parameters
        ----------
        rules : RuleBase
        defaults : mapping of str to float or None
            For each output what the format gives where no rule fires; others are carried.
        """
        variables = (*rules.inputs, *rules.outputs)
        layout = rules.layout
        parts: dict[str, Any] = {
            "description": rules.description,
            "source": rules.source,
            "labels": {v.name: v.label for v in variables if v.label},
            "units": {v.name: v.unit for v in variables if v.unit},
            "grids": {v.name: [v.universe.points, v.universe.grid] for v in variables},
            "defaults": {v.name: v.default for v in rules.outputs if v.default != defaults[v.name]},
            "scheduler": dict(rules.scheduler),
            "table": layout
            and {"columns": layout.columns, "rows": layout.rows, "cells": list(layout.cells)},
        }
        return cls({key: part for key, part in parts.items() if part})

    def lines(self, mark: str) -> Iterator[str]:
        """The comments; `mark` begins a comment of the format."""
        for key, part in self.parts.items():
            yield f"{mark} fuzzytrack {key} {json.dumps(part, ensure_ascii=True)}"

    def error(self, key: str, message: str) -> RuleBaseError:
        """Error about one part."""
        return RuleBaseError(f"{key}: {message}", self.places[key])

    # ---------------------------------------------------------------- parts

    def of_variable(self, key: str, name: str) -> Any:
        """What one part says of a variable; None where it says nothing."""
        return self.parts.get(key, {}).get(name)

    def check_names(self, names: tuple[str, ...]) -> None:
        """Raise RuleBaseError if a part names a variable that there is not."""
        for key in ("grids", "defaults", "labels", "units"):
            for name in self.parts.get(key, {}):
                if name not in names:
                    raise self.error(key, f"no variable {quoted(name)}; one of {', '.join(names)}")

    def grid(self, name: str) -> tuple[int, str] | None:
        """Points and kind of the grid of a variable."""
        found = self.of_variable("grids", name)
        if found is None:
            return None
        proper = isinstance(found, list) and len(found) == 2
        counted = proper and type(found[0]) is int and 0 < found[0] <= MAX_POINTS
        if not counted or found[1] not in GRIDS:
            raise self.error(
                "grids", f"{name} needs up to {MAX_POINTS} points and one of {', '.join(GRIDS)}"
            )
        return found[0], found[1]

    def default(self, name: str, usual: float | None) -> float | None:
        """Value of an output where no rule fires; `usual` is that of the format."""
        if name not in self.parts.get("defaults", {}):
            return usual
        found = self.parts["defaults"][name]
        if found is not None and (isinstance(found, bool) or not isinstance(found, int | float)):
            raise self.error("defaults", f"{name} needs a number or null")
        return None if found is None else float(found)

    def text(self, key: str, name: str | None = None) -> str:
        """A text; empty where there is none."""
        found = self.parts.get(key, "") if name is None else self.of_variable(key, name)
        if found is None:
            return ""
        if not isinstance(found, str):
            raise self.error(key, f"{name} needs a text")
        return found

    def scheduler(self) -> tuple[tuple[str, str], ...]:
        """Settings of a gain scheduler."""
        found = self.parts.get("scheduler", {})
        if not all(isinstance(value, str) for value in found.values()):
            raise self.error("scheduler", 'settings are texts, such as {"rho": "0.774"}')
        place = self.places.get("scheduler")
        return tuple((Word(key, place), Word(value, place)) for key, value in found.items())

    def layout(self) -> TableLayout | None:
        """How the rules are laid out."""
        found = self.parts.get("table")
        if found is None:
            return None
        cells = found.get("cells")
        texts = [
            found.get("columns"),
            found.get("rows"),
            *(cells if isinstance(cells, list) else [0]),
        ]
        if set(found) != {"columns", "rows", "cells"} or not all(isinstance(t, str) for t in texts):
            raise self.error("table", "needs columns, rows and cells")
        return TableLayout(found["columns"], found["rows"], tuple(found["cells"]))


def _json(text: str, kind: type, place: Location) -> Any:
    """JSON of one type; depth and length are bounded before it is read."""
    deep = text.count("[") + text.count("{") > len(text) // 2 or _depth(text) > _DEEPEST
    try:
        found = None if len(text) > _LONGEST or deep else json.loads(text)
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, kind):
        raise RuleBaseError(f"{quoted(text)} is not the JSON that is expected here", place)
    return found


def _depth(text: str) -> int:
    """Most brackets that are open at one place, strings included."""
    deepest = open_ = 0
    for character in text:
        open_ += (character in "[{") - (character in "]}")
        deepest = max(deepest, open_)
    return deepest
