"""The command that lists what there is to track with."""

from __future__ import annotations

from dataclasses import asdict

from fuzzytrack.cli import options
from fuzzytrack.cli.output import print_json, print_table, say
from fuzzytrack.trackers.catalog import catalog

__all__ = ["trackers"]


def trackers(json: options.Json = False) -> None:
    """List what there is to track with, plug-ins included."""
    entries = catalog()
    if json:
        print_json([asdict(entry) for entry in entries])
        return
    rows = [[e.name, e.kind, ", ".join(e.parameters), e.package] for e in entries]
    print_table(["name", "kind", "parameters", "package"], rows, words=4)
    say()
    say("Write NAME, NAME:parameter=value:parameter=value, or a rule-base file (.yaml).")
    say("For example fixed:alpha=0.5:beta=0.2, or stiffness-damping:method=table.")
    say("Sources are printed with --json.")
