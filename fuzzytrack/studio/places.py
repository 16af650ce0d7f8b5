"""Where the parts of a rule base are in its text, and which of them share a text."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from fuzzytrack.errors import FileError
from fuzzytrack.yamltree import Document, Mapping, Node, Sequence

__all__ = ["Places", "places_of"]


@dataclass(frozen=True)
class Places:
    """Lines of a text, from 1, and what shares it.

    Attributes
    ----------
    shared : dict of str to list of str
        Variables that share their sets by an anchor, each with the others.
    sets : dict of (str, str) to int
        Line of each set, by variable and name.
    operators : dict of str to int
        Line of the operators that an output has of its own.
    rules : list of (int, int)
        For each rule of a list, its line, and how many rules have its text: ``if any`` is short for
        several. Empty for a table.
    """

    shared: dict[str, list[str]] = field(default_factory=dict)
    sets: dict[tuple[str, str], int] = field(default_factory=dict)
    operators: dict[str, int] = field(default_factory=dict)
    rules: list[tuple[int, int]] = field(default_factory=list)


def places_of(text: str) -> Places:
    """Places of a rule base in YAML; of what cannot be read there are none."""
    found = Places()
    try:
        root = Document(text.removeprefix("\ufeff"), "<text>").root
    except FileError:
        return found
    groups: dict[int, list[str]] = {}
    for name, variable in _variables(root):
        own, sets = _at(variable, "operators"), _at(variable, "sets")
        if own is not None:
            found.operators[name] = own.line
        if isinstance(sets, Mapping):
            # What an alias repeats has the same entries.
            groups.setdefault(id(sets.entries), []).append(name)
            found.sets.update(((name, word), key.line) for word, (key, _) in sets.entries.items())
    for names in groups.values():
        if len(names) > 1:
            found.shared.update((name, [n for n in names if n != name]) for name in names)
    rules = _at(root, "rules")
    for item in rules.items if isinstance(rules, Sequence) else ():
        either = _at(item, "if any")
        count = len(either.entries) if isinstance(either, Mapping) else 1
        found.rules.extend([(item.line, count)] * count)
    return found


def _variables(root: Node) -> Iterator[tuple[str, Node]]:
    for role in ("inputs", "outputs"):
        variables = _at(root, role)
        if isinstance(variables, Mapping):
            for name, (_, variable) in variables.entries.items():
                yield name, variable


def _at(node: Node, key: str) -> Node | None:
    found = node.entries.get(key) if isinstance(node, Mapping) else None
    return found[1] if found else None
