"""Sets that variables of a rule base share by an anchor, written out in its text."""

from __future__ import annotations

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.saving import shape_text, word_text
from fuzzytrack.fuzzy.text_edits import EditedText, TextEdits
from fuzzytrack.yamltree import MAX_DEPTH, Mapping, Node, Sequence

__all__ = ["write_out"]


def write_out(
    text: str, variable: str, set_name: str | None = None, file: str = "<text>"
) -> EditedText:
    """Write out the sets of a variable that shares them by an anchor, so that they are its own.

    Parameters
    ----------
    text : str
        A rule base in YAML.
    variable : str
        Name of an input or output.
    set_name : str, optional
        A set whose shape is to be its own as well.
    file : str
        Name for messages.

    Returns
    -------
    EditedText
        Text of an equal rule base: the variable has its sets for itself, and the others share
        what they shared. Where the variable has the anchor, the first alias takes it over. The
        same text if nothing is shared.

    Raises
    ------
    RuleBaseError
        If the text is no rule base, it has no such variable or set, or the sets cannot be written
        in the place of an alias.
    """
    first = TextEdits(text, file).before
    owner = first.variable(variable)
    if set_name is not None:
        owner.index(set_name)
    for _ in range(MAX_DEPTH):
        edits = TextEdits(text, file)
        node = next((n for n in _path(edits, variable, set_name) if _is_shared(edits, n)), None)
        if node is None:
            return EditedText(text, edits.before)
        if node.alias and len(_aliases(edits, node)) > 1:
            _put_copy(edits, node, keep_anchor=False)
        else:
            _pass_on(edits, _source(edits, node))
        text = edits.result(edits.before, node, f"writing out the sets of {variable}")
    raise RuleBaseError(f"{file}: the sets of {variable} cannot be written out; do it by hand")


def _path(edits: TextEdits, variable: str, set_name: str | None) -> list[Node]:
    """Nodes from a variable down to its sets, or to the parameters of one of them."""
    sets = edits.sets(variable)
    path: list[Node] = [edits.variable(variable), sets]
    if set_name is not None:
        shape = sets.entries[set_name][1]
        assert isinstance(shape, Mapping)
        path += [shape, *(value for _, value in shape.entries.values())]
    return path


def _is_shared(edits: TextEdits, node: Node) -> bool:
    return node.alias or (node.anchored and bool(_aliases(edits, node)))


def _aliases(edits: TextEdits, node: Node) -> list[Node]:
    name = edits.anchor(node)
    return [
        other for other in edits.all_nodes(keys=True) if other.alias and edits.anchor(other) == name
    ]


def _source(edits: TextEdits, node: Node) -> Node:
    """The node that has the anchor, for itself and for its aliases."""
    name = edits.anchor(node)
    nodes = edits.all_nodes(keys=True)
    return next(n for n in nodes if n.anchored and edits.anchor(n) == name)


def _pass_on(edits: TextEdits, node: Node) -> None:
    """Give the anchor of a node to the first of its aliases, if there are several."""
    first, *others = _aliases(edits, node)
    _put_copy(edits, first, keep_anchor=bool(others))
    start, end = node.start, edits.content(node)
    if edits.text[end : end + 1] in ("\r", "\n", "#"):
        # The content begins on the next line: no blank is left at the end of this one.
        end = node.start + len(edits.text[start:end].rstrip())
        start = len(edits.text[:start].rstrip(" "))
    edits.replace(start, end, "")


def _put_copy(edits: TextEdits, alias: Node, *, keep_anchor: bool) -> None:
    """Write what an alias refers to in its place."""
    name = edits.anchor(alias)
    source = _source(edits, alias)
    start = edits.content(source)
    mark = f"&{name}" if keep_anchor else ""
    if not isinstance(source, Mapping | Sequence) or source.flow:
        copy = edits.current(start, source.end, anchors=False)
        edits.replace(alias.start, alias.end, f"{mark} {copy}".strip())
        return
    parent = _block_parent(edits, alias)
    if parent is None:
        edits.replace(alias.start, alias.end, f"{mark} {_in_braces(edits, alias)}".strip())
        return
    start = edits.start_of(source)
    old = edits.margin_at(start)
    new = edits.margin_at(parent) + "  "
    lines = edits.current(start, source.end, anchors=False).split("\n")
    moved = [
        new + lines[0],
        *(new + line[min(old.count(" "), _indent(line)) :] for line in lines[1:]),
    ]
    before = len(edits.text[: alias.start].rstrip(" "))
    edits.replace(before, alias.end, f" {mark}" if mark else "")
    place = edits.end_of_line(alias.end)
    edits.replace(place, place, edits.line_end + "\n".join(moved))


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip(" "))


def _block_parent(edits: TextEdits, alias: Node) -> int | None:
    """Where the key before an alias starts, if it stands in a mapping in block style."""
    for node in edits.all_nodes():
        if isinstance(node, Mapping) and not node.flow and not node.alias:
            for key, value in node.entries.values():
                if value.start == alias.start:
                    return key.start
    return None


def _in_braces(edits: TextEdits, alias: Node) -> str:
    """The sets that an alias refers to, on one line."""
    for variable in edits.before.variables:
        if edits.sets(variable.name).start == alias.start:
            pairs = (f"{word_text(s.name)}: {shape_text(s)}" for s in variable.sets)
            return f"{{{', '.join(pairs)}}}"
    raise edits.document.error(
        alias, "what this alias refers to cannot be written in its place; write it out by hand"
    )
