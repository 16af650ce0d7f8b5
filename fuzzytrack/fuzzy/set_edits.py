"""Fuzzy sets added, removed and renamed in the text of a rule base; the rest stays as it is.

Sets that variables share by an anchor (``sets: &seven``, ``sets: *seven``) are changed for all of
them, and the result says so in `also`; or, with ``apart=True``, they are written out first.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.anchors import write_out
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import Rule, RuleBase
from fuzzytrack.fuzzy.saving import shape_text, word_text
from fuzzytrack.fuzzy.table_edits import (
    add_line,
    axes_of_table,
    edit_heading,
    entry_text,
    remove_line,
    table_rows,
)
from fuzzytrack.fuzzy.text_edits import EditedText, TextEdits
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.yamltree import Mapping, Node, Scalar, quoted
from fuzzytrack.yamltree import Sequence as ListNode

__all__ = ["add_set", "remove_set", "rename_set"]

# Rules that a message names; of more, it says how many.
_NAMED = 6


def add_set(
    text: str,
    variable: str,
    new: FuzzySet,
    *,
    like: str | None = None,
    apart: bool = False,
    file: str = "<text>",
) -> EditedText:
    """Add a fuzzy set, at the place that its peak has among the others.

    Parameters
    ----------
    text : str
        A rule base in YAML.
    variable : str
        Name of an input or output.
    new : FuzzySet
        The set.
    like : str, optional
        A set of the same variable. An input of a table gets a column or row for the new set, a
        copy of the one of `like`; the set before it, or the first one, unless given. A list of
        rules stays as it is.
    apart : bool
        Whether sets that are shared by an anchor are written out first.
    file : str
        Name for messages.

    Returns
    -------
    EditedText
        The text; `also` names the sets that other variables got, which share the sets of this one.
        A comment above a table that lists the sets of its columns is kept up to date.

    Raises
    ------
    RuleBaseError
        If the text, before or after, is no rule base, there is no such variable, or it has a set
        of that name.
    """
    if apart:
        text = write_out(text, variable, None, file)
    edits = TextEdits(text, file)
    owner = edits.before.variable(variable)
    if new.name in owner.set_names:
        raise RuleBaseError(f"{variable} has a set {quoted(new.name)} already; choose another name")
    low, high = owner.universe.low, owner.universe.high
    index = sum(s.center(low, high) <= new.center(low, high) for s in owner.sets)
    model = owner.set_names[max(index - 1, 0)] if like is None else like
    owner.index(model)
    shared = _sharing(edits, variable)
    sets = edits.sets(variable)
    beside = list(sets.entries.values())[max(index - 1, 0)]
    entry = entry_text(edits, new.name, beside, shape_text(new))
    edits.insert(sets, index, entry)
    rules = edits.before.rules
    for name in axes_of_table(edits.before, shared):
        add_line(edits, name, new.name, index, model)
        rules += tuple(
            _conditioned(rule, name, new.name) for rule in rules if _has(rule, name, model)
        )

    def longer(found: tuple[FuzzySet, ...]) -> tuple[FuzzySet, ...]:
        return (*found[:index], new, *found[index:])

    expected = _with_sets(edits.before, shared, longer, rules)
    return edits.result(
        expected, sets, f"the set {quoted(new.name)}", _others(shared, variable, new.name)
    )


def remove_set(
    text: str,
    variable: str,
    set_name: str,
    *,
    with_rules: bool = False,
    apart: bool = False,
    file: str = "<text>",
) -> EditedText:
    """Remove a fuzzy set that no rule uses.

    Parameters
    ----------
    text : str
        A rule base in YAML.
    variable, set_name : str
        Name of an input or output, and of one of its sets.
    with_rules : bool
        Whether the rules of a table that have the set as a condition, a column or a row, are
        removed with it.
    apart : bool
        Whether sets that are shared by an anchor are written out first.
    file : str
        Name for messages.

    Returns
    -------
    EditedText
        The text, without the line of the set and a comment at its end; `also` names the sets that
        other variables lost, which share the sets of this one.

    Raises
    ------
    RuleBaseError
        If the text, before or after, is no rule base, there is no such set, or rules use it, which
        are named.
    """
    if apart:
        text = write_out(text, variable, None, file)
    edits = TextEdits(text, file)
    owner = edits.before.variable(variable)
    index = owner.index(set_name)
    shared = _sharing(edits, variable)
    lines = axes_of_table(edits.before, shared) if with_rules else []
    users = [
        rule
        for rule in edits.before.rules
        if _uses(rule, shared, set_name) and not any(_has(rule, name, set_name) for name in lines)
    ]
    sets = edits.sets(variable)
    if users:
        raise edits.document.error(sets.entries[set_name][0], _in_use(variable, set_name, users))
    edits.remove(sets, index)
    for name in lines:
        remove_line(edits, name, set_name, index, set(lines))
    rules = tuple(r for r in edits.before.rules if not any(_has(r, n, set_name) for n in lines))

    def shorter(found: tuple[FuzzySet, ...]) -> tuple[FuzzySet, ...]:
        return (*found[:index], *found[index + 1 :])

    expected = _with_sets(edits.before, shared, shorter, rules)
    return edits.result(expected, sets, "the removal", _others(shared, variable, set_name))


def rename_set(
    text: str,
    variable: str,
    old: str,
    new: str,
    *,
    apart: bool = False,
    file: str = "<text>",
) -> EditedText:
    """Give a fuzzy set another name, in the rules that use it as well.

    Parameters
    ----------
    text : str
        A rule base in YAML.
    variable, old : str
        Name of an input or output, and of one of its sets.
    new : str
        The new name: no blank, comma or ``@``.
    apart : bool
        Whether sets that are shared by an anchor are written out first.
    file : str
        Name for messages.

    Returns
    -------
    EditedText
        The text; `also` names the sets of other variables that were renamed with it. A comment
        above a table that lists the sets of its columns is kept up to date.

    Raises
    ------
    RuleBaseError
        If the text, before or after, is no rule base, there is no such set, another set has that
        name already, or a cell such as ``a-b`` could then be read in two ways.
    """
    if apart:
        text = write_out(text, variable, None, file)
    edits = TextEdits(text, file)
    owner = edits.before.variable(variable)
    index = owner.index(old)
    if new != old and new in owner.set_names:
        raise RuleBaseError(f"{variable} has a set {quoted(new)} already; choose another name")
    shared = _sharing(edits, variable)
    sets = edits.sets(variable)
    _rename_word(edits, sets.entries[old][0], old, new)
    _rename_in_conditions(edits, shared, old, new)
    _rename_in_consequents(edits, shared, old, new)
    for name in shared:
        edit_heading(edits, name, lambda spans: {spans[index]: new})

    def renamed(found: tuple[FuzzySet, ...]) -> tuple[FuzzySet, ...]:
        return tuple(replace(s, name=new) if s.name == old else s for s in found)

    rules = tuple(_renamed_rule(rule, shared, old, new) for rule in edits.before.rules)
    expected = _with_sets(edits.before, shared, renamed, rules)
    return edits.result(expected, sets, f"the name {quoted(new)}", _others(shared, variable, new))


# -------------------------------------------------------------------- names


def _rename_word(edits: TextEdits, node: Node, old: str, new: str, offset: int = 0) -> None:
    """Put a name in the place of another, which begins `offset` characters into a word."""
    if node.alias:
        return  # it is renamed where its anchor is
    assert isinstance(node, Scalar)
    start = edits.content(node)
    text = node.text[:offset] + new + node.text[offset + len(old) :]
    raw = edits.text[start : node.end]
    quotes = raw[:1] if raw != node.text else ""
    if quotes and raw == quotes + node.text + quotes and not re.search(r"[\"'\\]", new):
        edits.replace(start, node.end, quotes + text + quotes)
    else:
        edits.replace(
            start, node.end, json.dumps(text, ensure_ascii=False) if quotes else word_text(text)
        )


def _rename_in_conditions(edits: TextEdits, shared: Sequence[str], old: str, new: str) -> None:
    layout, rules = edits.before.layout, edits.field("rules")
    if layout is not None:
        if layout.rows in shared:
            _rename_word(edits, table_rows(edits)[old][0], old, new)
        return
    assert isinstance(rules, ListNode)
    for rule in rules.items:
        entries = edits.document.entries(rule, "a rule")
        conditions = [(entries.get("if") or entries["if any"])[1]]
        if "or" in entries:
            conditions += edits.document.items(entries["or"][1], "or")
        words = [pair for node in conditions for pair in edits.document.entries(node, "if").items()]
        for name, (_, word) in words:
            if name in shared and edits.document.text(word, "set") == old:
                _rename_word(edits, word, old, new)


def _rename_in_consequents(edits: TextEdits, shared: Sequence[str], old: str, new: str) -> None:
    outputs = edits.before.output_names
    order = edits.before.layout.cells if edits.before.layout else outputs
    nodes = {node.start: node for node, _ in edits.reader.rule_nodes.values()}
    for node in nodes.values():
        for word, names in _words(edits, node, order):
            said = edits.reader.cells.names(word, names)
            offset = 0
            # From the last to the first: one word may have the name twice.
            changed = edits.document.text(word, "a cell")
            for output, name in zip(names, said, strict=True):
                if output in shared and name == old:
                    changed = changed[:offset] + new + changed[offset + len(old) :]
                    offset += len(new) + 1
                else:
                    offset += len(name) + 1
            if changed != word.text:
                _rename_word(edits, word, word.text, changed)


def _words(
    edits: TextEdits, node: Node, order: tuple[str, ...]
) -> Iterator[tuple[Scalar, tuple[str, ...]]]:
    """Words of the consequents of a rule, each with the outputs whose sets it names."""
    if isinstance(node, Scalar):
        yield node, order
    elif isinstance(node, ListNode):
        for item in node.items:
            yield from _words(edits, item, order)
    elif isinstance(node, Mapping):
        for output, (_, value) in node.entries.items():
            yield from _words(edits, value, (output,))


# -------------------------------------------------------------------- rule bases


def _sharing(edits: TextEdits, variable: str) -> list[str]:
    """Variables that have the same sets in the text, this one included."""
    entries = edits.sets(variable).entries
    names = (v.name for v in edits.before.variables)
    return [name for name in names if edits.sets(name).entries is entries]


def _others(shared: Sequence[str], variable: str, set_name: str) -> list[tuple[str, str]]:
    return [(name, set_name) for name in shared if name != variable]


def _with_sets(
    rules: RuleBase,
    names: Sequence[str],
    change: Callable[[tuple[FuzzySet, ...]], tuple[FuzzySet, ...]],
    new_rules: Iterable[Rule],
) -> RuleBase:
    def changed(variables: tuple[Variable, ...]) -> tuple[Variable, ...]:
        return tuple(replace(v, sets=change(v.sets)) if v.name in names else v for v in variables)

    return replace(
        rules,
        inputs=changed(rules.inputs),
        outputs=changed(rules.outputs),
        rules=tuple(new_rules),
    )


def _has(rule: Rule, name: str, set_name: str) -> bool:
    """Whether a rule has a condition."""
    return any((name, set_name) in group for group in rule.groups)


def _uses(rule: Rule, names: Sequence[str], set_name: str) -> bool:
    """Whether a rule has a set of one of some variables as a condition or a consequent."""
    return any(_has(rule, name, set_name) for name in names) or any(
        c.output in names and c.set_name == set_name for c in rule.consequents
    )


def _conditioned(rule: Rule, name: str, set_name: str) -> Rule:
    """The rule with another set of an input."""
    first, *others = (
        tuple((n, set_name if n == name else term) for n, term in group) for group in rule.groups
    )
    return replace(rule, conditions=first, alternatives=tuple(others))


def _renamed_rule(rule: Rule, names: Sequence[str], old: str, new: str) -> Rule:
    first, *others = (
        tuple((n, new if n in names and term == old else term) for n, term in group)
        for group in rule.groups
    )
    consequents = tuple(
        replace(c, set_name=new) if c.output in names and c.set_name == old else c
        for c in rule.consequents
    )
    return Rule(first, consequents, tuple(others))


def _in_use(variable: str, set_name: str, users: Sequence[Rule]) -> str:
    cells = [
        " or ".join(", ".join(f"{n}={term}" for n, term in group) for group in rule.groups)
        for rule in users
    ]
    more = f"; and {len(cells) - _NAMED} more" if len(cells) > _NAMED else ""
    return (
        f"the set {quoted(set_name)} of {variable} is used by the rules for "
        f"{'; '.join(cells[:_NAMED])}{more}: change these first"
    )
