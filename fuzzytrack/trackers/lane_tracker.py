"""The base of trackers that are given by their step of a lane."""

from __future__ import annotations

import operator
import traceback
import warnings
from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError, Location, PluginError, TrackWarning
from fuzzytrack.lanes.layout import MEMORY, Rows
from fuzzytrack.lanes.plots import (
    PlotLayout,
    as_plots,
    as_times,
    check_single_precision,
    infinite_plot,
    plot_sigmas,
    time_steps,
    with_time_axis,
)  # fmt: skip
from fuzzytrack.lanes.program import LaneProgram
from fuzzytrack.lanes.runner import InfinitePlotError, Runner
from fuzzytrack.lanes.start import CORRECT_RETURNS, CORRECT_TAKES, single_axis_step
from fuzzytrack.reprs import constructor_code
from fuzzytrack.trackers.compiled_step import CompiledStep
from fuzzytrack.trackers.filtered_variance import filtered_variance
from fuzzytrack.trackers.origin import Origin
from fuzzytrack.trackers.output_arrays import Out, OutputArrays
from fuzzytrack.trackers.prediction import Prediction
from fuzzytrack.trackers.result import ON_REQUEST, TrackResult, checked_keep
from fuzzytrack.trackers.runners import runner
from fuzzytrack.trackers.state import TrackState, check_origin
from fuzzytrack.trackers.time_check import WRONG_GAINS, TrackTimes

__all__ = ["MISSED", "LaneTracker", "check_missed"]

_PACKAGE = Path(__file__).parents[1]

#: What `LaneTracker.missed` can be.
MISSED = ("elapsed", "step")


