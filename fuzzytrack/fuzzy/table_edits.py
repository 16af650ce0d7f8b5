"""Columns and rows of a table of rules, added and removed in its text."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.saving import word_text
from fuzzytrack.fuzzy.text_edits import TextEdits
from fuzzytrack.yamltree import Mapping, Node, Scalar
from fuzzytrack.yamltree import Sequence as ListNode

__all__ = ["add_line", "axes_of_table", "edit_heading", "entry_text", "remove_line", "table_rows"]


def axes_of_table(rules: RuleBase, names: Sequence[str]) -> list[str]:
    """Those inputs that a table has, the one of its columns first."""
    layout = rules.layout
    return [n for n in (layout.columns, layout.rows) if n in names] if layout else []


def table_rows(edits: TextEdits) -> dict[str, tuple[Scalar, ListNode]]:
    """Rows of the table, by the names of their sets."""
    found = {}
    for name, (key, row) in edits.document.entries(edits.field("rules", "table"), "table").items():
        assert isinstance(row, ListNode)
        found[name] = key, row
    return found


def add_line(edits: TextEdits, name: str, new: str, index: int, model: str) -> None:
    """Add a column or row of the table, as a copy of that of another set."""
    layout = edits.before.layout
    assert layout is not None
    place = edits.before.input(name).index(model)
    if name == layout.columns:
        rows = table_rows(edits).values()
        for items in {id(row.items): row for _, row in rows}.values():
            cell = items.items[place]
            copy = edits.current(edits.content(cell), cell.end, anchors=False)
            edits.insert(items, index, copy)
        width = max(_width(row.items[place]) for _, row in rows)

        def inserted(spans: list[tuple[int, int]]) -> dict[tuple[int, int], str]:
            if index == 0:
                start = spans[0][0]
                return {(start, start): new.ljust(width + 2)}
            start, end = spans[index - 1]
            return {(end, end): " " * max(0, width - (end - start)) + f"  {new}"}

        edit_heading(edits, name, inserted)
        return
    key, row = table_rows(edits)[model]
    table = edits.field("rules", "table")
    assert isinstance(table, Mapping)
    copy = edits.current(edits.content(row), row.end, anchors=False)
    where = list(table.entries).index(model) + (place < index)
    edits.insert(table, where, entry_text(edits, new, (key, row), copy))


def _width(cell: Node) -> int:
    return cell.end - cell.start


def remove_line(edits: TextEdits, name: str, old: str, index: int, lines: set[str]) -> None:
    """Remove a column or row of the table."""
    layout = edits.before.layout
    assert layout is not None
    if name == layout.columns:
        # A row that is removed as well needs no change.
        rows = [
            r for n, (_, r) in table_rows(edits).items() if not (n == old and layout.rows in lines)
        ]
        for items in {id(row.items): row for row in rows}.values():
            edits.remove(items, index)

        def shorter(spans: list[tuple[int, int]]) -> dict[tuple[int, int], str]:
            if index == 0:
                return {(spans[0][0], spans[1][0]): ""}
            return {(spans[index - 1][1], spans[index][1]): ""}

        edit_heading(edits, name, shorter)
        return
    table = edits.field("rules", "table")
    assert isinstance(table, Mapping)
    edits.remove(table, list(table.entries).index(old))


def edit_heading(
    edits: TextEdits,
    name: str,
    change: Callable[[list[tuple[int, int]]], dict[tuple[int, int], str]],
) -> None:
    """Change the comment above the rows of a table that lists the sets of its columns, if any.

    `change` gets the first and last characters of the names.
    """
    layout = edits.before.layout
    if layout is None or layout.columns != name:
        return
    key = edits.document.entries(edits.field("rules"), "rules")["table"][0]
    first = next(iter(table_rows(edits).values()))[0]
    words = [re.escape(word) for word in edits.before.input(name).set_names]
    line = re.compile(r"#[ \t]*" + r"[ \t]+".join(f"({w})" for w in words) + r"[ \t]*(?=[\r\n])")
    found = line.search(edits.text, key.end, max(key.end, first.start))
    if found:
        spans = [found.span(k + 1) for k in range(len(words))]
        for (start, end), new in change(spans).items():
            edits.replace(start, end, new)


def entry_text(edits: TextEdits, name: str, beside: tuple[Scalar, Node], value: str) -> str:
    """Entry of a mapping, its value in the column of that of another entry."""
    key, other = beside
    word = f"{word_text(name)}:"
    if value.startswith(("\r", "\n")):
        return word + value
    if other.line != key.line and not other.alias and "\n" in value:
        return word + edits.text[key.end : other.start].lstrip(" :") + value
    width = other.column - key.column if other.line == key.line else 0
    return word.ljust(max(width, len(word) + 1)) + value
