"""Which tracker is best? Every scheduler of the package on fresh random tracks.

    python -m benchmarks.ranking --tracks 3000 -o ranking.json
    python -m benchmarks.ranking --tracks 3000 --variants "constant T" --trackers maneuver,imm-three

The first column is the change of the geometric mean of the RMSE over the sets report, mixed and
strong at constant T against fixed gains of 0.543 and 0.548, the others are the change against the
Kalman filter of constant velocity, tuned once at constant T. Tables of paired differences follow.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.ranked import Conditions, ranked
from benchmarks.work import ROOT
from fuzzytrack.cli.output import progress, write_json
from fuzzytrack.json_types import plain
from fuzzytrack.simulation.published import TRACK_SETS
from fuzzytrack.tasks import part
from fuzzytrack.tuning import VARIANTS, rank
from fuzzytrack.yamltree import suggestion

CONSTANT = "constant T"
FIXED, KALMAN = "fixed .543 .548", "Kalman CV"
AGAINST = ("maneuver", "imm-three", "IMM CV/CA")
# Rows of a table of paired differences: the best at constant T.
_BEST = 10
# Times as large an error as the reference from which on only that is shown.
_FAR, _LOST = 3.0, 1000.0
# Variants of the first table; the others are in the second.
_REGULAR = (CONSTANT, "T=.5", "T=2", "Pd.9", "Pd.7", "Pd.5", "Pd.3")
# What the home page and README.md show: trackers and variants as these pages call them.
_SUMMARY_ROWS = {
    "imm-three": "`imm-three`, three Kalman filters side by side",
    "maneuver": "`maneuver`, a rule base with a covariance behind it",
    "omega-schedule": "`omega-schedule`, a rule base of six numbers",
    FIXED: "fixed gains, tuned",
    f"{FIXED} + period": "fixed gains, tuned, converted to each interval",
    KALMAN: "Kalman filter, tuned",
    "stiffness-damping": "`stiffness-damping`, the published rule base",
}
_SUMMARY_COLUMNS = {
    "regular plots": CONSTANT,
    "irregular times": "jitter",
    "30 % of plots missed": "Pd.7",
}

Table = list[list[str]]


@dataclass(frozen=True)
class Job:
    """Tracks on which all trackers are run."""

    tracks: int
    variants: Sequence[str]
    sets: Sequence[str] = TRACK_SETS


def jobs(tracks: int, others: int, variants: Sequence[str]) -> Iterator[Job]:
    """Constant T, the other variants, and targets for which no tracker was tuned."""
    yield Job(tracks, [v for v in variants if v == CONSTANT])
    yield Job(others, [v for v in variants if v != CONSTANT])
    yield Job(others, [v for v in variants if v in (CONSTANT, "jitter")], ("weaving",))


def measured(trackers: Mapping[str, str], work: Sequence[Job], seed: int) -> dict[str, Any]:
    """Rank the trackers, in plain types."""
    references = [name for name in (FIXED, KALMAN, *AGAINST) if name in trackers]
    named = {name: spec.replace(f"{ROOT}/", "") for name, spec in trackers.items()}
    found: dict[str, Any] = {"trackers": named, "rankings": []}
    sizes = [job.tracks * len(job.variants) * len(job.sets) for job in work]
    with progress("ranking") as watch:
        for k, job in enumerate(work):
            if job.variants:
                low, high = (sum(sizes[:m]) / sum(sizes) for m in (k, k + 1))
                share = part(watch, low, high)
                ranking = rank(trackers, job.tracks, seed, job.variants, job.sets, share)
                found["rankings"].append(ranking.to_json_dict(references))
    return rounded(plain(found))  # type: ignore[no-any-return]


def rounded(value: Any) -> Any:
    """Numbers of a value in the types of JSON to six digits."""
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    if isinstance(value, list):
        return [rounded(item) for item in value]
    return float(f"{value:.6g}") if isinstance(value, float) else value


Figures = dict[str, dict[str, list[float | None]]]


def changes(found: Mapping[str, Any], reference: str) -> Figures:
    """Change and standard error of every tracker in every column against a reference.

    A column is a variant, or another set than the usual ones with its variant.
    """
    merged: Figures = {name: {} for name in found["trackers"]}
    for ranking in found["rankings"]:
        usual = list(ranking["sets"]) == list(TRACK_SETS)
        for name, each in ranking["changes"].get(reference, {}).items():
            for variant, change in each.items():
                column = variant if usual else f"{', '.join(ranking['sets'])}, {variant}"
                merged[name][column] = change
    return merged


def shown(change: Sequence[float | None], digits: int = 1) -> str:
    """A change in percent; from three times the error on, the factor."""
    value, error = change
    if value is None or value + 1 > _LOST:
        return "diverges"
    if value + 1 > _FAR:
        return f"×{value + 1:.3g}"
    text = f"{100 * value:+.{digits}f}".replace("-", "−")
    return text if error is None else f"{text} ± {100 * error:.{digits}f}"


def main_table(found: Mapping[str, Any], columns: Sequence[str]) -> Table:
    """Rows of all trackers, the best at constant T first; a head in front."""
    tables = {column: changes(found, FIXED if column == CONSTANT else KALMAN) for column in columns}
    rows = [["", *(f"{c} vs fixed" if c == CONSTANT else c for c in columns)]]
    for name in ordered(found):
        rows.append([name, *(shown(tables[column][name][column]) for column in columns)])
    return rows


def paired_table(found: Mapping[str, Any], reference: str, columns: Sequence[str]) -> Table:
    """Paired differences of the best against a reference; a head in front."""
    table = changes(found, reference)
    rows = [[f"against {reference}, %", *columns]]
    for name in ordered(found)[:_BEST]:
        if name != reference:
            rows.append([name, *(shown(table[name][column], 2) for column in columns)])
    return rows


def ordered(found: Mapping[str, Any]) -> list[str]:
    """Names, the best at constant T first, or in the first variant that was ranked."""
    table = changes(found, KALMAN if KALMAN in found["trackers"] else FIXED)

    def place(name: str) -> float:
        value = next(iter(table[name].values()), [None])[0]
        return math.inf if value is None else value

    return sorted(found["trackers"], key=place)


def lines(table: Table) -> Iterator[str]:
    """A table as text for a terminal."""
    widths = [max(len(row[k]) for row in table) for k in range(len(table[0]))]
    for row in table:
        first, *rest = (cell.ljust(w) if k == 0 else cell.rjust(w)
                        for k, (cell, w) in enumerate(zip(row, widths, strict=True)))  # fmt: skip
        yield "  ".join([first, *rest])


def markdown(table: Table) -> str:
    """A table as Markdown."""
    head, *rows = table
    ruler = ["---", *("--:" for _ in head[1:])]
    return "\n".join("| " + " | ".join(row) + " |" for row in (head, ruler, *rows)) + "\n"


def chosen(text: str | None, known: Sequence[str], what: str) -> list[str]:
    """Names out of a text with commas; all of them unless given."""
    names = list(known) if text is None else [name.strip() for name in text.split(",")]
    for name in names:
        if name not in known:
            raise SystemExit(f"error: --{what}: unknown {name!r}{suggestion(name, known)}")
    return names


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.ranking",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--tracks", type=int, default=300, help="in each set, at constant T")
    parser.add_argument("--others", type=int, help="in each set, in other variants; as --tracks")
    parser.add_argument("--seed", type=int, default=20)
    parser.add_argument("--variants", metavar="A,B,C", help="all of them unless given")
    parser.add_argument("--trackers", metavar="A,B,C", help="all of them unless given")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.json", help="write all figures")
    parser.add_argument("--docs", action="store_true", help="write the tables of docs/ranking.md")
    given = parser.parse_args(arguments)
    everyone = ranked(Conditions())
    names = chosen(given.trackers, list(everyone), "trackers")
    names += [name for name in (FIXED, KALMAN) if name not in names]
    variants = chosen(given.variants, list(VARIANTS), "variants")
    trackers = {name: everyone[name] for name in names}
    others = given.tracks if given.others is None else given.others
    found = measured(trackers, list(jobs(given.tracks, others, variants)), given.seed)
    for each in parts(found):
        print("\n".join(lines(each)), end="\n\n")
    if given.output:
        write_json(given.output, found, 1)
    if given.docs:
        text = json.dumps(found, ensure_ascii=False, separators=(",", ":"))
        (ROOT / "docs" / "ranking.json").write_text(f"{text}\n")
        (ROOT / "docs" / "ranking-tables.txt").write_text(described(found))
        (ROOT / "docs" / "ranking-summary.txt").write_text(summary(found))
    return 0


def parts(found: Mapping[str, Any]) -> Iterator[Table]:
    """The tables of a ranking."""
    columns = list(next(iter(changes(found, KALMAN).values())))
    groups = ([c for c in columns if c in _REGULAR], [c for c in columns if c not in _REGULAR])
    for group in filter(None, groups):
        yield main_table(found, group)
    for reference in AGAINST:
        if reference in found["trackers"]:
            for group in filter(None, groups):
                yield paired_table(found, reference, group)


def described(found: Mapping[str, Any]) -> str:
    """The tables in Markdown, with how they were measured."""
    how = "; ".join(
        f"{each['tracks']} tracks of {', '.join(each['sets'])} in {len(each['variants'])} "
        f"variant{'s' * (len(each['variants']) != 1)}"
        for each in found["rankings"]
    )
    seed = found["rankings"][0]["seed"]
    tables = "\n".join(markdown(table) for table in parts(found))
    return f"*Measured on {how}; seed {seed}.*\n\n{tables}"


def summary(found: Mapping[str, Any]) -> str:
    """A short table in Markdown: a few trackers, the best first, against the Kalman filter."""
    table = changes(found, KALMAN)
    rows = [["Error of predictions, against a Kalman filter (%)", *_SUMMARY_COLUMNS]]
    for name in filter(_SUMMARY_ROWS.get, ordered(found)):
        figures = (table[name][column][0] for column in _SUMMARY_COLUMNS.values())
        rows.append(
            [
                _SUMMARY_ROWS[name],
                *(shown([figure, None], 0) if figure else "0" for figure in figures),
            ]
        )
    return markdown(rows)


if __name__ == "__main__":
    sys.exit(main())
