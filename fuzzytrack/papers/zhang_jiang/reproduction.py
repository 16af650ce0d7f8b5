"""The numbers of the paper, and the experiment that it does not describe, rebuilt."""

from __future__ import annotations

from fuzzytrack.papers.reproduction import Reproduction
from fuzzytrack.papers.zhang_jiang import experiment
from fuzzytrack.papers.zhang_jiang.theory import gates_picture, theory_rows
from fuzzytrack.papers.zhang_jiang.vessels import Traffic
from fuzzytrack.tasks import Progress

__all__ = ["RUNS", "TRAFFIC", "reproduce"]

#: Seeds of the experiment.
RUNS = 5
#: Its vessels.
TRAFFIC = Traffic()


def reproduce(runs: int, seed: int, progress: Progress) -> Reproduction:
    """Rebuild tables and experiment; see `fuzzytrack.papers.reproduce`."""
    rows = (*theory_rows(), *experiment.experiment_rows(TRAFFIC, runs, seed, progress))
    progress(1.0)
    return Reproduction(
        paper="zhang-jiang",
        title="Zhang & Jiang: improved α-β filter for vessel traffic services",
        rows=rows,
        notes=(
            "Table 1 cannot be reproduced: noise, trajectory, gains, process noise, run length and "
            "units are not given. The experiment with 200 vessels is ours; its published numbers "
            "are those of an independent reconstruction.",
            "The gate has no room for the error of the plot itself; it works because the size of a "
            "plot is large against its noise.",
            "With 30 steps of quality the lag behind a vessel that turns outgrows its gate, from N "
            "of about 12 on, and the track is lost; QualityGains stops at 10 by default.",
            "A new track starts at once where one is lost, so the errors hide the losses: count "
            "breaks.",
        ),
        pictures={"gains-and-gates": gates_picture},
    )
