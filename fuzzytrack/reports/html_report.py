"""Report of a Monte Carlo experiment as one HTML page, pictures included."""

from __future__ import annotations

import base64
import io
import os
from collections.abc import Mapping
from datetime import UTC, datetime
from html import escape
from importlib import resources
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from fuzzytrack.io.files import check_output, whole_file
from fuzzytrack.reports.html_tables import (
    Column,
    column_of_least,
    column_of_numbers,
    difference,
    html_table,
    interval,
    number,
)
from fuzzytrack.reports.pictures import CAPTIONS, LEVEL, report_pictures
from fuzzytrack.testbed.marks import WORSE, marks_of
from fuzzytrack.testbed.results import Results
from fuzzytrack.version import __version__

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["report_pictures", "write_report"]


# Size in bytes above which a picture is embedded as PNG rather than SVG.
HEAVY = 250_000
# Of a tracker whose filtered positions are further from the truth than the plots.
WORSE_NOTE = "worse than the plots"

DEFINITIONS = {
    "Scored scans": (
        "Scans that count: those from the first scored one on in which every tracker has a "
        "prediction, so that all are judged on the same scans. Scans without a plot, in which "
        "trackers coast, are included."
    ),
    "Error": (
        "Distance, over all axes, between an estimated and the true position. The predicted "
        "position is that for a scan before its plot is used, the filtered one that after."
    ),
    "RMSE": "Root of the mean of squared errors over all runs and scored scans.",
    "Mean error, variance of error": (
        "Mean of the errors of prediction over all runs and scored scans, and the variance of "
        "these errors about it."
    ),
    "Peak RMSE": (
        "The RMSE of prediction is taken over runs, scan by scan; this is its largest value among "
        "scored scans, and when it is reached."
    ),
    "Cumulative error": "Sum of the errors of prediction over a run, mean over runs.",
    "Change against the first": (
        "The RMSE of prediction of each run, minus that of the first tracker in the same run; mean "
        "over runs, with its confidence interval (Student t). Negative is better than the first. "
        "If the interval does not contain 0, the difference is significant."
    ),
    "±": "What follows is the standard error: what another set of runs would typically change.",
    "Velocity RMSE": "As RMSE, of the filtered velocity.",
    "NIS, NEES": (
        "Normalized innovation squared and normalized estimation error squared: squared errors in "
        "units of the variance that the filter presumes. A consistent filter has a mean equal to "
        "the number of axes; a larger one means that its variances are too small, a smaller one "
        "too large. Only where the scenario states the acceleration noise that is presumed."
    ),
}

PAGE = Template("""\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>$title</title>
<meta name="color-scheme" content="light dark">
<style>
$style</style>
</head>
<body>
<h1>$title</h1>
$facts
<h2>Errors</h2>
$errors
$consistency
<h2>Pictures</h2>
$pictures
<h2>What the numbers are</h2>
$definitions
</body>
</html>
""")


def write_report(
    path: str | os.PathLike[str],
    results: Results,
    *,
    title: str | None = None,
    pictures: Mapping[str, Figure] | None = None,
    command: str | None = None,
    date: datetime | None = None,
) -> Path:
    """Write the results of an experiment as one HTML page, pictures included.

    Parameters
    ----------
    path : str or path
        The file; replaced if it exists, written whole or not at all.
    results : Results
        Results of the experiment.
    title : str, optional
        Of the page; the name of the scenario unless given.
    pictures : mapping of str to Figure, optional
        Those of `report_pictures`, if they are drawn already.
    command : str, optional
        Command that gives these results, to be shown.
    date : datetime, optional
        Date of the page, with its time zone; unless given that of the environment variable
        ``SOURCE_DATE_EPOCH``, seconds since 1970 (UTC), or now.

    Returns
    -------
    Path
        The file, with symbolic links followed.

    Raises
    ------
    OSError
        If the file cannot be written.
    ValueError
        If `date` has no time zone, or ``SOURCE_DATE_EPOCH`` is not a whole number of seconds.

    Notes
    -----
    The page loads nothing from elsewhere, and follows the light or dark mode of the reader. The
    same results with the same date give the same bytes.
    """
    target = check_output(path)
    made = _date(date)
    drawn = report_pictures(results) if pictures is None else pictures
    page = PAGE.substitute(
        style=resources.files(__package__).joinpath("report.css").read_text(encoding="utf-8"),
        title=escape(title or results.scenario),
        facts=_facts(results, command, made),
        errors=_errors(results),
        consistency=_consistency(results),
        pictures="\n".join(_picture(key, figure) for key, figure in drawn.items()),
        definitions=_definitions(),
    )
    with whole_file(target) as draft:
        draft.write_text(page, encoding="utf-8", newline="\n")
    return target


def _picture(key: str, figure: Figure) -> str:
    """One picture with its caption, embedded in the page."""
    import matplotlib

    drawing = io.BytesIO()
    # A fixed salt and no date, so that the same picture has the same bytes.
    with matplotlib.rc_context({"svg.hashsalt": "fuzzytrack"}):
        figure.savefig(drawing, format="svg", metadata={"Date": None})
    kind = "svg+xml"
    if len(drawing.getvalue()) > HEAVY:
        kind, drawing = "png", io.BytesIO()
        figure.savefig(drawing, format="png", dpi=160)
    data = base64.b64encode(drawing.getvalue()).decode("ascii")
    heading, reading = CAPTIONS[key]
    # A number and its sign stay on one line.
    caption = escape(reading).replace(" %", "&nbsp;%")
    return (
        f'<figure id="{key}">\n<img alt="{escape(heading)}" src="data:image/{kind};base64,{data}">'
        f"\n<figcaption><strong>{escape(heading)}.</strong> {caption}</figcaption>\n</figure>"
    )


