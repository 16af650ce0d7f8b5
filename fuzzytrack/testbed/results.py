"""Results of a Monte Carlo experiment: errors of every tracker, run and scan, with statistics."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.gains.checks import number, positive
from fuzzytrack.html_reprs import as_text, block, paragraph, table
from fuzzytrack.plurals import counted
from fuzzytrack.reprs import summary
from fuzzytrack.testbed import metrics, results_as
from fuzzytrack.testbed.marks import best_of
from fuzzytrack.testbed.metrics import Consistency, PairedDifference, Peak

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

__all__ = ["QUANTITIES", "Quantity", "Results", "Sample"]


#: Quantity whose errors are taken.
Quantity = Literal["predicted", "filtered", "velocity"]
QUANTITIES: tuple[Quantity, ...] = ("predicted", "filtered", "velocity")


@dataclass(frozen=True, eq=False)
class Sample:
    """One run in full.

    Attributes
    ----------
    time : ndarray, shape (n_steps,)
        Times of its scans (s).
    truth, plots : ndarray, shape (n_steps, n_axes)
        True positions and plots (m); NaN where missed.
    predicted, filtered : ndarray, shape (n_trackers, n_steps, n_axes)
        Of each tracker (m).
    alpha, beta, gamma : ndarray, shape (n_trackers, n_steps, n_axes)
        Gains of each tracker.
    """

    time: Array
    truth: Array
    plots: Array
    predicted: Array
    filtered: Array
    alpha: Array
    beta: Array
    gamma: Array

    def __repr__(self) -> str:
        return summary(self, "truth", "predicted")


@dataclass(frozen=True, eq=False)
class Results:
    """Errors of trackers over Monte Carlo runs; every tracker saw the same plots.

    A scan counts from `first_scored` on where every tracker has a prediction, coasted or not: all
    are scored on the same scans. Errors are distances over all axes. Where a method takes a
    `quantity` it is ``"predicted"``, ``"filtered"`` (both m) or ``"velocity"`` (m/s). Standard
    errors are those over runs, see `fuzzytrack.testbed.metrics`; NaN is what is not known.

    Attributes
    ----------
    scenario : str
        Name of the scenario.
    names : tuple of str
        The trackers.
    seed : int
        Seed of the noise.
    first_scored : int
        First scan, from 0, whose errors count.
    time : ndarray, shape (n_steps,)
        Times of the scans (s); their means where runs have times of their own.
    predicted : ndarray, shape (n_trackers, runs, n_steps, n_axes)
        Predicted minus true position (m); NaN where there is no prediction.
    filtered : ndarray, same shape
        Filtered minus true position (m).
    velocity : ndarray, same shape, or None
        Filtered minus true velocity (m/s), where the scenario knows it.
    measured : ndarray, shape (runs, n_steps, n_axes)
        Plot minus true position (m); NaN where missed.
    nis, nees : ndarray, shape (n_trackers, runs, n_steps), or None
        Normalized innovation squared, and normalized estimation error squared of position, summed
        over axes, where the scenario presumes a `process_sigma`; NaN for runs of a tracker whose
        covariance does not follow from that alone (γ, one-point start, a recursion of its own).
    sample : Sample
        Run 0 in full.
    """

    scenario: str
    names: tuple[str, ...]
    seed: int
    first_scored: int
    time: Array
    predicted: Array
    filtered: Array
    velocity: Array | None
    measured: Array
    nis: Array | None
    nees: Array | None
    sample: Sample

    def __repr__(self) -> str:
        return summary(self, "scenario", "names", "runs", "seed", scans=len(self.time))

    def plot(self) -> Figure:
        """Picture of the errors of prediction, see `fuzzytrack.plotting.plot_comparison`."""
        from fuzzytrack.plotting.comparison import plot_estimates

        plots = {"plots": self.measured_rmse}
        return plot_estimates(self.names, self.rmse(), self.rmse_se(), reference=plots)[0]

    def _repr_html_(self) -> str:
        """Table of errors, for notebooks."""
        quantities = [q for q in QUANTITIES if q != "velocity" or self.velocity is not None]
        columns = {
            f"{quantity} RMSE ({'m/s' if quantity == 'velocity' else 'm'})": list(
                map(as_text, self.rmse(quantity).tolist(), self.rmse_se(quantity).tolist())
            )
            for quantity in quantities
        }
        rows = list(zip(self.names, *columns.values(), strict=True))
        plots = ["the plots themselves", "", as_text(self.measured_rmse)]
        rows.append((*plots, *[""] * (len(columns) - 2)))
        told = f"{counted(self.runs, 'run')} of {counted(len(self.time), 'scan')}, seed {self.seed}"
        return block(
            self.scenario,
            table(["tracker", *columns], rows, best=best_of(self.rmse())),
            paragraph(told),
        )

    @property
    def runs(self) -> int:
        """Number of Monte Carlo runs."""
        return len(self.measured)

    # ---------------------------------------------------------------- distances

    @cached_property
    def predicted_distance(self) -> Array:
        """Distance between predicted and true position (m), shape (n_trackers, runs, n_steps)."""
        return metrics.distance(self.predicted)

    @cached_property
    def filtered_distance(self) -> Array:
        """Distance between filtered and true position (m), shape (n_trackers, runs, n_steps)."""
        return metrics.distance(self.filtered)

    @cached_property
    def velocity_distance(self) -> Array | None:
        """Length of the error of velocity (m/s), shape (n_trackers, runs, n_steps)."""
        return None if self.velocity is None else metrics.distance(self.velocity)

    @cached_property
    def compared(self) -> Mask:
        """Scans in which every tracker has a prediction, shape (runs, n_steps)."""
        return metrics.compared(self.predicted_distance)

    @cached_property
    def scored(self) -> Mask:
        """Scans that count: those `compared`, from `first_scored` on, shape (runs, n_steps)."""
        return self.compared & (np.arange(len(self.time)) >= self.first_scored)

    @property
    def scored_scans(self) -> NDArray[np.int64]:
        """Number of scans that count, shape (runs,)."""
        return np.asarray(self.scored.sum(axis=1))

    @property
    def empty_runs(self) -> int:
        """Number of runs in which no scan counts; all statistics leave them out."""
        return int((self.scored_scans == 0).sum())

    @property
    def unstarted_runs(self) -> NDArray[np.int64]:
        """Number of runs in which a tracker predicts no scan that could count, (n_trackers,)."""
        unknown = np.isnan(self.predicted_distance[:, :, self.first_scored :])
        return np.asarray(unknown.all(axis=2).sum(axis=1))

    # ---------------------------------------------------------------- pooled over runs and scans

    def mean_error(self, quantity: Quantity = "predicted") -> Array:
        """Mean distance, pooled over runs and scans, shape (n_trackers,).

        Notes
        -----
        Llinas et al. (1998), section 5.2, as `error_variance`: mean and variance of the distance
        between prediction and truth.
        """
        return metrics.mean(self._distance(quantity), self.scored).value

    def mean_error_se(self, quantity: Quantity = "predicted") -> Array:
        """Standard error of `mean_error`."""
        return metrics.mean(self._distance(quantity), self.scored).error

    def error_variance(self, quantity: Quantity = "predicted") -> Array:
        """Variance of the distance about `mean_error`, pooled as it is, shape (n_trackers,)."""
        return metrics.variance(self._distance(quantity), self.scored).value

    def error_variance_se(self, quantity: Quantity = "predicted") -> Array:
        """Standard error of `error_variance`."""
        return metrics.variance(self._distance(quantity), self.scored).error

    def rmse(self, quantity: Quantity = "predicted") -> Array:
        """Root mean square distance, pooled over runs and scans, shape (n_trackers,)."""
        return metrics.root(self._squares(quantity), self.scored).value

    def rmse_se(self, quantity: Quantity = "predicted") -> Array:
        """Standard error of `rmse`."""
        return metrics.root(self._squares(quantity), self.scored).error

    def rmse_per_axis(self, quantity: Quantity = "predicted") -> Array:
        """Root mean square error on each axis, shape (n_trackers, n_axes)."""
        squares = np.square(np.moveaxis(self._errors(quantity), -1, 1))
        return metrics.root(squares, self.scored).value

    @property
    def measured_rmse(self) -> float:
        """Root mean square distance between plot and truth in the scans that count (m)."""
        squares = np.square(metrics.distance(self.measured))
        return float(metrics.root(squares, self.scored).value)

    def cumulative(self, quantity: Quantity = "predicted") -> Array:
        """Distance summed over the scans of a run, mean over runs, shape (n_trackers,)."""
        return metrics.cumulative(self._distance(quantity), self.scored).value

    def cumulative_se(self, quantity: Quantity = "predicted") -> Array:
        """Standard error of `cumulative`."""
        return metrics.cumulative(self._distance(quantity), self.scored).error

    # ---------------------------------------------------------------- scan by scan

    def rmse_per_scan(self, quantity: Quantity = "predicted") -> Array:
        """Root mean square distance over runs, shape (n_trackers, n_steps).

        At every scan in which all trackers have a prediction, before `first_scored` too.
        """
        return metrics.per_scan(self._squares(quantity), self.compared).value

    def rmse_per_scan_se(self, quantity: Quantity = "predicted") -> Array:
        """Standard error of `rmse_per_scan`."""
        return metrics.per_scan(self._squares(quantity), self.compared).error

    def npe(self, sigma: float, quantity: Quantity = "predicted") -> Array:
        """Normalized position error: `rmse_per_scan` per standard deviation of the plots.

        Parameters
        ----------
        sigma : float
            Standard deviation of the plots (m), > 0.
        quantity : {"predicted", "filtered"}
            Of which position.

        Raises
        ------
        ValueError
            If `sigma` is not positive, or `quantity` is not a position.
        """
        if quantity == "velocity":
            raise ValueError("quantity: 'velocity' is no position; one of predicted, filtered")
        return self.rmse_per_scan(quantity) / number("sigma", positive("sigma", sigma))

    def peak(self, quantity: Quantity = "predicted") -> Peak:
        """Largest `rmse_per_scan` from `first_scored` on, and its scan, shape (n_trackers,)."""
        curves = self.rmse_per_scan(quantity)
        curves[:, : self.first_scored] = np.nan
        return metrics.peak(curves)

    def quantiles(self, levels: ArrayLike, quantity: Quantity = "predicted") -> Array:
        """Quantiles of the distance over runs, shape (n_levels, n_trackers, n_steps).

        Parameters
        ----------
        levels : array_like
            From 0 to 1; a number gives shape (n_trackers, n_steps).
        quantity : {"predicted", "filtered", "velocity"}
            Whose distance.

        Raises
        ------
        ValueError
            If a level is out of range.
        """
        return metrics.quantiles(self._distance(quantity), self.compared, levels)

    # ---------------------------------------------------------------- one against another

    def paired_difference(
        self,
        first: str,
        second: str,
        level: float = 0.95,
        quantity: Quantity = "predicted",
        of: Literal["rmse", "mean"] = "rmse",
    ) -> PairedDifference:
        """Difference between the errors of two trackers, run by run.

        Parameters
        ----------
        first, second : str
            The trackers; the difference is second minus first.
        level : float
            Confidence level of the interval, 0 < level < 1.
        quantity : {"predicted", "filtered", "velocity"}
            Whose distance.
        of : {"rmse", "mean"}
            What is taken of each run: root mean square or mean distance.

        Raises
        ------
        ValueError
            If there is no such tracker, or a parameter is out of its range.

        Notes
        -----
        Both saw the same plots, so their errors are correlated, and the interval is narrower than
        that of the difference of two independent errors.
        """
        if of not in ("rmse", "mean"):
            raise ValueError(f"of: unknown {of!r}; one of rmse, mean")
        pair: list[Array] = []
        for parameter, name in (("first", first), ("second", second)):
            if name not in self.names:
                known = ", ".join(self.names)
                raise ValueError(f"{parameter}: no such tracker {name!r}; one of {known}")
            away = self._distance(quantity)[self.names.index(name)]
            if of == "rmse":
                pair.append(np.sqrt(metrics.run_means(np.square(away), self.scored)))
            else:
                pair.append(metrics.run_means(away, self.scored))
        difference, error, low, high, runs = metrics.paired_difference(pair[0], pair[1], level)
        return PairedDifference(
            first, second, quantity, of, difference, error, level, low, high, int(runs)
        )

    # ---------------------------------------------------------------- consistency

    def nis_consistency(self, level: float = 0.95) -> Consistency | None:
        """NIS against the chi-square distribution; None where there is no NIS."""
        if self.nis is None:
            return None
        # An axis has an innovation where it has a prediction and a plot.
        axes = (~np.isnan(self.predicted) & ~np.isnan(self.measured)).sum(axis=-1)
        return metrics.consistency(self.nis, axes, self.scored, independent_scans=True, level=level)

    def nees_consistency(self, level: float = 0.95) -> Consistency | None:
        """NEES of position against the chi-square distribution; None where there is no NEES."""
        if self.nees is None:
            return None
        axes = self.measured.shape[-1]
        return metrics.consistency(
            self.nees, axes, self.scored, independent_scans=False, level=level
        )

    # ---------------------------------------------------------------- in other forms

    def table(self) -> list[dict[str, Any]]:
        """Summary of each tracker, a row each, in plain numbers.

        Returns
        -------
        list of dict
            ``name``; ``unstarted_runs``; for each quantity (``predicted``, ``filtered``, and
            ``velocity`` if it is known) ``predicted_mean``, ``predicted_mean_se``,
            ``predicted_variance``, ``predicted_rmse``, ``predicted_rmse_se``; of predictions
            ``cumulative``, ``cumulative_se``, ``peak``, ``peak_scan`` (from 0, None if there is
            none), ``peak_time``; ``change``, ``change_se``, ``change_low``, ``change_high``: mean
            difference of a run's RMSE of prediction to the first tracker's, with its standard error
            and 95 % interval (None for the first); and ``nis``, ``nis_expected``, ``nis_low``,
            ``nis_high``, the same of ``nees``, if they are known. NaN where nothing counts.
        """
        columns: dict[str, list[Any]] = {
            "name": list(self.names),
            "unstarted_runs": self.unstarted_runs.tolist(),
        }
        for quantity in self._known():
            columns[f"{quantity}_mean"] = self.mean_error(quantity).tolist()
            columns[f"{quantity}_mean_se"] = self.mean_error_se(quantity).tolist()
            columns[f"{quantity}_variance"] = self.error_variance(quantity).tolist()
            columns[f"{quantity}_rmse"] = self.rmse(quantity).tolist()
            columns[f"{quantity}_rmse_se"] = self.rmse_se(quantity).tolist()
        columns["cumulative"] = self.cumulative().tolist()
        columns["cumulative_se"] = self.cumulative_se().tolist()
        peak = self.peak()
        scans = peak.scan.tolist()
        columns["peak"] = peak.value.tolist()
        columns["peak_scan"] = [None if scan < 0 else scan for scan in scans]
        columns["peak_time"] = [None if scan < 0 else float(self.time[scan]) for scan in scans]
        first, *others = self.names
        changes = [self.paired_difference(first, name) for name in others]
        columns["change"] = [None, *(each.difference for each in changes)]
        columns["change_se"] = [None, *(each.standard_error for each in changes)]
        columns["change_low"] = [None, *(each.low for each in changes)]
        columns["change_high"] = [None, *(each.high for each in changes)]
        for name, found in self._consistencies():
            columns[name] = found.mean.tolist()
            columns[f"{name}_expected"] = found.expected.tolist()
            columns[f"{name}_low"] = found.low.tolist()
            columns[f"{name}_high"] = found.high.tolist()
        return results_as.rows(columns)

    def to_json_dict(self) -> dict[str, Any]:
        """Summary and curves in plain types, for JSON.

        Returns
        -------
        dict
            ``fuzzytrack`` (version), ``scenario``, ``seed``, ``runs``, ``empty_runs``,
            ``first_scored``, ``measured_rmse``, ``trackers`` (the rows of `table`), ``time``, and
            ``curves``: for each tracker by name its columns of `to_pandas`. None where a number is
            not finite, since JSON has no NaN.
        """
        facts = ("scenario", "seed", "runs", "empty_runs", "first_scored", "measured_rmse")
        return results_as.json_dict(
            {name: getattr(self, name) for name in facts}, self.table(), self.time, self._curves()
        )

    def to_pandas(self) -> pandas.DataFrame:
        """Curves as a table, a row for each tracker and scan.

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
        return results_as.data_frame(self.names, self.time, self._curves())

    def _known(self) -> list[Quantity]:
        return [name for name in QUANTITIES if getattr(self, name) is not None]

    def _consistencies(self) -> list[tuple[str, Consistency]]:
        found = (("nis", self.nis_consistency()), ("nees", self.nees_consistency()))
        return [(name, each) for name, each in found if each is not None]

    def _curves(self) -> dict[str, Array]:
        """Curves over the scans, each of shape (n_trackers, n_steps)."""
        curves = {}
        for quantity in self._known():
            curves[f"{quantity}_rmse"] = self.rmse_per_scan(quantity)
            curves[f"{quantity}_rmse_se"] = self.rmse_per_scan_se(quantity)
            curves[f"{quantity}_median"] = self.quantiles(0.5, quantity)
        return curves | {name: found.scan_mean for name, found in self._consistencies()}

    def _errors(self, quantity: Quantity) -> Array:
        if quantity not in QUANTITIES:
            raise ValueError(f"quantity: unknown {quantity!r}; one of {', '.join(QUANTITIES)}")
        errors: Array | None = getattr(self, quantity)
        if errors is None:
            raise ValueError("quantity: 'velocity' is not known; the scenario has no velocity")
        return errors

    def _distance(self, quantity: Quantity) -> Array:
        self._errors(quantity)
        away: Array = getattr(self, f"{quantity}_distance")
        return away

    def _squares(self, quantity: Quantity) -> Array:
        return np.square(self._distance(quantity))
