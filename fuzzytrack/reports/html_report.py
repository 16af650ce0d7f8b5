"""Report of a Monte Carlo experiment as one HTML page, pictures included."""

from __future__ import annotations

import base64
import io
import math
import os
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from fuzzytrack.arrays import Array
from fuzzytrack.io.files import check_output, whole_file
from fuzzytrack.reports.pictures import CAPTIONS, LEVEL, report_pictures
from fuzzytrack.testbed.metrics import PairedDifference
from fuzzytrack.testbed.results import Results
from fuzzytrack.version import __version__

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["report_pictures", "write_report"]


# Size in bytes above which a picture is embedded as PNG rather than SVG.
HEAVY = 250_000
# Numbers from here on are written as powers of ten.
LARGE = 1e7

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
<style>
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 64rem; margin: 0 auto;
  padding: 1rem; }
h1, h2 { line-height: 1.2; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem .7rem; border-bottom: 1px solid #ddd; text-align: right;
  white-space: nowrap; }
thead th { vertical-align: bottom; border-bottom: 2px solid #222; white-space: normal; }
th[scope=row], th.name { text-align: left; overflow-wrap: anywhere; white-space: normal;
  min-width: 9rem; }
figure { margin: 1.5rem 0; }
img { display: block; max-width: 100%; height: auto; margin: 0 auto; }
figcaption, .note { color: #444; font-size: .92rem; }
dt { font-weight: 600; margin-top: .6rem; }
dd { margin-left: 1.2rem; }
dl.facts { display: grid; grid-template-columns: max-content 1fr; gap: .1rem 1rem; }
.facts dt, .facts dd { margin: 0; overflow-wrap: anywhere; }
@media print {
  body { max-width: none; padding: 0; font-size: 10pt; }
  .wide { overflow: visible; }
  th, td { padding: .15rem .35rem; font-size: 8.5pt; }
  figure, tr, dt { break-inside: avoid; }
  h2, dt { break-after: avoid; }
}
</style>
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

    Returns
    -------
    Path
        The file, with symbolic links followed.

    Raises
    ------
    OSError
        If the file cannot be written.

    Notes
    -----
    The page loads nothing from elsewhere. The same results give the same bytes.
    """
    target = check_output(path)
    drawn = report_pictures(results) if pictures is None else pictures
    page = PAGE.substitute(
        title=escape(title or results.scenario),
        facts=_facts(results),
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
    return (
        f'<figure id="{key}">\n<img alt="{escape(heading)}" src="data:image/{kind};base64,{data}">'
        f"\n<figcaption><strong>{escape(heading)}.</strong> {escape(reading)}</figcaption>"
        "\n</figure>"
    )


def _facts(results: Results) -> str:
    scans, first = len(results.time), results.first_scored
    facts = {
        "Scenario": results.scenario,
        "Runs": f"{results.runs}",
        "Seed": f"{results.seed}",
        "Scans": f"{scans}, scored from scan {first + 1} (t = {results.time[first]:.6g} s) on",
        "Plots": f"RMSE {_number(results.measured_rmse)} m",
        "Trackers": f"{len(results.names)}",
        "Made with": f"fuzzytrack {__version__}",
    }
    lines = "\n".join(f"<dt>{key}</dt><dd>{escape(value)}</dd>" for key, value in facts.items())
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
    columns = {
        "Predicted RMSE (m)": _estimates(results.rmse(), results.rmse_se()),
        f"Change against {first} (m), {LEVEL:.0%} interval": [
            "–" if name == first else _change(results.paired_difference(first, name, LEVEL))
            for name in results.names
        ],
        "Filtered RMSE (m)": _estimates(results.rmse("filtered"), results.rmse_se("filtered")),
        "Mean error (m)": _estimates(results.mean_error(), results.mean_error_se()),
        "Variance of error (m²)": [_number(v) for v in results.error_variance()],
        "Peak RMSE (m)": [
            _number(value) + (f" at {results.time[scan]:.6g} s" if scan >= 0 else "")
            for value, scan in zip(peak.value, peak.scan.tolist(), strict=True)
        ],
        "Cumulative error (m)": _estimates(results.cumulative(), results.cumulative_se()),
    }
    if results.velocity is not None:
        columns["Velocity RMSE (m/s)"] = _estimates(
            results.rmse("velocity"), results.rmse_se("velocity")
        )
    return _table(results.names, columns)


def _consistency(results: Results) -> str:
    """Table of consistency; empty where it is not known."""
    columns = {}
    for name, found in (
        ("NIS", results.nis_consistency(LEVEL)),
        ("NEES of position", results.nees_consistency(LEVEL)),
    ):
        if found is not None:
            columns[f"{name}, mean"] = [_number(value) for value in found.mean]
            columns[f"{name}, {LEVEL:.0%} interval if consistent"] = [
                _interval(low, high) for low, high in zip(found.low, found.high, strict=True)
            ]
    return f"<h2>Consistency</h2>\n{_table(results.names, columns)}" if columns else ""


def _table(names: Sequence[str], columns: Mapping[str, Sequence[str]]) -> str:
    head = "".join(f'<th scope="col">{escape(column)}</th>' for column in columns)
    rows = "\n".join(
        f'<tr><th scope="row">{escape(name)}</th>'
        + "".join(f"<td>{escape(cell)}</td>" for cell in cells)
        + "</tr>"
        for name, *cells in zip(names, *columns.values(), strict=True)
    )
    return (
        '<div class="wide">\n<table>\n<thead>\n'
        f'<tr><th scope="col" class="name">Tracker</th>{head}</tr>\n'
        f"</thead>\n<tbody>\n{rows}\n</tbody>\n</table>\n</div>"
    )


def _definitions() -> str:
    lines = (f"<dt>{escape(k)}</dt>\n<dd>{escape(v)}</dd>" for k, v in DEFINITIONS.items())
    return "<dl>\n" + "\n".join(lines) + "\n</dl>"


def _estimates(values: Array, errors: Array) -> list[str]:
    """Estimates with their standard errors, rounded to two digits of these."""
    return [_estimate(*pair) for pair in zip(values.tolist(), errors.tolist(), strict=True)]


def _estimate(value: float, error: float) -> str:
    if not (math.isfinite(value) and math.isfinite(error)):
        return _number(value)
    if abs(value) >= LARGE or not error:
        return f"{_number(value)} ± {error:.2g}"
    digits = _digits(error)
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def _change(found: PairedDifference) -> str:
    if not math.isfinite(found.standard_error) or abs(found.difference) >= LARGE:
        return f"{_number(found.difference)} {_interval(found.low, found.high)}".strip()
    digits = _digits(found.standard_error)
    low, high = (f"{side:+.{digits}f}" for side in (found.low, found.high))
    return f"{found.difference:+.{digits}f} [{low}, {high}]".replace("-", "−")


def _digits(error: float) -> int:
    """Decimal places that show two digits of a standard error."""
    return min(12, max(0, 1 - math.floor(math.log10(error)))) if error > 0 else 3


def _interval(low: float, high: float) -> str:
    known = math.isfinite(low) and math.isfinite(high)
    return f"[{_number(low)}, {_number(high)}]" if known else ""


def _number(value: float) -> str:
    """Number to four digits, or to all before the point; a dash for NaN."""
    if not math.isfinite(value):
        return "–"
    text = f"{value:.0f}" if 1e4 <= abs(value) < LARGE else f"{value:.4g}"
    return text.replace("-", "−")