class LaneTracker(ABC):
    """A tracker that is given by its lane program.

    A subclass implements `program` and has everything else of `fuzzytrack.Tracker`: batches, single
    steps, missed plots, irregular times, predictions and compilation. It must be immutable and
    hashable, and pickle: make it a frozen dataclass.

    Attributes
    ----------
    coupled : bool
        Whether a lane is a whole track, and not one of its axes.
    needs_sigma : bool
        Whether plots need a standard deviation.
    sees_misses : bool
        Whether steps without a plot change its memory also with ``missed="elapsed"``, as those of
        a tracker that counts them.
    sigma_w : float or None
        Standard deviation of all plots (m), if the tracker has one.
    missed : {"elapsed", "step"}
        What the time step dt is after missed plots. ``elapsed``: the time since the last plot of
        the track. A missed plot does not change the track: it is predicted over the whole gap, as
        if there had been no steps between. ``step``: the time since the last step, at which the
        track may have coasted; so it is in the papers.
    uses_acceleration : bool
        Whether the gain γ can be other than 0; files of tracks then have it.
    one_recursion : bool
        Whether a track is one α-β-γ recursion with the gains of the result, as it is without a
        retention time. Then `run` can see that they do not suit the times of the plots, and warns.
    """

    coupled: bool = False
    needs_sigma: bool = False
    sees_misses: bool = False
    sigma_w: float | None = None
    missed: str = "elapsed"
    uses_acceleration: bool = True
    one_recursion: bool = True
    # What a user wrote for this tracker, if it was made of a text; for messages.
    _typed: ClassVar[str | None] = None

    def __repr__(self) -> str:
        return constructor_code(self)

    def remember_text(self, typed: str) -> None:
        """Note the text that the tracker was made of, so that messages name what a user wrote."""
        object.__setattr__(self, "_typed", typed)

    @property
    def name(self) -> str:
        """Name for messages."""
        return type(self).__name__

    @abstractmethod
    def program(self, n_axes: int) -> LaneProgram:
        """Arithmetic of a lane.

        Parameters
        ----------
        n_axes : int
            Axes of a lane: 1 unless the tracker is coupled.
        """

    def run(
        self,
        t: ArrayLike,
        z: ArrayLike,
        sigma: ArrayLike | None = None,
        *,
        state: TrackState | None = None,
        keep: Sequence[str] | None = None,
        threads: int | None = None,
        dtype: DTypeLike = np.float64,
        out: Out | None = None,
    ) -> TrackResult:
        """Track plots over time.

        Parameters
        ----------
        t : array_like, shape (n_steps,) or (n_steps, ...batch)
            Times (s), strictly increasing; for a batch, common or each track's own.
        z : array_like, shape (n_steps,), (n_steps, n_axes) or (n_steps, ...batch, n_axes)
            Plots (m); NaN where missed.
        sigma : array_like, optional
            Standard deviation of the plots (m), broadcast against `z`; needed by some schedulers.
        state : TrackState, optional
            State from which to continue; a new track unless given.
        keep : sequence of str, optional
            Outputs to keep in the result, from `fuzzytrack.trackers.result.KEPT`: predicted,
            filtered, velocity, acceleration, innovation, gains. Unless given, what is in `out`, or
            without `out` all of it. Less is faster, and takes less memory. If it is named here,
            position_variance is kept too.
        threads : int, optional
            Threads that share the tracks of a large job; all processors unless given. The numbers
            do not depend on it.
        dtype : dtype
            np.float64, or np.float32 for half the memory and more speed: plots and results are
            then rounded to 7 digits, and so is every operation, so choose an origin near the plots.
            Such a run is always compiled.
        out : mapping of str to ndarray, or TrackResult, optional
            Arrays to write results into, by names of `keep` (for ``gains`` a
            `fuzzytrack.trackers.state.Gains`), or a result whose arrays are used again and whose
            numbers are lost. Each has the shape of `z` and the type `dtype`, is C-contiguous and
            shares no memory with the arguments. The result holds these very arrays. What is kept
            and not in `out` gets new arrays, as do gains in a result that all axes of its tracks
            share. After an error in the run itself, such as an infinite plot, the arrays may have
            been written to in part.

        Returns
        -------
        TrackResult

        Raises
        ------
        DataError
            If a plot is infinite, or times are not finite and increasing; says where. Also if
            positions are no longer finite, since numbers are too large or too small.
        TypeError
            If `out` holds anything but arrays.
        ValueError
            If shapes do not fit, the scheduler needs `sigma`, a name in `keep` or `out` is unknown,
            `threads` is less than 1, `dtype` is another, an array of `out` cannot be used, or the
            state comes from another tracker.

        Warns
        -----
        TrackWarning
            If the times between plots differ so much that the gains make the noise of the plots
            more than ten times larger. It is looked for if gains are kept, in up to 200 tracks.

        Examples
        --------
        Results of batch after batch in the same memory:

        >>> import numpy as np
        >>> from fuzzytrack import AlphaBetaTracker
        >>> tracker = AlphaBetaTracker("fixed:alpha=0.5:beta=0.2")
        >>> filtered = np.empty(3)
        >>> for plots in [0, 31, 60], [5, 7, 11]:
        ...     result = tracker.run([0, 1, 2], plots, out={"filtered": filtered})
        ...     print(filtered)
        [ 0. 31. 61.]
        [ 5.  7. 10.]
        >>> result.filtered is filtered
        True
        """
        names = None if keep is None else checked_keep(keep)
        variances = names is not None and "position_variance" in names
        if names is not None:
            names = tuple(name for name in names if name not in ON_REQUEST)
        arrays = OutputArrays.of(out, names)
        _check_threads(threads)
        before = _time_of(state)
        plots, times = as_plots(z, dtype), as_times(t, before)
        layout = PlotLayout.of(plots.shape, self.coupled)
        core = runner(self, layout.lane_axes)
        self._check_state(state, plots, core.rows)
        steps = time_steps(times, plots.shape, before)
        deviation = self._sigmas(sigma, plots)
        if plots.dtype == np.float32:
            check_single_precision("t: a time step of", steps, times)
            check_single_precision("sigma:", deviation, plots)
        arrays.check(plots, z=plots, t=times, sigma=deviation)
        sigmas = layout.to_lanes(deviation)
        try:
            after, raw = core(
                None if state is None else state.lanes,
                layout.to_lanes(plots),
                layout.times_to_lanes(times),
                sigmas,
                keep=(*arrays.parts, MEMORY) if variances else arrays.parts,
                threads=threads,
                into=arrays.arrays,
            )
        except InfinitePlotError:
            raise infinite_plot(plots) from None
        except Exception as error:
            self._explain(error, layout.lane_axes)
            if _is_arithmetic(error):
                raise self._out_of_range() from error
            raise
        memories = raw.pop(MEMORY, None)
        results = arrays.results(raw, layout)
        if (lane := core.lost(after)) is not None:
            raise self._out_of_range(layout.track_of(lane))
        last = state
        if len(plots):
            shape = plots.shape[1:]
            last = TrackState(times[-1].copy(), shape, after, core.rows, self._origin)
        if memories is not None:
            noise = sigmas if self.sigma_w is None else np.full((1, 1, 1), self.sigma_w)
            variance = filtered_variance(
                self.prediction_variance, memories, layout.to_lanes(plots),
                layout.times_to_lanes(times), noise, None if state is None else state.lanes,
                core.rows, self.missed == "elapsed",
            )  # fmt: skip
            results["position_variance"] = layout.from_lanes(variance)
        result = TrackResult.of(times, plots, last, results)
        if self.one_recursion and "gains" in result.kept:
            between = TrackTimes.of(times, plots, self.coupled, self.missed)
            if between is not None and between.are_wrong_for(result.gains):
                warnings.warn(f"{self!r}: {WRONG_GAINS}", TrackWarning, stacklevel=2)
        return result

    def start(self, z: ArrayLike, t: ArrayLike, sigma: ArrayLike | None = None) -> TrackState:
        """State of a new track, or batch of tracks, after a first plot.

        Parameters
        ----------
        z : array_like, shape (), (n_axes,) or (...batch, n_axes)
            Plot (m).
        t : array_like, shape () or (...batch)
            Its time (s).
        sigma : array_like, optional
            Its standard deviation (m).
        """
        return self._one_step(None, z, t, sigma)

    def step(
        self, state: TrackState, z: ArrayLike, t: ArrayLike, sigma: ArrayLike | None = None
    ) -> TrackState:
        """State after one more plot; equals `run` to the last bit.

        Parameters
        ----------
        state : TrackState
            From `start`, `step` or a result.
        z, t, sigma : array_like
            As for `start`; the time later than that of the state.

        Raises
        ------
        DataError, ValueError
            As for `run`.
        """
        if not isinstance(state, TrackState):
            raise _no_state(state)
        step = self._compiled_steps.get(state.rows.n_axes) or self._new_compiled_step(state)
        after = None if step is None else step(state, z, t, sigma)
        return self._one_step(state, z, t, sigma) if after is None else after

    def predict(
        self, state: TrackState, t: ArrayLike, sigma: ArrayLike | None = None
    ) -> Prediction:
        """Predict a track, or a batch of tracks, to a later time; the state does not change.

        Parameters
        ----------
        state : TrackState
            From `start`, `step` or a result.
        t : array_like, shape () or (...batch)
            Time (s), common or each track's own. It must be later than that of the state: a plot
            of the same time could not be used by `step`.
        sigma : array_like, optional
            Standard deviation of the next plots (m), broadcast against the positions, for
            `innovation_variance`; the tracker's `sigma_w` unless given.

        Returns
        -------
        Prediction
            Position, velocity and acceleration are those of a `step` with a missed plot, to the
            last bit; variances are NaN if the tracker keeps no covariance.

        Raises
        ------
        DataError, ValueError
            As for `step`.

        Examples
        --------
        >>> from fuzzytrack import AlphaBetaTracker
        >>> from fuzzytrack.schedulers import KalmanCV
        >>> tracker = AlphaBetaTracker(KalmanCV(sigma_v=1.0, sigma_w=10.0))
        >>> state = tracker.run([0, 1, 2], [0, 31, 60]).state
        >>> prediction = tracker.predict(state, 4)
        >>> round(float(prediction.position), 2), round(float(prediction.velocity), 2)
        (120.33, 30.0)
        >>> round(float(prediction.innovation_variance), 1)
        590.2
        """
        if not isinstance(state, TrackState):
            raise _no_state(state)
        coasted = self.step(state, np.full(state.shape, np.nan), t, 1.0)
        variance = self._position_variance(state, coasted.time)
        if sigma is not None:
            noise = self._sigmas(sigma, np.zeros((1, *state.shape)))[0]
        else:
            noise = np.array(np.nan if self.sigma_w is None else self.sigma_w)
        return Prediction(
            coasted.time,
            coasted.position,
            coasted.velocity,
            coasted.acceleration,
            variance,
            np.asarray(variance + noise**2),
        )

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of the position predicted over a time (m²); NaN unless overridden.

        Parameters
        ----------
        memory : ndarray, shape (n_memory, lanes)
            Memories of lanes that have started, each as its state holds it.
        dt : ndarray, shape (lanes,)
            Time since the last plot (s), > 0, or with ``missed="step"`` since the last step.

        Returns
        -------
        ndarray or float
            The variance without that of the next plot, shape (n_axes, lanes) or, where a lane is an
            axis or its axes have it in common, (lanes,).
        """
        return np.nan

    def knows_variance(self, n_axes: int) -> bool:
        """Whether the tracker has the variance of its positions, see `prediction_variance`.

        Parameters
        ----------
        n_axes : int
            Axes of the plots.
        """
        t = np.arange(4.0)
        z = np.repeat(t[:, None], n_axes, axis=1)
        found = self.run(t, z, 1.0, keep=("position_variance",)).position_variance
        return bool(np.isfinite(found[-1]).all())

    def compile(self, n_axes: int = 1) -> None:
        """Compile now what `run` compiles when a job is large, and make `step` run compiled.

        Until then, or until a large `run`, `step` runs in plain Python: a stream of plots does not
        wait for the compiler. Compiled code is kept on disk for the next process.

        Parameters
        ----------
        n_axes : int
            Axes of the plots.
        """
        if operator.index(n_axes) < 1:
            raise ValueError(f"n_axes must be at least 1, got {n_axes}")
        runner(self, n_axes if self.coupled else 1).compile()

    def __getstate__(self) -> dict[str, Any]:
        made = ("_compiled_steps", "_origin")
        return {name: value for name, value in self.__dict__.items() if name not in made}

    @cached_property
    def _origin(self) -> Origin:
        """What the states of this tracker say of it."""
        return Origin(self)

    @cached_property
    def _compiled_steps(self) -> dict[int, CompiledStep]:
        """Compiled steps, by the number of axes of a lane."""
        return {}

    def _new_compiled_step(self, state: TrackState) -> CompiledStep | None:
        """Compiled step from states like this one; None if there is none for them."""
        n_axes = PlotLayout.of((0, *state.shape), self.coupled).lane_axes
        core = runner(self, n_axes)
        if core.own_step is None or core.rows != state.rows:
            return None
        step = self._compiled_steps[n_axes] = CompiledStep(core, self.needs_sigma, self._origin)
        return step

    def _one_step(
        self, state: TrackState | None, z: ArrayLike, t: ArrayLike, sigma: ArrayLike | None
    ) -> TrackState:
        before = _time_of(state)
        plots = as_plots(z, np.float64)[None]
        times = as_times(with_time_axis(t), before)
        layout = PlotLayout.of(plots.shape, self.coupled)
        if np.isinf(plots).any():
            raise infinite_plot(plots)
        core = runner(self, layout.lane_axes)
        self._check_state(state, plots, core.rows)
        time_steps(times, plots.shape, before)
        lane_times = layout.times_to_lanes(times)
        deviation = None if sigma is None else with_time_axis(sigma)
        sigmas = layout.to_lanes(self._sigmas(deviation, plots))
        shape = (layout.lanes, layout.lane_axes)
        lanes = core.fresh(layout.lanes) if state is None else state.lanes
        try:
            if core.native:
                after, _ = core(lanes, plots.reshape(1, *shape), lane_times, sigmas, True, (), 1)
            else:
                after = core.step(
                    lanes,
                    plots.reshape(shape),
                    np.broadcast_to(lane_times[0], (layout.lanes,)).tolist(),
                    np.broadcast_to(sigmas[0], shape).tolist(),
                )
        except Exception as error:
            self._explain(error, layout.lane_axes)
            if _is_arithmetic(error):
                raise self._out_of_range() from error
            raise
        if (lane := core.lost(after)) is not None:
            raise self._out_of_range(layout.track_of(lane))
        return TrackState(times[0].copy(), plots.shape[1:], after, core.rows, self._origin)

    def _check_state(self, state: TrackState | None, plots: Array, rows: Rows) -> None:
        """Raise ValueError for a state of other tracks, or of another tracker."""
        if state is None:
            return
        if state.shape != plots.shape[1:]:
            raise ValueError(
                f"z: plots of shape {plots.shape[1:]} do not go on from a state of shape "
                f"{state.shape}"
            )
        check_origin(state, rows, self._origin)

    def _explain(self, error: Exception, n_axes: int) -> None:
        """Name the tracker in an error of its step; PluginError if its functions lack the form."""
        self._check_form(n_axes)
        error.add_note(f"in a step of {self.name}")

    def _out_of_range(self, track: tuple[int, ...] = ()) -> DataError:
        """Error about a track, or the only one, whose numbers have left the range of floats."""
        which = f" {track if len(track) > 1 else track[0]}" if track else ""
        return DataError(
            f"z: track{which} cannot be followed with floating-point numbers: its plots, times or "
            f"standard deviations, or the parameters of {self!r}, are too large or too small; "
            "give plots about an origin near them, in units in which they are ordinary numbers"
        )

    def _check_form(self, n_axes: int) -> None:
        """Raise PluginError if the tracker's part of `single_axis_step` lacks the form for it.

        Called when a step has failed: it is no work for trackers without a mistake.
        """
        core = Runner(self.program(n_axes))
        try:
            core.step(core.fresh(1), np.zeros((1, n_axes)), [1.0], [[1.0] * n_axes])
        except Exception as error:
            raised_in = traceback.extract_tb(error.__traceback__)[-1].filename
            if raised_in == single_axis_step.__code__.co_filename:
                raise PluginError(
                    f"{self.name}: correct must take {CORRECT_TAKES} and return "
                    f"{CORRECT_RETURNS}; {error}",
                    Location.of_function(self.program),
                ) from error

    def _position_variance(self, state: TrackState, time: Array | np.float64) -> Array:
        """Variance of the position predicted for a later time, shaped as a plot."""
        layout, rows = PlotLayout.of((0, *state.shape), self.coupled), state.rows
        (times,) = layout.times_to_lanes(np.asarray(time)[None])
        dts = times - state.lanes[rows.last_time]
        # Of lanes that have not started it may be anything.
        with np.errstate(over="ignore", invalid="ignore"):
            variance = self.prediction_variance(state.lanes[rows.memory : rows.state], dts)
        running = state.lanes[rows.plots] >= 2.0
        lanes = np.where(running, variance, np.nan)
        by_axis = np.broadcast_to(lanes, (rows.n_axes, layout.lanes))
        return np.array(by_axis.T).reshape(state.shape)

    def _sigmas(self, sigma: ArrayLike | None, plots: Array) -> Array:
        return plot_sigmas(sigma, plots, self._typed or self.name if self.needs_sigma else None)


def _is_arithmetic(error: Exception) -> bool:
    """Whether compiled code of this package goes on with NaN or infinity where Python raises this.

    That of a plug-in is left to its author.
    """
    domain = type(error) is ValueError and str(error) == "math domain error"
    raised_in = traceback.extract_tb(error.__traceback__)[-1].filename
    ours = raised_in == "<rule base>" or Path(raised_in).is_relative_to(_PACKAGE)
    return ours and (domain or isinstance(error, ArithmeticError))


def check_missed(missed: str) -> None:
    """Raise ValueError unless it is a word for `LaneTracker.missed`."""
    if missed not in MISSED:
        raise ValueError(f"missed: unknown {missed!r}; one of {', '.join(MISSED)}")


def _no_state(given: object) -> TypeError:
    """Error about what was given in place of a state."""
    return TypeError(f"state must be a TrackState, got {type(given).__name__}")


def _time_of(state: TrackState | None) -> Array | np.float64 | None:
    """Time of a state (s); None for new tracks."""
    if not (state is None or isinstance(state, TrackState)):
        raise _no_state(state)
    return None if state is None else state.time


def _check_threads(threads: int | None) -> None:
    if threads is not None and operator.index(threads) < 1:
        raise ValueError(f"threads must be at least 1, got {threads}")
