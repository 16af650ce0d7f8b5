"""Changes of the text of a rule base that leave the rest of it as it is, byte for byte.

`fuzzytrack.fuzzy.rule_edits`, `set_edits` and `shape_edits` use it.
"""

from __future__ import annotations

from collections.abc import Iterable

from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.fuzzy.reader import Reader
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.yamledits import DocumentEdits
from fuzzytrack.yamltree import Mapping, Node

__all__ = ["EditedText", "TextEdits"]


class EditedText(str):
    """The text of a rule base after a change; otherwise an ordinary string.

    Parameters
    ----------
    text : str
        The text.
    rules : RuleBase
        The rule base that has been read from it.
    also : tuple of (str, str)
        Sets that were changed along, as (variable, set): those that share their text by an anchor
        with the one that was to be changed.
    """

    rules: RuleBase
    also: tuple[tuple[str, str], ...]

    def __new__(
        cls, text: str, rules: RuleBase, also: Iterable[tuple[str, str]] = ()
    ) -> EditedText:
        """Make the text; ``str`` is filled when it is made, not in ``__init__``."""
        edited = super().__new__(cls, text)
        edited.rules = rules
        edited.also = tuple(also)
        return edited


class TextEdits(DocumentEdits):
    """Replacements in the text of a rule base, collected and then made at once.

    Parameters
    ----------
    text : str
        A rule base in YAML.
    file : str
        Name for messages.

    Attributes
    ----------
    reader : Reader
    before : RuleBase
        The rule base of the text.

    Raises
    ------
    RuleBaseError
        If the text is no rule base.
    """

    def __init__(self, text: str, file: str) -> None:
        super().__init__(text, file)
        self._file = file
        self.reader = Reader(self.document)
        self.before = self.reader.rulebase()

    # ---------------------------------------------------------------- places

    def variable(self, name: str) -> Node:
        """Value of an input or output, by name."""
        role = "inputs" if name in self.before.input_names else "outputs"
        return self.field(role, name)

    def sets(self, name: str) -> Mapping:
        """Sets of a variable; those of two variables that share them have the same `entries`."""
        node = self.document.entries(self.variable(name), name)["sets"][1]
        assert isinstance(node, Mapping)  # the text has been read as a rule base
        return node

    # ---------------------------------------------------------------- the result

    def loaded(self) -> tuple[str, RuleBase]:
        """Text with the changes made, and the rule base that is read from it.

        Raises
        ------
        RuleBaseError
            If the changed text is no rule base; the place is one in the changed text.
        """
        text = self.changed()
        return text, loads_rulebase(text, self._file)

    def result(
        self, expected: RuleBase, node: Node, what: str, also: Iterable[tuple[str, str]] = ()
    ) -> EditedText:
        """Text with the changes made, if it is read as the rule base that is expected.

        Parameters
        ----------
        expected : RuleBase
        node : Node
            What was changed, for the place in a message.
        what : str
            What was to be changed, for messages.
        also : iterable of (str, str)
            See `EditedText`.

        Raises
        ------
        RuleBaseError
            If the changed text is no rule base, or another one.
        """
        text, after = self.loaded()
        if after != expected:
            raise self.document.error(
                node,
                f"{what} would change other parts too, which share this text by an anchor; "
                "write them out first",
            )
        return EditedText(text, after, also)
