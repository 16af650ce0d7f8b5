"""The edits that a session makes, by name, with their arguments checked.

A command is a function of this module that takes the text of a rule base, or any of the texts, and
returns the changed one. Its arguments come from JSON: their names are those of its parameters, and
their types are checked by its annotations.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from fuzzytrack.fuzzy.anchors import write_out
from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rule_edits import (
    add_rule,
    remove_rule,
    set_cell,
    set_consequents,
    set_operator,
)
from fuzzytrack.fuzzy.rulebase import Consequent
from fuzzytrack.fuzzy.set_edits import add_set, remove_set, rename_set
from fuzzytrack.fuzzy.shape_edits import set_shapes
from fuzzytrack.fuzzy.text_edits import EditedText
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.studio.symmetry import (
    mirrored_conditions,
    mirrored_name,
    mirrored_shape,
    symmetric_shape,
)
from fuzzytrack.yamltree import quoted, suggestion
from fuzzytrack.yamlvalues import Value, insert_value, remove_value, set_value

__all__ = ["COMMANDS", "OF_ANY_TEXT", "edited", "is_number", "parameters_of"]

MAX_SAYS = 4096
_THEN = 'conclusions, such as [{"output": "u", "set": "S"}]'
_SHAPES = 'sets, such as [{"set": "ze", "parameters": [-0.1, 0, 0.1], "shape": "trimf"}]'
_LARGEST = 1e300


def cell(text: str, where: dict[str, str], says: str, symmetric: bool = False) -> EditedText:
    """Set the conclusions of a rule, as the text of a cell; `symmetric` also of its mirror.

    Rules that are written as one, with ``if any``, change together.
    """
    if len(says) > MAX_SAYS:
        raise ValueError(f"says: {len(says)} characters; at most {MAX_SAYS} are allowed")
    changed = set_cell(text, where, says, together=True)
    return _mirrored(changed, where) if symmetric else changed


def conclude(
    text: str, where: dict[str, str], then: list[dict[str, Any]], symmetric: bool = False
) -> EditedText:
    """Set the conclusions of a rule: output, set and, unless it is 1, confidence of each."""
    changed = set_consequents(text, where, _consequents(then), together=True)
    return _mirrored(changed, where) if symmetric else changed


def confidence(
    text: str,
    where: dict[str, str],
    confidence: float,
    output: str | None = None,
    symmetric: bool = False,
) -> EditedText:
    """Set the confidence of all conclusions of a rule, or of those about one output."""
    rules = loads_rulebase(text)
    if output is not None:
        rules.output(output)
    key = frozenset(where.items())
    found = [rule for rule in rules.rules if rule.key == key]
    then = [
        replace(c, confidence=confidence) if output in (None, c.output) else c
        for rule in found
        for c in rule.consequents
    ]
    # Without such a rule, `set_consequents` says so.
    then = then or [Consequent(rules.output_names[0], rules.outputs[0].set_names[0])]
    changed = set_consequents(text, where, then, together=True)
    return _mirrored(changed, where) if symmetric else changed


def shape(
    text: str,
    variable: str,
    set: str,
    parameters: list[float],
    shape: str | None = None,
    symmetric: bool = False,
    apart: bool = False,
) -> EditedText:
    """Set the parameters of a set, and its shape; `symmetric` also of its mirror."""
    new = {"set": set, "parameters": parameters, "shape": shape}
    return shapes(text, variable, [new], symmetric, apart)


def shapes(
    text: str,
    variable: str,
    shapes: list[dict[str, Any]],
    symmetric: bool = False,
    apart: bool = False,
) -> EditedText:
    """Set several sets at once: set, parameters and, if it changes, shape of each."""
    owner = loads_rulebase(text).variable(variable)
    found: dict[str, FuzzySet] = {}
    mirrors: dict[str, FuzzySet] = {}
    for each in shapes:
        new = _shape(owner, each)
        if new.name in found:
            raise ValueError(f"shapes: {quoted(new.name)} is named twice; give each set once")
        if symmetric and mirrored_name(owner, new.name) == new.name:
            new = symmetric_shape(owner, new)
        elif symmetric:
            other = mirrored_shape(owner, new)
            mirrors[other.name] = other
        found[new.name] = new
    changed = set_shapes(text, variable, (mirrors | found).values(), apart=apart)
    more = [(variable, name) for name in mirrors if name not in found]
    return EditedText(changed, changed.rules, (*more, *changed.also))


def add(
    text: str,
    variable: str,
    set: str,
    shape: str,
    parameters: list[float],
    like: str | None = None,
    apart: bool = False,
) -> EditedText:
    """Add a set; an input of a table gets a column or row like that of another set."""
    new = FuzzySet(set, shape, tuple(parameters))
    return add_set(text, variable, new, like=like, apart=apart)


def remove(
    text: str, variable: str, set: str, with_rules: bool = False, apart: bool = False
) -> EditedText:
    """Remove a set; `with_rules` also its column or row of a table."""
    return remove_set(text, variable, set, with_rules=with_rules, apart=apart)


def rename(text: str, variable: str, set: str, name: str, apart: bool = False) -> EditedText:
    """Rename a set, in the rules as well."""
    return rename_set(text, variable, set, name, apart=apart)


def separate(text: str, variable: str) -> EditedText:
    """Write out the sets of a variable that shares them by an anchor."""
    return write_out(text, variable)


def operator(text: str, operator: str, word: str) -> EditedText:
    """Set an operator: and, or, defuzzification."""
    return set_operator(text, operator, word)


def add_to_list(text: str, where: dict[str, str], then: list[dict[str, Any]]) -> EditedText:
    """Add a rule to a list of rules."""
    return add_rule(text, where, _consequents(then))


def remove_from_list(text: str, where: dict[str, str]) -> EditedText:
    """Remove a rule from a list of rules."""
    return remove_rule(text, where)


def set_at(text: str, path: list[str | int], value: Value) -> str:
    """Set a value in a text, or add a key, e.g. ``["target", "speed"]``."""
    return set_value(text, path, value)


def insert_at(text: str, path: list[str | int], value: Value) -> str:
    """Insert an item into a list, e.g. before ``["target", "waypoints", 2]``."""
    return insert_value(text, path, value)


def remove_at(text: str, path: list[str | int]) -> str:
    """Remove a key or an item of a list."""
    return remove_value(text, path)


#: Commands by name: those of rule bases, and those of any text.
COMMANDS: dict[str, Callable[..., str]] = {
    "cell": cell,
    "conclude": conclude,
    "confidence": confidence,
    "shape": shape,
    "shapes": shapes,
    "add-set": add,
    "remove-set": remove,
    "rename-set": rename,
    "write-out": separate,
    "operator": operator,
    "add-rule": add_to_list,
    "remove-rule": remove_from_list,
    "set-value": set_at,
    "insert-value": insert_at,
    "remove-value": remove_at,
}
#: Commands of any text: the result is YAML, and whoever made it reads it.
OF_ANY_TEXT = ("set-value", "insert-value", "remove-value")


def edited(text: str, command: str, arguments: Mapping[str, Any]) -> str:
    """Text after a command; an `EditedText` after one of rule bases.

    Parameters
    ----------
    text : str
        The text.
    command : str
        A key of `COMMANDS`.
    arguments : mapping
        Values of JSON by the names of the command's parameters, see `parameters_of`.

    Raises
    ------
    FileError
        If the text, before or after, is no rule base or no YAML, or the edit cannot be made.
    ValueError
        If there is no such command, or an argument is missing, unknown or of another type.
    """
    if command not in COMMANDS:
        word = str(command)
        raise ValueError(f"command: unknown {quoted(word)}{suggestion(word, COMMANDS)}")
    parameters = parameters_of(command)
    for name in arguments:
        if name not in parameters:
            raise ValueError(f"{name}: is no argument of {command}{suggestion(name, parameters)}")
    for name, (kind, required) in parameters.items():
        if name not in arguments:
            if required:
                raise ValueError(f"{name}: is missing; {command} needs {_SAID[kind]}")
            continue
        if not _IS[kind](arguments[name]):
            raise ValueError(f"{name}: must be {_SAID[kind]}, got {quoted(repr(arguments[name]))}")
    return COMMANDS[command](text, **arguments)


def parameters_of(command: str) -> dict[str, tuple[str, bool]]:
    """Parameters of a command: the type of each, as it is annotated, and whether it is required."""
    found = list(inspect.signature(COMMANDS[command]).parameters.values())[1:]
    return {p.name: (str(p.annotation), p.default is p.empty) for p in found}


def is_number(value: Any) -> bool:
    """Whether a value of JSON is a number that a float can hold; not NaN."""
    is_real = isinstance(value, int | float) and not isinstance(value, bool)
    return is_real and abs(value) <= _LARGEST


def _is_words(value: Any) -> bool:
    return isinstance(value, dict) and all(
        isinstance(word, str) for pair in value.items() for word in pair
    )


def _is_value(value: Any, depth: int = 3) -> bool:
    if isinstance(value, list):
        return depth > 0 and all(_is_value(each, depth - 1) for each in value)
    return is_number(value) or (isinstance(value, str) and 0 < len(value) <= MAX_SAYS)


def _is_path(value: Any) -> bool:
    return isinstance(value, list) and all(
        isinstance(key, str | int) and not isinstance(key, bool) for key in value
    )


_IS: dict[str, Callable[[Any], bool]] = {
    "str": lambda value: isinstance(value, str),
    "str | None": lambda value: value is None or isinstance(value, str),
    "bool": lambda value: isinstance(value, bool),
    "float": is_number,
    "list[float]": lambda value: isinstance(value, list) and all(map(is_number, value)),
    "dict[str, str]": _is_words,
    "list[str | int]": _is_path,
    "Value": _is_value,
    "list[dict[str, Any]]": lambda value: (
        isinstance(value, list) and all(isinstance(each, dict) for each in value)
    ),
}
_SAID = {
    "list[str | int]": 'keys and indices, such as ["target", "waypoints", 2]',
    "Value": "a number, a text that is not empty, or a list of them",
    "str": "a text",
    "str | None": "a text",
    "bool": "true or false",
    "float": "a number",
    "list[float]": "a list of numbers",
    "dict[str, str]": 'sets by input, such as {"E": "ze"}',
    "list[dict[str, Any]]": "a list of mappings",
}


def _consequents(then: list[dict[str, Any]]) -> list[Consequent]:
    """Consequents from what `fuzzytrack.fuzzy.as_json` writes of them."""
    found = []
    for each in then:
        sure = each.get("confidence", 1.0)
        named = {"output", "set"} <= each.keys() <= {"output", "set", "confidence"}
        if not (named and _IS["str"](each["output"]) and _IS["str"](each["set"])):
            raise ValueError(f"then: must be {_THEN}, got {each!r:.60}")
        if not is_number(sure):
            raise ValueError(f"then: confidence must be a number, got {sure!r:.60}")
        found.append(Consequent(each["output"], each["set"], sure))
    return found


def _shape(owner: Variable, each: Mapping[str, Any]) -> FuzzySet:
    """A set as a message gives it, with the shape that it has unless one is given."""
    kinds = {"set": "str", "parameters": "list[float]", "shape": "str | None"}
    named = {"set", "parameters"} <= each.keys() <= kinds.keys()
    if not named or not all(_IS[kinds[key]](value) for key, value in each.items()):
        raise ValueError(f"shapes: must be {_SHAPES}, got {each!r:.60}")
    old = owner.sets[owner.index(each["set"])]
    return FuzzySet(old.name, each.get("shape") or old.shape, tuple(each["parameters"]))


def _mirrored(changed: EditedText, where: Mapping[str, str]) -> EditedText:
    """The text with the mirror of a rule changed to what that rule now concludes."""
    mirror = mirrored_conditions(changed.rules, where)
    if mirror == where:
        return changed
    key = frozenset(where.items())
    (rule,) = (r for r in changed.rules.rules if r.key == key)
    return set_consequents(changed, mirror, rule.consequents)
