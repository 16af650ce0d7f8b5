"""Commands that do what is on the page of the studio."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

__all__ = ["testbed_command"]


def testbed_command(scenario: str, trackers: Sequence[str], runs: int, seed: int) -> str:
    """Command that gives the same numbers as a Monte Carlo experiment of the page.

    Parameters
    ----------
    scenario : str
        Name of a shipped one, or file.
    trackers : sequence of str
        As users write them.
    runs, seed : int
    """
    words = ["fuzzytrack", "testbed", scenario, "--trackers", ",".join(trackers)]
    return shlex.join([*words, "--runs", str(runs), "--seed", str(seed)])
