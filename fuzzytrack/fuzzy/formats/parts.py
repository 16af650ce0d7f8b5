"""Parts of a fuzzy system as another program describes it, and the rule base made of them.

Readers of other formats collect variables, sets and rules as they stand there. `assemble` does what
all of them need: names that a rule base may have, sets in the order of their peaks, sets after
hedges, conditions about outputs replaced by those behind them, and rules that share conditions
joined.
"""

from __future__ import annotations

import itertools
import keyword
import math
import re
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

from fuzzytrack.errors import Location, RuleBaseError
from fuzzytrack.fuzzy.formats.carried import Carried
from fuzzytrack.fuzzy.formats.source_text import located
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.operators import Operators
from fuzzytrack.fuzzy.reader import MAX_NAME, SET_NAME
from fuzzytrack.fuzzy.rulebase import (
    MAX_ALTERNATIVES,
    MAX_INPUTS,
    MAX_OUTPUTS,
    MAX_RULES,
    Consequent,
    Rule,
    RuleBase,
    remember_places,
)  # fmt: skip
from fuzzytrack.fuzzy.shapes import LINEAR
from fuzzytrack.fuzzy.variable import Universe, Variable
from fuzzytrack.yamltree import quoted

__all__ = [
    "DEFAULT_GRID", "Condition", "Group", "RulePart", "SetPart", "System", "VariablePart",
    "is_linear", "widened",
]  # fmt: skip

#: Points and grid of a variable of which a file says nothing: those of MATLAB.
DEFAULT_GRID = (101, "ends")


@dataclass(frozen=True)
class SetPart:
    """A set as it stands in a file, its shape and parameters in the terms of this package."""

    name: str
    shape: str
    parameters: tuple[float, ...]
    place: Location


@dataclass
class VariablePart:
    """A variable as it stands in a file.

    Attributes
    ----------
    grid : (int, str)
        Points, and ``ends`` or ``midpoints``.
    default : float or None
        For an output, the value where no rule fires.
    operators : Operators or None
        For an output, its own.
    """

    name: str
    low: float
    high: float
    place: Location
    sets: list[SetPart] = field(default_factory=list)
    grid: tuple[int, str] = DEFAULT_GRID
    default: float | None = None
    operators: Operators | None = None
    label: str = ""

    def set_index(self, name: str, place: Location) -> int:
        """Place of a set; of several with one name, rules mean the last."""
        for index in range(len(self.sets) - 1, -1, -1):
            if self.sets[index].name == name:
                return index
        allowed = ", ".join(s.name for s in self.sets) or "none"
        raise RuleBaseError(f"{self.name} has no set {quoted(name)}; one of {allowed}", place)


@dataclass(frozen=True)
class Condition:
    """``variable is hedges set``: a condition, or a conclusion.

    Attributes
    ----------
    variable, index : int
        Place of the variable among the inputs, or the outputs if `of_output`, and of its set.
    """

    variable: int
    index: int
    hedges: tuple[str, ...] = ()
    of_output: bool = False


Group = tuple[Condition, ...]


@dataclass(frozen=True)
class RulePart:
    """A rule: it fires if the conditions of any group hold.

    Attributes
    ----------
    conclusions : tuple of Condition
        About outputs.
    """

    groups: tuple[Group, ...]
    conclusions: tuple[Condition, ...]
    weight: float
    place: Location


@dataclass
class System:
    """All parts of a file."""

    name: str
    place: Location
    operators: Operators = field(default_factory=Operators)
    inputs: list[VariablePart] = field(default_factory=list)
    outputs: list[VariablePart] = field(default_factory=list)
    rules: list[RulePart] = field(default_factory=list)
    carried: Carried = field(default_factory=Carried)

    def rulebase(self) -> RuleBase:
        """Make a rule base of the parts.

        Raises
        ------
        RuleBaseError
            If they do not make one; names the place of the part that does not fit.
        """
        return _Assembly(self).rulebase()


