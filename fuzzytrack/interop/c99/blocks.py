"""Statements of a C function as a tree, with the declarations of its variables."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

__all__ = ["Assignment", "Block", "Costs", "Line", "Nest", "worst"]

#: How often each operation is done.
Costs = Counter[str]


def worst(*costs: Costs) -> Costs:
    """Of several sets of costs, the largest count of each operation."""
    largest: Costs = Counter()
    for each in costs:
        largest |= each
    return largest


@dataclass
class Line:
    """A statement that is no assignment to a variable."""

    text: str


@dataclass
class Assignment:
    """An assignment to a variable.

    Attributes
    ----------
    name, kind : str
        The variable, and its type in C.
    text : str
        The expression.
    used : bool
        Whether it stays although nothing reads the variable.
    """

    name: str
    kind: str
    text: str
    used: bool = False


@dataclass
class Nest:
    """Statements with blocks of others: a choice, or a loop.

    Attributes
    ----------
    heads : list of str
        Text before each block.
    blocks : list of Block
    """

    heads: list[str]
    blocks: list[Block]


@dataclass
class Block:
    """Statements in order.

    Attributes
    ----------
    items : list
    costs : Counter
        Operations in it, those of its nested blocks included.
    """

    items: list[Line | Assignment | Nest] = field(default_factory=list)
    costs: Costs = field(default_factory=Counter)

    def words(self) -> Counter[str]:
        """How often each name occurs in it, other than as the target of an assignment."""
        found: Counter[str] = Counter()
        for item in self.items:
            if isinstance(item, Nest):
                for head, block in zip(item.heads, item.blocks, strict=True):
                    found.update(_words(head))
                    found += block.words()
            else:
                found.update(_words(item.text))
        return found

    def assignments(self) -> Iterator[Assignment]:
        """All assignments, those of nested blocks included."""
        for item in self.items:
            if isinstance(item, Assignment):
                yield item
            elif isinstance(item, Nest):
                for block in item.blocks:
                    yield from block.assignments()

    def without_unused(self) -> None:
        """Remove assignments to variables that nothing reads, and blocks that are then empty."""
        while True:
            words = self.words()
            unused = {
                each.name for each in self.assignments() if not words[each.name] and not each.used
            }
            if not self._remove(unused):
                return

    def _remove(self, names: set[str]) -> bool:
        before, self.items = self.items, []
        removed = False
        for item in before:
            if isinstance(item, Assignment) and (item.name in names or item.name == item.text):
                removed = True
                continue
            if isinstance(item, Nest):
                removed |= sum(block._remove(names) for block in item.blocks) > 0
                if not any(block.items for block in item.blocks):
                    removed = True
                    continue
            self.items.append(item)
        return removed

    def lines(self, empty: dict[str, str], taken: frozenset[str] = frozenset()) -> list[str]:
        """Text, with every variable declared where it is first needed.

        Parameters
        ----------
        empty : dict of str to str
            Initializers by type, for variables that are declared before they are assigned to.
        taken : frozenset of str
            Variables that are declared already, such as parameters.
        """
        counts = Counter(each.name for each in self.assignments())
        return self._lines(counts, set(taken), empty)

    def _lines(self, counts: Counter[str], declared: set[str], empty: dict[str, str]) -> list[str]:
        declared = set(declared)
        ahead = [
            f"{kind} {name} = {empty[kind]};"
            for name, kind in sorted(self._early(declared).items())
        ]
        lines = list(ahead)
        for item in self.items:
            if isinstance(item, Line):
                lines.append(item.text)
            elif isinstance(item, Assignment):
                if item.name in declared:
                    lines.append(f"{item.name} = {item.text};")
                else:
                    declared.add(item.name)
                    constant = "const " if counts[item.name] == 1 else ""
                    lines.append(f"{constant}{item.kind} {item.name} = {item.text};")
            else:
                for k, (head, block) in enumerate(zip(item.heads, item.blocks, strict=True)):
                    lines.append(f"{'} ' if k else ''}{head} {{")
                    inner = block._lines(counts, declared, empty)
                    lines += [f"    {line}" for line in inner]
                lines.append("}")
        return lines

    def _early(self, declared: set[str]) -> dict[str, str]:
        """Variables that must be declared at the beginning of this block, with their types."""
        early: dict[str, str] = {}
        seen: set[str] = set()
        for item in self.items:
            if isinstance(item, Assignment):
                seen.add(item.name)
            elif isinstance(item, Nest):
                inner = {a.name: a.kind for block in item.blocks for a in block.assignments()}
                for name in inner.keys() - declared - seen - early.keys():
                    if not all(_alone_inside(other, name) for other in self.items):
                        early[name] = inner[name]
                        declared.add(name)
        return early

    def _mentions(self, name: str) -> bool:
        return any(_mentions(item, name) for item in self.items)

    def _sets_first(self, name: str) -> bool:
        """Whether the first use of a variable in this block is an assignment to it, always done."""
        for item in self.items:
            if not _mentions(item, name):
                continue
            if isinstance(item, Assignment):
                return item.name == name and not re.search(rf"\b{name}\b", item.text)
            # Deeper inside, it is declared there, if nothing else needs it.
            return all(_alone_inside(other, name) for other in self.items)
        return False


def _alone_inside(item: Line | Assignment | Nest, name: str) -> bool:
    """Whether a statement needs a variable at most inside of its blocks, each of which sets it."""
    if not isinstance(item, Nest):
        return not _mentions(item, name)
    in_heads = any(re.search(rf"\b{name}\b", head) for head in item.heads)
    own = [block for block in item.blocks if block._mentions(name)]
    return not in_heads and all(block._sets_first(name) for block in own)


def _mentions(item: Line | Assignment | Nest, name: str) -> bool:
    if isinstance(item, Nest):
        heads = any(re.search(rf"\b{name}\b", head) for head in item.heads)
        return heads or any(block._mentions(name) for block in item.blocks)
    if isinstance(item, Assignment) and item.name == name:
        return True
    return re.search(rf"\b{name}\b", item.text) is not None


def _words(text: str) -> list[str]:
    """Names in a text; names of members are not among them."""
    return re.findall(r"(?<![\w.])[A-Za-z_]\w*", text)
