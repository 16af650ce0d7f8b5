"""A reader of FuzzyLite Language files (.fll) and their expected outputs (.fld).

It turns a system into rule bases of this package, so that its engine is judged by answers it had
no part in. What cannot be said in a rule base is expanded where the expansion is exact:

* ``or`` becomes two rules that share a consequent, which is the same under the maximum;
* an output in a condition is replaced by the conditions of the rules that conclude it;
* ``not`` and shapes of the language that the package lacks become sets of the tests' own;
* a linear Takagi-Sugeno term Σ aₖ xₖ + b becomes one output for each coefficient, as the weighted
  average of linear functions is the linear function of the weighted averages.

Anything else raises `UnsupportedError`, with the reason.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import Consequent, Operators, Rule, RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.fuzzy.variable import Universe, Variable

RESOLUTION = 1000
FAR = 1e6

CONJUNCTIONS = {"Minimum": "min", "AlgebraicProduct": "product"}
DEFUZZIFIERS = {
    "Centroid": "centroid",
    "Bisector": "bisector",
    "MeanOfMaximum": "mom",
    "SmallestOfMaximum": "som",
    "LargestOfMaximum": "lom",
}


class UnsupportedError(Exception):
    """A feature of the language that neither the engine nor this reader has."""


# ------------------------------------------------------------ sets


class OwnSet(FuzzySet):
    """A fuzzy set by a function, for shapes that the package does not have."""

    def __init__(self, name: str, function: Callable[[np.ndarray], np.ndarray]) -> None:
        for key, value in (("name", name), ("shape", "own"), ("parameters", ())):
            object.__setattr__(self, key, value)
        object.__setattr__(self, "function", function)

    def membership(self, x):
        return np.asarray(self.function(np.asarray(x, dtype=float)))


def sigmoid(x, inflection, slope):
    return 1 / (1 + np.exp(-slope * (x - inflection)))


def bell_sides(x, mean1, sigma1, mean2, sigma2):
    left = np.where(x < mean1, np.exp(-((x - mean1) ** 2) / (2 * sigma1**2)), 1.0)
    right = np.where(x > mean2, np.exp(-((x - mean2) ** 2) / (2 * sigma2**2)), 1.0)
    return left * right


def cosine(x, center, width):
    wave = (1 + np.cos(2 * np.pi / width * (x - center))) / 2
    return np.where(np.abs(x - center) <= width / 2, wave, 0.0)


def concave(x, inflection, end):
    # The decreasing curve is the increasing one seen in a mirror.
    sign = 1.0 if inflection <= end else -1.0
    x, i, e = sign * x, sign * inflection, sign * end
    return np.where(x < e, (e - i) / (2 * e - i - np.minimum(x, e)), 1.0)


def quarter_circle(x, start, end):
    distance = np.clip((x - end) / (start - end), 0.0, 1.0)
    return np.sqrt(1 - distance**2)


def half_ellipse(x, start, end):
    distance = np.clip(np.abs(2 * x - start - end) / (end - start), 0.0, 1.0)
    return np.sqrt(1 - distance**2)


OWN_SHAPES = {
    "Arc": quarter_circle,
    "Binary": lambda x, start, side: np.where(x >= start if side > 0 else x <= start, 1.0, 0.0),
    "Concave": concave,
    "Cosine": cosine,
    "Discrete": lambda x, *pairs: np.interp(x, pairs[::2], pairs[1::2]),
    "GaussianProduct": bell_sides,
    "SemiEllipse": half_ellipse,
    "SigmoidDifference": lambda x, a, rise, fall, b: np.abs(
        sigmoid(x, a, rise) - sigmoid(x, b, fall)
    ),
    "SigmoidProduct": lambda x, a, rise, fall, b: sigmoid(x, a, rise) * sigmoid(x, b, fall),
    "Spike": lambda x, center, width: np.exp(-np.abs(10 / width * (x - center))),
}

SHAPES = {
    "Bell": ("gbellmf", lambda center, width, slope: (width, slope, center)),
    "Gaussian": ("gaussmf", lambda *p: p),
    "PiShape": ("pimf", lambda *p: p),
    "Ramp": ("trapmf", lambda s, e: (s, e, FAR, FAR) if s < e else (-FAR, -FAR, e, s)),
    "Rectangle": ("trapmf", lambda s, e: (min(s, e), min(s, e), max(s, e), max(s, e))),
    "SShape": ("smf", lambda *p: p),
    "Sigmoid": ("sigmf", lambda *p: p),
    "Trapezoid": ("trapmf", lambda *p: p),
    "Triangle": ("trimf", lambda *p: p),
    "ZShape": ("zmf", lambda *p: p),
}

FORMULA_NAMES = {"lt": np.less, "gt": np.greater, "eq": np.equal, "__builtins__": {}}


def formula(text):
    """Function of x from the arithmetic and comparisons of a Function term."""
    words = set(re.findall(r"[a-zA-Z_]\w*", text))
    unknown = words - {"x", *FORMULA_NAMES}
    if unknown:
        raise UnsupportedError(f"Function of {', '.join(sorted(unknown))}")
    code = compile(text, "<term>", "eval")
    return lambda x: np.asarray(eval(code, {**FORMULA_NAMES, "x": x}), dtype=float)


@dataclass(frozen=True)
class Term:
    """One ``term:`` line."""

    name: str
    shape: str
    text: str

    @property
    def numbers(self):
        return tuple(float(word) for word in self.text.split())

    def fuzzy_set(self):
        if self.shape == "Function":
            return OwnSet(self.name, formula(self.text))
        if self.shape in SHAPES:
            shape, order = SHAPES[self.shape]
            return FuzzySet(self.name, shape, order(*self.numbers))
        if self.shape in OWN_SHAPES:
            function, numbers = OWN_SHAPES[self.shape], self.numbers
            return OwnSet(self.name, lambda x: function(x, *numbers))
        raise UnsupportedError(f"{self.shape} term as a fuzzy set")


# ------------------------------------------------------------ file


@dataclass
class Part:
    """One block of a file: its ``key: value`` lines, its terms and its rules."""

    kind: str
    name: str
    keys: dict[str, str] = field(default_factory=dict)
    terms: dict[str, Term] = field(default_factory=dict)
    rules: list[str] = field(default_factory=list)

    @property
    def range(self):
        low, high = self.keys["range"].split()
        return float(low), float(high)

    def flag(self, key):
        return self.keys.get(key, "false") == "true"


def parse(text):
    """Parts of a file, in order."""
    parts = []
    for line in text.splitlines():
        key, _, value = (piece.strip() for piece in line.partition(":"))
        if not key or key.startswith("#"):
            continue
        if not line.startswith(" "):
            parts.append(Part(key, value))
        elif key == "term":
            name, shape, *rest = value.split(maxsplit=2)
            # Of terms with one name, rules mean the last.
            parts[-1].terms[name] = Term(name, shape, "".join(rest))
        elif key == "rule":
            parts[-1].rules.append(value)
        else:
            parts[-1].keys[key] = value
    return parts


@dataclass(frozen=True)
class Condition:
    """``variable is [not] term``."""

    variable: str
    term: str
    negated: bool = False


@dataclass(frozen=True)
class Written:
    """One rule: alternatives of joint conditions, conclusions, weight, and its block."""

    alternatives: tuple[tuple[Condition, ...], ...]
    conclusions: tuple[tuple[str, str], ...]
    weight: float
    block: Part


def proposition(text):
    variable, is_, *hedges, term = text.split()
    assert is_ == "is", text
    other = [h for h in hedges if h != "not"]
    if other:
        raise UnsupportedError(f"hedge '{other[0]}'")
    return Condition(variable, term, len(hedges) % 2 == 1)


def read_rule(text, block):
    match = re.fullmatch(r"if (.+) then (.+?)(?: with (\S+))?", text)
    if match is None or "(" in text:
        raise UnsupportedError(f"rule {text!r}")
    condition, conclusion, weight = match.groups()
    alternatives = tuple(
        tuple(proposition(p) for p in joint.split(" and ")) for joint in condition.split(" or ")
    )
    concluded = [proposition(p) for p in conclusion.split(" and ")]
    if any(c.negated for c in concluded):
        raise UnsupportedError("hedge 'not' in a conclusion")
    return Written(
        alternatives,
        tuple((c.variable, c.term) for c in concluded),
        float(weight or 1.0),
        block,
    )


# ------------------------------------------------------------ system


class Engine:
    """The system of one file, evaluated by this package."""

    def __init__(self, text):
        parts = parse(text)
        self.inputs = {p.name: p for p in parts if p.kind == "InputVariable"}
        self.outputs = {p.name: p for p in parts if p.kind == "OutputVariable"}
        blocks = [p for p in parts if p.kind == "RuleBlock"]
        for part in (*self.inputs.values(), *self.outputs.values(), *blocks):
            if not part.flag("enabled"):
                raise UnsupportedError("something that is not enabled")
        for output in self.outputs.values():
            if output.flag("lock-previous"):
                raise UnsupportedError("an output that locks its previous value")
            for term in output.terms.values():
                if term.shape == "Function" and output.keys["defuzzifier"].startswith("Weighted"):
                    raise UnsupportedError("Function term as a conclusion")
        if any(b.keys["activation"] != "General" for b in blocks):
            raise UnsupportedError("activation other than General")
        self.rules = []
        for block in blocks:
            for text in block.rules:
                self.rules.append(self._without_outputs(read_rule(text, block)))

    def _without_outputs(self, rule):
        """Replace conditions about outputs by those of the earlier rules that conclude them."""
        alternatives = []
        for joint in rule.alternatives:
            choices = []
            for condition in joint:
                if condition.variable not in self.outputs:
                    choices.append([(condition,)])
                    continue
                output = self.outputs[condition.variable]
                if condition.negated or output.keys["aggregation"] != "Maximum":
                    raise UnsupportedError("a condition about an output that is not a maximum")
                target = (condition.variable, condition.term)
                sources = [r for r in self.rules if target in r.conclusions]
                if any(r.weight != 1 for r in sources):
                    raise UnsupportedError("a condition about an output of a weighted rule")
                choices.append([joint for r in sources for joint in r.alternatives])
            alternatives += [sum(choice, ()) for choice in itertools.product(*choices)]
        return Written(tuple(alternatives), rule.conclusions, rule.weight, rule.block)

    def __call__(self, points):
        """Values of every output, shape (n, n_outputs), at points of shape (n, n_inputs)."""
        columns = [self._evaluate(name, points) for name in self.outputs]
        return np.stack(columns, axis=1)

    def _evaluate(self, name, points):
        output = self.outputs[name]
        rules = [r for r in self.rules if any(o == name for o, _ in r.conclusions)]
        defuzzifier, *more = output.keys["defuzzifier"].split()
        if defuzzifier in DEFUZZIFIERS:
            resolution = int(more[0]) if more else RESOLUTION
            variable = Variable(
                name,
                Universe(*output.range, resolution, "midpoints"),
                [t.fuzzy_set() for t in output.terms.values()],
            )
            operators = self._operators(output, rules, DEFUZZIFIERS[defuzzifier])
            concluded = [[(name, t) for o, t in r.conclusions if o == name] for r in rules]
            values = self._run(points, [variable], operators, rules, concluded)[name]
        elif defuzzifier == "WeightedAverage":
            values = self._weighted_average(output, rules, points)
        else:
            raise UnsupportedError(f"defuzzifier {defuzzifier}")
        values = np.where(np.isnan(values), float(output.keys["default"]), values)
        return np.clip(values, *output.range) if output.flag("lock-range") else values

    def _operators(self, output, rules, defuzzification):
        weighted = defuzzification == "weighted-centers"
        if output.keys["aggregation"] not in ("Maximum", *(["none"] if weighted else [])):
            raise UnsupportedError(f"aggregation {output.keys['aggregation']}")
        used = set()
        for rule in rules:
            keys = rule.block.keys
            if any(len(joint) > 1 for joint in rule.alternatives):
                used.add(keys["conjunction"])
            if not weighted:
                used.add(keys["implication"])
            if len(rule.alternatives) > 1 and keys["disjunction"] not in ("Maximum", "none"):
                raise UnsupportedError(f"disjunction {keys['disjunction']}")
        for word in sorted(used - set(CONJUNCTIONS)):
            raise UnsupportedError(f"conjunction or implication {word}")
        if len(used) > 1:
            raise UnsupportedError("an implication that is not the conjunction")
        conjunction = CONJUNCTIONS[used.pop()] if used else "product"
        if conjunction == "min" and any(r.weight != 1 for r in rules):
            raise UnsupportedError("a rule weight that multiplies while AND is the minimum")
        return Operators(conjunction, "max", defuzzification)

    def _weighted_average(self, output, rules, points):
        """Constant or linear terms; without aggregation every rule counts, so each has its own."""
        operators = self._operators(output, rules, "weighted-centers")
        n = len(self.inputs)
        targets, levels = [], {}
        for number, rule in enumerate(rules):
            ((term,),) = [[t for o, t in rule.conclusions if o == output.name]]
            own = term if output.keys["aggregation"] == "Maximum" else f"{term} {number}"
            targets.append(own)
            levels[own] = self._coefficients(output.terms[term], n)
        table = np.array(list(levels.values()))
        variables = [
            Variable(
                f"{output.name} {k}",
                Universe(column.min() - 1, column.max() + 1, 2),
                [
                    FuzzySet(own, "singleton", (value,))
                    for own, value in zip(levels, column, strict=True)
                ],
            )
            for k, column in enumerate(table.T)
        ]
        concluded = [[(v.name, own) for v in variables] for own in targets]
        values = self._run(points, variables, operators, rules, concluded)
        *slopes, offset = (values[v.name] for v in variables)
        return offset + sum(a * points[:, k] for k, a in enumerate(slopes))

    @staticmethod
    def _coefficients(term, n):
        if term.shape == "Constant":
            return (0.0,) * n + term.numbers
        if term.shape == "Linear":
            assert len(term.numbers) == n + 1
            return term.numbers
        raise UnsupportedError(f"{term.shape} term in a weighted average (Tsukamoto)")

    def _run(self, points, outputs, operators, rules, concluded):
        """Build the rule base and evaluate it."""
        sets = {name: {} for name in self.inputs}
        merged = {}
        for rule, targets in zip(rules, concluded, strict=True):
            for joint in rule.alternatives:
                conditions = self._join(joint, sets, operators)
                here = merged.setdefault(conditions, {})
                for target in targets:
                    here[target] = max(here.get(target, 0.0), rule.weight)
        used = {name: found for name, found in sets.items() if found}
        inputs = [
            Variable(name, self._universe(name, points), tuple(found.values()))
            for name, found in used.items()
        ]
        written = [
            Rule(conditions, [Consequent(o, t, weight) for (o, t), weight in targets.items()])
            for conditions, targets in merged.items()
        ]
        base = RuleBase("fll", inputs, outputs, written, operators)
        columns = [list(self.inputs).index(name) for name in used]
        return FuzzySystem(base).evaluate(points[:, columns])

    def _join(self, joint, sets, operators):
        """Conditions as (input, set) pairs; several about one input become one set."""
        by_input = {}
        for condition in joint:
            by_input.setdefault(condition.variable, []).append(condition)
        pairs = []
        for name, conditions in sorted(by_input.items()):
            members = [self._set(name, c) for c in dict.fromkeys(conditions)]
            joined = members[0]
            for other in members[1:]:
                joined = _both(joined, other, operators)
            sets[name].setdefault(joined.name, joined)
            pairs.append((name, joined.name))
        return tuple(pairs)

    def _set(self, name, condition):
        fuzzy_set = self.inputs[name].terms[condition.term].fuzzy_set()
        if not condition.negated:
            return fuzzy_set
        return OwnSet(f"not {fuzzy_set.name}", lambda x: 1 - fuzzy_set.membership(x))

    def _universe(self, name, points):
        """Range of an input; without ``lock-range`` it does not limit the values."""
        low, high = self.inputs[name].range
        if not self.inputs[name].flag("lock-range"):
            column = points[:, list(self.inputs).index(name)]
            low, high = min(low, np.nanmin(column)), max(high, np.nanmax(column))
        return Universe(low, high, 2)


def _both(a, b, operators):
    together = np.minimum if operators.conjunction == "min" else np.multiply
    return OwnSet(f"{a.name} and {b.name}", lambda x: together(a.membership(x), b.membership(x)))


@dataclass(frozen=True)
class Result:
    """Outcome of one file."""

    name: str
    rows: int
    error: float
    reason: str = ""


def referee(path: Path, root: Path) -> Result:
    """Compare one .fll with its .fld; the error is infinite where a NaN has no counterpart."""
    name = path.relative_to(root).with_suffix("").as_posix()
    rows = np.loadtxt(path.with_suffix(".fld"), skiprows=1, ndmin=2, encoding="utf-8")
    try:
        engine = Engine(path.read_text(encoding="utf-8"))
        n = len(engine.inputs)
        answer = engine(rows[:, :n])
    except UnsupportedError as reason:
        return Result(name, len(rows), math.nan, str(reason))
    expected = rows[:, n:]
    gap = np.abs(answer - expected)
    gap[np.isnan(answer) & np.isnan(expected)] = 0.0
    gap[np.isnan(gap)] = np.inf
    return Result(name, len(rows), float(gap.max()))
