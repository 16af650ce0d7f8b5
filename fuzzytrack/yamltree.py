"""YAML text as a small tree in which every word has its place in the text.

Words stay text: none is taken for a number, a date or a truth value, and no objects are
constructed. Size, depth and the growth of aliases are bounded while the text is being read, with
a stack of our own, so that no text can exhaust memory, time or Python's recursion limit.
"""

from __future__ import annotations

import copy
import difflib
import re
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import yaml

from fuzzytrack.errors import FileError, Location, RuleBaseError
from fuzzytrack.numerals import as_number

__all__ = [
    "MAX_BYTES",
    "MAX_DEPTH",
    "MAX_NODES",
    "Document",
    "Mapping",
    "Node",
    "Scalar",
    "Sequence",
    "quoted",
    "suggestion",
]

# Chosen so that PyYAML without libyaml also stays under a second.
MAX_BYTES = 128 * 1024
MAX_DEPTH = 12
MAX_NODES = 10_000

_LOADER: type[Any] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
# Also YAML's own extra line breaks, which editors do not count as lines. What is allowed instead
# would take ten times as long to compile.
_FORBIDDEN = re.compile(
    "[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff\ufeff\ufffe\uffff]"
)
# First bytes of files that are no text.
_NO_TEXT = {
    b"\x1f\x8b": "compressed by gzip",
    b"\x28\xb5\x2f\xfd": "compressed by zstd",
    b"PK\x03\x04": "a zip archive",
}
_SHOWN_CHARACTERS = 60
_SHOWN_WORDS = 30


# What PyYAML says of a text, whether the mistake is where the part begins that it was reading, and
# what is to be done.
_SYNTAX = (
    (r"found character '\t'", False, "a tab; indent with blanks"),
    (
        "while parsing a flow sequence",
        True,
        "'[' is closed by no ']', or a comma is missing, before {found}",
    ),
    (
        "while parsing a flow mapping",
        True,
        "'{{' is closed by no '}}', or a comma is missing, before {found}",
    ),
    (
        "expected <block end>, but found '<block",
        False,
        "wrong indentation: no line above that it may belong to begins in column {column}",
    ),
    (
        "expected <block end>, but found '-'",
        False,
        "wrong indentation: no line above that it may belong to begins in column {column}",
    ),
    ("could not find expected ':'", True, "no ':' with a blank after it follows this word"),
    (
        "mapping values are not allowed",
        False,
        "a ':' where none may be: put the text in quotes, or mend the indentation",
    ),
    (
        "expected '<document start>'",
        False,
        "text after the end of the rule base or scenario; is this a file of another program?",
    ),
    ("while scanning a quoted scalar", True, "the quotation mark is not closed"),
)


class Node:
    """One value of the tree, with its place in the text.

    Attributes
    ----------
    line, column : int
        Where it starts, from 1.
    start, end : int
        Its characters are ``text[start:end]``.
    anchored : bool
        Whether it carries an anchor, so that aliases repeat it.
    alias : bool
        Whether an alias stands in its place.
    size, height : int
        Number of nodes and of levels, after expansion of aliases.
    """

    __slots__ = ("alias", "anchored", "column", "end", "height", "line", "size", "start")

    kind = "a value"

    def __init__(self, event: Any) -> None:
        self.line: int = event.start_mark.line + 1
        self.column: int = event.start_mark.column + 1
        self.start: int = event.start_mark.index
        self.end: int = event.end_mark.index
        self.anchored = event.anchor is not None
        self.alias = False
        self.size = 1
        self.height = 1

    def repeated(self, event: Any) -> Node:
        """Return the same content, shared, at the place of an alias."""
        twin = copy.copy(self)
        twin.line, twin.column = event.start_mark.line + 1, event.start_mark.column + 1
        twin.start, twin.end = event.start_mark.index, event.end_mark.index
        twin.anchored, twin.alias = False, True
        return twin


class Scalar(Node):
    """A word, a number or a text; `plain` if it stands in the file as it is."""

    __slots__ = ("plain", "text")

    kind = "a word"

    def __init__(self, event: Any) -> None:
        super().__init__(event)
        self.text: str = event.value
        one_line = event.start_mark.line == event.end_mark.line
        self.plain = not event.style and one_line and self.end - self.start == len(self.text)


class Sequence(Node):
    """A list; `flow` if it is written in brackets."""

    __slots__ = ("flow", "items")

    kind = "a list"

    def __init__(self, event: Any) -> None:
        super().__init__(event)
        self.flow = bool(event.flow_style)
        self.items: list[Node] = []


