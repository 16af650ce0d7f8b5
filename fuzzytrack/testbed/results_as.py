"""Results of a Monte Carlo experiment as rows, plain types and data frames."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.testbed.results import QUANTITIES, Quantity, Results

if TYPE_CHECKING:
    import pandas

__all__ = ["data_frame", "json_dict", "table"]


def table(results: Results) -> list[dict[str, Any]]:
    """What there is to say of each tracker, a row each, in plain numbers.

    Parameters
    ----------
    results : Results

    Returns
    -------
    list of dict
        ``name``; ``unstarted_runs``; for each quantity (``predicted``, ``filtered``, and
        ``velocity`` if it is known) ``predicted_mean``, ``predicted_mean_se``,
        ``predicted_variance``, ``predicted_rmse``, ``predicted_rmse_se``; of predictions
        ``cumulative``, ``cumulative_se``, ``peak``, ``peak_scan`` (from 0, None if there is none),
        ``peak_time``; ``change``, ``change_se``, ``change_low``, ``change_high``: mean difference
        of a run's RMSE of prediction to the first tracker's, with its standard error and 95 %
        interval (None for the first); and ``nis``, ``nis_expected``, ``nis_low``, ``nis_high``, the
        same of ``nees``, if they are known. NaN where nothing counts.
    """
    known = _quantities(results)
    columns: dict[str, list[Any]] = {
        "name": list(results.names),
        "unstarted_runs": results.unstarted_runs.tolist(),
    }
    for quantity in known:
        columns[f"{quantity}_mean"] = results.mean_error(quantity).tolist()
        columns[f"{quantity}_mean_se"] = results.mean_error_se(quantity).tolist()
        columns[f"{quantity}_variance"] = results.error_variance(quantity).tolist()
        columns[f"{quantity}_rmse"] = results.rmse(quantity).tolist()
        columns[f"{quantity}_rmse_se"] = results.rmse_se(quantity).tolist()
    columns["cumulative"] = results.cumulative().tolist()
    columns["cumulative_se"] = results.cumulative_se().tolist()
    peak = results.peak()
    scans = peak.scan.tolist()
    columns["peak"] = peak.value.tolist()
    columns["peak_scan"] = [None if scan < 0 else scan for scan in scans]
    columns["peak_time"] = [None if scan < 0 else float(results.time[scan]) for scan in scans]
    columns |= _changes(results)
    for name, found in (("nis", results.nis_consistency()), ("nees", results.nees_consistency())):
        if found is not None:
            columns[name] = found.mean.tolist()
            columns[f"{name}_expected"] = found.expected.tolist()
            columns[f"{name}_low"] = found.low.tolist()
            columns[f"{name}_high"] = found.high.tolist()
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def _changes(results: Results) -> dict[str, list[Any]]:
    first, *others = results.names
    found = [results.paired_difference(first, name) for name in others]
    return {
        "change": [None, *(each.difference for each in found)],
        "change_se": [None, *(each.standard_error for each in found)],
        "change_low": [None, *(each.low for each in found)],
        "change_high": [None, *(each.high for each in found)],
    }


def json_dict(results: Results) -> dict[str, Any]:
    """Summary and curves in plain types.

    Parameters
    ----------
    results : Results

    Returns
    -------
    dict
        ``fuzzytrack`` (version), ``scenario``, ``seed``, ``runs``, ``empty_runs``,
        ``first_scored``, ``measured_rmse``, ``trackers`` (the rows of `table`), ``time``, and
        ``curves``: for each tracker by name its columns of `data_frame`. None where a number is
        not known, which JSON has no NaN for.
    """
    from fuzzytrack import __version__

    curves = _curves(results)
    content: dict[str, Any] = _plain(
        {
            "fuzzytrack": __version__,
            "scenario": results.scenario,
            "seed": results.seed,
            "runs": results.runs,
            "empty_runs": results.empty_runs,
            "first_scored": results.first_scored,
            "measured_rmse": results.measured_rmse,
            "trackers": table(results),
            "time": results.time.tolist(),
            "curves": {
                name: {column: curve[k].tolist() for column, curve in curves.items()}
                for k, name in enumerate(results.names)
            },
        }
    )
    return content


def data_frame(results: Results) -> pandas.DataFrame:
    """Curves as a table, a row a tracker and scan.

    Parameters
    ----------
    results : Results

    Returns
    -------
    pandas.DataFrame
        Columns ``tracker``, ``scan`` (from 0), ``time``, and for each quantity that is known
        ``predicted_rmse``, ``predicted_rmse_se``, ``predicted_median`` and so on; ``nis`` and
        ``nees``, the means over runs, if they are known.

    Raises
    ------
    ImportError
        If pandas is not installed.
    """
    try:
        import pandas
    except ImportError as error:
        raise ImportError("to_pandas needs pandas: pip install pandas") from error
    n_trackers, n_steps = len(results.names), len(results.time)
    return pandas.DataFrame(
        {
            "tracker": np.repeat(np.array(results.names, dtype=object), n_steps),
            "scan": np.tile(np.arange(n_steps), n_trackers),
            "time": np.tile(results.time, n_trackers),
            **{name: curve.ravel() for name, curve in _curves(results).items()},
        }
    )


def _quantities(results: Results) -> list[Quantity]:
    return [name for name in QUANTITIES if getattr(results, name) is not None]


def _curves(results: Results) -> dict[str, Array]:
    """Curves over the scans, each of shape (n_trackers, n_steps)."""
    curves = {}
    for quantity in _quantities(results):
        curves[f"{quantity}_rmse"] = results.rmse_per_scan(quantity)
        curves[f"{quantity}_rmse_se"] = results.rmse_per_scan_se(quantity)
        curves[f"{quantity}_median"] = results.quantiles(0.5, quantity)
    for name, found in (("nis", results.nis_consistency()), ("nees", results.nees_consistency())):
        if found is not None:
            curves[name] = found.scan_mean
    return curves


def _plain(value: Any) -> Any:
    """The same without numbers that are not finite."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
