"""Python that does in a script what is on the page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fuzzytrack import specs
from fuzzytrack.studio.tracker_texts import EDITOR, SAVED

__all__ = ["OnPage", "python_snippet"]


@dataclass(frozen=True)
class OnPage:
    """What a page shows.

    Attributes
    ----------
    rules, scenario : str
        Name of what is shipped, or of a file; empty if the text differs from that.
    rules_text, scenario_text : str
        The texts.
    saved : str
        Name of the rule base as it was last saved or opened.
    trackers : sequence of str
    runs, seed : int
    """

    rules: str
    rules_text: str
    scenario: str
    scenario_text: str
    saved: str
    trackers: Sequence[str]
    runs: int
    seed: int


def python_snippet(shown: OnPage) -> str:
    """Script that gives the same numbers as the experiment of a page."""
    imports = {"from fuzzytrack.testbed.montecarlo import monte_carlo"}
    lines: list[str] = []
    scenario = repr(shown.scenario)
    if not shown.scenario:
        imports.add("from fuzzytrack.simulation.scenario_files import loads_scenario")
        lines.append(f"scenario = loads_scenario({_literal(shown.scenario_text)})")
        scenario = "scenario"
    trackers = {text: _tracker(text, shown, imports, lines) for text in shown.trackers}
    if all(value == repr(text) for text, value in trackers.items()):
        named = f"[{', '.join(trackers.values())}]"
    else:
        named = "{" + ", ".join(f"{text!r}: {value}" for text, value in trackers.items()) + "}"
    lines += [
        f"trackers = {named}",
        f"results = monte_carlo({scenario}, trackers, runs={shown.runs}, seed={shown.seed})",
        "for row in results.table():",
        '    print(row["name"], row["predicted_rmse"], row["predicted_rmse_se"])',
    ]
    return "\n".join([*sorted(imports), "", *lines, ""])


def _tracker(text: str, shown: OnPage, imports: set[str], lines: list[str]) -> str:
    """Expression for a tracker of the page."""
    name, options = specs.split(text, "tracker")
    if name not in (EDITOR, SAVED):
        return repr(text)
    file = shown.rules if name == EDITOR else shown.saved
    if file:
        return repr(file + text.strip()[len(name) :])
    imports.add("from fuzzytrack.fuzzy.loading import loads_rulebase")
    imports.add("from fuzzytrack.trackers.catalog import tracker_of_rules")
    line = f"rules = loads_rulebase({_literal(shown.rules_text)})"
    if line not in lines:
        lines.append(line)
    return f"tracker_of_rules(rules, {dict(options)!r})"


def _literal(text: str) -> str:
    """A text over several lines as Python, if it can be written so."""
    plain = '"""' not in text and "\\" not in text and "\r" not in text
    if plain and text.endswith("\n") and not text.startswith('"'):
        return f'"""{text}"""'
    return repr(text)
