"""From a YAML tree to a rule base; every error names its place in the file and the word."""

from __future__ import annotations

import keyword
import math
import re
import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import replace

from fuzzytrack.errors import Location, Word
from fuzzytrack.fuzzy.cells import CellReader
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.operators import CONJUNCTIONS, DEFUZZIFICATIONS, DISJUNCTIONS, Operators
from fuzzytrack.fuzzy.rulebase import (
    Conditions,
    Rule,
    RuleBase,
    TableLayout,
    remember_places,
)
from fuzzytrack.fuzzy.shapes import SHAPES
from fuzzytrack.fuzzy.variable import GRIDS, Universe, Variable
from fuzzytrack.yamltree import Document, Node, Scalar, Sequence, quoted
from fuzzytrack.yamltree import Mapping as MappingNode

__all__ = [
    "FORMAT_VERSION",
    "MAX_NAME",
    "SET_NAME",
    "VARIABLE_NAME",
    "Reader",
]

FORMAT_VERSION = "1"
MAX_NAME = 64
# "@" introduces a confidence, and "," and blanks separate cells.
SET_NAME = r"[^@,\s]+"
VARIABLE_NAME = r"[^\W\d]\w*"

_SET_NAME = re.compile(SET_NAME)
_REQUIRED = ("rulebase", "name", "inputs", "outputs", "operators", "rules")
_OPTIONAL = ("description", "source", "scheduler")


