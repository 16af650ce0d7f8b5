"""States of tracks that are kept outside of the array of tracks."""

from __future__ import annotations

from typing import Any, Protocol

__all__ = ["Companion"]


class Companion(Protocol):
    """What an update keeps beside the array of tracks, called between the stages of a scan.

    A session has one of its own, and pickles it. `work` are the arrays of the session, see
    `fuzzytrack.scan.workspace.Workspace`.
    """

    def predict(self, work: Any) -> None:
        """Before pairs of tracks and plots are looked for."""

    def correct(self, work: Any) -> None:
        """After each track has got its plot, before it is updated."""

    def end(self, work: Any) -> None:
        """After tracks were updated; some have ended."""

    def start(self, work: Any) -> None:
        """After new tracks have started."""

    def copy(self) -> Companion:
        """As it is now, to go back to when a scan fails."""
