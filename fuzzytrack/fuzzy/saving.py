"""Rule bases to YAML, with tables laid out as in print."""

from __future__ import annotations

import json
import os
import re
import tempfile
import textwrap
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.cells import CellReader
from fuzzytrack.fuzzy.loading import SCHEMA_FILE, loads_rulebase
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.numbers import written
from fuzzytrack.fuzzy.operators import Operators
from fuzzytrack.fuzzy.reader import FORMAT_VERSION
from fuzzytrack.fuzzy.rulebase import Conditions, Consequent, Rule, RuleBase, TableLayout
from fuzzytrack.fuzzy.variable import Universe, Variable
from fuzzytrack.yamltree import MAX_BYTES, Document, quoted

__all__ = [
    "SCHEMA_LINE", "cell_text", "consequents_text", "dumps_rulebase", "read_cell", "save_rulebase",
    "shape_text", "word_text", "yaml_text",
]  # fmt: skip

#: First line of a file: where editors find its JSON Schema.
SCHEMA_LINE = f"# yaml-language-server: $schema={SCHEMA_FILE}"
_WIDTH = 96

_PLAIN_WORD = re.compile(r"[^\W\d](?:[\w.@-]*[\w@])?")
_PLAIN_NUMBER = re.compile(r"-?[0-9]+(?:\.[0-9]+)?")
_PLAIN_TEXT = re.compile(r"[^\W\d](?:[\w ().,;/%+&*'^-]*[\w).])?")
# Words that some YAML readers take for true, false or null.
_NOT_WORDS = frozenset({"y", "n", "yes", "no", "on", "off", "true", "false", "null"})


# -------------------------------------------------------------------- writing


def dumps_rulebase(rules: RuleBase) -> str:
    """Write a rule base as YAML text.

    Parameters
    ----------
    rules : RuleBase
        The rule base.

    Returns
    -------
    str
        Text from which `fuzzytrack.fuzzy.loading.loads_rulebase` makes an equal rule base.

    Raises
    ------
    RuleBaseError
        If a file may not contain the rule base: a name with blanks, sets out of order, a range of
        an input without a rule, a text that is too long to be read. Names which, with the place in
        the text.
    """
    text = "\n".join(_lines(rules)) + "\n"
    if len(text.encode()) > MAX_BYTES:
        raise RuleBaseError(
            f"{rules.name}: has more than {MAX_BYTES // 1024} KiB as YAML, the most that is read; "
            "keep it in another format"
        )
    if loads_rulebase(text, f"<{rules.name}>") != rules:
        raise RuleBaseError(f"rule base {quoted(rules.name)} cannot be written as YAML")
    return text


def save_rulebase(rules: RuleBase, path: str | os.PathLike[str]) -> None:
    """Write a rule base to a file, whole or not at all.

    Parameters
    ----------
    rules : RuleBase
        The rule base.
    path : str or path
        The file; replaced if it exists.

    Raises
    ------
    RuleBaseError
        See `dumps_rulebase`; the file is then as it was.
    OSError
        If the file cannot be written; it is then as it was.
    """
    text = dumps_rulebase(rules)
    target = Path(path).resolve()
    handle, draft = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.", suffix=".part")
    try:
        with open(handle, "w", encoding="utf-8", newline="\n") as stream:
            stream.write(text)
        # mkstemp makes files that only their owner may read.
        os.chmod(draft, _mode(target))
        os.replace(draft, target)
    except BaseException:
        os.unlink(draft)
        raise


def _mode(target: Path) -> int:
    try:
        return target.stat().st_mode & 0o777
    except FileNotFoundError:
        return 0o644


