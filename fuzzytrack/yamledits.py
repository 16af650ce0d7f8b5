"""Changes of a YAML text that leave the rest of it as it is, byte for byte."""

from __future__ import annotations

import re
from collections.abc import Iterator

from fuzzytrack.errors import FileError, RuleBaseError
from fuzzytrack.yamltree import Document, Mapping, Node, Sequence

__all__ = ["DocumentEdits"]

_ANCHOR = re.compile(r"&[\w-]+")
_LINE_END = re.compile(r"\r\n|\r|\n")


class DocumentEdits:
    """Replacements in a YAML text, collected and then made at once.

    Parameters
    ----------
    text : str
        The text.
    file : str
        Name for messages.
    failure : type
        The error to raise, after what the text is meant to be.

    Attributes
    ----------
    text : str
        The text without a byte order mark; the places of nodes count in it.
    document : Document
    line_end : str
        The line end that the text uses first.

    Raises
    ------
    FileError
        Of the type `failure`, if the text is no YAML.
    """

    def __init__(self, text: str, file: str, failure: type[FileError] = RuleBaseError) -> None:
        self.text = text.removeprefix("\ufeff")
        self._mark = text[: len(text) - len(self.text)]
        self.document = Document(self.text, file, failure=failure)
        found = _LINE_END.search(self.text)
        self.line_end = found.group() if found else "\n"
        self._parts: dict[tuple[int, int], str] = {}

    # ---------------------------------------------------------------- places

    def field(self, *keys: str) -> Node:
        """Value below the top of the document that some keys lead to."""
        node = self.document.root
        for key in keys:
            node = self.document.entries(node, key)[key][1]
        return node

    def content(self, node: Node) -> int:
        """Where the content of a node starts, behind its anchor."""
        found = _ANCHOR.match(self.text, node.start) if node.anchored else None
        if found is None:
            return node.start
        start = found.end()
        while self.text[start : start + 1] in (" ", "\t"):
            start += 1
        return start

    def anchor(self, node: Node) -> str:
        """Name of the anchor of a node, or of the one that an alias refers to."""
        end = self.content(node) if node.anchored else node.end
        return self.text[node.start + 1 : end].strip()

    def all_nodes(self, *, keys: bool = False) -> Iterator[Node]:
        """Nodes in the order in which they stand in the text; what aliases repeat comes once."""
        yield from _walk(self.document.root, keys)

    # ---------------------------------------------------------------- changes

    def replace(self, start: int, end: int, new: str) -> None:
        """Put other characters in the place of ``text[start:end]``."""
        self._parts[start, end] = new

    def current(self, start: int, end: int, *, anchors: bool = True) -> str:
        """Characters of ``text[start:end]`` with the changes inside it made.

        A copy is made without `anchors`, which stay with the original.
        """
        inside = {span: new for span, new in self._parts.items() if start <= span[0] <= end}
        if not anchors:
            nodes = (n for n in self.all_nodes(keys=True) if n.anchored and start <= n.start < end)
            inside |= {(n.start, self.content(n)): "" for n in nodes}
        text = self.text[:end]
        for (first, last), new in sorted(inside.items(), reverse=True):
            text = text[:first] + new + text[last:]
        return text[start:]

    def insert(self, node: Mapping | Sequence, index: int, entry: str) -> None:
        """Insert an entry of a collection, as it is written behind the dash of a block list.

        It comes on a line of its own in block style, and behind the entry before it in brackets.
        """
        spans = self._spans(node)
        if node.flow:
            start, end = (spans[0][0],) * 2 if index == 0 else (spans[index - 1][1],) * 2
            self.replace(start, end, f"{entry}, " if index == 0 else f", {entry}")
            return
        margin = self._margin(node, spans[0][0])
        dash = "- " if isinstance(node, Sequence) else ""
        if index == 0:
            start = spans[0][0] - len(margin)
            self.replace(start, start, f"{margin}{dash}{entry}{self.line_end}")
        else:
            start = self.end_of_line(spans[index - 1][1])
            self.replace(start, start, f"{self.line_end}{margin}{dash}{entry}")

    def remove(self, node: Mapping | Sequence, index: int) -> None:
        """Remove an entry of a collection; in block style with a comment on its line."""
        spans = self._spans(node)
        start, end = spans[index]
        if len(spans) == 1:
            raise self.document.error(node, "the last entry cannot be removed")
        if node.flow:
            before = spans[index - 1][1] if index else start
            after = end if index else spans[1][0]
            if _LINE_END.search(self.text, before, after):
                # Comments may stand between the entries.
                comma = re.compile(r"[ \t]*,?").match(self.text, end)
                before, after = start, comma.end() if comma else end
            self.replace(before, after, "")
            return
        start -= len(self._margin(node, start))
        end = self.end_of_line(end)
        ending = _LINE_END.match(self.text, end)
        if ending:
            end = ending.end()
        else:  # the last line of a text that does not end in a new line
            start -= len(self.line_end)
        self.replace(start, end, "")

    def _spans(self, node: Mapping | Sequence) -> list[tuple[int, int]]:
        """First and last characters of the entries, with the dashes of a block list."""
        if isinstance(node, Mapping):
            return [(key.start, value.end) for key, value in node.entries.values()]
        if node.flow:
            return [(item.start, item.end) for item in node.items]
        return [(self.text.rindex("-", 0, item.start), item.end) for item in node.items]

    def _margin(self, node: Node, start: int) -> str:
        """Blanks between the beginning of a line and the entry that starts there."""
        margin = self.margin_at(start)
        if margin.strip(" "):
            raise self.document.error(
                node, "an entry stands on a line with other words; put it on a line of its own"
            )
        return margin

    def margin_at(self, start: int) -> str:
        """Characters between the beginning of a line and a place in it."""
        line = max(self.text.rfind("\n", 0, start), self.text.rfind("\r", 0, start)) + 1
        return self.text[line:start]

    def start_of(self, node: Mapping | Sequence) -> int:
        """Where the first entry of a collection starts."""
        return self._spans(node)[0][0]

    def end_of_line(self, place: int) -> int:
        """Where the line of a place ends."""
        found = _LINE_END.search(self.text, place)
        return found.start() if found else len(self.text)

    # ---------------------------------------------------------------- the result

    def changed(self) -> str:
        """The text with the changes made.

        Raises
        ------
        FileError
            If an anchor would go to which an alias refers that stays.
        """
        self._check_anchors()
        return self._mark + self.current(0, len(self.text))

    def _check_anchors(self) -> None:
        """Check that no anchor goes to which an alias refers that stays."""
        gone = [(start, end) for start, end in self._parts if end > start]
        nodes = list(self.all_nodes(keys=True))

        def goes(node: Node) -> bool:
            return any(start <= node.start < end for start, end in gone)

        for node in nodes:
            name = self.anchor(node) if node.anchored and goes(node) else None
            if name is None or any(f"&{name}" in new for new in self._parts.values()):
                continue
            for other in nodes:
                if other.alias and self.anchor(other) == name and not goes(other):
                    raise self.document.error(
                        node,
                        f"the anchor &{name} is in what is to be changed, and *{name} in line "
                        f"{other.line} repeats it: write it out there first",
                    )


def _walk(node: Node, keys: bool) -> Iterator[Node]:
    """A node and those below it, but for those that an alias repeats."""
    yield node
    if node.alias:
        return
    if isinstance(node, Mapping):
        for key, value in node.entries.values():
            if keys:
                yield key
            yield from _walk(value, keys)
    elif isinstance(node, Sequence):
        for item in node.items:
            yield from _walk(item, keys)
