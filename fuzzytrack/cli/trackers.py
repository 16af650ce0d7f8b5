"""The command `trackers`: a list of trackers, schedulers and normalizations."""

from __future__ import annotations

from dataclasses import asdict

from fuzzytrack.cli import options
from fuzzytrack.cli.output import print_json, print_table, say
from fuzzytrack.trackers.catalog import CatalogEntry, catalog

__all__ = ["trackers"]


def trackers(plugin: options.Plugins = None, json: options.Json = False) -> None:
    """List trackers, schedulers and normalizations with their sources, plug-ins included."""
    options.load_plugins(plugin)
    entries = catalog()
    if json:
        print_json([asdict(entry) for entry in entries])
        return
    rows = [[e.name, e.kind, _origin(e.source, e.package)] for e in entries]
    print_table(["name", "kind", "source"], rows, words=3)
    say()
    for names, parameters in _alike(entries).items():
        say(f"{', '.join(names)}: {', '.join(parameters)}")
    say()
    say("Write NAME, NAME:parameter=value:parameter=value, or a rule-base file (.yaml).")
    say("For example fixed:alpha=0.5:beta=0.2, or stiffness-damping:method=table.")
    say("A normalization is named in the settings of a rule base.")


def _origin(source: str, package: str) -> str:
    return source if package == "fuzzytrack" else f"{source} (from {package})".strip()


def _alike(entries: tuple[CatalogEntry, ...]) -> dict[tuple[str, ...], tuple[str, ...]]:
    """Names that take the same parameters, and these."""
    names: dict[tuple[str, ...], list[str]] = {}
    for entry in entries:
        if entry.parameters:
            names.setdefault(entry.parameters, []).append(entry.name)
    return {tuple(found): parameters for parameters, found in names.items()}
