"""FLL files of fuzzylite, versions 5 and 6 and later, read as rule bases.

The language is described on fuzzylite.com/fll-fld: blocks ``Engine``, ``InputVariable``,
``OutputVariable`` and ``RuleBlock``, and lines ``key: value``.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace

from fuzzytrack.errors import Location, RuleBaseError
from fuzzytrack.fuzzy.formats import fll_words as words
from fuzzytrack.fuzzy.formats.carried import Carried
from fuzzytrack.fuzzy.formats.fll_rules import RuleParser
from fuzzytrack.fuzzy.formats.parts import SetPart, System, VariablePart, is_linear, widened
from fuzzytrack.fuzzy.formats.source_text import PlacedText, SourceText
from fuzzytrack.fuzzy.operators import Operators
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.shapes import LINEAR
from fuzzytrack.yamltree import quoted, suggestion

__all__ = ["DEFAULT_RESOLUTION", "loads_fll"]

#: Points of a defuzzifier that names none, as fuzzylite 7 and later take them.
DEFAULT_RESOLUTION = 1000

_LINE = re.compile(r"([A-Za-z][A-Za-z-]*)\s*:\s*(.*)")
_KEYS = {
    "Engine": ("description",),
    "InputVariable": ("description", "enabled", "range", "lock-range", "term"),
    "OutputVariable": (
        "description", "enabled", "range", "lock-range", "aggregation", "accumulation",
        "defuzzifier", "default", "lock-previous", "lock-valid", "term",
    ),
    "RuleBlock": (
        "description", "enabled", "conjunction", "disjunction", "implication", "activation",
        "rule",
    ),
}  # fmt: skip
_REPEATED = ("term", "rule")


def loads_fll(text: str | bytes, file: str = "<text>", name: str = "") -> RuleBase:
    """Read a rule base from the text of an FLL file.

    Parameters
    ----------
    text : str or bytes
        At most 1 MiB.
    file : str
        Name for messages.
    name : str
        Name of the rule base if the file gives none.

    Returns
    -------
    RuleBase
        Outputs are summed over the midpoints of as many cells as the defuzzifier says, and 1000 if
        it does not.

    Raises
    ------
    RuleBaseError
        If the text is no FLL file, or has what a rule base cannot have; names file, line and
        column.
    """
    source = SourceText(text, file)
    return _FllReader(source, name).system().rulebase()


@dataclass
class _Block:
    """A block: its name, its values by key, and its terms or rules."""

    kind: str
    name: str
    place: Location
    values: dict[str, PlacedText] = field(default_factory=dict)
    repeated: list[PlacedText] = field(default_factory=list)

    def text(self, key: str) -> str:
        value = self.values.get(key)
        return "" if value is None or value.text == "none" else value.text


class _FllReader:
    def __init__(self, source: SourceText, name: str) -> None:
        self.source = source
        self.name = name
        self.blocks: list[_Block] = []
        for number, line in enumerate(source.lines, start=1):
            self._line(number, line.split("#", 1)[0])
        if not self._of_kind("Engine"):
            raise source.error(1, 1, "no line 'Engine: name': this is no FLL file")
        for kind in ("InputVariable", "OutputVariable", "RuleBlock"):
            if not self._of_kind(kind):
                raise source.error(1, 1, f"there is no {kind}: is the file complete?")
        self.inputs = [self._input(b) for b in self._of_kind("InputVariable")]
        self.outputs = [self._output(b) for b in self._of_kind("OutputVariable")]
        self.rule_blocks = self._of_kind("RuleBlock")
        self._check_names()

    # ---------------------------------------------------------------- lines

    def _line(self, number: int, line: str) -> None:
        text = line.strip()
        if not text:
            return
        start = len(line) - len(line.lstrip()) + 1
        found = _LINE.fullmatch(text)
        if found is None:
            raise self.source.error(number, start, f"{quoted(text)} is not written as key: value")
        key, text = found.groups()
        place = self.source.place(number, start)
        if key in _KEYS:
            self.blocks.append(_Block(key, text, place))
            return
        if not self.blocks:
            raise RuleBaseError("text before the line 'Engine: name': this is no FLL file", place)
        block = self.blocks[-1]
        if key not in _KEYS[block.kind]:
            allowed = _KEYS[block.kind]
            raise RuleBaseError(
                f"{block.kind}: unknown key {quoted(key)}{suggestion(key, allowed)}",
                place,
            )
        value = PlacedText(text, number, start + found.start(2))
        if key in _REPEATED:
            block.repeated.append(value)
        elif key in block.values:
            raise RuleBaseError(f"{key} is given twice", place)
        else:
            block.values[key] = value

    def _of_kind(self, kind: str) -> list[_Block]:
        found = [block for block in self.blocks if block.kind == kind]
        for block in found:
            if not self._flag(block, "enabled", True):
                raise RuleBaseError(
                    f"{kind} {quoted(block.name)} is not enabled, which has no counterpart; remove "
                    "it",
                    self._place(block.values["enabled"]),
                )
        return found

    def _check_names(self) -> None:
        """Rules name variables, so that each needs a name of its own."""
        names: set[str] = set()
        for part in (*self.inputs, *self.outputs):
            if part.name in names:
                raise RuleBaseError(
                    f"a second variable {quoted(part.name)}; rename one of them", part.place
                )
            names.add(part.name)

    def _place(self, value: PlacedText, offset: int = 0) -> Location:
        return self.source.place(value.line, value.column + offset)

    def _flag(self, block: _Block, key: str, usual: bool) -> bool:
        value = block.values.get(key)
        if value is None:
            return usual
        if value.text not in ("true", "false"):
            raise RuleBaseError(
                f"{key} must be true or false, got {quoted(value.text)}", self._place(value)
            )
        return value.text == "true"

    def _choice(self, value: PlacedText, allowed: dict[str, str], what: str) -> str:
        """Word of this package for a word of the file."""
        word = value.text.split()[0] if value.text.split() else ""
        if word not in allowed or word != value.text:
            raise RuleBaseError(
                f"{what} {quoted(value.text)} has no counterpart{suggestion(word, tuple(allowed))}",
                self._place(value),
            )
        return allowed[word]

    # ---------------------------------------------------------------- variables

    def _variable(self, block: _Block, *, constant: bool = False) -> VariablePart:
        value = block.values.get("range")
        if value is None:
            raise RuleBaseError(f"{block.kind} {quoted(block.name)} lacks its range", block.place)
        ends = value.text.split()
        if constant and all(word in ("inf", "-inf", "nan") for word in ends):
            ends = ["0", "0"]
        numbers = [self.source.number(word, self._place(value), "range") for word in ends]
        if len(numbers) != 2 or not (
            numbers[0] < numbers[1] or (constant and len(set(numbers)) == 1)
        ):
            raise RuleBaseError(
                f"range must be low high with low < high, got {quoted(value.text)}",
                self._place(value),
            )
        name = block.name or block.kind
        return VariablePart(
            name, numbers[0], numbers[1], block.place, label=block.text("description") or name
        )

    def _input(self, block: _Block) -> VariablePart:
        part = self._variable(block)
        self._flag(block, "lock-range", False)
        part.sets = [self._term(value, block, constant=False) for value in block.repeated]
        return part

    def _output(self, block: _Block) -> VariablePart:
        crisp, resolution = self._defuzzifier(block)
        constant = crisp == "weighted-centers"
        part = self._variable(block, constant=constant)
        previous = self._flag(block, "lock-previous", False)
        if previous or self._flag(block, "lock-valid", False):
            key = "lock-previous" if previous else "lock-valid"
            raise RuleBaseError(
                f"{key}: an output that keeps its previous value has no counterpart",
                self._place(block.values[key]),
            )
        part.sets = [self._term(value, block, constant=constant) for value in block.repeated]
        part.grid = (resolution, "midpoints")
        low, high = part.low, part.high
        if constant:
            part.grid = (101, "ends")
            widened(part)
        if self._flag(block, "lock-range", False) and (
            is_linear(part) or (part.low, part.high) != (low, high)
        ):
            raise RuleBaseError(
                "lock-range: an output that is cut at the ends of its range has no counterpart",
                self._place(block.values["lock-range"]),
            )
        part.default = self._default(block)
        part.operators = Operators("product", self._aggregation(block, constant), crisp)
        return part

    def _default(self, block: _Block) -> float | None:
        value = block.values.get("default")
        if value is None or value.text == "nan":
            return None
        return self.source.number(value.text, self._place(value), "default")

    def _defuzzifier(self, block: _Block) -> tuple[str, int]:
        value = block.values.get("defuzzifier")
        if value is None or value.text in ("", "none"):
            raise RuleBaseError(f"{quoted(block.name)} has no defuzzifier", block.place)
        word, *more = value.text.split()
        if word == "WeightedAverage":
            if more and more not in (["TakagiSugeno"], ["Automatic"]):
                raise RuleBaseError(
                    f"WeightedAverage {quoted(more[0])} has no counterpart; allowed: TakagiSugeno",
                    self._place(value),
                )
            return "weighted-centers", 2
        if word not in words.DEFUZZIFIERS:
            allowed = (*words.DEFUZZIFIERS, "WeightedAverage")
            raise RuleBaseError(
                f"the defuzzifier {quoted(word)} has no counterpart{suggestion(word, allowed)}",
                self._place(value),
            )
        if not more:
            return words.DEFUZZIFIERS[word], DEFAULT_RESOLUTION
        if len(more) > 1 or not re.fullmatch(r"[0-9]{1,6}", more[0]):
            raise RuleBaseError(
                f"{word} takes a whole number of points, got {quoted(' '.join(more))}",
                self._place(value),
            )
        return words.DEFUZZIFIERS[word], int(more[0])

    def _aggregation(self, block: _Block, constant: bool) -> str:
        key = "accumulation" if "accumulation" in block.values else "aggregation"
        value = block.values.get(key)
        if value is None or value.text in ("", "none"):
            if constant:
                return "sum"
            raise RuleBaseError(f"{quoted(block.name)} has no aggregation", block.place)
        return self._choice(value, words.S_NORMS, key)

    # ---------------------------------------------------------------- terms

    def _term(self, value: PlacedText, block: _Block, *, constant: bool) -> SetPart:
        found = re.fullmatch(r"(\S+)\s+(\S+)\s*(.*)", value.text)
        if found is None:
            raise RuleBaseError(
                f"a term is written as 'name Shape numbers', got {quoted(value.text)}",
                self._place(value),
            )
        name, shape, rest = found.groups()
        place = self._place(value, found.start(2))
        if shape == "Function":
            raise RuleBaseError("a Function term has no counterpart", place)
        numbers = tuple(
            self._parameter(m.group(), self._place(value, found.start(3) + m.start()), shape)
            for m in re.finditer(r"\S+", rest)
        )
        if constant:
            return self._constant(name, shape, numbers, place)
        if shape == "Discrete":
            return self._discrete(name, numbers, place)
        if shape not in words.TERMS:
            allowed = (*words.TERMS, "Discrete")
            raise RuleBaseError(
                f"{block.kind} {block.name}: the term {quoted(shape)} has no counterpart"
                f"{suggestion(shape, allowed)}",
                place,
            )
        term = words.TERMS[shape]
        count = len(term.names)
        if len(numbers) == count + 1:
            self._check_height(numbers[-1], shape, place)
            numbers = numbers[:-1]
        if len(numbers) != count or not _are_proper(shape, numbers):
            raise RuleBaseError(
                f"{shape} takes {' '.join(term.names)} as finite numbers, got {quoted(rest)}", place
            )
        if shape == "Ramp" and numbers[0] == numbers[1]:
            # It is 0 everywhere in fuzzylite, whereas a step would be meant.
            raise RuleBaseError(
                f"Ramp takes start and end that differ, got {quoted(rest)}; a step is 'Binary "
                f"{numbers[0]:g} inf' or 'Binary {numbers[0]:g} -inf'",
                place,
            )
        here, parameters = term.read(numbers)
        return SetPart(name, here, parameters, place)

    def _parameter(self, word: str, place: Location, shape: str) -> float:
        """A number; the direction of a Binary may be infinite."""
        if word in ("inf", "+inf", "-inf"):
            return -math.inf if word.startswith("-") else math.inf
        return self.source.number(word, place, f"parameters of {shape}")

    def _check_height(self, height: float, shape: str, place: Location) -> None:
        if height != 1.0:
            raise RuleBaseError(
                f"{shape} of the height {height:g}: only the height 1 has a counterpart", place
            )

    def _discrete(self, name: str, numbers: tuple[float, ...], place: Location) -> SetPart:
        if len(numbers) % 2 == 1:
            self._check_height(numbers[-1], "Discrete", place)
            numbers = numbers[:-1]
        if len(numbers) == 2:
            # The grade of one point is that of all.
            numbers = (*numbers, numbers[0] + max(1.0, abs(numbers[0])), numbers[1])
        return SetPart(name, "discrete", numbers, place)

    def _constant(
        self, name: str, shape: str, numbers: tuple[float, ...], place: Location
    ) -> SetPart:
        if shape not in ("Constant", "Linear"):
            raise RuleBaseError(
                f"a {shape} term in a weighted average (Tsukamoto) has no counterpart; allowed: "
                "Constant, Linear",
                place,
            )
        inputs = len([b for b in self.blocks if b.kind == "InputVariable"])
        count = 1 if shape == "Constant" else inputs + 1
        if len(numbers) != count or not all(map(math.isfinite, numbers)):
            raise RuleBaseError(f"{shape} takes {count} numbers here, got {len(numbers)}", place)
        return SetPart(name, "singleton" if shape == "Constant" else LINEAR, numbers, place)

    # ---------------------------------------------------------------- the system

    def system(self) -> System:
        engine = next(block for block in self.blocks if block.kind == "Engine")
        conjunction = self._common("conjunction", words.T_NORMS, " and ")
        alternatives = self._common("disjunction", words.S_NORMS, " or ")
        distributes = alternatives in ("", "max") and conjunction in ("", "min", "product")
        system = System(
            engine.name or self.name, engine.place, inputs=self.inputs, outputs=self.outputs,
            carried=Carried.read(self.source),
        )  # fmt: skip
        if engine.text("description"):
            system.carried.parts.setdefault("description", engine.text("description"))
        implications: list[dict[str, PlacedText]] = [{} for _ in self.outputs]
        weighted = False
        for block in self.rule_blocks:
            implication, value = self._implication(block)
            for each in block.repeated:
                rule = RuleParser(
                    self.source, each.line, each.column, each.text, self.inputs, self.outputs,
                    distributes=distributes,
                ).rule()  # fmt: skip
                system.rules.append(rule)
                weighted = weighted or rule.weight != 1.0
                for conclusion in rule.conclusions:
                    implications[conclusion.variable][implication] = value or each
        self._set_operators(system, conjunction, alternatives, implications, weighted)
        return system

    def _common(self, key: str, allowed: dict[str, str], word: str) -> str:
        """The norm of all blocks whose rules use it; empty if none does."""
        found = ""
        for block in self.rule_blocks:
            uses = any(word in rule.text.partition(" then ")[0] for rule in block.repeated)
            value = block.values.get(key)
            if not uses:
                continue
            if value is None or value.text in ("", "none"):
                raise RuleBaseError(f"rules use {word.strip()!r} without a {key}", block.place)
            norm = self._choice(value, allowed, key)
            if found not in ("", norm):
                raise RuleBaseError(
                    f"rule blocks with a {key} each, {found} and {norm}, have no counterpart",
                    self._place(value),
                )
            found = norm
        return found

    def _implication(self, block: _Block) -> tuple[str, PlacedText | None]:
        """The implication of a block; version 5 of the language names it activation."""
        activation = block.values.get("activation")
        if activation is not None and activation.text in words.T_NORMS:
            return words.T_NORMS[activation.text], activation
        if activation is not None and activation.text not in ("", "none", "General"):
            raise RuleBaseError(
                f"the activation {quoted(activation.text)} has no counterpart; allowed: General",
                self._place(activation),
            )
        value = block.values.get("implication")
        if value is None or value.text in ("", "none"):
            return "", None
        return self._choice(value, words.T_NORMS, "implication"), value

    def _set_operators(
        self,
        system: System,
        conjunction: str,
        alternatives: str,
        implications: list[dict[str, PlacedText]],
        weighted: bool,
    ) -> None:
        """One algebra for all outputs if they have the same, and otherwise one for each."""
        algebras: list[Operators] = []
        for output, found in zip(self.outputs, implications, strict=True):
            assert output.operators is not None
            crisp = output.operators.defuzzification
            if crisp == "weighted-centers":
                # Any implication leaves the constants as they are.
                found = {}
            if "" in found:
                raise RuleBaseError(
                    f"rules conclude about {output.name} without an implication", output.place
                )
            if len(found) > 1:
                raise RuleBaseError(
                    f"two implications for {output.name}, {' and '.join(found)}, have no "
                    "counterpart",
                    output.place,
                )
            implication = next(iter(found), "")
            both = conjunction or implication or "product"
            weighting = "product" if weighted else ""
            algebras.append(
                replace(
                    output.operators, conjunction=both, implication=implication,
                    weighting=weighting, alternatives=alternatives or "max",
                )
            )  # fmt: skip
        system.operators = algebras[0] if algebras else Operators()
        for output, algebra in zip(self.outputs, algebras, strict=True):
            output.operators = None if algebra == system.operators else algebra


def _are_proper(shape: str, numbers: tuple[float, ...]) -> bool:
    finite = numbers[:1] if shape == "Binary" else numbers
    return all(map(math.isfinite, finite)) and (shape != "Binary" or numbers[1] != 0)
