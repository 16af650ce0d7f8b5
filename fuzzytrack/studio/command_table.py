"""All commands of the page by name."""

from __future__ import annotations

from fuzzytrack.studio import (
    export_handlers,
    rule_handlers,
    run_handlers,
    surface_handlers,
    world_handlers,
)
from fuzzytrack.studio.handlers import Handler
from fuzzytrack.yamltree import quoted, suggestion

__all__ = ["HANDLERS", "find_handler"]

HANDLERS: dict[str, Handler] = {
    **rule_handlers.HANDLERS,
    **surface_handlers.HANDLERS,
    **world_handlers.HANDLERS,
    **run_handlers.HANDLERS,
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
