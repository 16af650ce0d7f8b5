"""Rules and operators changed in the text of a rule base; all else in the text stays as it is."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.operators import CONJUNCTIONS, DEFUZZIFICATIONS, DISJUNCTIONS
from fuzzytrack.fuzzy.rulebase import (
    Consequent,
    Rule,
    RuleBase,
)
from fuzzytrack.fuzzy.saving import cell_text, consequents_text, read_cell, word_text
from fuzzytrack.fuzzy.text_edits import EditedText, TextEdits
from fuzzytrack.yamltree import Document, Node, Sequence, quoted, suggestion
from fuzzytrack.yamltree import Mapping as MappingNode

__all__ = ["OPERATORS", "add_rule", "remove_rule", "set_cell", "set_consequents", "set_operator"]

#: Operators by the words of a file: the attribute of `Operators`, and the allowed words.
OPERATORS = {
    "and": ("conjunction", CONJUNCTIONS),
    "or": ("disjunction", DISJUNCTIONS),
    "defuzzification": ("defuzzification", DEFUZZIFICATIONS),
}


def set_cell(
    text: str,
    where: Mapping[str, str],
    cell: str,
    file: str = "<text>",
    *,
    together: bool = False,
) -> EditedText:
    """Change one cell of a table, or the consequents of one rule, and nothing else in the text.

    Parameters
    ----------
    text : str
        A rule base in YAML.
    where : mapping
        Input to set, e.g. ``{"dE": "ns", "E": "pl"}``: the conditions of the rule, all of them.
    cell : str
        The new conclusion of the rule, as it is written in a table: ``M-Z``, ``M-Z@0.5`` or
        ``[S-L@0.5, M-L@0.5]``, the outputs in the order of the table's ``cells`` (without a table,
        in the order in which the rule names them); or ``{stiffness: M, damping: Z}``.
    file : str
        Name for messages.
    together : bool
        Whether a rule of ``if any`` is changed with the others that are written with it.

    Returns
    -------
    EditedText
        The text; nothing outside that cell is changed.

    Raises
    ------
    RuleBaseError
        If the text, before or after, is no rule base, there is no such rule, or the rule shares
        its consequents with others (an anchor; ``if any``, unless `together`).
    """
    return _with_cell(TextEdits(text, file), where, cell, together)


def _with_cell(edits: TextEdits, where: Mapping[str, str], cell: str, together: bool) -> EditedText:
    before = edits.before
    key = _known_conditions(before, where)
    node = _own_consequents(edits, key, where, together)
    order = before.layout.cells if before.layout else before.output_names
    if before.layout is None and isinstance(node, MappingNode):
        order = tuple(node.entries)
    wanted = read_cell(cell, order, before)
    if isinstance(node, MappingNode) and not cell.strip().startswith("{"):
        cell = consequents_text(wanted)
    edits.replace(node.start, node.end, cell.strip())
    changed = {k for k, (each, _) in edits.reader.rule_nodes.items() if each is node}
    expected = tuple(
        replace(rule, consequents=wanted) if rule.key in changed else rule for rule in before.rules
    )
    return edits.result(replace(before, rules=expected), node, quoted(cell))


def set_consequents(
    text: str,
    where: Mapping[str, str],
    consequents: Iterable[Consequent],
    file: str = "<text>",
    *,
    together: bool = False,
) -> EditedText:
    """Change the consequents of one rule, with their confidences.

    Parameters
    ----------
    text : str
        A rule base in YAML.
    where : mapping
        The conditions of the rule, as for `set_cell`.
    consequents : iterable of Consequent
        All that the rule concludes; several for one output share it by their confidences. They are
        written in the shortest form of a cell.
    file : str
        Name for messages.
    together : bool
        As for `set_cell`.

    Returns
    -------
    EditedText
        The text; nothing outside that cell is changed.

    Raises
    ------
    RuleBaseError
        As for `set_cell`.
    """
    edits = TextEdits(text, file)
    before = edits.before
    _known_conditions(before, where)
    rule = _checked_rule(before, where, consequents)
    cell = consequents_text(rule.consequents)
    if before.layout is not None:
        cell = cell_text(rule, before.layout.cells, before)
    return _with_cell(edits, where, cell, together)


def add_rule(
    text: str, where: Mapping[str, str], consequents: Iterable[Consequent], file: str = "<text>"
) -> EditedText:
    """Add a rule to the end of a list of rules.

    Parameters
    ----------
    text : str
        A rule base in YAML, its rules a list; a table is complete already.
    where : mapping
        Input to set: the conditions of the new rule.
    consequents : iterable of Consequent
        What it concludes.
    file : str
        Name for messages.

    Returns
    -------
    EditedText

    Raises
    ------
    RuleBaseError
        If the text, before or after, is no rule base, its rules are a table, or it has a rule with
        these conditions.
    """
    edits = TextEdits(text, file)
    rules = _rule_list(edits, "added")
    if _known_conditions(edits.before, where) in edits.reader.rule_nodes:
        raise RuleBaseError(f"a rule for {_spelled(where)} is there already; change that one")
    rule = _checked_rule(edits.before, where, consequents)
    conditions = ", ".join(f"{word_text(name)}: {word_text(term)}" for name, term in where.items())
    entry = f"{{if: {{{conditions}}}, then: {consequents_text(rule.consequents)}}}"
    edits.insert(rules, len(rules.items), entry)
    expected = replace(edits.before, rules=(*edits.before.rules, rule))
    return edits.result(expected, rules, "the new rule")


def remove_rule(text: str, where: Mapping[str, str], file: str = "<text>") -> EditedText:
    """Remove a rule from a list of rules, with a comment on its line.

    Parameters
    ----------
    text : str
        A rule base in YAML, its rules a list.
    where : mapping
        The conditions of the rule, all of them.
    file : str
        Name for messages.

    Returns
    -------
    EditedText

    Raises
    ------
    RuleBaseError
        If the text, before or after, is no rule base, its rules are a table, or there is no such
        rule by itself: one of ``if any`` is removed in the text.
    """
    edits = TextEdits(text, file)
    rules = _rule_list(edits, "removed")
    key = _known_conditions(edits.before, where)
    _own_consequents(edits, key, where)
    for index, item in enumerate(rules.items):
        assert isinstance(item, MappingNode)  # the text has been read as a rule base
        if edits.reader.rule_nodes[key][0] is item.entries["then"][1]:
            edits.remove(rules, index)
    kept = tuple(rule for rule in edits.before.rules if rule.key != key)
    return edits.result(replace(edits.before, rules=kept), rules, "the removal")


def set_operator(text: str, operator: str, word: str, file: str = "<text>") -> EditedText:
    """Change an operator of a rule base, and nothing else in the text.

    Parameters
    ----------
    text : str
        A rule base in YAML.
    operator : {"and", "or", "defuzzification"}
        Which one.
    word : str
        The new one, e.g. ``"min"``; see `fuzzytrack.fuzzy.rulebase.Operators`.
    file : str
        Name for messages.

    Returns
    -------
    EditedText

    Raises
    ------
    RuleBaseError
        If the text, before or after, is no rule base, or a word is unknown.
    """
    if operator not in OPERATORS:
        raise RuleBaseError(f"unknown operator {quoted(operator)}{suggestion(operator, OPERATORS)}")
    attribute, allowed = OPERATORS[operator]
    if word not in allowed:
        raise RuleBaseError(
            f"operators: unknown {operator} {quoted(word)}{suggestion(word, allowed)}"
        )
    edits = TextEdits(text, file)
    node = edits.field("operators", operator)
    edits.replace(edits.content(node), node.end, word)
    operators = replace(edits.before.operators, **{attribute: word})
    return edits.result(replace(edits.before, operators=operators), node, quoted(word))


def _checked_rule(
    before: RuleBase, where: Mapping[str, str], consequents: Iterable[Consequent]
) -> Rule:
    """A rule of sets that are there."""
    rule = Rule(tuple(where.items()), tuple(consequents))
    for consequent in rule.consequents:
        before.output(consequent.output).index(consequent.set_name)
    return rule


def _rule_list(edits: TextEdits, done: str) -> Sequence:
    rules = edits.field("rules")
    if not isinstance(rules, Sequence):
        raise edits.document.error(
            rules, f"a table has a rule for each pair of sets; no rule can be {done}"
        )
    return rules


def _own_consequents(
    edits: TextEdits,
    key: frozenset[tuple[str, str]],
    where: Mapping[str, str],
    together: bool = False,
) -> Node:
    """Node of the consequents of a rule that shares them with no other, but those of `together`."""
    if key not in edits.reader.rule_nodes:
        raise RuleBaseError(
            f"no rule has exactly the conditions {_spelled(where)}; name a set for each input "
            "that the rule has"
        )
    node, shared = edits.reader.rule_nodes[key]
    if (shared and not together) or node.anchored or _inside_anchor(edits.document, node):
        raise edits.document.error(
            node,
            f"other rules share the conclusions of the rule for {_spelled(where)}; "
            "in the text, give it an entry of its own first",
        )
    return node


def _known_conditions(rules: RuleBase, where: Mapping[str, str]) -> frozenset[tuple[str, str]]:
    for name, term in where.items():
        rules.input(name).index(term)
    return frozenset(where.items())


def _spelled(where: Mapping[str, str]) -> str:
    return ", ".join(f"{name}={term}" for name, term in where.items())


def _inside_anchor(document: Document, node: Node) -> bool:
    """Whether a node lies in a collection that aliases repeat elsewhere."""
    stack = [document.root]
    while stack:
        outer = stack.pop()
        if outer.anchored and outer.start <= node.start < outer.end:
            return True
        if isinstance(outer, MappingNode):
            stack.extend(value for _, value in outer.entries.values())
        else:
            stack.extend(getattr(outer, "items", ()))
    return False
