"""The rule base: variables, rules and operators, checked as a whole."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from fuzzytrack.errors import Location, RuleBaseError
from fuzzytrack.fuzzy.operators import Operators
from fuzzytrack.fuzzy.shapes import LINEAR
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.html_reprs import Cell, block, paragraph, table, tinted
from fuzzytrack.reprs import shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Consequent", "Operators", "Rule", "RuleBase", "TableLayout"]

_USUAL = Operators()
MAX_INPUTS = 8
MAX_OUTPUTS = 16
MAX_RULES = 10_000
MAX_ALTERNATIVES = 64

#: Pairs (input, set).
Conditions = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Consequent:
    """One conclusion of a rule: ``output is set``, with a confidence in [0, 1]."""

    output: str
    set_name: str
    confidence: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "confidence", float(self.confidence))
        if not 0.0 <= self.confidence <= 1.0:
            raise RuleBaseError(f"confidence must be within [0, 1], got {self.confidence}")

    def __str__(self) -> str:
        sure = "" if self.confidence == 1.0 else f" @ {self.confidence:g}"
        return f"{self.output} is {self.set_name}{sure}"


@dataclass(frozen=True)
class Rule:
    """``if`` every condition holds ``then`` every consequent, each with its confidence.

    Parameters
    ----------
    conditions : tuple of (str, str)
        Pairs (input, set); an input that is not named does not matter.
    consequents : tuple of Consequent
        At least one; several for one output share it by their confidences (Eq. 3.12).
    alternatives : tuple of tuple of (str, str)
        Further conditions: the rule fires if those of any group hold.
    """

    conditions: Conditions
    consequents: tuple[Consequent, ...]
    alternatives: tuple[Conditions, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "conditions", _as_pairs(self.conditions))
        object.__setattr__(self, "consequents", tuple(self.consequents))
        object.__setattr__(self, "alternatives", tuple(map(_as_pairs, self.alternatives)))
        for group in self.groups:
            inputs = [name for name, _ in group]
            if not inputs:
                raise RuleBaseError("a rule needs at least one condition")
            if len(set(inputs)) < len(inputs):
                raise RuleBaseError(f"a rule names an input twice: {', '.join(inputs)}")
        if len(self.alternatives) >= MAX_ALTERNATIVES:
            raise RuleBaseError(f"a rule takes up to {MAX_ALTERNATIVES} alternatives")
        if not self.consequents:
            raise RuleBaseError("a rule needs at least one consequent")
        targets = [(c.output, c.set_name) for c in self.consequents]
        if len(set(targets)) < len(targets):
            raise RuleBaseError(f"a rule names a consequent twice: {self}")

    def __str__(self) -> str:
        condition = " or ".join(map(_said, self.groups))
        return f"if {condition} then {', '.join(map(str, self.consequents))}"

    @property
    def groups(self) -> tuple[Conditions, ...]:
        """The conditions and the alternatives to them."""
        return (self.conditions, *self.alternatives)

    @property
    def key(self) -> frozenset[object]:
        """What no two rules of a rule base have in common: all conditions, in no order."""
        if not self.alternatives:
            return frozenset(self.conditions)
        # The same group twice counts twice, unless the maximum is taken.
        return frozenset(Counter(map(frozenset, self.groups)).items())

    def asks(self, name: str, silent: str = "") -> str:
        """What the rule asks of an input, in words; `silent` where it does not matter."""
        return " or ".join(dict(group).get(name, silent) for group in self.groups)


def _as_pairs(conditions: Conditions) -> Conditions:
    return tuple((str(name), str(term)) for name, term in conditions)


def _said(conditions: Conditions) -> str:
    return " and ".join(f"{name} is {term}" for name, term in conditions)


@dataclass(frozen=True)
class TableLayout:
    """Layout of rules in a table: columns and rows are inputs, cells name sets of outputs."""

    columns: str
    rows: str
    cells: tuple[str, ...]


@dataclass(frozen=True, repr=False)
class RuleBase:
    """A complete, consistent rule base.

    Parameters
    ----------
    name : str
        Short name.
    inputs, outputs : tuple of Variable
        At least one of each, all names distinct; at most 8 inputs and 16 outputs.
    rules : tuple of Rule
        From 1 to 10,000 rules; no two with the same conditions. Kept with conditions and
        consequents in the order of the variables, and with a `layout` row by row.
    operators : Operators
        AND, OR and defuzzification.
    source, description : str
        Where the rule base comes from, and what it is for.
    scheduler : tuple of (str, str)
        Settings for the scheduler that uses the outputs as gains; opaque to the fuzzy engine.
    layout : TableLayout or None
        How the rules are written: a complete table over exactly two inputs, or None for an
        if/then list.

    Raises
    ------
    RuleBaseError
        If the parts do not fit; names the offending word and the allowed ones.

    Notes
    -----
    The `repr` of a rule base that was loaded by name or from a file is code that loads it again. Of
    any other it is a summary in angle brackets, which is no code; its text, with which
    `fuzzytrack.fuzzy.loading.loads_rulebase` makes an equal one, is that of
    `fuzzytrack.fuzzy.saving.dumps_rulebase`.
    """

    name: str
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    rules: tuple[Rule, ...]
    operators: Operators = _USUAL
    source: str = ""
    description: str = ""
    scheduler: tuple[tuple[str, str], ...] = ()
    layout: TableLayout | None = None

    # What `load_rulebase` was given. No field: a changed copy does not come from there, and equal
    # rule bases are equal wherever they come from.
    _origin: ClassVar[str | None] = None
    # Where the universes stand in the text that it was read from, by the name of a variable.
    _places: ClassVar[Mapping[str, Location]] = {}

    def __post_init__(self) -> None:
        for name in ("inputs", "outputs", "rules", "scheduler"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        self._check_variables()
        if not 1 <= len(self.rules) <= MAX_RULES:
            raise RuleBaseError(f"a rule base needs 1 to {MAX_RULES} rules, got {len(self.rules)}")
        seen: dict[frozenset[object], Rule] = {}
        for rule in self.rules:
            self._check_rule(rule)
            if rule.key in seen:
                before = seen[rule.key]
                raise RuleBaseError(f"two rules with the same conditions: {rule}; and {before}")
            seen[rule.key] = rule
        object.__setattr__(self, "rules", self._in_order())
        for output in self.outputs:
            if not any(c.output == output.name for rule in self.rules for c in rule.consequents):
                raise RuleBaseError(f"no rule concludes about output {output.name!r}")
        self._check_alternatives()

    def __repr__(self) -> str:
        if self._origin is not None:
            return f"load_rulebase({shown(self._origin)})"
        variables = f"{', '.join(self.input_names)} -> {', '.join(self.output_names)}"
        return f"<RuleBase {shown(self.name)}: {variables}; {len(self.rules)} rules>"

    def plot(self) -> Figure:
        """Picture of the sets, the rules and the surfaces, see `fuzzytrack.plotting`."""
        from fuzzytrack.plotting import plot_rulebase

        return plot_rulebase(self)[0]

    def _repr_html_(self) -> str:
        """The table of words, for notebooks; words are tinted by the order of their sets."""
        return block(self.name, *self.html_parts())

    def html_parts(self) -> tuple[str, ...]:
        """Description, rules and operators, as parts of HTML."""
        settings = ", ".join(f"{key} {value}" for key, value in self.scheduler)
        said = "; ".join(self.algebra())
        rules = _html_list(self) if self.layout is None else _html_table(self, self.layout)
        source = f"Source: {self.source}" if self.source else ""
        notes = (said, f"scheduler: {settings}" if settings else "", source)
        below = (paragraph(text, note=True) for text in notes)
        return (paragraph(self.description), rules, *below)

    def __hash__(self) -> int:
        # Compiled code is looked up by scheduler, and so by rule base, at every step; a hash of all
        # parts would take longer than the step itself.
        return hash((self.name, len(self.rules)))

    def _check_variables(self) -> None:
        if not 1 <= len(self.inputs) <= MAX_INPUTS or not self.outputs:
            raise RuleBaseError(f"a rule base needs 1 to {MAX_INPUTS} inputs and 1 output or more")
        if len(self.outputs) > MAX_OUTPUTS:
            raise RuleBaseError(f"a rule base takes up to {MAX_OUTPUTS} outputs")
        names = [v.name for v in self.variables]
        doubled = {n for n in names if names.count(n) > 1}
        if doubled:
            raise RuleBaseError(f"two variables of one name: {min(doubled)!r}")
        for variable in self.inputs:
            if variable.is_linear or variable.operators or variable.default is not None:
                raise RuleBaseError(
                    f"input {variable.name!r}: linear sets, operators and a default are for outputs"
                )
        for output in self.outputs:
            self._check_output(output)

    def _check_output(self, output: Variable) -> None:
        """Sets must fit the defuzzification."""
        by_centers = self.operators_of(output).defuzzification == "weighted-centers"
        if output.is_linear and not by_centers:
            raise RuleBaseError(f"output {output.name!r}: linear sets need weighted-centers")
        for fuzzy_set in output.sets:
            count = len(fuzzy_set.parameters)
            if fuzzy_set.base == LINEAR and count != len(self.inputs) + 1:
                raise RuleBaseError(
                    f"set {fuzzy_set.name!r} of {output.name}: linear takes a coefficient for each "
                    f"of the {len(self.inputs)} inputs and a constant, not {count} numbers"
                )
            if by_centers and fuzzy_set.base != LINEAR and not fuzzy_set.has_core:
                raise RuleBaseError(
                    f"set {fuzzy_set.name!r} of {output.name}: {fuzzy_set.shape} has no center, "
                    "which weighted-centers needs"
                )

    def _check_rule(self, rule: Rule) -> None:
        for group in rule.groups:
            for name, term in group:
                self.input(name).index(term)
        for consequent in rule.consequents:
            self.output(consequent.output).index(consequent.set_name)

    def _check_alternatives(self) -> None:
        """Refuse strengths above 1 for an output whose norms are for grades alone."""
        if self.operators.alternatives != "sum" or not any(r.alternatives for r in self.rules):
            return
        for output in self.outputs:
            if not self.operators_of(output).takes_sums:
                raise RuleBaseError(
                    "operators: alternatives 'sum', by which strengths exceed 1, need product for "
                    f"implication and weighting, and sum or max for or, but {output.name} has "
                    "others; use alternatives 'bounded-sum'"
                )

    def _in_order(self) -> tuple[Rule, ...]:
        """Conditions and consequents in the order of the variables, the rules of a table by row.

        Rule bases with the same rules are then equal, in whatever order they were written.
        """
        inputs = {v.name: k for k, v in enumerate(self.inputs)}
        outputs = {v.name: (k, v) for k, v in enumerate(self.outputs)}

        def place(consequent: Consequent) -> tuple[int, int]:
            number, output = outputs[consequent.output]
            return number, output.index(consequent.set_name)

        def ordered(rule: Rule) -> Rule:
            groups = [tuple(sorted(group, key=lambda c: inputs[c[0]])) for group in rule.groups]
            consequents = tuple(sorted(rule.consequents, key=place))
            same = tuple(groups) == rule.groups and consequents == rule.consequents
            return rule if same else Rule(groups[0], consequents, tuple(groups[1:]))

        rules = tuple(map(ordered, self.rules))
        return rules if self.layout is None else self._as_table(rules, self.layout)

    def _as_table(self, rules: tuple[Rule, ...], layout: TableLayout) -> tuple[Rule, ...]:
        columns, rows = self.input(layout.columns), self.input(layout.rows)
        if len(self.inputs) != 2 or columns is rows:
            raise RuleBaseError(
                "a table is for exactly two inputs, one for columns and one for rows; "
                f"there are {', '.join(self.input_names)}: write the rules as an if/then list"
            )
        if sorted(layout.cells) != sorted(self.output_names):
            raise RuleBaseError(
                f"cells of the table must name every output once: {', '.join(self.output_names)}"
            )
        cells: dict[frozenset[object], Rule] = {rule.key: rule for rule in rules}
        ordered = []
        for row in rows.set_names:
            for column in columns.set_names:
                rule = cells.pop(frozenset({(columns.name, column), (rows.name, row)}), None)
                if rule is None:
                    raise RuleBaseError(
                        f"the table has no cell for {rows.name} {row}, {columns.name} {column}"
                    )
                ordered.append(rule)
        for rule in cells.values():
            raise RuleBaseError(f"a rule that is no cell of the table: {rule}")
        return tuple(ordered)

    @property
    def variables(self) -> tuple[Variable, ...]:
        """The inputs and then the outputs, in order."""
        return (*self.inputs, *self.outputs)

    def operators_of(self, output: Variable) -> Operators:
        """Operators by which the rules conclude about an output."""
        return self.operators if output.operators is None else output.operators

    @property
    def adds_products(self) -> bool:
        """Whether every output is a quotient of two sums over the rules of products of grades.

        So it is with product and sum, centroid or weighted centers, no alternatives in a rule and
        no linear sets.
        """
        return not any(rule.alternatives for rule in self.rules) and all(
            operators.is_classical
            and (operators.conjunction, operators.disjunction) == ("product", "sum")
            and operators.defuzzification in ("centroid", "weighted-centers")
            and not output.is_linear
            for output in self.outputs
            for operators in (self.operators, self.operators_of(output))
        )

    def algebra(self) -> Iterator[str]:
        """Operators in words, and after them those of each output that has its own."""
        yield _in_words(self.operators)
        for output in self.outputs:
            if output.operators is not None:
                yield f"of {output.name}: {_in_words(output.operators)}"

    @property
    def input_names(self) -> tuple[str, ...]:
        """Names of the inputs, in order."""
        return tuple(v.name for v in self.inputs)

    @property
    def output_names(self) -> tuple[str, ...]:
        """Names of the outputs, in order."""
        return tuple(v.name for v in self.outputs)

    def input(self, name: str) -> Variable:
        """Input by name; RuleBaseError names the allowed ones."""
        return _named(self.inputs, name, "input")

    def output(self, name: str) -> Variable:
        """Output by name; RuleBaseError names the allowed ones."""
        return _named(self.outputs, name, "output")

    def variable(self, name: str) -> Variable:
        """Input or output by name; RuleBaseError names the allowed ones."""
        return _named(self.variables, name, "variable")

    def place(self, name: str) -> Location | None:
        """Where the universe of a variable stands in the file that the rule base was read from.

        None for a rule base, or a changed copy, that comes from no file.
        """
        return self._places.get(name)

    def uncovered(self, name: str) -> Iterator[tuple[float, float]]:
        """Intervals of an input, as (low, high), where every membership is zero."""
        return self.input(name).uncovered()


def _in_words(operators: Operators) -> str:
    return ", ".join(f"{key}: {word}" for key, word in operators.words().items())


def remember_origin(rules: RuleBase, name_or_path: str) -> RuleBase:
    """The same rule base, with the name or path by which it was loaded in its `repr`."""
    object.__setattr__(rules, "_origin", name_or_path)
    return rules


def remember_places(rules: RuleBase, places: Mapping[str, Location]) -> RuleBase:
    """The same rule base, with the places of its universes, for messages."""
    object.__setattr__(rules, "_places", dict(places))
    return rules


def _named(variables: tuple[Variable, ...], name: str, role: str) -> Variable:
    for variable in variables:
        if variable.name == name:
            return variable
    allowed = ", ".join(v.name for v in variables)
    raise RuleBaseError(f"unknown {role} {name!r}; one of {allowed}")


# -------------------------------------------------------------------- HTML


def _html_table(rules: RuleBase, layout: TableLayout) -> str:
    """Rules that were written as a table, as one."""
    columns, rows = rules.input(layout.columns), rules.input(layout.rows)
    width = len(columns.sets)
    cells = [_html_cell(rules, rule, layout.cells) for rule in rules.rules]
    body = [
        [name, *cells[number * width : (number + 1) * width]]
        for number, name in enumerate(rows.set_names)
    ]
    says = f"{' '.join(layout.cells)} by {layout.rows} (down) and {layout.columns} (across)"
    heads = [f"{layout.rows} \\ {layout.columns}", *columns.set_names]
    return paragraph(says) + table(heads, body, words=len(heads))


def _html_list(rules: RuleBase) -> str:
    """Rules of any form, one in a row."""
    names = rules.output_names
    rows = []
    for number, rule in enumerate(rules.rules, 1):
        words = [str(number), *(rule.asks(name) for name in rules.input_names)]
        rows.append([*words, *(_html_cell(rules, rule, [name]) for name in names)])
    conditions_of = (f"if {name}" for name in rules.input_names)
    heads = ["rule", *conditions_of, *(f"then {name}" for name in names)]
    return table(heads, rows, words=len(heads), what="rules")


def _html_cell(rules: RuleBase, rule: Rule, outputs: Sequence[str]) -> Cell:
    """What a rule concludes of some outputs."""
    words = []
    for name in outputs:
        shares = rules.output(name).shares()
        for each in rule.consequents:
            if each.output == name:
                sure = "" if each.confidence == 1.0 else f" @{each.confidence:g}"
                words.append(tinted(each.set_name + sure, shares[each.set_name]))
    return Cell(" ".join(words))
