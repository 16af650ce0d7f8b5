"""Cells of a rule table: the conclusions of a rule in a few characters."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping

from fuzzytrack.errors import FileError
from fuzzytrack.fuzzy.rulebase import Consequent
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.yamltree import Document, Node, Sequence, quoted
from fuzzytrack.yamltree import Mapping as MappingNode

__all__ = ["CellReader"]

_MAX_CELL = 256


class CellReader:
    """Reads the consequents of rules.

    Parameters
    ----------
    document : Document
        The tree; it also makes the errors.
    outputs : mapping
        The outputs of the rule base, by name.
    """

    def __init__(self, document: Document, outputs: Mapping[str, Variable]) -> None:
        self.document = document
        self.outputs = outputs
        self._known: dict[str, tuple[Consequent, ...]] = {}

    def read(self, node: Node, order: tuple[str, ...]) -> tuple[Consequent, ...]:
        """Read a cell of a table, or what follows ``then``.

        Parameters
        ----------
        node : Node
            ``S-L@0.5``, one set for each output in turn; a list of such words; or a mapping of
            outputs to ``S@0.5`` or a list of such words.
        order : tuple of str
            The outputs, as the first two forms take them.

        Returns
        -------
        tuple of Consequent
        """
        if isinstance(node, MappingNode):
            return self._by_output(node)
        if isinstance(node, Sequence):
            words = self.document.items(node, "a cell")
            return _merged(c for word in words for c in self._joint(word, order))
        return self._joint(node, order)

    def names(self, node: Node, order: tuple[str, ...]) -> tuple[str, ...]:
        """Names of the sets in a word such as ``S-L@0.5``, one for each output in turn."""
        body = self.document.text(node, "a cell").partition("@")[0]
        return self._split(node, body, order)

    def _by_output(self, node: Node) -> tuple[Consequent, ...]:
        found = []
        for name, (key, value) in self.document.entries(node, "consequents").items():
            if name not in self.outputs:
                raise self.document.unknown(key, name, "output", tuple(self.outputs))
            several = isinstance(value, Sequence)
            words = self.document.items(value, name) if several else [value]
            found += [c for word in words for c in self._joint(word, (name,))]
        return _merged(found)

    def _joint(self, node: Node, order: tuple[str, ...]) -> tuple[Consequent, ...]:
        text = self.document.text(node, "a cell")
        key = f"{text}@{'-'.join(order)}"
        if key not in self._known:
            body, at, sure = text.partition("@")
            confidence = self._confidence(node, sure, len(body) + 1) if at else 1.0
            names = self._split(node, body, order)
            self._known[key] = tuple(
                Consequent(output, name, confidence)
                for output, name in zip(order, names, strict=True)
            )
        return self._known[key]

    def _confidence(self, node: Node, word: str, offset: int) -> float:
        value = self.document.as_number(node, word, "confidence", offset)
        if not 0 <= value <= 1:
            raise self.document.error(
                node, f"confidence must be within [0, 1], not {quoted(word)}", offset
            )
        return value

    def _split(self, node: Node, body: str, order: tuple[str, ...]) -> tuple[str, ...]:
        """Set names of a word such as ``S-L``; names with hyphens must leave one way to read it."""
        variables = [self.outputs[name] for name in order]
        parts = body.split("-")
        readings = []
        if len(body) <= _MAX_CELL:
            readings = _readings(parts, variables)
        if len(readings) == 1:
            return readings[0]
        if readings:
            either = " or ".join(" and ".join(map(quoted, names)) for names in readings)
            raise self.document.error(
                node, f"{quoted(body)} can be read as {either}; write it as a mapping of outputs"
            )
        raise self._unreadable(node, body, parts, variables)

    def _unreadable(
        self, node: Node, body: str, parts: list[str], variables: list[Variable]
    ) -> FileError:
        if len(variables) == 1:
            (variable,) = variables
            role = f"set of {variable.name}"
            return self.document.unknown(node, body, role, variable.set_names)
        if len(parts) == len(variables):
            offsets = itertools.accumulate((len(part) + 1 for part in parts), initial=0)
            for part, offset, variable in zip(parts, offsets, variables, strict=False):
                if part not in variable.set_names:
                    role = f"set of {variable.name}"
                    return self.document.unknown(node, part, role, variable.set_names, offset)
        form = "-".join(variable.name for variable in variables)
        return self.document.error(
            node, f"{quoted(body)} is not of the form {form}, one set name for each output"
        )


def _readings(parts: list[str], variables: list[Variable]) -> list[tuple[str, ...]]:
    """Up to two ways of joining hyphenated parts to one set name for each variable."""
    paths: dict[int, list[tuple[str, ...]]] = {0: [()]}
    for variable in variables:
        further: dict[int, list[tuple[str, ...]]] = {}
        for start, found in paths.items():
            for end in range(start + 1, len(parts) + 1):
                name = "-".join(parts[start:end])
                if name in variable.set_names:
                    longer = further.setdefault(end, [])
                    # Two are enough to know that it is ambiguous.
                    longer.extend((*path, name) for path in found)
                    del longer[2:]
        paths = further
    return paths.get(len(parts), [])


def _merged(consequents: Iterable[Consequent]) -> tuple[Consequent, ...]:
    """Add the confidences of equal consequents: ``[S-L@0.5, M-L@0.5]`` gives L confidence 1."""
    shares: dict[tuple[str, str], list[float]] = {}
    for consequent in consequents:
        key = (consequent.output, consequent.set_name)
        shares.setdefault(key, []).append(consequent.confidence)
    return tuple(Consequent(*key, _total(parts)) for key, parts in shares.items())


def _total(shares: list[float]) -> float:
    total = math.fsum(shares)
    # Shares such as 0.7, 0.2 and 0.1 are meant to add up to 1; a single one stays as it is.
    return 1.0 if len(shares) > 1 and abs(total - 1.0) <= 1e-12 else total
