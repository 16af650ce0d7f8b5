"""Limits of what a page may ask for, and the messages with which more is refused."""

from __future__ import annotations

__all__ = [
    "LIMITS", "MESSAGE_BYTES", "MOST_PLOTS", "MOST_POINTS", "MOST_RUNS", "MOST_SCANS",
    "MOST_SESSIONS", "RESULT_BYTES", "SECONDS", "SILENCE", "WAITING", "check_runs_fit", "run_bytes",
]  # fmt: skip

#: Bytes of one message from the page; a longer one ends the connection.
MESSAGE_BYTES = 2**20
#: Monte Carlo runs of one job.
MOST_RUNS = 100_000
#: Bytes of the errors that are kept, of the last jobs of all pages.
RESULT_BYTES = 2**30
#: Plots of one file.
MOST_PLOTS = 1_000_000
#: Scans of a scenario; files may have more, which would fill the memory of a few pages.
MOST_SCANS = 100_000
#: Points of a surface on each axis.
MOST_POINTS = 201
#: Pages that are open at a time, or can be reloaded.
MOST_SESSIONS = 8
#: Messages of one page that are worked on at a time; more wait.
WAITING = 16
#: Seconds that the answer to one message may take.
SECONDS = 60.0
#: Seconds without progress after which a job counts as stuck.
SILENCE = 300.0

#: What the page is told of them.
LIMITS = {
    "runs": MOST_RUNS,
    "plots": MOST_PLOTS,
    "points": MOST_POINTS,
    "sessions": MOST_SESSIONS,
    "message": MESSAGE_BYTES,
}


def run_bytes(scans: int, n_axes: int, trackers: int) -> int:
    """Bytes of the errors that are kept of one Monte Carlo run.

    The notes of `fuzzytrack.testbed.montecarlo.monte_carlo` say what they are.
    """
    return 8 * scans * (n_axes * (1 + 3 * trackers) + 2 * trackers)


def check_runs_fit(runs: int, scans: int, n_axes: int, trackers: int) -> None:
    """Refuse a job whose errors would take more than `RESULT_BYTES`.

    Parameters
    ----------
    runs, scans, n_axes, trackers : int
        Size of the job.

    Raises
    ------
    ValueError
        Names the number of runs that fits.
    """
    each = run_bytes(scans, n_axes, trackers)
    fit = RESULT_BYTES // each
    if runs > fit:
        raise ValueError(
            f"runs: {runs} runs of {scans} scans with {trackers} trackers need "
            f"{runs * each / 2**30:.1f} GiB of memory; give at most {fit} runs, or fewer trackers"
        )
