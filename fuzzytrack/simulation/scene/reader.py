"""Scene read from a YAML tree; every error names the place in the file and the word."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import MISSING, fields
from typing import Any, TypeVar

from fuzzytrack.errors import FileError
from fuzzytrack.simulation.scene.clutter import Clutter
from fuzzytrack.simulation.scene.clutter_kinds import CLUTTER
from fuzzytrack.simulation.scene.radar import OwnShip, Radar, ScanTimes
from fuzzytrack.simulation.scene.region import Region
from fuzzytrack.simulation.scene.scene import Scene
from fuzzytrack.simulation.scene.settings import Setting, Settings, settings_of
from fuzzytrack.simulation.scene.targets import TargetGroup
from fuzzytrack.yamltree import Document, Node, Sequence

__all__ = ["FORMAT_VERSION", "SceneReader", "is_scene"]

FORMAT_VERSION = "1"

_REQUIRED = ("scenario", "name", "scans", "radar", "traffic")
_OPTIONAL = ("source", "region", "own", "clutter")

# Other programs write truth values so.
_TRUTH = {"true": "yes", "false": "no"}

SomeSettings = TypeVar("SomeSettings", bound=Settings)


def is_scene(document: Document) -> bool:
    """Whether a document is a scene of many targets rather than a scenario of one."""
    entries = getattr(document.root, "entries", {})
    return "traffic" in entries or ("radar" in entries and "target" not in entries)


class SceneReader:
    """Reader of the scene in a YAML document.

    Parameters
    ----------
    document : Document
        The document; it gives errors their place in the file.
    """

    def __init__(self, document: Document) -> None:
        self.document = document

    def scene(self) -> Scene:
        """Read the whole document.

        Raises
        ------
        ScenarioError
            At the first error in the document.
        """
        document = self.document
        self._check_version()
        top = document.fields(document.root, "the scene", _REQUIRED, _OPTIONAL)
        given: dict[str, Any] = {
            "name": document.text(top["name"], "name"),
            "source": document.text(top["source"], "source") if "source" in top else "",
            "scans": self._part(top["scans"], "scans", ScanTimes),
            "radar": self._part(top["radar"], "radar", Radar),
            "traffic": self._traffic(top["traffic"]),
        }
        if "own" in top:
            given["own"] = self._part(top["own"], "own", OwnShip)
        if "region" in top:
            given["region"] = self._part(top["region"], "region", Region)
        if "clutter" in top:
            given["clutter"] = self._clutter(top["clutter"])
        with self._errors_at(top, document.root):
            return Scene(**given)

    def source(self) -> str:
        """Read the source of the scene only; empty if the file names none."""
        entries = self.document.entries(self.document.root, "the scene")
        return self.document.text(entries["source"][1], "source") if "source" in entries else ""

    def _check_version(self) -> None:
        document = self.document
        entries = document.entries(document.root, "the scene")
        if "scenario" not in entries:
            raise document.error(
                document.root, f"the scene lacks its format version, 'scenario: {FORMAT_VERSION}'"
            )
        document.choice(entries["scenario"][1], "format version", (FORMAT_VERSION,))
        if "target" in entries:
            raise document.error(
                entries["target"][0],
                "target is that of a scenario with one target; a scene has traffic",
            )

    def _traffic(self, node: Node) -> dict[str, TargetGroup]:
        entries = self.document.entries(node, "traffic")
        return {
            name: self._part(value, f"the targets {name!r}", TargetGroup)
            for name, (_, value) in entries.items()
        }

    def _clutter(self, node: Node) -> dict[str, Clutter]:
        document = self.document
        found: dict[str, Clutter] = {}
        for name, (_, value) in document.entries(node, "clutter").items():
            role = f"the clutter {name!r}"
            entries = document.entries(value, role)
            if "kind" not in entries:
                raise document.error(
                    value, f"{role} lacks the key 'kind'; kinds: {', '.join(CLUTTER)}"
                )
            kind = document.choice(entries["kind"][1], "kind of clutter", CLUTTER)
            found[name] = self._part(value, f"{kind} clutter", CLUTTER[kind], "kind")
        return found

    def _part(self, node: Node, role: str, part: type[SomeSettings], *also: str) -> SomeSettings:
        """Read settings; the keys `also` are allowed, and left to others."""
        declared = settings_of(part)
        needed = tuple(each.name for each in fields(part) if each.default is MISSING)
        others = tuple(name for name in declared if name not in needed)
        found = self.document.fields(node, role, needed, (*also, *others))
        values = {
            name: self._value(value, name, declared[name])
            for name, value in found.items()
            if name in declared
        }
        with self._errors_at(found, node):
            return part(**values)

    def _value(self, node: Node, name: str, declared: Setting) -> Any:
        """A value; numbers are checked one by one, so that an error has the place of its own."""
        if declared.form == "part":
            return self._part(node, name, Region)
        if declared.form == "word":
            word = self.document.text(node, name)
            if word in _TRUTH and _TRUTH[word] in declared.words:
                return _TRUTH[word]
            return self.document.choice(node, name, declared.words)
        if declared.form in ("number", "whole") or not isinstance(node, Sequence):
            if declared.form in ("point", "points"):
                self.document.items(node, name)
            return self._number(node, name, declared)
        items = self.document.items(node, name)
        if declared.form == "curve":
            return [self._pair(item, name, declared) for item in items]
        if declared.form == "points":
            return [
                [self._number(each, name, declared) for each in self.document.items(item, name)]
                for item in items
            ]
        return [self._number(item, name, declared) for item in items]

    def _pair(self, node: Node, name: str, declared: Setting) -> list[float]:
        items = self.document.items(node, f"each of the {name}")
        if len(items) != 2:
            raise self.document.error(node, f"{name} must be pairs of numbers, got {len(items)}")
        first = self.document.number(items[0], name)
        return [first, self._number(items[1], name, declared)]

    def _number(self, node: Node, name: str, declared: Setting) -> float:
        value = self.document.number(node, name)
        with self._errors_at({}, node):
            return declared.number(name, value * declared.in_file if declared.unit else value)

    @contextmanager
    def _errors_at(self, found: Mapping[str, Node], node: Node) -> Iterator[None]:
        """Give an error of the model the place of the key that it names, else of `node`."""
        try:
            yield
        except FileError:
            raise
        except ValueError as error:
            named = str(error).partition(" ")[0].rstrip(":")
            raise self.document.error(found.get(named, node), str(error)) from None