class _Names:
    """Names that a rule base may have, each given once.

    Parameters
    ----------
    of_sets : bool
        Whether they are those of sets, which may be any words; otherwise they are identifiers.
    """

    def __init__(self, *, of_sets: bool) -> None:
        self.of_sets = of_sets
        self.taken: set[str] = set()
        # By name the next number of a namesake, so that thousands of them take no longer.
        self.numbers: dict[str, int] = {}

    def take(self, name: str) -> str:
        """Name that is near to another name and was not taken before."""
        stem = found = self._proper(name)
        while found in self.taken:
            number = self.numbers.get(stem, 2)
            self.numbers[stem] = number + 1
            end = f"_{number}"
            found = stem[: MAX_NAME - len(end)] + end
        self.taken.add(found)
        return found

    def _proper(self, name: str) -> str:
        name = unicodedata.normalize("NFKC", name.strip())
        if self.of_sets:
            proper = re.sub(r"[@,\s\x00-\x1f\x7f-\x9f\u2028\u2029]", "_", name) or "set"
            assert re.fullmatch(SET_NAME, proper)
        else:
            proper = re.sub(r"\W", "_", name) or "x"
            if not proper.isidentifier() or keyword.iskeyword(proper):
                proper = f"x_{proper}"
            if not proper.isidentifier():
                proper = "x"
        return proper[:MAX_NAME]


class _Sets:
    """Sets of one variable: those of the file, and those that rules need besides."""

    def __init__(self, part: VariablePart) -> None:
        self.part = part
        self.sets: list[FuzzySet] = []
        self.names: dict[object, str] = {}
        self.free = _Names(of_sets=True)
        for index, each in enumerate(part.sets):
            self._add((index, (), 0), each.name, each.shape, each.parameters, each.place)

    def _add(
        self, key: object, name: str, shape: str, parameters: tuple[float, ...], place: Location
    ) -> str:
        name = self.free.take(name)
        with located(place):
            self.sets.append(FuzzySet(name, shape, parameters))
        self.names[key] = name
        return name

    def name(self, condition: Condition, place: Location, twin: int = 0) -> str:
        """Name of a set after hedges, made when it is first asked for; twins are alike."""
        key = (condition.index, condition.hedges, twin)
        if key in self.names:
            return self.names[key]
        base = self.part.sets[condition.index]
        words = condition.hedges
        known = self.names[(condition.index, (), 0)]
        # A complement of a complement is the set itself.
        shape = " ".join([*words, base.shape])
        return self._add(key, "_".join([*words, known]), shape, base.parameters, place)

    def ordered(self, low: float, high: float) -> tuple[FuzzySet, ...]:
        """All sets by ascending peak, those without one after the others."""

        def place(fuzzy_set: FuzzySet) -> tuple[bool, float]:
            return not fuzzy_set.has_core, fuzzy_set.center(low, high) if fuzzy_set.has_core else 0

        return tuple(sorted(self.sets, key=place))


