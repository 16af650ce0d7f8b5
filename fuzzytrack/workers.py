"""Executors for the tasks of a long job: processes of this computer, or a Dask cluster."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor
from contextlib import contextmanager
from functools import partial
from multiprocessing import parent_process
from typing import TYPE_CHECKING

from fuzzytrack.plugins.scripts import Script, load_scripts, loaded_scripts

if TYPE_CHECKING:
    from concurrent.futures import ProcessPoolExecutor

__all__ = ["end_processes", "process_pool", "workers"]

# Seconds that a cluster may take to answer.
_PATIENCE = 5


@contextmanager
def workers(jobs: int, scheduler: str | None) -> Iterator[Executor | None]:
    """Executor for a job; closed at the end, with the tasks that have not begun canceled.

    Parameters
    ----------
    jobs : int
        Processes of this computer; no executor for 1.
    scheduler : str or None
        Address of a Dask scheduler, whose workers do the work instead.

    Yields
    ------
    concurrent.futures.Executor or None

    Raises
    ------
    ValueError
        If both are asked for, Dask is not installed, no scheduler answers, or workers are lost
        during the job.
    """
    if scheduler is not None and jobs > 1:
        raise ValueError("jobs and scheduler: give one; a cluster has workers of its own")
    if scheduler is None and jobs == 1:
        yield None
        return
    pool = _processes(jobs) if scheduler is None else _cluster(scheduler)
    try:
        with pool as executor:
            yield executor
    except BrokenExecutor:
        raise ValueError(
            "jobs: a worker process died, perhaps for lack of memory; try fewer"
        ) from None
    except CancelledError:
        raise ValueError(f"scheduler: lost the Dask scheduler at {scheduler}") from None


def process_pool(jobs: int) -> ProcessPoolExecutor:
    """Executor of new processes of this computer, with the scripts of plug-ins that are loaded."""
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    return ProcessPoolExecutor(
        jobs,
        multiprocessing.get_context("spawn"),
        initializer=_begin,
        initargs=(loaded_scripts(),),
    )


def end_processes(pool: ProcessPoolExecutor) -> None:
    """End the processes of a pool at once, whatever they do; what they were doing fails."""
    # Python 3.14 has `terminate_workers` for this. The pool forgets its processes when it is shut
    # down, and may begin one until then.
    processes = pool._processes
    pool.shutdown(wait=False, cancel_futures=True)
    for process in list((processes or {}).values()):
        process.kill()


@contextmanager
def _processes(jobs: int) -> Iterator[Executor]:
    pool = process_pool(jobs)
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)


def _begin(scripts: tuple[Script, ...]) -> None:
    """Begin the work of a process, with the plug-ins that the first process has."""
    # Ctrl-C goes to all processes of a terminal: the first one ends the job.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    load_scripts(scripts)


def _end_with_parent() -> None:
    """End this process with the one that began it, which may be killed or lose its terminal."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        # In another thread than the first one, `sys.exit` would end that thread.
        os._exit(1)


@contextmanager
def _cluster(address: str) -> Iterator[Executor]:
    try:
        from distributed import Client
        from distributed.comm.addressing import resolve_address
    except ImportError:
        raise ValueError(
            "scheduler: needs Dask, which is not installed; pip install 'fuzzytrack[dask]'"
        ) from None
    try:
        # A client that is given an invalid address logs errors when it is closed.
        resolve_address(address)
        client = Client(address, timeout=_PATIENCE, set_as_default=False)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        why = str(error).partition("\n")[0]
        raise ValueError(f"scheduler: no Dask scheduler answers at {address!r}: {why}") from None
    with client:
        # Also on workers that join later.
        if scripts := loaded_scripts():
            client.register_worker_callbacks(partial(load_scripts, scripts))  # type: ignore[no-untyped-call]
        yield client.get_executor()  # type: ignore[no-untyped-call]
