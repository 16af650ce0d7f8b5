"""Papers by name, and the function that rebuilds the experiments of one."""

from __future__ import annotations

import importlib
from collections.abc import Sequence

from fuzzytrack.papers.reproduction import Reproduction
from fuzzytrack.simulation.noise import check_runs
from fuzzytrack.tasks import Progress, part

__all__ = ["PAPERS", "reproduce", "reproduce_all"]

#: Papers by name, and the modules that rebuild their experiments.
PAPERS = {
    "alwagih-abdulla": "alwagih_abdulla",
    "kim-lee": "kim_lee",
    "llinas": "llinas.reproduction",
    "njonjo": "njonjo",
    "zhang-jiang": "zhang_jiang",
}

# About how long each takes, relative to the others.
_COST = {"alwagih-abdulla": 5, "kim-lee": 1, "llinas": 8, "njonjo": 9, "zhang-jiang": 6}


def reproduce(
    name: str, runs: int | None = None, seed: int = 0, progress: Progress | None = None
) -> Reproduction:
    """Rebuild the experiments of a paper.

    Parameters
    ----------
    name : str
        One of `PAPERS`.
    runs : int, optional
        Monte Carlo runs of each experiment; as many as the paper's unless given.
    seed : int
        Seed of the noise.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    Reproduction

    Raises
    ------
    ValueError
        If there is no such paper, or a number is out of range.
    """
    if name not in PAPERS:
        raise ValueError(f"name: unknown paper {name!r}; one of {', '.join(PAPERS)}")
    module = importlib.import_module(f"fuzzytrack.papers.{PAPERS[name]}")
    count = module.RUNS if runs is None else runs
    check_runs(count, seed)
    found: Reproduction = module.reproduce(count, seed, progress or (lambda share: None))
    return found


def reproduce_all(
    names: Sequence[str],
    runs: int | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> list[Reproduction]:
    """Rebuild the experiments of several papers; parameters as for `reproduce`."""
    watch = progress or (lambda share: None)
    found, before, whole = [], 0.0, sum(_COST[name] for name in names)
    for name in names:
        after = before + _COST[name] / whole
        found.append(reproduce(name, runs, seed, part(watch, before, after)))
        before = after
    return found
