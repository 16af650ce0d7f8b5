"""A whole tracker in C99: its recursion, scheduler, memory, starts and missed plots."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzytrack.interop.c99.compiled import DTYPES
from fuzzytrack.interop.c99.function_writer import written_function
from fuzzytrack.interop.c99.program import Program, number_text
from fuzzytrack.interop.c99.python_source import FloatRangeError
from fuzzytrack.interop.c99.translation import INCLUDES, Translation
from fuzzytrack.interop.c99.values import Fixed, Room
from fuzzytrack.lanes.layout import GAINS, Rows
from fuzzytrack.lanes.plots import SIGMAS
from fuzzytrack.lanes.program import LaneProgram
from fuzzytrack.trackers.lane_tracker import LaneTracker

__all__ = ["STATUS", "FilterTranslation", "translated_filter"]

#: What a step returns, by the ends of the names in C.
STATUS = {
    "DONE": "the plot was used, or counted as missed",
    "INFINITE_PLOT": "a coordinate is infinite; nothing done",
    "TIME": "time not finite, or not later than before; nothing done",
    "SIGMA": "a standard deviation is missing or out of range; nothing done",
    "NOT_FINITE": "the track left the range of numbers; start it again",
}

#: Axes of a filter. With coupled axes the step is written out for each, and long before 24 of them
#: it is too long for Numba, with which the library runs the same step.
MOST_AXES = 12
#: Vectors of the state that a user reads.
_SHOWN = ("position", "velocity", "acceleration", "predicted", "innovation")
_MEANINGS = {
    "position": "position (m); after a missed plot the prediction",
    "velocity": "velocity (m/s)",
    "acceleration": "acceleration (m/s^2)",
    "predicted": "position predicted for this step (m); NaN at a start",
    "innovation": "plot minus prediction (m); NaN without either",
    "alpha": "gains of this step; NaN where no plot corrects a prediction",
    "beta": "",
    "gamma": "",
}


@dataclass(frozen=True, eq=False, repr=False)
class FilterTranslation(Translation):
    """A tracker in C99.

    Attributes
    ----------
    axes : int
        Axes of space.
    inside : {"double", "float"}
        Type in which a step calculates and keeps its memory; `number` is that of plots and results.
    gain_sets : int
        Sets of gains of a track.
    state_bytes, stack_bytes : int
        Size of the state of a track; numbers that a step needs beside it.
    needs_sigma : bool
        Whether plots need a standard deviation.
    """

    axes: int
    inside: str
    gain_sets: int
    state_bytes: int
    stack_bytes: int
    needs_sigma: bool


def translated_filter(
    tracker: LaneTracker,
    *,
    name: str,
    axes: int,
    number: str = "double",
    libm: Sequence[str] = (),
) -> FilterTranslation:
    """A tracker as two C functions over one struct.

    Parameters
    ----------
    tracker : LaneTracker
        Such as `fuzzytrack.AlphaBetaTracker`; others of the package can be written, too.
    name, number, libm
        As for `fuzzytrack.interop.c99.translation.translated`.
    axes : int
        Axes of space, >= 1.

    Returns
    -------
    FilterTranslation
        It has a struct ``NAME_state`` and the functions ``NAME_init(state)`` and ``NAME_step(state,
        time, plot, sigma)``. A plot with a coordinate that is NaN is missed, on that axis, or on
        all of them if the tracker is coupled. A step returns 0, or one of the other values of the
        enumeration, see `STATUS`. Times are in double precision in any case.

    Raises
    ------
    PluginError
        If the scheduler lacks the form.
    TranslationError
        If a function of the tracker uses what is not written in C.
    ValueError
        If `axes`, `name`, `number` or `libm` is wrong.

    Notes
    -----
    Written from the step of the tracker's `fuzzytrack.lanes.program.LaneProgram`, which also runs
    in Python and compiled. So it does the same operations, in the same order. A step that needs
    numbers beyond the range of floats calculates in double precision, and its results are rounded.
    """
    if not isinstance(axes, int) or not 1 <= axes <= MOST_AXES:
        raise ValueError(f"axes must be a whole number from 1 to {MOST_AXES}, got {axes!r}")
    lane_axes = axes if tracker.coupled else 1
    lane = tracker.program(lane_axes)
    try:
        return _translated(tracker, lane, name, axes, number, number, libm)
    except FloatRangeError:
        return _translated(tracker, lane, name, axes, number, "double", libm)


def _translated(
    tracker: LaneTracker, lane: LaneProgram, name: str, axes: int, number: str, inside: str,
    libm: Sequence[str],
) -> FilterTranslation:  # fmt: skip
    """A tracker that calculates in one type of number, and takes and gives another."""
    taken = [f"{name}_{part}" for part in ("state", "init", "step", *STATUS)]
    parts = Program(name, inside, libm, taken)
    step: Any = lane.step(1)
    written = written_function(parts, step, (Room(lane.rows.total), Fixed(1)))
    template = _Template(parts, tracker, lane, axes, written.name, number)
    before = parts.definitions()
    return FilterTranslation(
        name=name,
        number=number,
        definitions=before + "\n" + template.text(),
        prototype=template.prototype,
        takes=(),
        gives=0,
        includes=INCLUDES,
        needs=frozenset(parts.needs),
        operations={key: count * template.lanes for key, count in sorted(written.costs.items())},
        constants_bytes=parts.constants_bytes,
        axes=axes,
        inside=inside,
        gain_sets=template.gain_sets,
        state_bytes=template.state_bytes,
        stack_bytes=lane.rows.total * _size(inside),
        needs_sigma=tracker.needs_sigma,
    )


class _Template:
    """The struct of a track, and what goes around the step of a lane.

    Parameters
    ----------
    parts : Program
    tracker : LaneTracker
    lane : LaneProgram
    axes : int
    step : str
        Name of the step in C.
    number : str
        Type of plots and results.
    """

    def __init__(
        self, parts: Program, tracker: LaneTracker, lane: LaneProgram, axes: int, step: str,
        number: str,
    ) -> None:  # fmt: skip
        self.parts, self.tracker, self.lane, self.step = parts, tracker, lane, step
        self.axes, self.rows = axes, lane.rows
        self.name, self.number, self.inside = parts.name, number, parts.number
        #: What a result is preceded by, and a plot.
        self.given = "" if number == self.inside else f"({number})"
        self.taken = "" if number == self.inside else f"({self.inside})"
        self.lanes = axes // self.rows.n_axes
        self.gain_sets = self.lanes * self.rows.gain_sets
        self.elapsed = tracker.missed == "elapsed"
        self.prototype = (
            f"int32_t {self.name}_step({self.name}_state *state, double time, "
            f"const {self.number} plot[{axes}], const {self.number} sigma[{axes}])"
        )

    @property
    def state_bytes(self) -> int:
        """Size of the struct."""
        kept = self.lanes * self.rows.state * _size(self.inside)
        shown = (len(_SHOWN) * self.axes + 3 * self.gain_sets) * _size(self.number)
        return 8 * (1 + self.lanes) + -(-(kept + shown) // 8) * 8

    def text(self) -> str:
        """Struct, enumeration and functions."""
        return "\n".join([*self._struct(), "", *self._init(), "", *self._step(), ""])

    def _struct(self) -> list[str]:
        vectors = [(name, self.axes) for name in _SHOWN] + [(g, self.gain_sets) for g in GAINS]
        width = max(len(f"{name}[{count}];") for name, count in vectors)
        shown = [
            f"    {self.number} {f'{name}[{count}];'.ljust(width)} "
            + (f"/* {_MEANINGS[name]} */" if _MEANINGS[name] else "")
            for name, count in vectors
        ]
        return [
            f"/* A track; its first members are of {self.name}_step only. */",
            "typedef struct {",
            "    double time;",
            f"    double plot_time[{self.lanes}];",
            f"    {self.inside} kept[{self.lanes}][{self.rows.state}];",
            *(line.rstrip() for line in shown),
            f"}} {self.name}_state;",
            "",
            f"/* What {self.name}_step returns. */",
            "enum {",
            ",\n".join(
                f"    /* {words} */\n    {self.name}_{key} = {k}"
                for k, (key, words) in enumerate(STATUS.items())
            ),
            "};",
        ]

    def _init(self) -> list[str]:
        rows, fresh = self.rows, np.zeros(self.rows.state)
        fresh[: rows.n_axes] = math.nan
        fresh[rows.memory : rows.state] = self.lane.memory
        digits = [self.parts.digits(float(value)) for value in fresh]
        nan = number_text(math.nan, self.number)
        return [
            "/* A track before its first plot. */",
            f"FUZZYTRACK_INLINE void {self.name}_init({self.name}_state *state)",
            "{",
            f"    static const {self.inside} fresh[{len(digits)}] = {{",
            *_filled(digits),
            "    };",
            "    int32_t k;",
            "    state->time = (double)NAN;",
            f"    for (k = 0; k < {self.lanes}; ++k) {{",
            "        state->plot_time[k] = (double)NAN;",
            "        (void)memcpy(state->kept[k], fresh, sizeof fresh);",
            "    }",
            f"    for (k = 0; k < {self.axes}; ++k) {{",
            *(f"        state->{name}[k] = {nan};" for name in _SHOWN),
            "    }",
            f"    for (k = 0; k < {self.gain_sets}; ++k) {{",
            *(f"        state->{name}[k] = {nan};" for name in GAINS),
            "    }",
            "}",
        ]

    def _step(self) -> list[str]:
        rows, n = self.rows, self.rows.n_axes
        infinity = number_text(math.inf, self.number)
        return [
            "/* One step: a plot (NaN where it was missed) at a time later than the last one. */",
            *_broken(f"FUZZYTRACK_INLINE {self.prototype}"),
            "{",
            f"    {self.inside} b[{rows.total}];",
            "    bool finite = true;",
            "    int32_t k;",
            "    int32_t j;",
            *([] if self.tracker.needs_sigma else ["    (void)sigma;"]),
            "    /* A difference of infinite times, or of NaN, is NaN. */",
            "    if (!(time - time == 0.0) || time <= state->time) {",
            f"        return {self.name}_TIME;",
            "    }",
            f"    for (k = 0; k < {self.axes}; ++k) {{",
            f"        if (plot[k] == {infinity} || plot[k] == -{infinity}) {{",
            f"            return {self.name}_INFINITE_PLOT;",
            "        }",
            *self._sigma_check(),
            "    }",
            "    state->time = time;",
            f"    for (k = 0; k < {self.lanes}; ++k) {{",
            "        const bool started = state->plot_time[k] == state->plot_time[k];",
            "        bool seen = true;",
            "        (void)memset(b, 0, sizeof b);",
            "        (void)memcpy(b, state->kept[k], sizeof state->kept[k]);",
            f"        for (j = 0; j < {n}; ++j) {{",
            f"            const {self.inside} z = {self.taken}plot[{_sum(_product('k', n), 'j')}];",
            f"            b[{_sum('j', rows.plot)}] = z;",
            f"            b[{_sum('j', rows.sigma)}] = "
            + (
                f"{self.taken}sigma[{_sum(_product('k', n), 'j')}];"
                if self.tracker.needs_sigma
                else f"{self.parts.digits(math.nan)};"
            ),
            "            seen = seen && z == z;",
            "        }",
            f"        b[{rows.dt}] = started ? ({self.inside})(time - state->plot_time[k]) : "
            f"{self.parts.digits(0.0)};",
            f"        {self.step}(b);",
            *self._kept(),
            *self._outputs(rows, n),
            "    }",
            f"    return finite ? {self.name}_DONE : {self.name}_NOT_FINITE;",
            "}",
        ]

    def _sigma_check(self) -> list[str]:
        if not self.tracker.needs_sigma:
            return []
        low, high = (number_text(s, self.number) for s in SIGMAS[DTYPES[self.number]])
        return [
            f"        if (plot[k] == plot[k] && !(sigma[k] >= {low} && sigma[k] <= {high})) {{",
            f"            return {self.name}_SIGMA;",
            "        }",
        ]

    def _kept(self) -> list[str]:
        """The state after a step: with time from plot to plot, that of the last plot."""
        copy = "(void)memcpy(state->kept[k], b, sizeof state->kept[k]);"
        time = "state->plot_time[k] = time;"
        if not self.elapsed:
            return [f"        {copy}", f"        {time}"]
        if self.lane.keeps_state:
            return [f"        {copy}", "        if (seen) {", f"            {time}", "        }"]
        return ["        if (seen) {", f"            {copy}", f"            {time}", "        }"]

    def _outputs(self, rows: Rows, n: int) -> list[str]:
        """Results of a step, where a user finds them."""
        keeps = self.lane.keeps_state
        first = (rows.now, rows.now + n, rows.now + 2 * n) if keeps else (0, n, 2 * n)
        places = dict(zip(_SHOWN, (*first, rows.predicted, rows.innovation), strict=True))
        target = _sum(_product("k", n), "j")
        gains = _sum(_product("k", rows.gain_sets), "j")
        zero = self.parts.digits(0.0)
        waits = f"!(b[{rows.plots}] > {zero})"
        nothing = number_text(0.0, self.number)
        results = (f"state->{name}[{target}]" for name in _SHOWN[:3])
        tests = " && ".join(f"{x} - {x} == {nothing}" for x in results)
        return [
            f"        for (j = 0; j < {n}; ++j) {{",
            *(
                f"            state->{name}[{target}] = {self.given}b[{_sum('j', place)}];"
                for name, place in places.items()
            ),
            # A difference of infinite numbers, or of NaN, is NaN.
            f"            finite = finite && ({waits} || ({tests}));",
            "        }",
            f"        for (j = 0; j < {rows.gain_sets}; ++j) {{",
            *(
                f"            state->{name}[{gains}] = {self.given}b[{_sum('j', place)}];"
                for name, place in ((name, rows.output(name)) for name in GAINS)
            ),
            "        }",
        ]


def _size(number: str) -> int:
    """Bytes of a number."""
    return int(np.dtype(DTYPES[number]).itemsize)


def _product(name: str, factor: int) -> str:
    return name if factor == 1 else f"{factor} * {name}"


def _sum(name: str, other: str | int) -> str:
    return name if other == 0 else f"{name} + {other}"


def _filled(words: list[str]) -> list[str]:
    """Words of an initializer in lines."""
    lines, line = [], "       "
    for k, word in enumerate(words):
        piece = f" {word}{',' if k + 1 < len(words) else ''}"
        if len(line) + len(piece) > 100:
            lines.append(line)
            line = "       "
        line += piece
    return [*lines, line]


def _broken(head: str) -> list[str]:
    """Head of a function in two lines."""
    first, comma, rest = head.partition(", const")
    return [first + ",", "    const" + rest] if comma else [head]