def _date(given: datetime | None) -> datetime:
    """Date of the page, in UTC."""
    if given is not None:
        if given.tzinfo is None:
            raise ValueError(f"date: needs a time zone, such as datetime.timezone.utc; got {given}")
        return given.astimezone(UTC)
    fixed = os.environ.get("SOURCE_DATE_EPOCH")
    if not fixed:
        return datetime.now(UTC)
    try:
        return datetime.fromtimestamp(int(fixed), UTC)
    except (ValueError, OverflowError, OSError):
        raise ValueError(
            "SOURCE_DATE_EPOCH: must be a whole number of seconds since 1970, within the years "
            f"that dates can have; got {fixed!r}"
        ) from None


def _facts(results: Results, command: str | None, made: datetime) -> str:
    scans, first = len(results.time), results.first_scored
    facts = {
        "Scenario": results.scenario,
        "Runs": f"{results.runs}",
        "Seed": f"{results.seed}",
        "Scans": f"{scans}, scored from scan {first + 1} (t = {results.time[first]:.6g} s) on",
        "Plots": f"RMSE {number(results.measured_rmse)} m",
        "Trackers": f"{len(results.names)}",
        "Made with": f"fuzzytrack {__version__}, {made:%Y-%m-%d %H:%M} UTC",
    }
    lines = "\n".join(f"<dt>{key}</dt><dd>{escape(value)}</dd>" for key, value in facts.items())
    if command is not None:
        lines += f"\n<dt>Command</dt><dd><code>{escape(command)}</code></dd>"
    warnings = [
        f"{name} predicted no scored scan in {count} of {results.runs} runs."
        for name, count in zip(results.names, results.unstarted_runs.tolist(), strict=True)
        if count
    ]
    if results.empty_runs:
        warnings.append(
            f"{results.empty_runs} of {results.runs} runs have no scan in which every tracker has "
            "a prediction; they are left out of every number."
        )
    notes = "".join(f'\n<p class="note">{escape(text)}</p>' for text in warnings)
    return f'<dl class="facts">\n{lines}\n</dl>{notes}'


def _errors(results: Results) -> str:
    """Table of errors, a row for each tracker."""
    first, *_ = results.names
    peak = results.peak()
    changes = [
        None if name == first else results.paired_difference(first, name, LEVEL)
        for name in results.names
    ]
    columns = {
        "Predicted RMSE (m)": column_of_numbers(results.rmse(), results.rmse_se()),
        f"Change against {first} (m), {LEVEL:.0%} interval": column_of_least(
            ["–" if change is None else difference(change) for change in changes],
            [0.0 if change is None else change.difference for change in changes],
        ),
        "Filtered RMSE (m)": column_of_numbers(
            results.rmse("filtered"), results.rmse_se("filtered")
        ),
        "Mean error (m)": column_of_numbers(results.mean_error(), results.mean_error_se()),
        "Variance of error (m²)": column_of_numbers(results.error_variance()),
        "Peak RMSE (m)": column_of_least(
            [
                number(value) + (f" at {results.time[scan]:.6g} s" if scan >= 0 else "")
                for value, scan in zip(peak.value, peak.scan.tolist(), strict=True)
            ],
            peak.value,
        ),
        "Cumulative error (m)": column_of_numbers(results.cumulative(), results.cumulative_se()),
    }
    if results.velocity is not None:
        columns["Velocity RMSE (m/s)"] = column_of_numbers(
            results.rmse("velocity"), results.rmse_se("velocity")
        )
    marks = marks_of(results.rmse(), results.rmse("filtered"), results.measured_rmse)
    notes = [WORSE_NOTE if WORSE in mark else "" for mark in marks]
    table = html_table(results.names, columns, notes)
    return f'{table}\n<p class="note">Marked cells are the best of their column.</p>'


def _consistency(results: Results) -> str:
    """Table of consistency; empty where it is not known."""
    columns = {}
    for name, found in (
        ("NIS", results.nis_consistency(LEVEL)),
        ("NEES of position", results.nees_consistency(LEVEL)),
    ):
        if found is not None:
            means = [number(value) for value in found.mean]
            inside = (found.low <= found.mean) & (found.mean <= found.high)
            columns[f"{name}, mean"] = Column(means, inside.tolist())
            columns[f"{name}, {LEVEL:.0%} interval if consistent"] = Column(
                [interval(low, high) for low, high in zip(found.low, found.high, strict=True)]
            )
    if not columns:
        return ""
    note = '<p class="note">Marked means are inside of their interval.</p>'
    return f"<h2>Consistency</h2>\n{html_table(results.names, columns)}\n{note}"


def _definitions() -> str:
    lines = (f"<dt>{escape(k)}</dt>\n<dd>{escape(v)}</dd>" for k, v in DEFINITIONS.items())
    return "<dl>\n" + "\n".join(lines) + "\n</dl>"