class Mapping(Node):
    """Pairs of a word and a value; `flow` if they are written in braces."""

    __slots__ = ("entries", "flow")

    kind = "a mapping"

    def __init__(self, event: Any) -> None:
        super().__init__(event)
        self.flow = bool(event.flow_style)
        self.entries: dict[str, tuple[Scalar, Node]] = {}


def quoted(word: str) -> str:
    """A word as error messages show it: in quotes, and shortened if it is long."""
    if len(word) > _SHOWN_CHARACTERS:
        word = word[:_SHOWN_CHARACTERS] + "…"
    return repr(word)


def suggestion(word: str, allowed: Collection[str]) -> str:
    """End of a message about an unknown word: a similar word, and the allowed ones."""
    words = [w if len(w) <= _SHOWN_CHARACTERS else w[:_SHOWN_CHARACTERS] + "…" for w in allowed]
    # Without regard to case, which is the most likely mistake.
    folded = {w.casefold(): w for w in reversed(words[:100])}
    close = difflib.get_close_matches(word[:_SHOWN_CHARACTERS].casefold(), folded, n=1)
    guess = f"; did you mean {folded[close[0]]!r}?" if close else ";"
    more = f" and {len(words) - _SHOWN_WORDS} more" if len(words) > _SHOWN_WORDS else ""
    return f"{guess} allowed: {', '.join(words[:_SHOWN_WORDS])}{more}"


class Document:
    """A parsed text, with methods that read its nodes and make errors with their places.

    Parameters
    ----------
    text : str or bytes
        One YAML document; bytes are UTF-8.
    file : str
        Name for messages.
    loader : type, optional
        A PyYAML loader class; libyaml's when it is there.
    failure : type
        The error to raise, after what the file is meant to be.

    Raises
    ------
    FileError
        Of the type `failure`, if the text is no YAML, or more than one document, or uses tags,
        merge keys, a key twice or control characters, or exceeds 128 KiB, 12 levels or 10,000
        nodes.
    """

    def __init__(
        self,
        text: str | bytes,
        file: str,
        loader: type[Any] | None = None,
        failure: type[FileError] = RuleBaseError,
    ) -> None:
        self.file = file
        self.failure = failure
        self.root = _Builder(file, failure).build(self._checked(text), loader or _LOADER)

    # ------------------------------------------------------------ errors

    def error(self, node: Node, message: str, offset: int = 0) -> FileError:
        """Error about a node, or about the word `offset` characters into a plain one."""
        inside = offset if isinstance(node, Scalar) and node.plain else 0
        return self.failure(message, self.location(node, inside))

    def location(self, node: Node, offset: int = 0) -> Location:
        """Place of a node, or of the word `offset` characters into it."""
        return Location(self.file, node.line, node.column + offset)

    def unknown(
        self, node: Node, word: str, role: str, allowed: Collection[str], offset: int = 0
    ) -> FileError:
        """Error about an unknown word, with the allowed ones."""
        message = f"unknown {role} {quoted(word)}{suggestion(word, allowed)}"
        return self.error(node, message, offset)

    @contextmanager
    def at(self, node: Node) -> Iterator[None]:
        """Give errors of the model, which have no place in a file, the place of `node`."""
        try:
            yield
        except FileError as error:
            if error.location is not None:
                raise
            raise self.error(node, error.message) from None

    # ------------------------------------------------------------ reading

    def entries(self, node: Node, role: str) -> dict[str, tuple[Scalar, Node]]:
        """Entries of a mapping that has at least one."""
        if not isinstance(node, Mapping) or not node.entries:
            raise self.error(node, f"{role} must be a mapping, 'word: value', not {_what(node)}")
        return node.entries

    def fields(
        self, node: Node, role: str, required: tuple[str, ...], optional: tuple[str, ...] = ()
    ) -> dict[str, Node]:
        """Values of a mapping whose keys are fixed."""
        entries = self.entries(node, role)
        allowed = tuple(dict.fromkeys((*required, *optional)))
        for word, (key, _) in entries.items():
            if word not in allowed:
                raise self.unknown(key, word, f"key in {role}:", allowed)
        for word in required:
            if word not in entries:
                raise self.error(node, f"{role} lacks the key {word!r}")
        return {word: value for word, (_, value) in entries.items()}

    def items(self, node: Node, role: str) -> list[Node]:
        """Items of a list that has at least one."""
        if not isinstance(node, Sequence) or not node.items:
            raise self.error(node, f"{role} must be a list, not {_what(node)}")
        return node.items

    def text(self, node: Node, role: str, meant: str = "a word") -> str:
        """Text of a scalar that is not empty; `meant` says in the message what it should be."""
        if not isinstance(node, Scalar) or not node.text:
            raise self.error(node, f"{role} must be {meant}, not {_what(node)}")
        return node.text

    def choice(self, node: Node, role: str, allowed: Collection[str]) -> str:
        """Read a word out of a given vocabulary."""
        word = self.text(node, role)
        if word not in allowed:
            raise self.unknown(node, word, role, allowed)
        return word

    def number(self, node: Node, role: str) -> float:
        """Read a finite number."""
        return self.as_number(node, self.text(node, role, "a finite number"), role)

    def as_number(self, node: Node, word: str, role: str, offset: int = 0) -> float:
        """Read a finite number written in part of a scalar."""
        value = as_number(word)
        if value is None:
            raise self.error(node, f"{role} must be a finite number, not {quoted(word)}", offset)
        return value

    def whole(self, node: Node, role: str) -> int:
        """Read a whole number."""
        value = self.number(node, role)
        if value != int(value):
            raise self.error(node, f"{role} must be a whole number, not {value:g}")
        return int(value)

    # ------------------------------------------------------------ before parsing

    def _checked(self, text: str | bytes) -> str:
        if len(text) > MAX_BYTES:
            raise self._at_offset("", 0, f"the text is longer than {MAX_BYTES // 1024} KiB")
        body = self._decoded(text) if isinstance(text, bytes) else text
        body = body.removeprefix("\ufeff")
        forbidden = _FORBIDDEN.search(body)
        if forbidden:
            code = f"U+{ord(forbidden.group()):04X}"
            message = f"control character {code} is not allowed"
            raise self._at_offset(body, forbidden.start(), message)
        if len(body.encode()) > MAX_BYTES:
            raise self._at_offset("", 0, f"the text is longer than {MAX_BYTES // 1024} KiB")
        return body

    def _decoded(self, raw: bytes) -> str:
        try:
            return raw.decode("utf-8")
        except UnicodeDecodeError as error:
            before = raw[: error.start].decode("utf-8")
            message = f"byte 0x{raw[error.start]:02x} is not valid UTF-8; save the text as UTF-8"
            for mark, what in _NO_TEXT.items():
                if raw.startswith(mark):
                    before, message = "", f"is {what}, not text; unpack it first"
            raise self._at_offset(before, len(before), message) from None

    def _at_offset(self, text: str, offset: int, message: str) -> FileError:
        before = text[:offset]
        column = offset - (before.rfind("\n") + 1) + 1
        return self.failure(message, Location(self.file, before.count("\n") + 1, column))


