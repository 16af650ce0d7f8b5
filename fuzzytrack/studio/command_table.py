"""All commands of the page by name, and the first one that it sends."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fuzzytrack.fuzzy.loading import shipped_rulebases
from fuzzytrack.simulation.scenario_files import scenario_source, shipped_scenarios
from fuzzytrack.studio import (
    data_handlers,
    export_handlers,
    rule_handlers,
    run_handlers,
    surface_handlers,
    world_handlers,
)
from fuzzytrack.studio.arguments import Arguments
from fuzzytrack.studio.handlers import Handler, Later
from fuzzytrack.studio.limits import LIMITS
from fuzzytrack.studio.pages import Page
from fuzzytrack.studio.rule_handlers import listed_files, state_of
from fuzzytrack.studio.world_handlers import scenario_state
from fuzzytrack.yamltree import quoted, suggestion

__all__ = ["HANDLERS", "find_handler"]


def hello(page: Page, given: Arguments) -> Later:
    """All that a page needs when it is opened."""
    state, scenario = state_of(page), scenario_state(page)
    jobs = list(page.jobs.values())

    def work() -> Mapping[str, Any]:
        return {
            "session": page.key,
            "state": state,
            "scenario": scenario,
            "files": listed_files(page.studio.folder),
            "shipped": shipped_rulebases(),
            "scenarios": [{"name": n, "source": scenario_source(n)} for n in shipped_scenarios()],
            "trackers": page.studio.trackers(),
            "commands": list(HANDLERS),
            "limits": LIMITS,
            "jobs": [job.as_json(True) for job in jobs],
        }

    return Later(work)


HANDLERS: dict[str, Handler] = {
    "hello": Handler(hello, ("session",)),
    **rule_handlers.HANDLERS,
    **surface_handlers.HANDLERS,
    **world_handlers.HANDLERS,
    **run_handlers.HANDLERS,
    **data_handlers.HANDLERS,
    **export_handlers.HANDLERS,
}


def find_handler(name: str) -> Handler:
    """The command of a name.

    Raises
    ------
    ValueError
        If there is none; names one that is like it.
    """
    if name not in HANDLERS:
        raise ValueError(f"command: unknown {quoted(name)}{suggestion(name, HANDLERS)}")
    return HANDLERS[name]
