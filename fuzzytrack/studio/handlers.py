"""What answers a command of the page: a function, and the arguments that it takes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from fuzzytrack.studio.arguments import Arguments
from fuzzytrack.studio.messages import Layers
from fuzzytrack.studio.pages import Page
from fuzzytrack.yamltree import quoted, suggestion

__all__ = ["Handler", "Later", "Result"]


@dataclass(frozen=True)
class Later:
    """An answer that takes long: later commands do not wait for it.

    Attributes
    ----------
    work : callable
        Gives the answer; it reads nothing that a command may change.
    """

    work: Callable[[], Mapping[str, Any] | Layers]


#: Answer to a command.
Result = Mapping[str, Any] | Layers | Later


@dataclass(frozen=True)
class Handler:
    """A command.

    Attributes
    ----------
    function : callable
        Called with the page and the arguments, when all commands before have been answered, or have
        left their answer for later.
    names : tuple of str
        Arguments that it takes.
    """

    function: Callable[[Page, Arguments], Result]
    names: tuple[str, ...] = ()

    def __call__(self, page: Page, given: Mapping[str, Any]) -> Result:
        """Do the command.

        Raises
        ------
        ValueError
            If there is an argument that it does not take, or one does not fit.
        """
        for name in given:
            if name not in self.names:
                allowed = f"{suggestion(name, self.names)}" if self.names else "; it takes none"
                raise ValueError(f"unknown argument {quoted(name)}{allowed}")
        return self.function(page, Arguments(given))
