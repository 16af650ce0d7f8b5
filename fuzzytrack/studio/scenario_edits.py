"""Target and sensors of a scenario changed in its text; all else in the text stays as it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from fuzzytrack.errors import ScenarioError
from fuzzytrack.fuzzy.numbers import written
from fuzzytrack.yamltree import Document, Node
from fuzzytrack.yamltree import Mapping as MappingNode
from fuzzytrack.yamltree import Sequence as ListNode

__all__ = ["Entry", "set_entries"]

#: A number, a word, numbers, or points.
Entry = float | str | Sequence[float] | Sequence[Sequence[float]]

_MARGIN = "  "


def set_entries(text: str, section: str, given: Mapping[str, Entry], drop: Sequence[str]) -> str:
    """Set entries of a part of a scenario.

    Parameters
    ----------
    text : str
        A scenario in YAML.
    section : str
        ``target`` or ``sensors``.
    given : mapping of str to Entry
        Entries that are set, or added.
    drop : sequence of str
        Entries that are removed, if they are there.

    Returns
    -------
    str
        The text. Entries that stay are left as they are written, with their comments, unless one is
        removed: then the part is written anew.

    Raises
    ------
    ScenarioError
        If the text is no YAML, or has no such part.
    """
    document = Document(text, "<text>", failure=ScenarioError)
    top = document.entries(document.root, "the scenario")
    if section not in top:
        raise document.error(document.root, f"the scenario lacks the key {section!r}")
    key, node = top[section]
    if (
        not isinstance(node, MappingNode)
        or node.anchored
        or text[node.start : node.start + 1] == "*"
    ):
        raise document.error(node, f"{section} must be a mapping without an anchor to be changed")
    entries = node.entries
    parts: dict[tuple[int, int], str] = {}
    new = {name: value for name, value in given.items() if name not in entries}
    if node.flow or any(name in entries for name in drop):
        kept = {n: _source(text, v) for n, (_, v) in entries.items() if n not in (*drop, *given)}
        lines = {**kept, **{name: _written(value) for name, value in given.items()}}
        block = "".join(f"\n{_MARGIN}{name}: {value}" for name, value in lines.items())
        parts[key.end, _end(node)] = f":{block}"
    else:
        for name, value in given.items():
            if name in entries:
                old = entries[name][1]
                parts[old.start, _end(old)] = _written(value)
        if new:
            (first, _), *_, (_, last) = [*entries.values()] * 2
            margin = " " * (first.column - 1)
            place = _end_of_line(text, _end(last))
            parts[place, place] = "".join(
                f"\n{margin}{name}: {_written(value)}" for name, value in new.items()
            )
    for (start, end), piece in sorted(parts.items(), reverse=True):
        text = text[:start] + piece + text[end:]
    return text


def _end(node: Node) -> int:
    """End of the characters of a node; a block is said to go on to the next token."""
    if isinstance(node, MappingNode) and not node.flow and node.entries:
        return _end(list(node.entries.values())[-1][1])
    if isinstance(node, ListNode) and not node.flow and node.items:
        return _end(node.items[-1])
    return node.end


def _source(text: str, node: Node) -> str:
    """A node as it is written, on one line."""
    if isinstance(node, ListNode) and not node.flow:
        return "[" + ", ".join(_source(text, item) for item in node.items) + "]"
    return " ".join(text[node.start : _end(node)].split())


def _end_of_line(text: str, place: int) -> int:
    end = text.find("\n", place)
    return len(text) if end < 0 else end


def _written(value: Entry) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, Sequence):
        return "[" + ", ".join(map(_written, value)) + "]"
    return written(value)