class _Assembly:
    def __init__(self, system: System) -> None:
        self.system = system
        for role, parts, most in (
            ("input", system.inputs, MAX_INPUTS),
            ("output", system.outputs, MAX_OUTPUTS),
        ):
            if not 1 <= len(parts) <= most:
                raise RuleBaseError(f"needs 1 to {most} {role}s, got {len(parts)}", system.place)
            for part in parts:
                if not part.sets and role == "input":
                    # No rule asks about it; linear conclusions may use its value.
                    part.sets.append(SetPart("any", "any singleton", (part.low,), part.place))
                if not part.sets:
                    raise RuleBaseError(f"{role} {quoted(part.name)} has no sets", part.place)
        if not 1 <= len(system.rules) <= MAX_RULES:
            raise RuleBaseError(
                f"needs 1 to {MAX_RULES} rules, got {len(system.rules)}", system.place
            )
        free = _Names(of_sets=False)
        self.names = [free.take(part.name) for part in (*system.inputs, *system.outputs)]
        self.inputs = [_Sets(part) for part in system.inputs]
        self.outputs = [_Sets(part) for part in system.outputs]

    def input_name(self, index: int) -> str:
        return self.names[index]

    def output_name(self, index: int) -> str:
        return self.names[len(self.inputs) + index]

    def rulebase(self) -> RuleBase:
        system, carried = self.system, self.system.carried
        self._check_conclusions()
        rules = self._rules()
        if not any(rule.alternatives for rule in rules):
            self._forget_alternatives()
        carried.check_names(tuple(self.names))
        variables = [
            self._variable(sets, name, carried)
            for sets, name in zip((*self.inputs, *self.outputs), self.names, strict=True)
        ]
        count = len(self.inputs)
        with located(system.place):
            found = RuleBase(
                system.name or "unnamed",
                tuple(variables[:count]),
                tuple(variables[count:]),
                rules,
                system.operators,
                source=carried.text("source"),
                description=carried.text("description"),
                scheduler=carried.scheduler(),
                layout=carried.layout(),
            )
        parts = (*system.inputs, *system.outputs)
        return remember_places(
            found, {name: part.place for name, part in zip(self.names, parts, strict=True)}
        )

    def _forget_alternatives(self) -> None:
        """Leave out how alternatives are joined, where no rule has any."""
        self.system.operators = replace(self.system.operators, alternatives="max")
        for part in self.system.outputs:
            if part.operators is not None:
                part.operators = replace(part.operators, alternatives="max")

    def _variable(self, sets: _Sets, name: str, carried: Carried) -> Variable:
        part = sets.part
        points, grid = carried.grid(name) or part.grid
        with located(part.place):
            universe = Universe(part.low, part.high, points, grid)
            return Variable(
                name,
                universe,
                sets.ordered(part.low, part.high),
                default=carried.default(name, part.default),
                label=carried.text("labels", name) or (part.label if part.label != name else ""),
                unit=carried.text("units", name),
                operators=part.operators,
            )

    def _check_conclusions(self) -> None:
        for rule in self.system.rules:
            if not rule.conclusions:
                raise RuleBaseError("a rule needs a conclusion", rule.place)
            if not 0.0 <= rule.weight <= 1.0:
                raise RuleBaseError(f"weight must be within [0, 1], got {rule.weight}", rule.place)

    # ---------------------------------------------------------------- rules

    def _rules(self) -> tuple[Rule, ...]:
        expanded: list[RulePart] = []
        for rule in self.system.rules:
            expanded.append(self._without_outputs(rule, expanded))
        merged: dict[object, _Merged] = {}
        for rule in expanded:
            for groups in self._split(rule):
                named = tuple(self._named(group, rule.place) for group in groups)
                with located(rule.place):
                    key = Rule(named[0], (Consequent("", ""),), named[1:]).key
                mine = merged.setdefault(key, _Merged(named, rule.place))
                for conclusion in rule.conclusions:
                    self._conclude(mine, conclusion, rule)
        found = []
        for mine in merged.values():
            with located(mine.place):
                consequents = [
                    Consequent(output, name, sure) for (output, name), sure in mine.sure.items()
                ]
                found.append(Rule(mine.groups[0], tuple(consequents), mine.groups[1:]))
        return tuple(found)

    def _operators(self, output: int) -> Operators:
        return self.system.outputs[output].operators or self.system.operators

    def _split(self, rule: RulePart) -> Iterable[tuple[Group, ...]]:
        """Under maxima, alternatives are rules of their own; elsewhere they stay in one."""
        algebras = [self._operators(c.variable) for c in rule.conclusions]
        maxima = self.system.operators.alternatives == "max"
        if maxima and all(o.disjunction == "max" for o in algebras):
            return [(group,) for group in rule.groups]
        if len(rule.groups) > MAX_ALTERNATIVES:
            raise RuleBaseError(
                f"a rule with {len(rule.groups)} alternatives; up to {MAX_ALTERNATIVES} are "
                "allowed",
                rule.place,
            )
        return [rule.groups]

    def _named(self, group: Group, place: Location) -> tuple[tuple[str, str], ...]:
        pairs: dict[str, str] = {}
        for condition in group:
            name = self.input_name(condition.variable)
            term = self.inputs[condition.variable].name(condition, place)
            if name in pairs:
                same = pairs[name] == term and self.system.operators.conjunction == "min"
                if not same:
                    raise RuleBaseError(
                        f"two conditions about {name} that hold together have no counterpart",
                        place,
                    )
            pairs[name] = term
        return tuple(sorted(pairs.items(), key=lambda pair: self.names.index(pair[0])))

    def _conclude(self, mine: _Merged, conclusion: Condition, rule: RulePart) -> None:
        output = self.output_name(conclusion.variable)
        sets, operators = self.outputs[conclusion.variable], self._operators(conclusion.variable)
        target = output, sets.name(conclusion, rule.place)
        if target not in mine.sure:
            mine.sure[target] = rule.weight
        elif operators.disjunction == "max":
            mine.sure[target] = max(mine.sure[target], rule.weight)
        elif operators.defuzzification != "weighted-centers" or operators.disjunction == "sum":
            # Two rules with the same conditions and conclusion count twice: by a twin of the set.
            twin = 1
            while target in mine.sure:
                target = output, sets.name(conclusion, rule.place, twin)
                twin += 1
            mine.sure[target] = rule.weight
        else:
            raise RuleBaseError(
                f"a rule that says the same as another, with {operators.disjunction}", rule.place
            )

    def _without_outputs(self, rule: RulePart, before: Sequence[RulePart]) -> RulePart:
        """Replace conditions about outputs by those of the rules before that conclude them."""
        if not any(c.of_output for group in rule.groups for c in group):
            return rule
        groups: list[Group] = []
        for group in rule.groups:
            choices: list[list[Group]] = []
            for condition in group:
                choices.append(
                    self._behind(condition, rule, before) if condition.of_output else [(condition,)]
                )
            count = 1
            for choice in choices:
                count *= len(choice)
            if count > MAX_ALTERNATIVES or not count:
                raise RuleBaseError(
                    f"conditions about outputs that stand for {count} others", rule.place
                )
            groups += [
                tuple(dict.fromkeys(itertools.chain.from_iterable(joint)))
                if self.system.operators.conjunction == "min"
                else tuple(itertools.chain.from_iterable(joint))
                for joint in itertools.product(*choices)
            ]
        return replace(rule, groups=tuple(groups))

    def _behind(
        self, condition: Condition, rule: RulePart, before: Sequence[RulePart]
    ) -> list[Group]:
        output = self.system.outputs[condition.variable]
        target = replace(condition, of_output=False, hedges=())
        sources = [each for each in before if target in each.conclusions]
        exact = (
            not condition.hedges
            and self._operators(condition.variable).disjunction == "max"
            and self.system.operators.alternatives == "max"
            and all(each.weight == 1.0 for each in sources)
        )
        if not exact:
            raise RuleBaseError(
                f"a condition about the output {output.name} has no counterpart, unless it is "
                "aggregated by the maximum from rules before it, without hedges and weights",
                rule.place,
            )
        return [group for each in sources for group in each.groups]


@dataclass
class _Merged:
    """Rules with the same conditions: what they conclude, and how surely."""

    groups: tuple[tuple[tuple[str, str], ...], ...]
    place: Location
    sure: dict[tuple[str, str], float] = field(default_factory=dict)


def widened(part: VariablePart) -> None:
    """Let the range of an output reach to all of its constants, which are not limited by it.

    A range without a width, as such outputs may have it, is given one.
    """
    values = [s.parameters[0] for s in part.sets if s.shape == "singleton"]
    ends = [end for end in (part.low, part.high) if math.isfinite(end)]
    low, high = min([*values, *ends], default=0.0), max([*values, *ends], default=0.0)
    if low == high:
        low, high = low - max(1.0, abs(low)), high + max(1.0, abs(high))
    part.low, part.high = low, high


def is_linear(part: VariablePart) -> bool:
    """Whether some sets are linear functions of the inputs."""
    return any(s.shape == LINEAR for s in part.sets)