def _what(node: Node) -> str:
    if isinstance(node, Scalar):
        return quoted(node.text) if node.text else "nothing"
    empty = not (node.items if isinstance(node, Sequence) else node.entries)  # type: ignore[attr-defined]
    return f"{node.kind}{' without entries' if empty else ''}"


@dataclass
class _Frame:
    """A collection that is still open."""

    node: Mapping | Sequence
    anchor: str | None
    key: Scalar | None = None


class _Builder:
    """Builds the tree from PyYAML's events, with an explicit stack."""

    def __init__(self, file: str, failure: type[FileError]) -> None:
        self.file = file
        self.failure = failure
        self.stack: list[_Frame] = []
        self.anchors: dict[str, Node | None] = {}
        self.count = 0
        self.root: Node | None = None

    def build(self, text: str, loader: type[Any]) -> Node:
        try:
            self._read(loader(text))
        except FileError:
            raise  # it is a ValueError too
        except yaml.YAMLError as error:
            if loader is not yaml.SafeLoader:
                # The limits and messages of libyaml depend on its version; PyYAML's own parser
                # refuses a text in the same words and at the same place on every system.
                return _Builder(self.file, self.failure).build(text, yaml.SafeLoader)
            raise self._syntax(error) from None
        except (ValueError, OverflowError) as error:
            # PyYAML's own parser on escapes such as "\\UFFFFFFFF".
            raise self.failure(f"not YAML: {error}", Location(self.file, 1, 1)) from None
        if self.root is None:
            raise self.failure("the text is empty", Location(self.file, 1, 1))
        return self.root

    def _read(self, parser: Any) -> None:
        # yaml.parse() does the same, with one more call for each event.
        try:
            event = None
            while not isinstance(event, yaml.StreamEndEvent):
                event = parser.get_event()
                self._take(event)
        finally:
            parser.dispose()

    def _syntax(self, error: yaml.YAMLError) -> FileError:
        start, mark = (getattr(error, f"{part}_mark", None) for part in ("context", "problem"))
        context, problem = (getattr(error, part, None) or "" for part in ("context", "problem"))
        for words, at_start, remedy in _SYNTAX:
            if words in f"{context}, {problem}":
                found = f"line {mark.line + 1}, column {mark.column + 1}" if mark else "the end"
                column = mark.column + 1 if mark else 1
                message = remedy.format(found=found, column=column)
                mark = start if at_start and start else mark
                break
        else:
            message = ", ".join(filter(None, (context, problem))) or "a forbidden character"
            mark = mark or start
        line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
        return self.failure(f"not YAML: {message}", Location(self.file, line, column))

    def _take(self, event: Any) -> None:
        kind = type(event)
        if kind is yaml.ScalarEvent:
            self._check_scalar(event)
            self._place(Scalar(event), event, event.anchor)
        elif kind is yaml.MappingStartEvent or kind is yaml.SequenceStartEvent:
            self._open(event)
        elif kind is yaml.MappingEndEvent or kind is yaml.SequenceEndEvent:
            self._close(event)
        elif kind is yaml.AliasEvent:
            self._repeat(event)
        elif kind is yaml.DocumentStartEvent and self.root is not None:
            raise self._error(event, "a second document; only one is allowed")

    def _error(self, event: Any, message: str) -> FileError:
        mark = event.start_mark
        return self.failure(message, Location(self.file, mark.line + 1, mark.column + 1))

    def _check_node(self, event: Any) -> None:
        if event.tag is not None:
            raise self._error(event, f"tag {quoted(event.tag)}: tags are not allowed")
        if event.anchor is not None:
            if event.anchor in self.anchors:
                raise self._error(event, f"anchor {quoted(event.anchor)} is there twice")
            # Until the node is complete its own content cannot refer to it.
            self.anchors[event.anchor] = None

    def _check_scalar(self, event: Any) -> None:
        self._check_node(event)
        # Control characters can still come in through escapes.
        forbidden = _FORBIDDEN.search(event.value) if event.style == '"' else None
        if forbidden:
            code = f"U+{ord(forbidden.group()):04X}"
            raise self._error(event, f"control character {code} is not allowed")

    def _open(self, event: Any) -> None:
        self._check_node(event)
        self._check_depth(event, 1)
        if self.stack and isinstance(self.stack[-1].node, Mapping) and not self.stack[-1].key:
            raise self._error(event, "a key must be a word")
        mapping = type(event) is yaml.MappingStartEvent
        node: Mapping | Sequence = Mapping(event) if mapping else Sequence(event)
        self.stack.append(_Frame(node, event.anchor))

    def _close(self, event: Any) -> None:
        frame = self.stack.pop()
        node = frame.node
        if isinstance(node, Sequence):
            children, keys = node.items, 0
        else:
            children, keys = [value for _, value in node.entries.values()], len(node.entries)
        node.size = 1 + keys + sum([child.size for child in children])
        node.height = 1 + max([child.height for child in children], default=0)
        # A block collection ends, to PyYAML, only where the next word begins.
        in_brackets = event.end_mark.index > event.start_mark.index
        node.end = (
            event.end_mark.index if in_brackets else children[-1].end if children else node.end
        )
        self._place(node, event, frame.anchor, counted=node.size - 1)

    def _repeat(self, event: Any) -> None:
        node = self.anchors.get(event.anchor)
        if node is None:
            inside = event.anchor in self.anchors
            why = "contains itself" if inside else "has no anchor before it"
            raise self._error(event, f"alias {quoted(event.anchor)} {why}")
        self._check_depth(event, node.height)
        self._place(node.repeated(event), event, None)

    def _check_depth(self, event: Any, height: int) -> None:
        if len(self.stack) + height > MAX_DEPTH:
            raise self._error(event, f"nested deeper than {MAX_DEPTH} levels")

    def _place(self, node: Node, event: Any, anchor: str | None, counted: int = 0) -> None:
        """Put a complete node where it belongs."""
        self.count += node.size - counted
        if self.count > MAX_NODES:
            raise self._error(event, f"more than {MAX_NODES} values (aliases count in full)")
        if anchor is not None:
            self.anchors[anchor] = node
        if not self.stack:
            self.root = node
            return
        frame = self.stack[-1]
        if isinstance(frame.node, Sequence):
            frame.node.items.append(node)
        elif frame.key is None:
            frame.key = self._key(node, event, frame.node)
        else:
            frame.node.entries[frame.key.text] = (frame.key, node)
            frame.key = None

    def _key(self, node: Node, event: Any, mapping: Mapping) -> Scalar:
        if not isinstance(node, Scalar):
            raise self._error(event, "a key must be a word")
        if node.text in mapping.entries:
            raise self._error(event, f"key {quoted(node.text)} is given twice")
        if node.text == "<<" and node.plain:
            raise self._error(event, "unknown word '<<': merge keys are not supported")
        return node
