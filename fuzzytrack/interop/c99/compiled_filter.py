"""A tracker in C, compiled by this computer's compiler and called from Python."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.errors import DataError
from fuzzytrack.interop.c99.build import built
from fuzzytrack.interop.c99.compiled import DTYPES, whole_source
from fuzzytrack.interop.c99.filter import STATUS, FilterTranslation, translated_filter
from fuzzytrack.plurals import counted
from fuzzytrack.reprs import summary
from fuzzytrack.schedulers.base import GainScheduler
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.catalog import as_lane_tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker

__all__ = ["CompiledFilter", "FilterRun", "compiled_c"]

#: Results of a run, in the order in which the C code writes them.
_OUTPUTS = (
    "filtered", "velocity", "acceleration", "predicted", "innovation", "alpha", "beta", "gamma",
)  # fmt: skip
#: Tracks that go through time together: their states stay in the cache.
_BLOCK = 64


@dataclass(frozen=True, eq=False)
class FilterRun:
    """What a compiled filter gives.

    Attributes
    ----------
    filtered, velocity, acceleration, predicted, innovation : ndarray
        As in a `fuzzytrack.trackers.result.TrackResult`, in the shape of the plots.
    alpha, beta, gamma : ndarray
        The last axis has one set of gains for all axes, or one for each.
    """

    filtered: NDArray[Any]
    velocity: NDArray[Any]
    acceleration: NDArray[Any]
    predicted: NDArray[Any]
    innovation: NDArray[Any]
    alpha: NDArray[Any]
    beta: NDArray[Any]
    gamma: NDArray[Any]

    def __repr__(self) -> str:
        return summary(self, *_OUTPUTS)


class CompiledFilter:
    """A tracker in C; made by `compiled_c`.

    Attributes
    ----------
    translation : FilterTranslation
        Its text, sizes and operation counts.
    """

    def __init__(
        self, translation: FilterTranslation, compiler: str | None, flags: Sequence[str]
    ) -> None:
        self.translation = translation
        text = whole_source(translation.definitions, _driver(translation))
        self._library = built(text, compiler=compiler, flags=flags, link=bool(translation.needs))
        name = translation.name
        self._init = self._library[f"{name}_init_many"]
        self._run = self._library[f"{name}_run"]
        self._init.restype, self._run.restype = None, ctypes.c_int64
        self._size = int(ctypes.c_int64.in_dll(self._library, f"{name}_size").value)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.translation!r}>"

    def start(self, tracks: int = 1) -> NDArray[np.uint8]:
        """States of tracks before their first plots: structs of C, for `run`."""
        states = np.zeros((tracks, self._size), np.uint8)
        self._init(ctypes.c_int64(tracks), ctypes.c_void_p(states.ctypes.data))
        return states

    def run(
        self,
        t: ArrayLike,
        z: ArrayLike,
        sigma: ArrayLike | None = None,
        *,
        states: NDArray[np.uint8] | None = None,
        keep: Sequence[str] = _OUTPUTS,
    ) -> FilterRun:
        """Track plots over time.

        Parameters
        ----------
        t : array_like, shape (n_steps,) or (n_steps, tracks)
            Times (s), increasing.
        z : array_like, shape (n_steps, axes), (n_steps, tracks, axes) or (n_steps,)
            Plots (m); NaN where missed.
        sigma : array_like, optional
            Standard deviation of the plots (m), broadcast against `z`.
        states : ndarray, optional
            From `start`, or from a run before: it is changed, so that the next run continues.
        keep : sequence of str
            Names of the results wanted; others are empty.

        Raises
        ------
        DataError
            If a step refuses a plot; says which and why.
        ValueError
            If shapes do not fit.
        """
        made, dtype = self.translation, DTYPES[self.translation.number]
        plots = np.asarray(z, dtype=dtype)
        if (plots.shape[-1] if plots.ndim > 1 else 1) != made.axes or plots.ndim > 3:
            raise ValueError(
                f"z: shape {plots.shape} does not fit a filter of "
                f"{counted(made.axes, 'axis', 'axes')}; (n_steps, "
                f"{made.axes}) or (n_steps, tracks, {made.axes}) does"
            )
        steps, tracks = len(plots), plots.shape[1] if plots.ndim == 3 else 1
        states = self.start(tracks) if states is None else states
        if states.shape != (tracks, self._size) or not states.flags.c_contiguous:
            raise ValueError(f"states: shape {states.shape}; needed is {(tracks, self._size)}")
        times = np.ascontiguousarray(t, dtype=np.float64)
        if times.shape not in ((steps,), (steps, tracks)):
            raise ValueError(f"t: shape {times.shape} does not fit plots of shape {plots.shape}")
        given = np.nan if sigma is None else np.asarray(sigma, dtype=dtype)
        sigmas = np.ascontiguousarray(np.broadcast_to(given, plots.shape), dtype=dtype)
        plots = np.ascontiguousarray(plots)
        found = {name: self._output(name, plots, name in keep) for name in _OUTPUTS}
        failed = ctypes.c_int64(-1)
        status = self._run(
            ctypes.c_int64(steps), ctypes.c_int64(tracks), ctypes.c_int64(times.ndim > 1),
            *(_pointer(array) for array in (times, plots, sigmas, states)),
            *(_pointer(array) if array.size else None for array in found.values()),
            ctypes.byref(failed),
        )  # fmt: skip
        if status:
            at = divmod(failed.value, tracks)
            name, words = list(STATUS.items())[status]
            argument = {"TIME": "t", "SIGMA": "sigma"}.get(name, "z")
            raise DataError(f"{argument}: at index {at if plots.ndim == 3 else at[0]}: {words}")
        return FilterRun(**found)

    def _output(self, name: str, plots: NDArray[Any], wanted: bool) -> NDArray[Any]:
        shape = plots.shape
        if name in ("alpha", "beta", "gamma"):
            shape = (*(plots.shape[:-1] if plots.ndim > 1 else shape), self.translation.gain_sets)
        return np.empty(shape if wanted else 0, plots.dtype)


def compiled_c(
    tracker: LaneTracker | GainScheduler | str,
    *,
    axes: int = 1,
    number: str = "double",
    compiler: str | None = None,
    flags: Sequence[str] = ("-O2",),
    libm: Sequence[str] = (),
) -> CompiledFilter:
    """A tracker as C code, compiled and loaded: to compare with Python, and to measure.

    Parameters
    ----------
    tracker : LaneTracker, GainScheduler or str
        A scheduler stands for the α-β(-γ) tracker with its gains; a text names a tracker or a
        scheduler as everywhere.
    axes, number, libm
        As for `fuzzytrack.interop.c99.filter.translated_filter`.
    compiler : str, optional
        Its command. Unless given, that in the environment variable ``CC``, as for make; without
        it ``cc``, ``gcc`` or ``clang``, the first that is installed.
    flags : sequence of str
        Options of the compiler, such as ``("-O3", "-march=native")``. Options that let it change
        the order of operations, such as ``-ffast-math``, give other results.

    Raises
    ------
    CompilerError
        If there is no compiler, or it does not compile the code.
    TranslationError
        If the tracker cannot be written in C; says why and where.
    TypeError
        If `tracker` is something else.

    Examples
    --------
    >>> from fuzzytrack.interop.c99.compiled_filter import compiled_c
    >>> tracker = compiled_c("fixed:alpha=0.5:beta=0.2")  # doctest: +SKIP
    >>> tracker.run([0, 1, 2, 3], [0, 10, 19, 31]).predicted  # doctest: +SKIP
    array([ nan,  nan, 20. , 29.3])
    """
    made = AlphaBetaTracker(tracker) if isinstance(tracker, GainScheduler) else tracker
    made = as_lane_tracker(made)
    translation = translated_filter(made, name="tracker", axes=axes, number=number, libm=libm)
    return CompiledFilter(translation, compiler, flags)


def _pointer(array: NDArray[Any]) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def _driver(translation: FilterTranslation) -> str:
    """Functions in C that run many tracks over time."""
    name, number, axes = translation.name, translation.number, translation.axes
    fields = ("position", *_OUTPUTS[1:])
    sets = {"alpha", "beta", "gamma"}
    head = (
        f"int64_t {name}_run(int64_t steps, int64_t tracks, int64_t own_times, "
        f"const double *times, const {number} *plots, const {number} *sigmas, "
        f"{name}_state *states, "
        + ", ".join(f"{number} *{output}" for output in _OUTPUTS)
        + ", int64_t *failed)"
    )
    copies = []
    for field, output in zip(fields, _OUTPUTS, strict=True):
        width = translation.gain_sets if output in sets else axes
        copies += [
            f"                if ({output} != NULL) {{",
            f"                    memcpy({output} + place * {width}, state->{field}, "
            f"sizeof state->{field});",
            "                }",
        ]
    return "\n".join(
        [
            f"extern const int64_t {name}_size;",
            f"const int64_t {name}_size = (int64_t)sizeof({name}_state);",
            f"extern void {name}_init_many(int64_t count, {name}_state *states);",
            f"void {name}_init_many(int64_t count, {name}_state *states)",
            "{",
            "    for (int64_t k = 0; k < count; ++k) {",
            f"        {name}_init(&states[k]);",
            "    }",
            "}",
            f"extern {head};",
            head,
            "{",
            f"    for (int64_t first = 0; first < tracks; first += {_BLOCK}) {{",
            f"        const int64_t end = first + {_BLOCK} < tracks ? first + {_BLOCK} : tracks;",
            "        for (int64_t k = 0; k < steps; ++k) {",
            "            for (int64_t track = first; track < end; ++track) {",
            "                const int64_t place = k * tracks + track;",
            f"                {name}_state *const state = &states[track];",
            f"                const int32_t status = {name}_step(state,",
            f"                    times[own_times ? place : k], plots + place * {axes},",
            f"                    sigmas + place * {axes});",
            "                if (status != 0) {",
            "                    *failed = place;",
            "                    return status;",
            "                }",
            *copies,
            "            }",
            "        }",
            "    }",
            "    return 0;",
            "}\n",
        ]
    )
