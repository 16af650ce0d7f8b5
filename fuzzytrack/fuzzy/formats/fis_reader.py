"""FIS files of MATLAB's Fuzzy Logic Toolbox, read as rule bases.

The format is described by MathWorks' pages on readfis and by FunctionBay's introduction to the FIS
file format: sections ``[System]``, ``[Input1]``, …, ``[Output1]``, … and ``[Rules]``, lines
``Key=value``, and rules as indices of sets.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace

from fuzzytrack.errors import Location, RuleBaseError
from fuzzytrack.fuzzy.formats import fis_words as words
from fuzzytrack.fuzzy.formats.carried import Carried
from fuzzytrack.fuzzy.formats.parts import (
    Condition,
    RulePart,
    SetPart,
    System,
    VariablePart,
    widened,
)  # fmt: skip
from fuzzytrack.fuzzy.formats.source_text import PlacedText, SourceText, located
from fuzzytrack.fuzzy.operators import Operators
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.shapes import LINEAR
from fuzzytrack.yamltree import quoted, suggestion

__all__ = ["loads_fis"]

_SECTION = re.compile(r"\[\s*(System|Rules|(Input|Output)\s*([0-9]{1,4}))\s*\]", re.IGNORECASE)
_ENTRY = re.compile(r"([A-Za-z][A-Za-z0-9_]*)\s*=\s*(.*)")
_TEXT = re.compile(r"'((?:[^']|'')*)'|\"((?:[^\"]|\"\")*)\"")
_LIST = re.compile(r"\[([^\[\]]*)\]")
_RULE = re.compile(r"([^,()]*),([^,()]*)\(([^()]*)\)\s*:\s*(\S+)")
_WHOLE = re.compile(r"([0-9]{1,6})(?:\.0*)?")
_WORD = re.compile(r"[^\s,;]+")
_INDEX = re.compile(r"([-+]?)([0-9]{1,6})(?:\.([0-9]{1,6}))?")


def loads_fis(text: str | bytes, file: str = "<text>", name: str = "") -> RuleBase:
    """Read a rule base from the text of a FIS file.

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
        Outputs have 101 points with both ends, as MATLAB takes them, and where no rule fires the
        middle of their range.

    Raises
    ------
    RuleBaseError
        If the text is no FIS file, or has what a rule base cannot have; names file, line and
        column.
    """
    source = SourceText(text, file)
    return _FisReader(source, name).system().rulebase()


class _FisReader:
    def __init__(self, source: SourceText, name: str) -> None:
        self.source = source
        self.name = name
        self.sections: dict[str, dict[str, PlacedText]] = {}
        self.starts: dict[str, int] = {}
        self.rules: list[PlacedText] = []
        self._split()

    # ---------------------------------------------------------------- sections and entries

    def _split(self) -> None:
        section = ""
        for number, whole in enumerate(self.source.lines, start=1):
            line = _without_comment(whole).rstrip()
            start = len(line) - len(line.lstrip())
            line = line.strip()
            if not line:
                continue
            found = _SECTION.fullmatch(line)
            if found is not None:
                section = found.group(1).replace(" ", "").replace("\t", "").lower()
                if section in self.sections:
                    raise self.source.error(number, start + 1, f"a second section [{found[1]}]")
                self.sections[section], self.starts[section] = {}, number
            elif line.startswith("["):
                raise self.source.error(
                    number,
                    start + 1,
                    f"unknown section {quoted(line)}; allowed: [System], [Input1], …, [Output1], "
                    "…, [Rules]",
                )
            elif not section:
                raise self.source.error(
                    number,
                    start + 1,
                    "text before the first section, [System]: this is no FIS file",
                )
            elif section == "rules":
                self.rules.append(PlacedText(line, number, start + 1))
            else:
                self._entry(section, line, number, start)
        if "system" not in self.sections:
            raise self.source.error(1, 1, "the section [System] is missing: this is no FIS file")

    def _entry(self, section: str, line: str, number: int, start: int) -> None:
        found = _ENTRY.fullmatch(line)
        if found is None:
            raise self.source.error(
                number, start + 1, f"{quoted(line)} is not written as Key=value"
            )
        key = found.group(1).lower()
        if key in self.sections[section]:
            raise self.source.error(number, start + 1, f"{found.group(1)} is given twice")
        self.sections[section][key] = PlacedText(found.group(2), number, start + found.start(2) + 1)

    def _get(self, section: str, key: str) -> PlacedText:
        entry = self.sections[section].get(key.lower())
        if entry is None:
            raise self.source.error(
                self.starts[section], 1, f"{key} is missing in this section; add a line {key}=…"
            )
        return entry

    def _place(self, entry: PlacedText, offset: int = 0) -> Location:
        return self.source.place(entry.line, entry.column + offset)

    def _text(self, entry: PlacedText, what: str) -> str:
        found = _TEXT.fullmatch(entry.text)
        if found is None:
            raise RuleBaseError(
                f"{what} must be a text in quotation marks, got {quoted(entry.text)}",
                self._place(entry),
            )
        return _unquoted(found)

    def _whole(self, section: str, key: str) -> int | None:
        """A count; None where it is not given."""
        entry = self.sections[section].get(key.lower())
        if entry is None:
            return None
        found = _WHOLE.fullmatch(entry.text)
        if found is None:
            raise RuleBaseError(
                f"{key} must be a whole number, got {quoted(entry.text)}", self._place(entry)
            )
        return int(found[1])

    def _numbers(
        self, entry: PlacedText, text: str, offset: int, what: str, *, infinite: bool = False
    ) -> tuple[float, ...]:
        """Numbers of a list; those that are infinite only where they may be."""
        found = []
        for m in _WORD.finditer(text):
            if infinite and m.group().lower() in ("inf", "+inf", "-inf"):
                found.append(-math.inf if m.group().startswith("-") else math.inf)
                continue
            found.append(
                self.source.number(m.group(), self._place(entry, offset + m.start()), what)
            )
        return tuple(found)

    def _word(self, key: str, allowed: dict[str, str], what: str) -> str:
        entry = self._get("system", key)
        word = self._text(entry, key).strip().lower()
        if word not in allowed:
            raise RuleBaseError(
                f"{what} {quoted(word)} has no counterpart{suggestion(word, tuple(allowed))}",
                self._place(entry),
            )
        return allowed[word]

    # ---------------------------------------------------------------- the system

    def system(self) -> System:
        top = self.source.place(self.starts["system"])
        entry = self.sections["system"].get("name")
        name = self._text(entry, "Name") if entry else ""
        kind = self._kind()
        operators = self._operators(kind)
        system = System(
            name.strip() or self.name, top, operators, carried=Carried.read(self.source)
        )
        system.inputs = self._variables("Input", kind)
        system.outputs = self._variables("Output", kind)
        inputs = len(system.inputs)
        for output in system.outputs:
            self._check_linear(output, inputs)
        system.rules = [self._rule(entry, system) for entry in self.rules]
        self._check_count("NumRules", len(system.rules), "rules")
        weighted = any(rule.weight != 1.0 for rule in system.rules)
        # A weight multiplies the strength of its rule, whatever stands for AND.
        system.operators = replace(operators, weighting="product" if weighted else "")
        return system

    def _kind(self) -> str:
        entry = self._get("system", "Type")
        kind = self._text(entry, "Type").strip().lower()
        if kind.endswith("type2"):
            raise RuleBaseError(
                f"{quoted(kind)}: sets of type 2 have no counterpart", self._place(entry)
            )
        if kind not in words.DEFUZZIFICATIONS:
            allowed = ", ".join(words.DEFUZZIFICATIONS)
            raise RuleBaseError(
                f"unknown Type {quoted(kind)}; allowed: {allowed}", self._place(entry)
            )
        return kind

    def _operators(self, kind: str) -> Operators:
        conjunction = self._word("AndMethod", words.ANDS, "AndMethod")
        either = self._word("OrMethod", words.ORS, "OrMethod")
        crisp = self._word("DefuzzMethod", words.DEFUZZIFICATIONS[kind], f"DefuzzMethod of {kind}")
        if kind == "sugeno":
            # Constants are joined by their weights alone, whatever the other methods are.
            return Operators(conjunction, "sum", crisp, alternatives=either)
        implication = self._word("ImpMethod", words.IMPLICATIONS, "ImpMethod")
        aggregation = self._word("AggMethod", words.AGGREGATIONS, "AggMethod")
        return Operators(conjunction, aggregation, crisp, implication, alternatives=either)

    def _check_count(self, key: str, found: int, what: str) -> None:
        said = self._whole("system", key)
        if said is not None and said != found:
            entry = self._get("system", key)
            raise RuleBaseError(
                f"{key} is {said}, but there are {found} {what}: is the file complete?",
                self._place(entry),
            )

    # ---------------------------------------------------------------- variables

    def _variables(self, role: str, kind: str) -> list[VariablePart]:
        prefix = role.lower()
        numbers = sorted(
            int(section.removeprefix(prefix))
            for section in self.sections
            if section.startswith(prefix)
        )
        if numbers != list(range(1, len(numbers) + 1)):
            missing = min(set(range(1, len(numbers) + 1)) - set(numbers))
            raise self.source.error(
                self.starts["system"], 1, f"the section [{role}{missing}] is missing"
            )
        self._check_count(f"Num{role}s", len(numbers), f"{prefix}s")
        return [self._variable(f"{prefix}{number}", role, kind) for number in numbers]

    def _variable(self, section: str, role: str, kind: str) -> VariablePart:
        name = self._text(self._get(section, "Name"), "Name").strip()
        entry = self._get(section, "Range")
        found = _LIST.fullmatch(entry.text)
        numbers = self._numbers(entry, found.group(1), 1, "Range") if found else ()
        constant = role == "Output" and kind == "sugeno"
        if len(numbers) != 2 or not (
            numbers[0] < numbers[1] or (constant and len(set(numbers)) == 1)
        ):
            raise RuleBaseError(
                f"Range must be [low high] with low < high, got {quoted(entry.text)}",
                self._place(entry),
            )
        low, high = numbers
        place = self.source.place(self.starts[section])
        part = VariablePart(name or section, low, high, place, label=name)
        if role == "Output":
            part.default = (low + high) / 2
        part.sets = self._sets(section, constant)
        if constant:
            widened(part)
        return part

    def _sets(self, section: str, constant: bool) -> list[SetPart]:
        entries = {
            int(key[2:]): entry
            for key, entry in self.sections[section].items()
            if re.fullmatch(r"mf[0-9]{1,4}", key)
        }
        said = self._whole(section, "NumMFs")
        if sorted(entries) != list(range(1, len(entries) + 1)) or said not in (None, len(entries)):
            counted = len(entries) if said is None else said
            last = f", the last MF{max(entries)}" if entries else ""
            raise self.source.error(
                self.starts[section],
                1,
                f"the sets must be MF1 to MF{counted}, got {len(entries)} sets{last}",
            )
        return [self._set(entries[number], constant) for number in sorted(entries)]

    def _set(self, entry: PlacedText, constant: bool) -> SetPart:
        text = entry.text
        found = re.fullmatch(
            rf"({_TEXT.pattern})\s*:\s*({_TEXT.pattern})\s*,\s*(\[[^\[\]]*\]|[^\s\[\],]+)", text
        )
        if found is None:
            raise RuleBaseError(
                f"a set is written as 'name':'shape',[numbers], got {quoted(text)}",
                self._place(entry),
            )
        first, second = list(_TEXT.finditer(text))[:2]
        name, shape = _unquoted(first), _unquoted(second).strip()
        start = found.start(7)
        numbers = self._numbers(
            entry,
            text[start:].replace("[", " ").replace("]", " "),
            start,
            f"parameters of {shape}",
            infinite=shape == "trapmf" and not constant,
        )
        place = self._place(entry, second.start())
        if constant:
            return self._conclusion(name, shape, numbers, place)
        if shape not in words.SHAPES:
            raise RuleBaseError(
                f"the shape {quoted(shape)} has no counterpart"
                f"{suggestion(shape, tuple(words.SHAPES))}",
                place,
            )
        shoulder = _shoulder(shape, numbers)
        if shoulder is not None:
            return SetPart(name, *shoulder, place)
        if not all(map(math.isfinite, numbers)):
            raise RuleBaseError(
                f"parameters of {shape} must be finite, but for the shoulders of a trapmf", place
            )
        order = words.SHAPES[shape]
        if len(numbers) != len(order.names):
            raise RuleBaseError(
                f"{shape} takes [{' '.join(order.names)}], not {len(numbers)} numbers", place
            )
        return SetPart(name, shape, order.read(numbers), place)

    def _conclusion(
        self, name: str, shape: str, numbers: tuple[float, ...], place: Location
    ) -> SetPart:
        if shape not in ("constant", "linear"):
            raise RuleBaseError(
                f"{quoted(shape)}: outputs of Sugeno systems are constant or linear", place
            )
        if shape == "linear":
            return SetPart(name, LINEAR, numbers, place)
        # Older files write a constant with a coefficient of 0 for each input before it.
        if not numbers or any(numbers[:-1]):
            raise RuleBaseError(f"constant takes one number, not {len(numbers)}", place)
        return SetPart(name, "singleton", numbers[-1:], place)

    def _check_linear(self, output: VariablePart, inputs: int) -> None:
        for each in output.sets:
            if each.shape == LINEAR and len(each.parameters) != inputs + 1:
                raise RuleBaseError(
                    f"linear takes a coefficient for each of the {inputs} inputs and a constant, "
                    f"not {len(each.parameters)} numbers",
                    each.place,
                )

    # ---------------------------------------------------------------- rules

    def _rule(self, entry: PlacedText, system: System) -> RulePart:
        found = _RULE.fullmatch(entry.text)
        place = self._place(entry)
        if found is None:
            raise RuleBaseError(
                f"a rule is written as '1 2, 1 (1) : 1', got {quoted(entry.text)}", place
            )
        asked = self._indices(entry, found, 1, system.inputs, "input")
        concluded = self._indices(entry, found, 2, system.outputs, "output")
        weight = self.source.number(
            found.group(3).strip(), self._place(entry, found.start(3)), "weight"
        )
        connection = _WHOLE.fullmatch(found.group(4))
        if connection is None or int(connection[1]) not in (1, 2):
            raise RuleBaseError(
                f"the connection must be 1 (and) or 2 (or), got {quoted(found.group(4))}",
                self._place(entry, found.start(4)),
            )
        if not asked or not concluded:
            what = "condition" if not asked else "conclusion"
            raise RuleBaseError(f"a rule without a {what} has no counterpart", place)
        groups = tuple((c,) for c in asked) if int(connection[1]) == 2 else (tuple(asked),)
        with located(place):
            return RulePart(groups, tuple(concluded), weight, place)

    def _indices(
        self,
        entry: PlacedText,
        found: re.Match[str],
        group: int,
        variables: list[VariablePart],
        role: str,
    ) -> list[Condition]:
        tokens = list(_WORD.finditer(found.group(group)))
        start = found.start(group)
        if len(tokens) != len(variables):
            raise RuleBaseError(
                f"a rule has {len(variables)} indices of {role} sets, got {len(tokens)}",
                self._place(entry, start),
            )
        conditions = []
        for number, (token, variable) in enumerate(zip(tokens, variables, strict=True)):
            place = self._place(entry, start + token.start())
            index, hedges = _index(token.group(), place)
            if index > len(variable.sets):
                raise RuleBaseError(
                    f"{quoted(token.group())}: {role} {variable.name} has "
                    f"{len(variable.sets)} sets",
                    place,
                )
            if index:
                conditions.append(Condition(number, index - 1, hedges))
        return conditions


def _shoulder(shape: str, numbers: tuple[float, ...]) -> tuple[str, tuple[float, ...]] | None:
    """A trapezoid with one side at infinity, as a straight fall or rise."""
    if shape != "trapmf" or len(numbers) != 4:
        return None
    a, b, c, d = numbers
    left, right = a == b == -math.inf, c == d == math.inf
    if left and math.isfinite(c) and math.isfinite(d):
        return "linzmf", (c, d)
    if right and math.isfinite(a) and math.isfinite(b):
        return "linsmf", (a, b)
    return None


def _index(word: str, place: Location) -> tuple[int, tuple[str, ...]]:
    """Index of a set from 1, 0 for none, and its hedges."""
    found = _INDEX.fullmatch(word)
    if found is None:
        raise RuleBaseError(f"{quoted(word)} is no index of a set", place)
    sign, index, decimals = found.groups()
    hedges: tuple[str, ...] = ()
    if decimals is not None and decimals.strip("0"):
        code = int(f"{decimals:0<2}") if len(decimals.rstrip("0")) <= 2 else -1
        code = int(f"{decimals.rstrip('0'):0<2}") if code >= 0 else code
        if code not in words.HEDGES:
            raise RuleBaseError(f"{quoted(word)}: unknown hedge .{decimals}", place)
        hedges = words.HEDGES[code]
    if sign == "-":
        hedges = ("not", *hedges)
    return int(index), hedges


def _unquoted(found: re.Match[str]) -> str:
    single, double = found.group(1), found.group(2)
    return single.replace("''", "'") if single is not None else double.replace('""', '"')


def _without_comment(line: str) -> str:
    """The line before a comment, which begins with % or #, and not inside of a text."""
    mark = ""
    for place, character in enumerate(line):
        if mark:
            mark = "" if character == mark else mark
        elif character in "'\"":
            mark = character
        elif character in "%#":
            return line[:place]
    return line
