"""A session: a rule base and a scenario as texts, their edits, files and surfaces.

The texts are the one truth. An edit makes a new text, from which the rule base is read; a text that
does not load is kept, with what is wrong with it, and so is the last rule base that did load, to be
drawn. There is nothing of the web in it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, astuple, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from fuzzytrack.errors import FileError, ScenarioError
from fuzzytrack.fuzzy.loading import (
    load_rulebase,
    loads_rulebase,
    rulebase_path,
    shipped_rulebases,
)
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.fuzzy.text_edits import EditedText
from fuzzytrack.json_types import plain
from fuzzytrack.schedulers.review import explanation
from fuzzytrack.simulation.scenario import Scenario
from fuzzytrack.simulation.scenario_files import loads_scenario, scenario_path, shipped_scenarios
from fuzzytrack.studio.commands import OF_ANY_TEXT, edited, is_number
from fuzzytrack.studio.complaints import Complaint, complaint_of, complaints_of_rules
from fuzzytrack.studio.folder import Folder, FolderError
from fuzzytrack.studio.history import History, OpenText, Texts
from fuzzytrack.studio.limits import MOST_SCANS
from fuzzytrack.studio.surfaces import Surfaces, surfaces
from fuzzytrack.yamltree import MAX_BYTES, Document, Node, quoted
from fuzzytrack.yamltree import Mapping as MappingNode

__all__ = ["KINDS", "Reading", "Session"]

#: Texts of a session.
KINDS = ("rules", "scenario")
_WORDS = {"rules": "rule base", "scenario": "scenario"}


@dataclass(frozen=True)
class Reading:
    """What was read from the texts of a session.

    Attributes
    ----------
    rules : RuleBase
        That of the text, or of the last text that loaded.
    scenario : Scenario
        Likewise.
    complaints : dict of str to tuple of Complaint
        What is wrong with each text, by `KINDS`.
    """

    rules: RuleBase
    scenario: Scenario
    complaints: dict[str, tuple[Complaint, ...]]

    @cached_property
    def system(self) -> FuzzySystem:
        """The fuzzy system of the rule base."""
        return FuzzySystem(self.rules)


class Session:
    """Texts of a rule base and a scenario, edited, undone, kept, and what follows from them.

    Parameters
    ----------
    folder : Folder, optional
        Where files are; without it none can be opened or saved.
    rules, scenario : str
        What is open first: a shipped name, or a file of the folder.
    key : str
        Name of the draft, up to 32 digits and small letters.

    Raises
    ------
    FileError, FolderError
        If one of them cannot be opened.
    """

    def __init__(
        self,
        folder: Folder | None = None,
        rules: str = "stiffness-damping",
        scenario: str = "turn",
        key: str = "0",
    ) -> None:
        self.folder = folder
        self.key = key
        # Texts of files as they were opened or saved last, and versions that were saved here.
        self._saved: dict[str, str] = {}
        self._own: dict[str, set[str]] = {}
        texts = Texts(self._opened("rules", rules), self._opened("scenario", scenario))
        for each in (texts.rules, texts.scenario):
            if each.version:
                self._saved[each.name] = each.text
        self._history = History(texts)
        first = load_rulebase("stiffness-damping")
        self._reading = Reading(first, self._scenario_of("turn", _shipped("scenario", "turn")), {})
        self._read(None)
        self._draft: str | None = None

    # ---------------------------------------------------------------- texts

    @property
    def texts(self) -> Texts:
        """The texts as they are."""
        return self._history.now

    def check_loads(self, kind: str) -> None:
        """Refuse to go on where a text does not load: `reading` then has an older one.

        Raises
        ------
        FileError, ValueError
            With what is wrong with it.
        """
        self._open_text(kind)
        broken = [each for each in self._reading.complaints[kind] if each.stops]
        if broken:
            raise FileError(
                f"the text of the {_WORDS[kind]} does not load: {broken[0].message}; mend it "
                "first, or undo"
            )

    @property
    def steps(self) -> tuple[int, int]:
        """How many edits can be undone, and redone."""
        return self._history.steps

    @property
    def reading(self) -> Reading:
        """What was read from them last."""
        return self._reading

    def do(
        self, command: str, arguments: Mapping[str, Any], gesture: str | None = None
    ) -> tuple[tuple[str, str], ...]:
        """Edit a text.

        Parameters
        ----------
        command : str
            A key of `fuzzytrack.studio.commands.COMMANDS`.
        arguments : mapping
            Its arguments, values of JSON by name. Those of any text also take ``kind``, one of
            `KINDS`.
        gesture : str, optional
            Name of a drag: its edits are undone together.

        Returns
        -------
        tuple of (str, str)
            Sets that were changed along, as (variable, set).

        Raises
        ------
        FileError, ValueError
            If the edit cannot be made; nothing has changed. See
            `fuzzytrack.studio.complaints.complaint_of`.
        """
        rest = dict(arguments)
        kind = rest.pop("kind", None) if command in OF_ANY_TEXT else "rules"
        old = self._open_text(kind)
        self.check_loads(kind)
        new = edited(old.text, command, rest)
        if not isinstance(new, EditedText):
            self._check(kind, old.name, new)
            self._put(kind, replace(old, text=new), gesture)
            return ()
        self._put(kind, replace(old, text=str(new)), gesture, new.rules)
        return new.also

    def replace(self, kind: str, text: str, gesture: str | None = None) -> None:
        """Replace a whole text, which need not load.

        Raises
        ------
        ValueError
            If there is no such kind, or the text is longer than 128 KiB.
        """
        if len(text.encode("utf-8", "surrogatepass")) > MAX_BYTES:
            raise ValueError(f"text: is longer than {MAX_BYTES // 1024} KiB; make it shorter")
        self._put(kind, replace(self._open_text(kind), text=text), gesture)

    def edit_scenario(self, text: str, gesture: str | None = None) -> None:
        """Replace the text of the scenario by another one that loads.

        Parameters
        ----------
        text : str
        gesture : str, optional
            As for `do`.

        Raises
        ------
        ScenarioError, ValueError
            If it does not, or is too long; nothing has changed.
        """
        self._scenario_of(self.texts.scenario.name, text)
        self.replace("scenario", text, gesture)

    def undo(self) -> bool:
        """Undo the last edit of either text; False if there is none."""
        before = self.texts
        return self._history.undo() and self._read(before)

    def redo(self) -> bool:
        """Make the edit again that was undone last; False if there is none."""
        before = self.texts
        return self._history.redo() and self._read(before)

    # ---------------------------------------------------------------- files

    def open(self, kind: str, name: str) -> None:
        """Open a shipped rule base or scenario, or a file of the folder, in place of the text.

        Raises
        ------
        FileError, FolderError, ValueError
            If there is no such kind, name or file.
        """
        self._open_text(kind)
        new = self._opened(kind, name)
        self._put(kind, new, None)
        if new.version:
            self._saved[name] = new.text

    def save(self, kind: str, name: str | None = None, *, overwrite: bool = False) -> None:
        """Save a text in the folder, also one that does not load.

        Parameters
        ----------
        kind : {"rules", "scenario"}
        name : str, optional
            Name of the file; the one that was opened unless given.
        overwrite : bool
            Whether a file that exists, or that was changed since it was opened, is replaced.

        Raises
        ------
        FolderError
            See `Folder.save`.
        """
        old = self._open_text(kind)
        name = old.name if name is None else name
        versions = self._own.setdefault(name, set())
        known = {*versions, old.version} - {""} if name == old.name else versions
        new = self._folder().save(name, old.text, known, overwrite=overwrite)
        versions.add(new)
        self._saved[name] = old.text
        saved = replace(old, name=name, version=new)
        self._history.amend(replace(self.texts, **{kind: saved}))

    def is_saved(self, kind: str) -> bool:
        """Whether a text is that of its file, or of what was shipped."""
        open_text = self._open_text(kind)
        return self.saved_text(kind) == open_text.text

    def saved_text(self, kind: str, name: str | None = None) -> str | None:
        """Text as it was last saved or opened; None if it never was.

        Parameters
        ----------
        kind : {"rules", "scenario"}
        name : str, optional
            Of what is shipped, or of a file; what is open unless given.
        """
        return self._text_as_saved(kind, self._open_text(kind).name if name is None else name)

    def autosave(self) -> bool:
        """Write a draft of both texts while one is not saved, and remove it when both are.

        Returns
        -------
        bool
            Whether there is a new draft; there is none where they have not changed since, or
            without a folder.
        """
        if self.folder is None:
            return False
        if all(map(self.is_saved, KINDS)):
            self.folder.drop_draft(self.key)
            self._draft = None
            return False
        draft = json.dumps({kind: asdict(self._open_text(kind)) for kind in KINDS})
        if draft == self._draft:
            return False
        self.folder.save_draft(self.key, draft)
        self._draft = draft
        return True

    def restore(self, key: str) -> None:
        """Take the texts of a draft; this can be undone.

        Raises
        ------
        FolderError
            If there is no such draft, or it is none that a session has written.
        """
        found = self.draft_texts(key)
        before = self.texts
        self._history.put(Texts(**found))
        self._read(before)

    def draft_texts(self, key: str) -> dict[str, OpenText]:
        """Texts of a draft, by their kinds.

        Raises
        ------
        FolderError
            As for `restore`.
        """
        try:
            draft = json.loads(self._folder().draft(key))
            found = {kind: OpenText(**draft[kind]) for kind in KINDS}
            words = [word for each in found.values() for word in astuple(each)]
            if not all(isinstance(w, str) and len(w.encode()) <= MAX_BYTES for w in words):
                raise ValueError("a text is too long, or none")
        except FolderError:
            raise
        except (ValueError, TypeError, KeyError, RecursionError) as error:
            raise FolderError(f"draft {key}: is damaged ({error}); remove it") from None
        return found

    # ---------------------------------------------------------------- what follows

    def explain(self, at: Mapping[str, float]) -> dict[str, Any]:
        """Rules that fire at a point, outputs there and gains behind them, as JSON prints it.

        Parameters
        ----------
        at : mapping
            A number for each input.

        Raises
        ------
        ValueError
            If a number is missing, or there is none.
        """
        names = self._reading.rules.input_names
        if set(at) != set(names) or not all(map(is_number, at.values())):
            got = ", ".join(f"{name}={value}" for name, value in at.items())
            raise ValueError(
                f"at: must give a number for {', '.join(names)}; got {got or 'nothing'}"
            )
        point = {name: float(at[name]) for name in names}
        found: dict[str, Any] = plain(explanation(self._reading.system, point))
        return found

    def surfaces(
        self,
        names: Sequence[str],
        points: int = 41,
        *,
        inputs: Sequence[str] | None = None,
        at: Mapping[str, float] | None = None,
        less: str | None = None,
    ) -> Surfaces:
        """Surfaces of outputs and gains, see `fuzzytrack.studio.surfaces.surfaces`.

        Parameters
        ----------
        names, points, inputs, at
            As there.
        less : str, optional
            What is subtracted: ``"saved"``, the rule base as it was last saved or opened, or the
            name of a shipped one or of a file.

        Raises
        ------
        ValueError
            If an argument is not one of the allowed ones.
        """
        other = None if less is None else self._other(less)
        return surfaces(self._reading.system, names, points, inputs=inputs, at=at, less=other)

    # ---------------------------------------------------------------- inside

    def _open_text(self, kind: str) -> OpenText:
        if kind not in KINDS:
            raise ValueError(f"kind: must be one of {', '.join(KINDS)}, got {quoted(str(kind))}")
        found: OpenText = getattr(self.texts, kind)
        return found

    def _put(
        self, kind: str, new: OpenText, gesture: str | None, rules: RuleBase | None = None
    ) -> None:
        before = self.texts
        self._open_text(kind)
        self._history.put(replace(before, **{kind: new}), gesture)
        self._read(before, rules)

    def _read(self, before: Texts | None, rules: RuleBase | None = None) -> bool:
        """Read the texts that are others than before; `rules` if they have been read already."""
        now, last = self.texts, self._reading
        if before is None or now.rules != before.rules:
            file = self._file(now.rules.name)
            rules, complaints = complaints_of_rules(now.rules.text, file, rules)
            found = {**last.complaints, "rules": complaints}
            last = Reading(rules or last.rules, last.scenario, found)
        if before is None or now.scenario != before.scenario:
            scenario = last.scenario
            wrong: tuple[Complaint, ...] = ()
            try:
                scenario = self._scenario_of(now.scenario.name, now.scenario.text)
            except Exception as error:  # a plug-in may raise anything
                wrong = (complaint_of(error, now.scenario.text),)
            last = Reading(last.rules, scenario, {**last.complaints, "scenario": wrong})
        self._reading = last
        return True

    def _check(self, kind: str, name: str, text: str) -> None:
        """Check that a text loads."""
        if kind == "rules":
            loads_rulebase(text, self._file(name))
        else:
            self._scenario_of(name, text)

    def _scenario_of(self, name: str, text: str) -> Scenario:
        file = self._file(name)
        self._check_files(Document(text, file, failure=ScenarioError))
        found = loads_scenario(text, file)
        if len(found.time) > MOST_SCANS:
            raise ScenarioError(
                f"{len(found.time)} scans; at most {MOST_SCANS} here: make the period longer"
            )
        return found

    def _check_files(self, document: Document) -> None:
        """Check that a scenario names no files but those of the folder."""
        for node, word in _named_files(document):
            try:
                self._folder().place(word.strip())
            except FolderError as error:
                raise document.error(node, str(error)) from None

    def _opened(self, kind: str, name: str) -> OpenText:
        if name in (shipped_rulebases() if kind == "rules" else shipped_scenarios()):
            return OpenText(name, _shipped(kind, name))
        found = self._folder().open(name)
        return OpenText(name, found.text, found.version)

    def _text_as_saved(self, kind: str, name: str) -> str | None:
        if name in self._saved:
            return self._saved[name]
        shipped = shipped_rulebases() if kind == "rules" else shipped_scenarios()
        return _shipped(kind, name) if name in shipped else None

    def _other(self, name: str) -> FuzzySystem:
        if name == "saved":
            name = self.texts.rules.name
            found = self.saved_text("rules")
            if found is None:
                raise ValueError("less: the rule base has not been saved yet; save it, or name one")
            text = found
        elif name in shipped_rulebases():
            text = _shipped("rules", name)
        else:
            # Not opened: a later save must still see that the file has been changed.
            text = self._folder().open(name).text
        rules, complaints = complaints_of_rules(text, self._file(name))
        if rules is None:
            raise ValueError(f"less: {name} does not load: {complaints[0].message}")
        return FuzzySystem(rules)

    def _folder(self) -> Folder:
        if self.folder is None:
            raise FolderError("folder: none was given at the start, so no file can be used")
        return self.folder

    def _file(self, name: str) -> str:
        """Path for messages, in whose folder a scenario looks for files."""
        return name if self.folder is None else str(self.folder.path / Path(name).name)


def _shipped(kind: str, name: str) -> str:
    path = rulebase_path(name) if kind == "rules" else scenario_path(name)
    return path.read_bytes().decode("utf-8")


def _named_files(document: Document) -> Iterator[tuple[Node, str]]:
    """Files that a scenario names, that of a target and those of trackers, each with its node."""
    root = document.root
    entries = root.entries if isinstance(root, MappingNode) else {}
    if "target" in entries:
        target = entries["target"][1]
        if isinstance(target, MappingNode) and "file" in target.entries:
            node = target.entries["file"][1]
            yield node, getattr(node, "text", "")
    if "trackers" in entries:
        for node in getattr(entries["trackers"][1], "items", ()):
            for word in re.split("[:=]", getattr(node, "text", "")):
                if any(mark in word.lower() for mark in (".yaml", ".yml", "/", "\\")):
                    yield node, word
