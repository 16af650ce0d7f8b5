"""Shapes of fuzzy sets changed in the text of a rule base; all else in the text stays as it is.

Sets that variables share by an anchor (``sets: &seven``, ``sets: *seven``) are changed for all of
them, and the result says so in `also`; or, with ``apart=True``, they are written out first.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.anchors import write_out
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.numbers import written
from fuzzytrack.fuzzy.text_edits import EditedText, TextEdits
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.yamltree import Mapping, Scalar, quoted
from fuzzytrack.yamltree import Sequence as ListNode

__all__ = ["set_shape", "set_shapes"]


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
        In the units of the variable, in the order of `fuzzytrack.fuzzy.shapes.SHAPES`. Numbers
        that stay are left as they are written.
    shape : str, optional
        A key of `fuzzytrack.fuzzy.shapes.SHAPES`; the shape that it has unless given.
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
    >>> from fuzzytrack.fuzzy.shape_edits import set_shape
    >>> text = rulebase_path("stiffness-damping").read_text(encoding="utf-8")
    >>> edited = set_shape(text, "E", "ze", [-0.15, 0, 0.15])
    >>> edited.also
    (('dE', 'ze'),)
    """
    if apart:
        text = write_out(text, variable, set_name, file)
    edits = TextEdits(text, file)
    owner = edits.before.variable(variable)
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
    owner = edits.before.variable(variable)
    names = [each.name for each in new]
    if len(set(names)) < len(names):
        doubled = next(name for name in names if names.count(name) > 1)
        raise RuleBaseError(f"sets: {quoted(doubled)} is named twice; give each set once")
    return _with_shapes(edits, owner, new)


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
    for was, now in zip(edits.before.variables, after.variables, strict=True):
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
    order = [(v.name, s.name) for v in after.variables for s in v.sets]
    return EditedText(text, after, [p for p in order if p in shapes and p not in wanted])


def _alike(a: FuzzySet, b: FuzzySet) -> bool:
    return (a.shape, a.parameters) == (b.shape, b.parameters)