class Reader:
    """Makes a rule base of a located YAML tree.

    Parameters
    ----------
    document : Document
        The tree; it also makes the errors.

    Attributes
    ----------
    rule_nodes : dict
        After `rulebase`: from the conditions of each rule, as a frozenset, to the node of its
        consequents, and whether other rules share that node.
    """

    def __init__(self, document: Document) -> None:
        self.document = document
        self.inputs: dict[str, Variable] = {}
        self.outputs: dict[str, Variable] = {}
        self.rule_nodes: dict[frozenset[object], tuple[Node, bool]] = {}
        self.places: dict[str, Location] = {}
        self.cells = CellReader(document, {})

    def rulebase(self) -> RuleBase:
        """Read the whole document.

        Raises
        ------
        RuleBaseError
            At the first mistake.
        """
        document = self.document
        self._check_version()
        top = document.fields(document.root, "the rule base", _REQUIRED, _OPTIONAL)
        texts = {
            key: document.text(top[key], key)
            for key in ("name", "source", "description")
            if key in top
        }
        self.inputs = self._variables(top["inputs"], "input")
        self.outputs = self._variables(top["outputs"], "output")
        self.cells = CellReader(document, self.outputs)
        operators = self._operators(top["operators"])
        self._check_output_grids(top["outputs"], operators)
        rules, layout = self._rules(top["rules"])
        scheduler = self._scheduler(top["scheduler"]) if "scheduler" in top else ()
        with document.at(top["rules"]):
            rulebase = RuleBase(
                **texts,
                inputs=tuple(self.inputs.values()),
                outputs=tuple(self.outputs.values()),
                rules=tuple(rules),
                operators=operators,
                scheduler=scheduler,
                layout=layout,
            )
        self._check_coverage(rulebase, top["inputs"])
        return remember_places(rulebase, self.places)

    def _check_version(self) -> None:
        entries = self.document.entries(self.document.root, "the rule base")
        if "rulebase" not in entries:
            raise self.document.error(
                self.document.root,
                f"the rule base lacks its format version, 'rulebase: {FORMAT_VERSION}'",
            )
        node = entries["rulebase"][1]
        word = self.document.text(node, "format version")
        if word != FORMAT_VERSION:
            raise self.document.unknown(node, word, "format version", (FORMAT_VERSION,))

    def _operators(self, node: Node) -> Operators:
        vocabulary = {
            "and": CONJUNCTIONS,
            "or": DISJUNCTIONS,
            "defuzzification": DEFUZZIFICATIONS,
            "implication": CONJUNCTIONS,
            "weighting": CONJUNCTIONS,
            "alternatives": DISJUNCTIONS,
        }
        required, optional = tuple(vocabulary)[:3], tuple(vocabulary)[3:]
        fields = self.document.fields(node, "operators", required, optional)
        words = {
            key: self.document.choice(fields[key], key, allowed)
            for key, allowed in vocabulary.items()
            if key in fields
        }
        main = [words.pop(key) for key in required]
        return Operators(*main, **words)

    def _scheduler(self, node: Node) -> tuple[tuple[str, str], ...]:
        """Words with their places, unread: they are checked when a scheduler is made."""
        document = self.document

        def word(node: Node, role: str) -> Word:
            return Word(document.text(node, role), document.location(node))

        return tuple(
            (word(key, "scheduler setting"), word(value, f"scheduler setting {quoted(name)}"))
            for name, (key, value) in document.entries(node, "scheduler").items()
        )

    # ---------------------------------------------------------------- variables

    def _variables(self, node: Node, role: str) -> dict[str, Variable]:
        variables = {}
        for name, (key, value) in self.document.entries(node, f"{role}s").items():
            self._check_variable_name(key, role)
            if name in self.inputs:
                raise self.document.error(key, f"{quoted(name)} is an input already")
            variables[name] = self._variable(name, value, role)
        return variables

    def _check_variable_name(self, key: Scalar, role: str) -> None:
        name = key.text
        proper = name.isidentifier() and unicodedata.normalize("NFKC", name) == name
        if not proper or keyword.iskeyword(name) or len(name) > MAX_NAME:
            raise self.document.error(
                key,
                f"{role} name {quoted(name)} must be a Python name (letters, digits, '_'; no "
                f"keyword; up to {MAX_NAME} characters): it is also the name of an argument",
            )

    def _variable(self, name: str, node: Node, role: str) -> Variable:
        document = self.document
        optional = ("label", "unit", *(("default", "operators") if role == "output" else ()))
        fields = document.fields(node, f"{role} {name}", ("universe", "sets"), optional)
        universe = self._universe(fields["universe"])
        self.places[name] = document.location(fields["universe"])
        sets = self._sets(fields["sets"], name, universe)
        with document.at(fields["sets"]):
            variable = Variable(
                name,
                universe,
                tuple(sets),
                label=document.text(fields["label"], "label") if "label" in fields else "",
                unit=document.text(fields["unit"], "unit") if "unit" in fields else "",
            )
        if "operators" in fields:
            variable = replace(variable, operators=self._operators(fields["operators"]))
        if "default" not in fields:
            return variable
        default = document.number(fields["default"], "default")
        with document.at(fields["default"]):
            return replace(variable, default=default)

    def _universe(self, node: Node) -> Universe:
        document = self.document
        grid = "ends"
        if isinstance(node, Sequence):
            items = document.items(node, "universe")
            if len(items) != 3:
                raise document.error(
                    node, f"universe takes 3 values [low, high, points], not {len(items)}"
                )
            low, high, points = items
        else:
            fields = document.fields(node, "universe", ("low", "high", "points"), ("grid",))
            low, high, points = (fields[key] for key in ("low", "high", "points"))
            if "grid" in fields:
                grid = document.choice(fields["grid"], "grid", GRIDS)
        with document.at(node):
            return Universe(
                document.number(low, "low"),
                document.number(high, "high"),
                document.whole(points, "points"),
                grid,
            )

    def _sets(self, node: Node, variable: str, universe: Universe) -> list[FuzzySet]:
        sets: list[FuzzySet] = []
        highest, last = -math.inf, ""
        for key, value in self.document.entries(node, f"sets of {variable}").values():
            self._check_set_name(key)
            fuzzy_set = self._set(key.text, value)
            sets.append(fuzzy_set)
            if not fuzzy_set.has_core:
                continue
            self._check_place(fuzzy_set, value, variable, universe)
            center = fuzzy_set.center(universe.low, universe.high)
            if center < highest:
                raise self.document.error(
                    key,
                    f"sets of {variable} must be listed by ascending peak: {fuzzy_set.name!r} at "
                    f"{center:g} comes after {last!r} at {highest:g}",
                )
            highest, last = center, fuzzy_set.name
        return sets

    def _check_set_name(self, key: Scalar) -> None:
        name = key.text
        if not _SET_NAME.fullmatch(name) or len(name) > MAX_NAME:
            raise self.document.error(
                key,
                f"set name {quoted(name)} must have 1 to {MAX_NAME} characters, and no blank, "
                "comma or '@'",
            )

    def _set(self, name: str, node: Node) -> FuzzySet:
        entries = self.document.entries(node, f"set {name}")
        if len(entries) != 1:
            raise self.document.error(node, f"set {name} takes one shape, not {len(entries)}")
        ((shape, (key, value)),) = entries.items()
        if shape not in SHAPES:
            raise self.document.unknown(key, shape, "shape", tuple(SHAPES))
        role = f"parameters of {shape}"
        parameters = [self.document.number(p, role) for p in self.document.items(value, role)]
        with self.document.at(value):
            return FuzzySet(name, shape, tuple(parameters))

    def _check_place(
        self, fuzzy_set: FuzzySet, node: Node, variable: str, universe: Universe
    ) -> None:
        # Its peak may lie outside, as in files of other programs.
        low, high = fuzzy_set.support()[:2]
        if high < universe.low or low > universe.high:
            raise self.document.error(
                node,
                f"set {fuzzy_set.name!r} lies outside the universe of {variable}, "
                f"[{universe.low:g}, {universe.high:g}]",
            )

    def _check_output_grids(self, node: Node, operators: Operators) -> None:
        """Every output set must be above zero somewhere on the grid, or it would have no effect."""
        for name, (_, value) in self.document.entries(node, "outputs").items():
            variable = self.outputs[name]
            if (variable.operators or operators).defuzzification == "weighted-centers":
                continue
            sets = self.document.entries(self.document.entries(value, name)["sets"][1], "sets")
            for fuzzy_set in variable.sets:
                if not _on_grid(fuzzy_set, variable.universe):
                    raise self.document.error(
                        sets[fuzzy_set.name][1],
                        f"set {fuzzy_set.name!r} is zero at all {variable.universe.points} points "
                        f"of {name}: give the universe more points",
                    )

    def _check_coverage(self, rulebase: RuleBase, node: Node) -> None:
        """At all inputs every output needs a rule that can fire, or a default."""
        entries = self.document.entries(node, "inputs")
        for output in rulebase.outputs:
            if output.default is not None:
                continue
            about = [r for r in rulebase.rules if _concludes(r, output.name)]
            for variable in rulebase.inputs:
                groups = [dict(group) for rule in about for group in rule.groups]
                terms = [group.get(variable.name) for group in groups]
                if None in terms:
                    continue
                used = {term for term in terms if term is not None}
                for low, high in variable.uncovered(used):
                    tailed = all(s.is_tailed for s in variable.sets if s.name in used)
                    lost = " (its sets are so narrow that their grades underflow to 0)"
                    raise self.document.error(
                        entries[variable.name][0],
                        f"no rule about {output.name} can fire for {variable.name} "
                        f"{_stretch(low, high)}{lost if tailed else ''}; "
                        f"cover it, or give {output.name} a default",
                    )

    # ---------------------------------------------------------------- rules

    def _rules(self, node: Node) -> tuple[list[Rule], TableLayout | None]:
        if isinstance(node, MappingNode):
            return self._table(node)
        if isinstance(node, Sequence):
            rules = [
                rule for item in self.document.items(node, "rules") for rule in self._listed(item)
            ]
            return rules, None
        raise self.document.error(node, "rules must be a list of if/then rules, or a table")

    def _table(self, node: Node) -> tuple[list[Rule], TableLayout]:
        document = self.document
        fields = document.fields(node, "rules", ("columns", "rows", "cells", "table"))
        layout = self._layout(fields)
        if len(self.inputs) != 2 or layout.columns == layout.rows:
            raise document.error(
                node,
                "a table is for exactly two inputs, one for columns and one for rows; there are "
                f"{', '.join(self.inputs)}: write the rules as an if/then list",
            )
        columns, rows = self.inputs[layout.columns], self.inputs[layout.rows]
        entries = document.entries(fields["table"], "table")
        for row, (key, _) in entries.items():
            if row not in rows.set_names:
                raise document.unknown(key, row, f"row (set of {rows.name})", rows.set_names)
        missing = [row for row in rows.set_names if row not in entries]
        if missing:
            raise document.error(
                fields["table"], f"the table lacks the row {', '.join(map(quoted, missing))}"
            )
        rules = []
        for row in rows.set_names:
            for column, cell in self._row(row, entries[row][1], columns):
                conditions = ((columns.name, column), (rows.name, row))
                rules.append(self._rule(conditions, cell, cell, layout.cells))
        return rules, layout

    def _layout(self, fields: Mapping[str, Node]) -> TableLayout:
        document = self.document
        node = fields["cells"]
        words = [node] if isinstance(node, Scalar) else document.items(node, "cells")
        cells = tuple(document.choice(word, "output", tuple(self.outputs)) for word in words)
        if len(set(cells)) < len(cells) or len(cells) < len(self.outputs):
            allowed = ", ".join(self.outputs)
            raise document.error(node, f"cells must name every output once: {allowed}")
        return TableLayout(
            document.choice(fields["columns"], "input", tuple(self.inputs)),
            document.choice(fields["rows"], "input", tuple(self.inputs)),
            cells,
        )

    def _row(self, row: str, node: Node, columns: Variable) -> Iterable[tuple[str, Node]]:
        cells = self.document.items(node, f"row {row}")
        if len(cells) != len(columns.sets):
            raise self.document.error(
                node,
                f"row {row!r} has {len(cells)} cells, not {len(columns.sets)}, one for each set "
                f"of {columns.name}: {', '.join(columns.set_names)}",
            )
        return zip(columns.set_names, cells, strict=True)

    def _listed(self, node: Node) -> list[Rule]:
        document = self.document
        entries = document.entries(node, "a rule")
        either = "if any" if "if any" in entries else "if"
        fields = document.fields(node, "a rule", (either, "then"), ("if", "if any", "or"))
        if "if" in fields and "if any" in fields:
            raise document.error(entries["if"][0], "a rule takes 'if' or 'if any', not both")
        if "or" in fields and either == "if any":
            raise document.error(entries["or"][0], "'or' goes with 'if', not with 'if any'")
        conditions = self._group(fields[either], either)
        if either == "if":
            others = document.items(fields["or"], "'or'") if "or" in fields else ()
            alternatives = tuple(self._group(item, "or") for item in others)
            then, outputs = fields["then"], tuple(self.outputs)
            return [self._rule(conditions, then, node, outputs, alternatives=alternatives)]
        shared = len(conditions) > 1
        return [
            self._rule((condition,), fields["then"], node, tuple(self.outputs), shared)
            for condition in conditions
        ]

    def _group(self, node: Node, word: str) -> Conditions:
        return tuple(
            self._condition(key, value)
            for key, value in self.document.entries(node, quoted(word)).values()
        )

    def _condition(self, key: Scalar, value: Node) -> tuple[str, str]:
        if key.text not in self.inputs:
            raise self.document.unknown(key, key.text, "input", tuple(self.inputs))
        variable = self.inputs[key.text]
        role = f"set of {variable.name}"
        return variable.name, self.document.choice(value, role, variable.set_names)

    def _rule(
        self,
        conditions: Conditions,
        consequents: Node,
        node: Node,
        order: tuple[str, ...],
        shared: bool = False,
        alternatives: tuple[Conditions, ...] = (),
    ) -> Rule:
        with self.document.at(consequents):
            rule = Rule(conditions, self.cells.read(consequents, order), alternatives)
        if rule.key in self.rule_nodes:
            words = str(rule).partition(" then ")[0]
            raise self.document.error(node, f"two rules with the same conditions: {words}")
        self.rule_nodes[rule.key] = consequents, shared
        return rule


def _concludes(rule: Rule, output: str) -> bool:
    return any(c.output == output and c.confidence > 0 for c in rule.consequents)


def _on_grid(fuzzy_set: FuzzySet, universe: Universe) -> bool:
    """Whether a set is above zero at one grid point at least."""
    if fuzzy_set.shape == "singleton":
        return True  # it belongs to the nearest point
    for stretch in fuzzy_set.positive():
        nearest = (max(stretch.low, universe.first) - universe.first) / universe.step
        first = min(max(int(nearest) - 1, 0), universe.points - 1)
        for index in range(first, min(first + 4, universe.points)):
            point = universe.first + index * universe.step
            if index == universe.points - 1 and universe.grid == "ends":
                point = universe.high
            if point in stretch:
                return True
    return False


def _stretch(low: float, high: float) -> str:
    return f"at {low:g}" if low == high else f"between {low:g} and {high:g}"
