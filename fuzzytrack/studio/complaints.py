"""What the loader says of a text, with the place in it and the cell or set that stands there."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace

from fuzzytrack.errors import FileError, in_one_sentence
from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.schedulers.fuzzy import FuzzyScheduler
from fuzzytrack.yamltree import Document, Mapping, Node, Sequence

__all__ = ["Complaint", "complaint_of", "complaints_of_rules"]

#: Cells with a mistake that are named at once, and characters that are read for them.
MAX_CELLS = 50
MAX_READ = 400_000

#: Keys and indices that lead to a value, as ``("rules", "table", "ns", 3)``.
Path = tuple[str | int, ...]


@dataclass(frozen=True)
class Complaint:
    """A mistake in a text.

    Attributes
    ----------
    message : str
        What is wrong, what was allowed and what to do.
    line, column : int or None
        Place in the text, from 1; None where it has none.
    path : tuple of str and int
        Keys and indices that lead to what stands there, as ``("rules", "table", "ns", 3)``;
        empty where that is not known.
    cell : dict of str to str
        Conditions of the rule, by input, where the place is a cell of a table; otherwise empty.
    stops : bool
        False if the text loads, but the rule base cannot schedule gains.
    """

    message: str
    line: int | None = None
    column: int | None = None
    path: Path = ()
    cell: dict[str, str] | None = None
    stops: bool = True


def complaint_of(error: Exception, text: str | None = None, *, stops: bool = True) -> Complaint:
    """Complaint from an error, with the place in the text that it is about.

    Parameters
    ----------
    error : Exception
        A `FileError`, or another one that has no place.
    text : str, optional
        The text that the error is about.
    stops : bool
        See `Complaint`.
    """
    place = error.location if isinstance(error, FileError) else None
    if place is None or not isinstance(error, FileError):
        message = str(error) if isinstance(error, ValueError) else in_one_sentence(error)
        return Complaint(message, stops=stops)
    path: Path = ()
    cell: dict[str, str] = {}
    if text is not None:
        try:
            document = Document(text, place.file)
        except FileError:
            pass  # it is no YAML, and has no keys
        else:
            path = _path(document.root, place.line, place.column)
            cell = _cell(document.root, path)
    return Complaint(error.message, place.line, place.column, path, cell, stops)


def complaints_of_rules(
    text: str, file: str, rules: RuleBase | None = None
) -> tuple[RuleBase | None, tuple[Complaint, ...]]:
    """Rule base of a text, and what is wrong with it.

    The loader stops at the first mistake. Where that is in a cell of a table, the cell is set to
    one without a mistake, and the next one is looked for, up to 50 cells.

    Parameters
    ----------
    text : str
        A text that may be a rule base in YAML.
    file : str
        Name for places.
    rules : RuleBase, optional
        The rule base of the text, if it has been read already.

    Returns
    -------
    rules : RuleBase or None
        None if the text does not load.
    complaints : tuple of Complaint
        In the order of the text, and last that the rule base cannot schedule gains.
    """
    try:
        rules = rules or loads_rulebase(text, file)
    except FileError as error:
        return None, tuple(_all_complaints(text, file, error))
    if rules.scheduler:
        try:
            FuzzyScheduler(rules)
        except Exception as error:  # a plug-in may raise anything
            return rules, (complaint_of(error, text, stops=False),)
    return rules, ()


def _all_complaints(text: str, file: str, error: FileError) -> Iterator[Complaint]:
    first = complaint_of(error, text)
    yield first
    mended, found = text, first
    for _ in range(min(MAX_CELLS, MAX_READ // max(len(text), 1)) - 1):
        changed = _without_cell(mended, file, found)
        if changed is None:
            return
        mended = changed
        try:
            loads_rulebase(mended, file)
        except FileError as next_error:
            found = complaint_of(next_error, mended)
        else:
            return
        if not found.cell:
            return  # the mended cells may be the reason
        yield _in_original(found, text, mended, file)


def _without_cell(text: str, file: str, complaint: Complaint) -> str | None:
    """The text with a cell that has no mistake in place of one that has; None if it cannot be."""
    if not complaint.cell:
        return None
    body = text.removeprefix("\ufeff")
    root = Document(body, file).root
    outputs, node = _at(root, ("outputs",)), _at(root, complaint.path[:4])
    if not isinstance(outputs, Mapping) or node is None or node.anchored:
        return None
    pairs = []
    for name in outputs.entries:
        sets = _at(root, ("outputs", name, "sets"))
        if not isinstance(sets, Mapping) or not sets.entries:
            return None
        pairs.append(f"{json.dumps(name)}: {json.dumps(next(iter(sets.entries)))}")
    return f"{body[: node.start]}{{{', '.join(pairs)}}}{body[node.end :]}"


def _in_original(found: Complaint, text: str, mended: str, file: str) -> Complaint:
    """A complaint about a mended text with its place in the original one."""
    was = _at(Document(text, file).root, found.path)
    now = _at(Document(mended, file).root, found.path)
    if was is None or now is None or found.column is None:
        return found
    return replace(found, line=was.line, column=was.column + found.column - now.column)


def _path(root: Node, line: int, column: int) -> Path:
    """Way to the value, or to the key, that starts last before a place."""
    found: tuple[tuple[int, int], Path] = ((0, 0), ())
    for path, start in _starts(root, ()):
        best, way = found
        # What an alias repeats stands where its anchor is: the first way there is taken.
        deeper = start == best and path[: len(way)] == way
        if (start > best or deeper) and start <= (line, column):
            found = start, path
    return found[1]


def _starts(node: Node, path: Path) -> Iterator[tuple[Path, tuple[int, int]]]:
    if isinstance(node, Mapping):
        for word, (key, value) in node.entries.items():
            yield (*path, word), (key.line, key.column)
            yield (*path, word), (value.line, value.column)
            yield from _starts(value, (*path, word))
    elif isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            yield (*path, index), (item.line, item.column)
            yield from _starts(item, (*path, index))


def _at(node: Node | None, path: Path) -> Node | None:
    """Value that a way leads to; None if there is none."""
    for key in path:
        if isinstance(node, Mapping) and key in node.entries:
            node = node.entries[str(key)][1]
        elif isinstance(node, Sequence) and isinstance(key, int) and key < len(node.items):
            node = node.items[key]
        else:
            return None
    return node


def _cell(root: Node, path: Path) -> dict[str, str]:
    """Conditions of a cell of a table, if a way leads into one."""
    if path[:2] != ("rules", "table") or len(path) < 4:
        return {}
    names = [getattr(_at(root, ("rules", key)), "text", None) for key in ("columns", "rows")]
    columns, rows = names
    sets = _at(root, ("inputs", str(columns), "sets"))
    index = path[3]
    if not isinstance(sets, Mapping) or not isinstance(index, int) or not columns or not rows:
        return {}
    words = list(sets.entries)
    return {columns: words[index], rows: str(path[2])} if index < len(words) else {}