def _lines(rules: RuleBase) -> Iterator[str]:
    yield SCHEMA_LINE
    yield f"rulebase: {FORMAT_VERSION}"
    for key in ("name", "description", "source"):
        if getattr(rules, key):
            yield from _prose(key, getattr(rules, key))
    for role, variables in (("inputs", rules.inputs), ("outputs", rules.outputs)):
        yield ""
        yield f"{role}:"
        for variable in variables:
            yield from _variable(variable)
    yield ""
    yield f"operators: {_operators(rules.operators)}"
    yield ""
    yield "rules:"
    yield from _table(rules, rules.layout) if rules.layout else _list(rules)
    if rules.scheduler:
        pairs = ", ".join(f"{word_text(key)}: {_setting(value)}" for key, value in rules.scheduler)
        yield ""
        yield f"scheduler: {{{pairs}}}"


def _prose(key: str, text: str) -> Iterator[str]:
    """Long text folded over several lines, other text on one line."""
    if len(text) < _WIDTH - len(key) or text != " ".join(text.split()):
        yield f"{key}: {yaml_text(text)}"
        return
    yield f"{key}: >-"
    lines = textwrap.wrap(text, _WIDTH, break_long_words=False, break_on_hyphens=False)
    yield from (f"  {line}" for line in lines)


def _variable(variable: Variable) -> Iterator[str]:
    yield f"  {word_text(variable.name)}:"
    for key in ("label", "unit"):
        if getattr(variable, key):
            yield f"    {key}: {yaml_text(getattr(variable, key))}"
    yield f"    universe: {_universe(variable.universe)}"
    if variable.default is not None:
        yield f"    default: {written(variable.default)}"
    if variable.operators is not None:
        yield f"    operators: {_operators(variable.operators)}"
    yield "    sets:"
    width = max(len(word_text(name)) for name in variable.set_names)
    for fuzzy_set in variable.sets:
        yield f"      {word_text(fuzzy_set.name) + ':':<{width + 1}} {shape_text(fuzzy_set)}"


def _operators(operators: Operators) -> str:
    return f"{{{', '.join(f'{key}: {word}' for key, word in operators.words().items())}}}"


def _universe(universe: Universe) -> str:
    low, high = written(universe.low), written(universe.high)
    if universe.grid == "ends":
        return f"[{low}, {high}, {universe.points}]"
    return f"{{low: {low}, high: {high}, points: {universe.points}, grid: {universe.grid}}}"


def shape_text(fuzzy_set: FuzzySet) -> str:
    """Write a shape with its parameters, ``{trimf: [0, 0.1, 0.3]}``."""
    parameters = ", ".join(map(written, fuzzy_set.parameters))
    return f"{{{fuzzy_set.shape}: [{parameters}]}}"


def _table(rules: RuleBase, layout: TableLayout) -> Iterator[str]:
    columns, rows = rules.input(layout.columns), rules.input(layout.rows)
    yield f"  columns: {word_text(layout.columns)}"
    yield f"  rows: {word_text(layout.rows)}"
    yield f"  cells: [{', '.join(map(word_text, layout.cells))}]"
    yield "  table:"
    cells = [cell_text(rule, layout.cells, rules) for rule in rules.rules]
    count = len(columns.sets)
    lines = [cells[start : start + count] for start in range(0, len(cells), count)]
    widths = [
        max(len(name), *(len(line[k]) + 1 for line in lines)) + 1
        for k, name in enumerate(columns.set_names)
    ]
    margin = max(len(word_text(name)) for name in rows.set_names) + 1
    heads = "".join(
        f"{name:<{width}}" for name, width in zip(columns.set_names, widths, strict=True)
    )
    yield f"    #{' ' * margin} {heads}".rstrip()
    for name, line in zip(rows.set_names, lines, strict=True):
        ends = [f"{cell}," for cell in line[:-1]] + [line[-1]]
        row = "".join(f"{cell:<{width}}" for cell, width in zip(ends, widths, strict=True))
        yield f"    {word_text(name) + ':':<{margin}} [{row.rstrip()}]"


