"""Values of a YAML text set, inserted and removed in place; all else in it stays byte for byte.

They know nothing of what the text is about: whoever uses them reads the result.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import Any

from fuzzytrack.errors import FileError
from fuzzytrack.numerals import is_number
from fuzzytrack.yamledits import DocumentEdits
from fuzzytrack.yamltree import Mapping, Node, Scalar, quoted, suggestion
from fuzzytrack.yamltree import Sequence as ListNode

__all__ = ["Path", "Value", "insert_value", "remove_value", "set_value"]

#: Keys and indices that lead to a value, as ``("target", "waypoints", 2)``.
Path = Sequence[str | int]
#: A word, a number, or a list of values.
Value = Any

_PLAIN = re.compile(r"[^\W\d](?:[\w.-]*\w)?")
# Words that some YAML readers take for true, false or null.
_NOT_WORDS = frozenset({"y", "n", "yes", "no", "on", "off", "true", "false", "null"})


def set_value(
    text: str, path: Path, value: Value, file: str = "<text>", failure: type[FileError] = FileError
) -> str:
    """Set a value, or add a key with it to the end of a mapping.

    Parameters
    ----------
    text : str
        A YAML text.
    path : sequence of str and int
        Keys and indices that lead to it. If only the last key is missing, it is added.
    value : str, number or list
        The new value; of a list of the same length only the items that differ are changed.
    file : str
        Name for messages.
    failure : type
        The error to raise.

    Returns
    -------
    str
        The changed text.

    Raises
    ------
    FileError
        Of the type `failure`, if the text is no YAML, the path leads nowhere, or an anchor shares
        the value with other parts.
    """
    edits, outer = _outer(text, path, file, failure)
    key, expected = path[-1], _plain(edits.document.root)
    if isinstance(outer, Mapping) and key not in outer.entries and isinstance(key, str):
        edits.insert(outer, len(outer.entries), f"{_written(key)}: {_written(value)}")
    else:
        _replace(edits, _below(edits, outer, key), value)
    _plain_at(expected, path[:-1])[key] = _plain_value(value)
    return _checked(edits, expected, outer)


def insert_value(
    text: str, path: Path, value: Value, file: str = "<text>", failure: type[FileError] = FileError
) -> str:
    """Insert an item into a list, before the one that a path leads to, or at the end.

    Parameters
    ----------
    text, path, value, file, failure
        As for `set_value`; the path ends with an index, at most the length of the list.

    Raises
    ------
    FileError
        As for `set_value`.
    """
    edits, outer = _outer(text, path, file, failure)
    index = path[-1]
    if not isinstance(outer, ListNode) or not isinstance(index, int):
        raise edits.document.error(
            outer, f"{_spelled(path[:-1])} is no list; set the value instead"
        )
    if not 0 <= index <= len(outer.items):
        raise edits.document.error(
            outer,
            f"{_spelled(path[:-1])} has {len(outer.items)} items; no item {index} can be added",
        )
    expected = _plain(edits.document.root)
    edits.insert(outer, index, _written(value))
    _plain_at(expected, path[:-1]).insert(index, _plain_value(value))
    return _checked(edits, expected, outer)


def remove_value(
    text: str, path: Path, file: str = "<text>", failure: type[FileError] = FileError
) -> str:
    """Remove a key with its value from a mapping, or an item from a list.

    Parameters
    ----------
    text, path, file, failure
        As for `set_value`.

    Raises
    ------
    FileError
        As for `set_value`; also for the only entry.
    """
    edits, outer = _outer(text, path, file, failure)
    key, expected = path[-1], _plain(edits.document.root)
    _below(edits, outer, key)
    if isinstance(outer, Mapping):
        edits.remove(outer, list(outer.entries).index(str(key)))
    elif isinstance(outer, ListNode) and isinstance(key, int):
        edits.remove(outer, key)
    del _plain_at(expected, path[:-1])[key]
    return _checked(edits, expected, outer)


# -------------------------------------------------------------------- places


def _outer(
    text: str, path: Path, file: str, failure: type[FileError]
) -> tuple[DocumentEdits, Node]:
    """The collection that holds what a path leads to."""
    edits = DocumentEdits(text, file, failure)
    if not path:
        raise failure("path: must have at least one key")
    node = edits.document.root
    for key in path[:-1]:
        node = _below(edits, node, key)
    return edits, node


def _below(edits: DocumentEdits, node: Node, key: str | int) -> Node:
    if isinstance(node, Mapping):
        if isinstance(key, str) and key in node.entries:
            return node.entries[key][1]
        word = str(key)
        raise edits.document.error(
            node, f"path: no key {quoted(word)} here{suggestion(word, node.entries)}"
        )
    if isinstance(node, ListNode) and isinstance(key, int) and 0 <= key < len(node.items):
        return node.items[key]
    count = f"a list of {len(node.items)}" if isinstance(node, ListNode) else node.kind
    raise edits.document.error(node, f"path: no {quoted(str(key))} in {count}")


def _spelled(path: Path) -> str:
    return ".".join(map(str, path)) or "the text"


# -------------------------------------------------------------------- values


def _replace(edits: DocumentEdits, node: Node, value: Value) -> None:
    """Write a value in the place of another one, which stays where it is equal."""
    if isinstance(node, ListNode) and isinstance(value, list) and len(value) == len(node.items):
        for item, each in zip(node.items, value, strict=True):
            _replace(edits, item, each)
    elif _plain(node) != _plain_value(value):
        edits.replace(node.start if node.alias else edits.content(node), node.end, _written(value))


def _written(value: Value) -> str:
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_written, value))}]"
    if isinstance(value, str):
        plain = _PLAIN.fullmatch(value) and value.casefold() not in _NOT_WORDS
        return value if plain or is_number(value) else json.dumps(value, ensure_ascii=False)
    return repr(float(value)).removesuffix(".0")


def _plain(node: Node) -> Any:
    """Values below a node; numbers in whatever way they are written are equal."""
    if isinstance(node, Mapping):
        return {word: _plain(value) for word, (_, value) in node.entries.items()}
    if isinstance(node, ListNode):
        return [_plain(item) for item in node.items]
    return _plain_value(node.text) if isinstance(node, Scalar) else None


def _plain_value(value: Value) -> Any:
    if isinstance(value, list | tuple):
        return [_plain_value(each) for each in value]
    if isinstance(value, str):
        return float(value) if is_number(value) else value
    return float(value)


def _plain_at(values: Any, path: Path) -> Any:
    for key in path:
        values = values[key]
    return values


def _checked(edits: DocumentEdits, expected: Any, node: Node) -> str:
    """The changed text, if it has the values that are expected, and no other changes."""
    text = edits.changed()
    document = edits.document
    after = DocumentEdits(text, document.file, document.failure)
    if _plain(after.document.root) != expected:
        raise document.error(node, "other parts share this text by an anchor; write them out first")
    return text
