"""The text of a rule base under another name: a copy to be edited, with its comments."""

from __future__ import annotations

from dataclasses import replace

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.fuzzy.saving import SCHEMA_LINE, yaml_text
from fuzzytrack.yamltree import Document, quoted

__all__ = ["copied_rulebase"]

_LANGUAGE_SERVER = "# yaml-language-server:"


def copied_rulebase(text: str, name: str, file: str = "<text>") -> str:
    """Text of a rule base under another name, which names its schema in its first line.

    Parameters
    ----------
    text : str
        A rule base in YAML.
    name : str
        Name of the copy, not empty.
    file : str
        Name for messages, and in the comment that says what it is a copy of.

    Returns
    -------
    str
        The text with its comments. A line on what it was made from is added.

    Raises
    ------
    RuleBaseError
        If the text is no rule base, or a rule base cannot have this name.
    """
    before = loads_rulebase(text, file)
    body = text.removeprefix("\ufeff")
    document = Document(body, file)
    _, node = document.entries(document.root, "the rule base")["name"]
    end = "\r\n" if "\r\n" in body else "\n"
    body = body[: node.start] + yaml_text(name) + body[node.end :]
    first, _, rest = body.partition(end)
    if first.startswith(_LANGUAGE_SERVER):
        body = rest
    copy = f"{SCHEMA_LINE}{end}# A copy of {before.name}, to be edited.{end}{body}"
    if loads_rulebase(copy, file) != replace(before, name=name):
        raise RuleBaseError(f"{file}: cannot be copied under the name {quoted(name)}")
    return copy
