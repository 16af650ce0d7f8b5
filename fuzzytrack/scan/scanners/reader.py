"""Configuration of a scan tracker read from a YAML tree, with the place of every mistake."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any

from fuzzytrack.errors import in_one_sentence
from fuzzytrack.numerals import is_number
from fuzzytrack.plugins import Registry
from fuzzytrack.reprs import constructor_code
from fuzzytrack.scan.part import Parameter, Part, Word, declared
from fuzzytrack.yamltree import Document, Node, Scalar, quoted, suggestion

__all__ = ["FORMAT_VERSION", "NONE", "PART", "SENSOR", "Configuration", "Roles", "ScannerReader"]

FORMAT_VERSION = "1"
#: Key of the part in the mapping of a role.
PART = "part"
#: Key of the sensor, which is a part that has no role.
SENSOR = "sensor"
#: The part of a role that a file need not name.
NONE = "none"

#: For each role the registry of its parts.
Roles = Mapping[str, Registry[Any]]

_WORDS = ("scanner", "name", "description", "based_on")
_FIRST_WORD = re.compile(r"\w+")


@dataclass(frozen=True, repr=False)
class Configuration:
    """What a file says of a scan tracker.

    Attributes
    ----------
    name : str
    description : str
        What it is for; may be empty.
    parts : tuple of (str, Part)
        The sensor, and the part of every role, in the order of the roles.
    based_on : str
        Name or path of the configuration that it changes; empty if there is none.
    """

    name: str
    description: str
    parts: tuple[tuple[str, Part], ...]
    based_on: str = ""

    def __repr__(self) -> str:
        return constructor_code(self)

    def part(self, role: str) -> Part:
        """The part of a role, or the sensor."""
        return dict(self.parts)[role]

    def with_part(self, role: str, part: Part) -> Configuration:
        """The same with another part of a role."""
        parts = tuple((each, part if each == role else old) for each, old in self.parts)
        return replace(self, parts=parts)


class ScannerReader:
    """Reader of the configuration in a YAML document.

    Parameters
    ----------
    document : Document
        The document; it gives errors their place in the file.
    sensor : type of Part
        What the numbers of the sensor are.
    roles : mapping of str to Registry
        The registry of the parts of each role.
    base : callable
        ``base(text)`` is the configuration that a file is based on.
    """

    def __init__(
        self,
        document: Document,
        sensor: type[Part],
        roles: Roles,
        base: Callable[[str], Configuration],
    ) -> None:
        self.document = document
        self.sensor = sensor
        self.roles = roles
        self.base = base

    def configuration(self) -> Configuration:
        """Read the whole document.

        Raises
        ------
        ScannerError
            At the first error in the document.
        """
        document = self.document
        top = document.fields(
            document.root, "the configuration", ("name",), (*_WORDS, SENSOR, *self.roles)
        )
        self._check_version(top)
        based_on, before = "", None
        if "based_on" in top:
            based_on = document.text(top["based_on"], "based_on")
            with document.at(top["based_on"]):
                before = self.base(based_on)
        return Configuration(
            document.text(top["name"], "name"),
            document.text(top["description"], "description") if "description" in top else "",
            (
                (SENSOR, self._sensor(top, before)),
                *((role, self._part(role, top, before)) for role in self.roles),
            ),
            based_on,
        )

    def _check_version(self, top: Mapping[str, Node]) -> None:
        if "scanner" in top:
            version = self.document.text(top["scanner"], "scanner")
            if version != FORMAT_VERSION:
                raise self.document.error(
                    top["scanner"],
                    f"scanner: version {version} of the format is unknown; this is version "
                    f"{FORMAT_VERSION}",
                )

    def _sensor(self, top: Mapping[str, Node], before: Configuration | None) -> Part:
        old = None if before is None else before.part(SENSOR)
        if SENSOR not in top:
            if old is None:
                raise self.document.error(
                    self.document.root, f"the configuration lacks the key {SENSOR!r}"
                )
            return old
        return self._made(SENSOR, self.sensor, old, top[SENSOR], ())

    def _part(self, role: str, top: Mapping[str, Node], before: Configuration | None) -> Part:
        """Part of a role."""
        old = None if before is None else before.part(role)
        node = top.get(role)
        if node is None:
            if old is None and NONE not in self.roles[role].names():
                raise self.document.error(
                    self.document.root,
                    f"the configuration lacks the key {role!r}; "
                    f"one of {', '.join(self.roles[role].names())}",
                )
            part: Part = self.roles[role].get(NONE)() if old is None else old
            return part
        if isinstance(node, Scalar):
            return self._made(role, self._kind(role, node), old, None, ())
        named = self.document.entries(node, role).get(PART)
        if named is not None:
            return self._made(role, self._kind(role, named[1]), old, node, (PART,))
        if old is None:
            raise self.document.error(node, f"{role} lacks the key {PART!r}")
        return self._made(role, type(old), old, node, (PART,))

    def _kind(self, role: str, node: Node) -> type[Part]:
        """Kind of part that a node names."""
        registry = self.roles[role]
        name = self.document.choice(node, role, registry.names())
        try:
            found = registry.get(name)
        except ValueError as error:  # of a package that cannot be imported
            raise self.document.error(node, str(error)) from error
        if not (isinstance(found, type) and issubclass(found, Part)):
            raise self.document.error(
                node, f"{role} {name!r} must be a class derived from Part, got {found!r}"
            )
        return found

    def _made(
        self,
        role: str,
        kind: type[Part],
        old: Part | None,
        node: Node | None,
        others: Collection[str],
    ) -> Part:
        """Part of a kind, with the numbers of a mapping; the rest as before, or by default."""
        known = declared(kind)
        nodes: dict[str, Node] = {}
        if node is not None:
            nodes = self.document.fields(node, role, (), (*others, *known))
        given = {
            key: self._value(f"{role}: {key}", known[key], nodes[key])
            for key in nodes
            if key in known
        }
        try:
            # A part of the same kind keeps what the file does not say.
            return replace(old, **given) if type(old) is kind else kind(**given)
        # Numbers that do not fit one another; a part of a plug-in may raise anything.
        except Exception as error:
            first = _FIRST_WORD.match(str(error))
            where = nodes.get(first.group() if first else "", node) or self.document.root
            message = str(error) if isinstance(error, ValueError) else in_one_sentence(error)
            raise self.document.error(where, f"{role}: {message}") from error

    def _value(self, what: str, meant: Parameter | Word, node: Node) -> float | int | str:
        """Value of a number or word of a part."""
        unit = f" ({meant.unit})" if isinstance(meant, Parameter) and meant.unit else ""
        allowed = "a word" if isinstance(meant, Word) else f"{meant.allowed}{unit}"
        text = self.document.text(node, what, allowed)
        if isinstance(meant, Word):
            if not meant.allows(text):
                guess = suggestion(text, meant.choices)
                raise self.document.error(node, f"{what}: unknown word {quoted(text)}{guess}")
            return text
        value = float(text) if is_number(text) else None
        if value is None or not meant.allows(value):
            raise self.document.error(node, f"{what} must be {allowed}, not {quoted(text)}")
        return int(value) if meant.whole else value
