"""Fuzzy sets changed in the text of a rule base; all else in the text stays as it is.

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
from fuzzytrack.fuzzy.numbers import written
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

__all__ = ["add_set", "remove_set", "rename_set", "set_shape", "set_shapes"]

# Rules that a message names; of more, it says how many.
_NAMED = 6


def set_shape(
    text: str,
    variable: str,
    set_name: str,
    parameters: Sequence[float],
    shape: str | None = None,
    *,
    apart: bool = False,
    file: str = "<text>",
) -> EditedText:
    """Change the parameters of a fuzzy set, and its shape.

    Parameters
    ----------
    text : str
        A rule base in YAML.
    variable, set_name : str
        Name of an input or output, and of one of its sets.
    parameters : sequence of float
        In the units of the variable, in the order of `fuzzytrack.fuzzy.membership.SHAPES`. Numbers
        that stay are left as they are written.
    shape : str, optional
        A key of `fuzzytrack.fuzzy.membership.SHAPES`; the shape that it has unless given.
    apart : bool
        Whether a set that is shared by an anchor is written out first, so that only this one is
        changed.
    file : str
        Name for messages.

    Returns
    -------
    EditedText
        The text; `also` names other sets that share this one, and were changed with it.

    Raises
    ------
    RuleBaseError
        If the text, before or after, is no rule base, there is no such set, the parameters do not
        fit the shape, or an anchor shares a single number.

    Examples
    --------
    >>> from fuzzytrack.fuzzy.loading import rulebase_path
    >>> from fuzzytrack.fuzzy.set_edits import set_shape
    >>> text = rulebase_path("stiffness-damping").read_text(encoding="utf-8")
    >>> edited = set_shape(text, "E", "ze", [-0.15, 0, 0.15])
    >>> edited.also
    (('dE', 'ze'),)
    """
    if apart:
        text = write_out(text, variable, set_name, file)
    edits = TextEdits(text, file)
    owner = _variable(edits.before, variable)
    kind = shape or owner.sets[owner.index(set_name)].shape
    return _with_shapes(edits, owner, [FuzzySet(set_name, kind, tuple(parameters))])


def set_shapes(
    text: str,
    variable: str,
    sets: Iterable[FuzzySet],
    *,
    apart: bool = False,
    file: str = "<text>",
) -> EditedText:
    """Change the shapes of several sets of a variable at once, as of neighbors that share a corner.

    Parameters
    ----------
    text : str
        A rule base in YAML.
    variable : str
        Name of an input or output.
    sets : iterable of FuzzySet
        New shapes, with the names of sets that are there, each once. Only all of them together
        need to be a rule base.
    apart : bool
        Whether sets that are shared by an anchor are written out first.
    file : str
        Name for messages.

    Returns
    -------
    EditedText
        As for `set_shape`.

    Raises
    ------
    RuleBaseError
        As for `set_shape`; also if a set is named twice, or two of them share their text.
    """
    new = tuple(sets)
    if apart:
        for each in new:
            text = write_out(text, variable, each.name, file)
    edits = TextEdits(text, file)
    owner = _variable(edits.before, variable)
    names = [each.name for each in new]
    if len(set(names)) < len(names):
        doubled = next(name for name in names if names.count(name) > 1)
        raise RuleBaseError(f"sets: {quoted(doubled)} is named twice; give each set once")
    return _with_shapes(edits, owner, new)


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
    owner = _variable(edits.before, variable)
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
    owner = _variable(edits.before, variable)
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
    owner = _variable(edits.before, variable)
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


# -------------------------------------------------------------------- shapes


def _set_numbers(edits: TextEdits, node: ListNode, parameters: tuple[float, ...]) -> None:
    """Put numbers in the place of others, of which there may be more or fewer."""
    numbers = [written(p) for p in parameters]
    if node.alias:
        edits.replace(node.start, node.end, f"[{', '.join(numbers)}]")
        return
    for item, number in zip(node.items, numbers, strict=False):
        assert isinstance(item, Scalar)
        if item.anchored:
            raise edits.document.error(
                item, "a number that an anchor shares cannot be set by itself; write it out first"
            )
        if float(item.text) != float(number):
            edits.replace(item.start, item.end, number)
    kept, last = node.items[: len(numbers)][-1].end, node.items[-1].end
    between = ", "
    if not node.flow:
        between = f"{edits.line_end}{edits.margin_at(edits.start_of(node))}- "
        kept, last = edits.end_of_line(kept), edits.end_of_line(last)
    if kept < last:
        edits.replace(kept, last, "")
    elif len(numbers) > len(node.items):
        more = "".join(between + number for number in numbers[len(node.items) :])
        edits.replace(kept, kept, more)


def _with_shapes(edits: TextEdits, owner: Variable, new: Sequence[FuzzySet]) -> EditedText:
    """The text with new shapes, after a check that only these and their equals have changed."""
    moved = []
    nodes = edits.sets(owner.name).entries
    for each in new:
        old = owner.sets[owner.index(each.name)]
        node = nodes[each.name][1]
        assert isinstance(node, Mapping)  # the text has been read as a rule base
        ((key, numbers),) = node.entries.values()
        assert isinstance(numbers, ListNode)
        if each.shape != old.shape:
            edits.replace(edits.content(key), key.end, each.shape)
        _set_numbers(edits, numbers, each.parameters)
        moved.append((old, each))
    text, after = edits.loaded()
    wanted = {(owner.name, each.name): each for each in new}
    shapes = dict(wanted)
    for was, now in zip(_variables(edits.before), _variables(after), strict=True):
        for a, b in zip(was.sets, now.sets, strict=True):
            # Sets that share the text of one of them were equal to it, and are so again.
            shared = any(_alike(a, old) and _alike(b, each) for old, each in moved)
            if a != b and shared:
                shapes.setdefault((was.name, a.name), b)

    def changed(variables: tuple[Variable, ...]) -> tuple[Variable, ...]:
        return tuple(
            replace(v, sets=tuple(shapes.get((v.name, s.name), s) for s in v.sets))
            for v in variables
        )

    before = edits.before
    expected = replace(before, inputs=changed(before.inputs), outputs=changed(before.outputs))
    if after != expected:
        named = ", ".join(quoted(each.name) for each in new)
        edits.result(expected, nodes[new[0].name][1], f"the shape of {named}")
    order = [(v.name, s.name) for v in _variables(after) for s in v.sets]
    return EditedText(text, after, [p for p in order if p in shapes and p not in wanted])


def _alike(a: FuzzySet, b: FuzzySet) -> bool:
    return (a.shape, a.parameters) == (b.shape, b.parameters)


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
        conditions = entries.get("if") or entries["if any"]
        for name, (_, word) in edits.document.entries(conditions[1], "if").items():
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


def _variables(rules: RuleBase) -> tuple[Variable, ...]:
    return (*rules.inputs, *rules.outputs)


def _variable(rules: RuleBase, name: str) -> Variable:
    for variable in _variables(rules):
        if variable.name == name:
            return variable
    allowed = ", ".join((*rules.input_names, *rules.output_names))
    raise RuleBaseError(f"unknown variable {quoted(name)}; one of {allowed}")


def _sharing(edits: TextEdits, variable: str) -> list[str]:
    """Variables that have the same sets in the text, this one included."""
    entries = edits.sets(variable).entries
    names = (v.name for v in _variables(edits.before))
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
    return (name, set_name) in rule.conditions


def _uses(rule: Rule, names: Sequence[str], set_name: str) -> bool:
    """Whether a rule has a set of one of some variables as a condition or a consequent."""
    return any(_has(rule, name, set_name) for name in names) or any(
        c.output in names and c.set_name == set_name for c in rule.consequents
    )


def _conditioned(rule: Rule, name: str, set_name: str) -> Rule:
    """The rule with another set of an input."""
    conditions = tuple((n, set_name if n == name else term) for n, term in rule.conditions)
    return replace(rule, conditions=conditions)


def _renamed_rule(rule: Rule, names: Sequence[str], old: str, new: str) -> Rule:
    return Rule(
        tuple((n, new if n in names and term == old else term) for n, term in rule.conditions),
        tuple(
            replace(c, set_name=new) if c.output in names and c.set_name == old else c
            for c in rule.consequents
        ),
    )


def _in_use(variable: str, set_name: str, users: Sequence[Rule]) -> str:
    cells = [", ".join(f"{name}={term}" for name, term in rule.conditions) for rule in users]
    more = f"; and {len(cells) - _NAMED} more" if len(cells) > _NAMED else ""
    return (
        f"the set {quoted(set_name)} of {variable} is used by the rules for "
        f"{'; '.join(cells[:_NAMED])}{more}: change these first"
    )
