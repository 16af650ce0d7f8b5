"""Texts of a session, with those before and after, for undo and redo."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["History", "OpenText", "Texts"]

MAX_STATES = 1000
# Characters in all states; texts that several states have are one object, and count once.
MAX_CHARACTERS = 16 * 1024 * 1024


@dataclass(frozen=True)
class OpenText:
    """A text, and what it was opened as.

    Attributes
    ----------
    name : str
        Name of a file in the folder, or of a shipped rule base or scenario (without suffix).
    text : str
    version : str
        Version of the file that the text was made from; empty if it was made from none.
    """

    name: str
    text: str
    version: str = ""


@dataclass(frozen=True)
class Texts:
    """The texts of a session at one time."""

    rules: OpenText
    scenario: OpenText


class History:
    """The texts of a session in the order of its edits.

    Parameters
    ----------
    first : Texts
        The texts at the beginning.
    """

    def __init__(self, first: Texts) -> None:
        self._states = [first]
        self._at = 0
        self._gesture: str | None = None

    @property
    def now(self) -> Texts:
        """The texts as they are."""
        return self._states[self._at]

    @property
    def steps(self) -> tuple[int, int]:
        """How many edits can be undone, and redone."""
        return self._at, len(self._states) - 1 - self._at

    def put(self, texts: Texts, gesture: str | None = None) -> None:
        """Add the texts after an edit; what was undone can then no longer be redone.

        Parameters
        ----------
        texts : Texts
        gesture : str, optional
            Edits in a row with the same name, as a drag makes them, are undone together.
        """
        if texts == self.now:
            return
        joined = gesture is not None and gesture == self._gesture
        del self._states[self._at + 1 :]
        if joined:
            self._states[-1] = texts
        else:
            self._states.append(texts)
        self._gesture = gesture
        while len(self._states) > 2 and self._is_full():
            del self._states[0]
        self._at = len(self._states) - 1

    def amend(self, texts: Texts) -> None:
        """Put texts in the place of those that are, which is no edit: after they were saved."""
        self._states[self._at] = texts
        self._gesture = None

    def undo(self) -> bool:
        """Go back by one edit; False if there is none."""
        return self._go(-1)

    def redo(self) -> bool:
        """Make the edit again that was undone last; False if there is none."""
        return self._go(1)

    def _go(self, step: int) -> bool:
        self._gesture = None
        if not 0 <= self._at + step < len(self._states):
            return False
        self._at += step
        return True

    def _is_full(self) -> bool:
        if len(self._states) > MAX_STATES:
            return True
        texts = (text for state in self._states for text in (state.rules, state.scenario))
        return sum(len(t) for t in {id(o.text): o.text for o in texts}.values()) > MAX_CHARACTERS
