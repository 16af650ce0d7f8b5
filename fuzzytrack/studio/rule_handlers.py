"""Commands about the rule base: edits, undo, files."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Mapping
from typing import Any

from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.specs import is_file
from fuzzytrack.studio.arguments import Arguments, renamed
from fuzzytrack.studio.complaints import Complaint
from fuzzytrack.studio.folder import Folder, FolderError
from fuzzytrack.studio.handlers import Handler
from fuzzytrack.studio.pages import Page
from fuzzytrack.studio.places import places_of
from fuzzytrack.studio.state import cell_place, rulebase_state
from fuzzytrack.studio.symmetry import DRAWN
from fuzzytrack.studio.world_handlers import scenario_state
from fuzzytrack.yamltree import quoted

__all__ = ["HANDLERS", "changed", "listed_files", "state_of"]

Answer = Mapping[str, Any]

_KIND = re.compile(r"^(rulebase|scenario)[ \t]*:", re.MULTILINE)
_KINDS = {"rulebase": "rules", "scenario": "scenario", None: "other"}
_SHARED = ("both", "apart")


def state_of(page: Page) -> dict[str, Any]:
    """The rule base of a page, and what is wrong with its text."""
    session = page.session
    opened, rules = session.texts.rules, session.reading.rules
    undo, redo = session.steps
    return {
        "version": page.version,
        "name": opened.name,
        "file": opened.name if is_file(opened.name) else None,
        "saved": session.is_saved("rules"),
        "undo": undo,
        "redo": redo,
        "text": opened.text,
        "complaints": [_complaint(rules, c) for c in session.reading.complaints["rules"]],
        "rulebase": rulebase_state(rules, places_of(opened.text)),
    }


def _complaint(rules: RuleBase, found: Complaint) -> dict[str, Any]:
    """A complaint, with the cell, rule or set that it is about."""
    where: dict[str, Any] | None = None
    path = found.path
    if found.cell and (place := cell_place(rules, found.cell)):
        where = {"cell": place}
    elif path[:1] == ("rules",) and len(path) > 1 and isinstance(path[1], int):
        where = {"rule": path[1]}
    elif len(path) > 3 and path[0] in ("inputs", "outputs") and path[2] == "sets":
        where = {"variable": path[1], "set": path[3]}
    elif len(path) > 1 and path[0] in ("inputs", "outputs"):
        where = {"variable": path[1], "set": None}
    return {
        "message": found.message,
        "line": found.line,
        "column": found.column,
        "stops": found.stops,
        "where": where,
    }


# -------------------------------------------------------------------- edits


def _edit(
    page: Page, command: str, arguments: dict[str, Any], gesture: str | None = None
) -> Answer:
    with renamed(says="text", confidence="weight", word="value", operators="value", where=None):
        also = page.session.do(command, arguments, gesture)
    page.version += 1
    return {"state": state_of(page), "also": [{"variable": v, "set": s} for v, s in also]}


def set_cell(page: Page, given: Arguments) -> Answer:
    """Change a cell of the table."""
    says, symmetric = given.text("text"), given.flag("symmetric")
    where = _where(page, given)
    return _edit(page, "cell", {"where": where, "says": says, "symmetric": symmetric})


def set_weight(page: Page, given: Arguments) -> Answer:
    """Change the confidence of a rule, or of what it concludes about one output."""
    weight = given.number("weight")
    if not 0 <= weight <= 1:
        raise ValueError(f"weight: must be within [0, 1], got {weight:g}")
    arguments = {
        "where": _rule_at(page, given) if "index" in given else _where(page, given),
        "confidence": weight,
        "symmetric": given.flag("symmetric"),
    }
    if "output" in given:
        arguments["output"] = given.text("output")
    return _edit(page, "confidence", arguments)


def _where(page: Page, given: Arguments) -> dict[str, str]:
    """Conditions of the rule of a cell, by row and column."""
    rules = page.session.reading.rules
    layout = rules.layout
    if layout is None:
        raise ValueError("row: there is none, the rules are a list, not a table; use their index")
    return {
        layout.rows: _set_at(given, "row", rules.input(layout.rows).set_names),
        layout.columns: _set_at(given, "column", rules.input(layout.columns).set_names),
    }


def _rule_at(page: Page, given: Arguments) -> dict[str, str]:
    """Conditions of a rule, by its place from 0."""
    rules = page.session.reading.rules.rules
    return dict(rules[given.whole("index", 0, len(rules) - 1)].conditions)


def _set_at(given: Arguments, name: str, sets: tuple[str, ...]) -> str:
    """A set by its name, or by its place from 0."""
    if given.is_text(name):
        return str(given.choice(name, sets))
    place: int = given.whole(name, 0, len(sets) - 1)
    return sets[place]


def set_rule(page: Page, given: Arguments) -> Answer:
    """Change the conclusions of a rule, by its place from 0."""
    arguments = {"where": _rule_at(page, given), "says": given.text("text")}
    return _edit(page, "cell", {**arguments, "symmetric": given.flag("symmetric")})


def add_rule(page: Page, given: Arguments) -> Answer:
    """Add a rule to the end of a list."""
    then = [
        {
            "output": each.text("output"),
            "set": each.text("set"),
            "confidence": each.number("confidence", 1.0),
        }
        for each in given.objects("then")
    ]
    return _edit(page, "add-rule", {"where": given.texts_by_name("if"), "then": then})


def remove_rule(page: Page, given: Arguments) -> Answer:
    """Remove a rule from a list, by its place from 0."""
    return _edit(page, "remove-rule", {"where": _rule_at(page, given)})


def set_shape(page: Page, given: Arguments) -> Answer:
    """Change a set; while it is dragged with ``draft``, which is undone as one."""
    arguments = {
        **_set_named(given),
        "parameters": given.numbers("parameters"),
        "symmetric": given.flag("symmetric"),
    }
    if "shape" in given:
        arguments["shape"] = given.choice("shape", DRAWN)
    return _edit(page, "shape", arguments, page.gesture(given.flag("draft")))


def set_shapes(page: Page, given: Arguments) -> Answer:
    """Change several sets of a variable at once, as neighbors that share a corner."""
    shapes = []
    for each in given.objects("shapes"):
        shapes.append({"set": each.text("set"), "parameters": each.numbers("parameters")})
        if "shape" in each:
            shapes[-1]["shape"] = each.choice("shape", DRAWN)
    arguments = {
        "variable": given.text("variable"),
        "shapes": shapes,
        "symmetric": given.flag("symmetric"),
        "apart": _is_apart(given),
    }
    return _edit(page, "shapes", arguments, page.gesture(given.flag("draft")))


def write_out(page: Page, given: Arguments) -> Answer:
    """Give a variable sets of its own, which it shares by an anchor."""
    return _edit(page, "write-out", {"variable": given.text("variable")})


def _is_apart(given: Arguments) -> bool:
    """Whether sets that are shared are written out first."""
    return bool(given.choice("shared", _SHARED, "both") == "apart")


def _set_named(given: Arguments) -> dict[str, Any]:
    names = {name: given.text(name) for name in ("variable", "set")}
    return {**names, "apart": _is_apart(given)}


def add_set(page: Page, given: Arguments) -> Answer:
    """Add a set, and its column or row."""
    arguments = {
        **_set_named(given),
        "shape": given.choice("shape", DRAWN),
        "parameters": given.numbers("parameters"),
    }
    if "like" in given:
        arguments["like"] = given.text("like")
    return _edit(page, "add-set", arguments)


def remove_set(page: Page, given: Arguments) -> Answer:
    """Remove a set; with ``with_rules`` its column or row too."""
    arguments = {**_set_named(given), "with_rules": given.flag("with_rules")}
    return _edit(page, "remove-set", arguments)


def rename_set(page: Page, given: Arguments) -> Answer:
    """Rename a set, in the rules too."""
    return _edit(page, "rename-set", {**_set_named(given), "name": given.text("name")})


def set_operator(page: Page, given: Arguments) -> Answer:
    """Change an operator."""
    arguments = {"operator": given.text("operator"), "word": given.text("value")}
    return _edit(page, "operator", arguments)


def set_text(page: Page, given: Arguments) -> Answer:
    """Take the whole text as it is typed; what is wrong with it is in the state."""
    page.session.replace("rules", given.text("text"))
    return changed(page)


def undo(page: Page, given: Arguments) -> Answer:
    """Undo the last change of the rule base or the scenario."""
    page.session.undo()
    return {**changed(page), "scenario": scenario_state(page)}


def redo(page: Page, given: Arguments) -> Answer:
    """Do again what was undone last."""
    page.session.redo()
    return {**changed(page), "scenario": scenario_state(page)}


def changed(page: Page) -> dict[str, Any]:
    """Answer to a change."""
    page.version += 1
    return {"state": state_of(page)}


# -------------------------------------------------------------------- files


def open_rules(page: Page, given: Arguments) -> Answer:
    """Open a shipped rule base, or a file of the folder."""
    page.session.open("rules", given.text("name"))
    return changed(page)


def save(page: Page, given: Arguments) -> Answer:
    """Save the rule base in the folder."""
    page.session.save("rules", _file_name(page, given), overwrite=given.flag("overwrite"))
    return {**changed(page), "files": listed_files(page.studio.folder)}


def _file_name(page: Page, given: Arguments) -> str:
    """Name of a file to be saved; ``.yaml`` is added where it is missing."""
    name: str = given.text("name", page.session.texts.rules.name, 100)
    return name if is_file(name) else f"{name}.yaml"


def files(page: Page, given: Arguments) -> Answer:
    """Files of the folder."""
    return {"files": listed_files(page.studio.folder)}


def drafts(page: Page, given: Arguments) -> Answer:
    """Drafts of pages that were closed before their texts were saved."""
    found = []
    for key in page.studio.closed_drafts():
        # A damaged draft is left where it is.
        with contextlib.suppress(FolderError, OSError):
            texts = page.session.draft_texts(key)
            names = {kind: text.name for kind, text in texts.items()}
            found.append({"key": key, "time": page.studio.folder.draft_time(key), **names})
    return {"drafts": found}


def restore(page: Page, given: Arguments) -> Answer:
    """Take the texts of a draft, which is then that of this page."""
    key = given.text("key", longest=32)
    if key not in page.studio.closed_drafts():
        raise ValueError(f"key: {quoted(key)}: there is no such draft, or another page has it open")
    page.session.restore(key)
    page.studio.folder.drop_draft(key)
    return {**changed(page), "scenario": scenario_state(page)}


def listed_files(folder: Folder) -> list[dict[str, Any]]:
    """Files of a folder with their kinds: rules, scenario, recording, other."""
    return [
        {"name": each.name, "size": each.size, "kind": _kind(folder, each.name)}
        for each in folder.list()
    ]


def _kind(folder: Folder, name: str) -> str:
    if not is_file(name):
        return "recording"
    try:
        found = _KIND.search(folder.open(name).text)
    except ValueError:
        return "other"
    return _KINDS[found[1] if found else None]


HANDLERS = {
    "set_cell": Handler(set_cell, ("row", "column", "text", "symmetric")),
    "set_rule": Handler(set_rule, ("index", "text", "symmetric")),
    "set_weight": Handler(set_weight, ("row", "column", "index", "weight", "output", "symmetric")),
    "add_rule": Handler(add_rule, ("if", "then")),
    "remove_rule": Handler(remove_rule, ("index",)),
    "set_shape": Handler(
        set_shape, ("variable", "set", "shape", "parameters", "shared", "symmetric", "draft")
    ),
    "set_shapes": Handler(set_shapes, ("variable", "shapes", "shared", "symmetric", "draft")),
    "write_out": Handler(write_out, ("variable",)),
    "add_set": Handler(add_set, ("variable", "set", "shape", "parameters", "shared", "like")),
    "remove_set": Handler(remove_set, ("variable", "set", "shared", "with_rules")),
    "rename_set": Handler(rename_set, ("variable", "set", "name", "shared")),
    "set_operator": Handler(set_operator, ("operator", "value")),
    "set_text": Handler(set_text, ("text",)),
    "undo": Handler(undo),
    "redo": Handler(redo),
    "open": Handler(open_rules, ("name",)),
    "save": Handler(save, ("name", "overwrite")),
    "files": Handler(files),
    "drafts": Handler(drafts),
    "restore": Handler(restore, ("key",)),
}