def _list(rules: RuleBase) -> Iterator[str]:
    conditions = [_group(rule.conditions) for rule in rules.rules]
    width = max(map(len, conditions)) + len(",")
    for rule, condition in zip(rules.rules, conditions, strict=True):
        either = f"{condition},"
        if rule.alternatives:
            either += f" or: [{', '.join(map(_group, rule.alternatives))}],"
        yield f"  - {{if: {either:<{width}} then: {consequents_text(rule.consequents)}}}"


def _group(conditions: Conditions) -> str:
    pairs = (f"{word_text(name)}: {word_text(term)}" for name, term in conditions)
    return f"{{{', '.join(pairs)}}}"


# -------------------------------------------------------------------- cells


def read_cell(text: str, order: tuple[str, ...], rules: RuleBase) -> tuple[Consequent, ...]:
    """Read a single cell, its words in the order of some outputs."""
    document = Document(text, "<cell>")
    outputs = {variable.name: variable for variable in rules.outputs}
    return CellReader(document, outputs).read(document.root, order)


def cell_text(rule: Rule, order: tuple[str, ...], rules: RuleBase) -> str:
    """Shortest of the three forms of a cell with the conclusions of the rule."""
    for text in (_joint(rule.consequents, order), _shares(rule.consequents, order)):
        if text is None:
            continue
        try:
            said = read_cell(text, order, rules)
        except RuleBaseError:
            continue  # a name with a hyphen, that could be split in two ways
        if set(said) == set(rule.consequents):
            return text
    return consequents_text(rule.consequents)


def _joint(consequents: Iterable[Consequent], order: tuple[str, ...]) -> str | None:
    """``S-L@0.5``, if there is one set for each output and one confidence for all."""
    names = {c.output: c.set_name for c in consequents}
    confidences = {c.confidence for c in consequents}
    if set(names) != set(order) or len(confidences) > 1:
        return None
    return word_text("-".join(names[output] for output in order) + _sure(confidences.pop()))


def _shares(consequents: tuple[Consequent, ...], order: tuple[str, ...]) -> str | None:
    """``[S-L@0.5, M-L@0.5]``, if only one output has several sets."""
    sets = {name: [c for c in consequents if c.output == name] for name in order}
    several = [name for name in order if len(sets[name]) > 1]
    if len(several) != 1 or not all(sets.values()):
        return None
    (divided,) = several
    words = []
    for share in sets[divided]:
        others = [replace(sets[n][0], confidence=share.confidence) for n in order if n != divided]
        words.append(_joint([*others, share], order))
    return f"[{', '.join(word for word in words if word)}]"


def consequents_text(consequents: Iterable[Consequent]) -> str:
    """Write conclusions by output, ``{stiffness: [S@0.5, M@0.5], damping: L}``."""
    words: dict[str, list[str]] = {}
    for consequent in consequents:
        word = word_text(consequent.set_name + _sure(consequent.confidence))
        words.setdefault(consequent.output, []).append(word)
    pairs = (
        f"{word_text(output)}: {found[0] if len(found) == 1 else '[' + ', '.join(found) + ']'}"
        for output, found in words.items()
    )
    return f"{{{', '.join(pairs)}}}"


def _sure(confidence: float) -> str:
    return "" if confidence == 1.0 else f"@{written(confidence)}"


# -------------------------------------------------------------------- scalars


def _setting(word: str) -> str:
    return word if _PLAIN_NUMBER.fullmatch(word) else word_text(word)


def word_text(word: str) -> str:
    """Write a word of the model, in quotes where a YAML reader could misread it."""
    plain = _PLAIN_WORD.fullmatch(word) and word.casefold() not in _NOT_WORDS
    return word if plain else json.dumps(word, ensure_ascii=False)


def yaml_text(text: str) -> str:
    """Write running text in a block, in quotes where it needs them."""
    plain = _PLAIN_TEXT.fullmatch(text) and text.casefold() not in _NOT_WORDS
    return text if plain else json.dumps(text, ensure_ascii=False)
