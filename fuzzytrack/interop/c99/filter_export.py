"""A whole tracker in an exported header: its source, its error, and its check."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import PrecisionWarning, TrackWarning
from fuzzytrack.interop.c99.c_program import CProgram, operations_in_words
from fuzzytrack.interop.c99.c_text import literal
from fuzzytrack.interop.c99.filter import FilterTranslation, translated_filter
from fuzzytrack.interop.c99.number_types import NumberType
from fuzzytrack.interop.c99.selftest import Check, check_lines, constant_rows
from fuzzytrack.plurals import counted
from fuzzytrack.reprs import summary
from fuzzytrack.trackers.lane_tracker import LaneTracker

__all__ = ["FilterExport", "filter_export"]

# Tracks of a trial and plots of each; the first track is the self-test.
_TRACKS, _PLOTS = 100, 100
_RADIUS, _SIGMA = 2_000.0, 10.0
#: A self-test in single precision allows so many times the largest error of the trial.
_MARGIN = 4.0
#: In double precision the operations are those of the library, in the same order.
_DOUBLE = 1e-9
#: Change of plots from which their growth is measured (m).
_CHANGE = 1e-6
#: An error of more than this part of the noise of the plots is warned of.
_LARGE = 0.01


@dataclass(frozen=True, eq=False)
class FilterExport:
    """A tracker in C.

    Attributes
    ----------
    translation : FilterTranslation
    number : NumberType
    errors : tuple of (float, float), or None
        Largest error of a position (m), and of a velocity (m/s), in a trial in single precision:
        no bound. None in double precision.
    allowed : tuple of (float, float)
        Errors that the self-test allows.
    growth : float
        How many times as large small differences between plots became in positions of the trial.
    times, plots, sigmas, expected : ndarray
        A track: times, plots and their standard deviations as numbers of C, and what the library
        gives: positions, then velocities.
    """

    translation: FilterTranslation
    number: NumberType
    errors: tuple[float, float] | None
    allowed: tuple[float, float]
    growth: float
    times: Array
    plots: Any
    sigmas: Any
    expected: Array

    def __repr__(self) -> str:
        return summary(self, "translation", "errors", "growth")

    def program(self) -> CProgram:
        """Source in C."""
        made = self.translation
        return CProgram(
            made.definitions,
            made.operations,
            made.constants_bytes,
            made.stack_bytes,
            frozenset(made.includes),
            made.needs,
        )

    def about(self, beside: str = "") -> Iterator[tuple[str, str]]:
        """What a comment says of it.

        Parameters
        ----------
        beside : str
            The function of the same rule base in the header; empty if there is none.
        """
        made = self.translation
        sigma = "with" if made.needs_sigma else "without"
        yield "", ""
        yield (
            "Filter",
            f"{made.name}_init, {made.name}_step: "
            f"{counted(made.axes, 'axis', 'axes')}, plots in m {sigma} standard "
            "deviations, times in s; a coordinate that is NaN is missed",
        )
        if beside:
            yield (
                "Rules",
                f"calculated as by the tracker of fuzzytrack, not by {beside}: they differ by "
                "roundings",
            )
        trial = (
            f"a trial of {_TRACKS} turning tracks of {_PLOTS} plots within {_RADIUS:.0f} m of the "
            f"origin, with noise of {_SIGMA:.0f} m and a tenth missed"
        )
        growth = (
            f"in {'that trial' if self.errors else trial}, small differences between plots, and so "
            f"roundings, became up to {_rounded_up(self.growth)} times as large in positions"
        )
        if self.errors is None:
            yield (
                "Error bound",
                f"position {_DOUBLE:g} m, velocity {_DOUBLE:g} m/s: of differences from "
                "fuzzytrack; the same operations in the same order, so that only exponentials and "
                "powers differ",
            )
        else:
            position, velocity = map(_rounded_up, self.errors)
            how = " It calculates in double, and rounds results." if self.widened else ""
            yield (
                "Error met",
                f"position {position} m, velocity {velocity} m/s. THIS IS NOT A BOUND: it is the "
                f"largest difference from fuzzytrack in double precision in {trial}. Other tracks "
                f"may err by more, without limit; the self-test allows {_MARGIN:.0f} times as "
                f"much.{how}",
            )
        yield "Growth", growth
        yield "ROM", f"{made.constants_bytes} bytes of constants, and the code"
        yield "RAM", f"{made.state_bytes} bytes a track; stack: {made.stack_bytes} bytes of numbers"
        yield "Operations", f"at most {operations_in_words(made.operations)} for a step"

    def figures(self) -> dict[str, Any]:
        """The same as JSON."""
        made = self.translation
        return {
            "axes": made.axes,
            "needs_sigma": made.needs_sigma,
            "inside": made.inside,
            "errors_met": None if self.errors is None else _named(self.errors),
            "errors_allowed": _named(self.allowed),
            "growth": self.growth,
            "rom_bytes": made.constants_bytes,
            "ram_bytes_per_track": made.state_bytes,
            "stack_bytes": made.stack_bytes,
            "operations": dict(made.operations),
            "needs": sorted(made.needs),
        }

    @property
    def widened(self) -> bool:
        """Whether it calculates in double precision although its plots and results are floats."""
        return self.translation.inside != self.number.name

    def check(self) -> Check:
        """Check of a track."""
        name, c_type, axes = self.translation.name, self.number.c_type, self.translation.axes
        position, velocity = (literal(self.number.dtype(b)) for b in self.allowed)
        # An expected value is rounded, too.
        wanted = self.expected.astype(self.number.dtype)
        compared = [
            f"        wrong += is_wrong(track.{word}[k], right[row][{place}], {bound});"
            for word, place, bound in (
                ("position", "k", position),
                ("velocity", f"k + {axes}U", velocity),
            )
        ]
        data = [
            "/* Times, plots and standard deviations of a track. */",
            *constant_rows("double", "times", self.times[:, None]),
            *constant_rows(c_type, "plots", self.plots),
            *constant_rows(c_type, "sigmas", self.sigmas),
            "/* Positions, then velocities. */",
            *constant_rows(c_type, "right", wanted),
        ]
        body = [
            f"{name}_state track;",
            "unsigned int wrong = 0U;",
            "unsigned int row;",
            "unsigned int k;",
            "",
            f"{name}_init(&track);",
            f"for (row = 0U; row < {len(self.times)}U; row++) {{",
            f"    if ({name}_step(&track, times[row][0], plots[row], sigmas[row]) != 0) {{",
            "        wrong += 1U;",
            "    }",
            f"    for (k = 0U; k < {axes}U; k++) {{",
            *compared,
            "    }",
            "}",
            "return wrong;",
        ]
        return Check("filter_check", wanted.size, check_lines("filter_check", data, body))


def filter_export(
    tracker: LaneTracker, number: NumberType, *, name: str, axes: int
) -> FilterExport:
    """Write a tracker in C, and measure its error.

    Parameters
    ----------
    tracker : LaneTracker
    number : NumberType
        ``double`` or ``float``.
    name : str
        With which all names begin.
    axes : int
        Axes of space.

    Raises
    ------
    TranslationError
        If the tracker cannot be written in C.
    ValueError
        If the numbers are integers, or `axes` is out of range.

    Warns
    -----
    PrecisionWarning
        If errors in single precision are large beside the noise of plots.

    Notes
    -----
    With numbers of 32 bits the error is that of the library in single precision, which does the
    same operations; or, if these need double precision, that of the rounded results.
    """
    if number.whole:
        raise ValueError("filter: there is none in integers; use the number double or float")
    made = translated_filter(tracker, name=name, axes=axes, number=number.name)
    times, plots, sigmas = _tracks(axes, number)
    with warnings.catch_warnings():
        # That gains do not suit the times of this track says nothing of a user's tracks.
        warnings.simplefilter("ignore", TrackWarning)
        exact, deviations = plots.astype(float), sigmas.astype(float)
        run = tracker.run(times, exact, deviations)
        growth = _growth(tracker, times, exact, deviations, run.filtered)
        if number.name == "double":
            errors, allowed = None, (_DOUBLE, _DOUBLE)
        else:
            single = run
            if made.inside == "float":
                single = tracker.run(times, plots, sigmas, dtype=np.float32)
            errors = (
                _apart(single.filtered, run.filtered), _apart(single.velocity, run.velocity)
            )  # fmt: skip
            allowed = (_MARGIN * errors[0], _MARGIN * errors[1])
    if errors is not None and errors[0] > _LARGE * _SIGMA:
        warnings.warn(_imprecise(errors[0], growth), PrecisionWarning, stacklevel=3)
    expected = np.concatenate([run.filtered[:, 0], run.velocity[:, 0]], axis=1)
    return FilterExport(
        made, number, errors, allowed, growth, times, plots[:, 0], sigmas[:, 0], expected
    )


def _growth(
    tracker: LaneTracker, times: Array, plots: Array, sigmas: Array, filtered: Array
) -> float:
    """How many times as large small changes of plots become in positions."""
    random = np.random.default_rng(2)
    changed = plots + random.choice([-_CHANGE, _CHANGE], plots.shape)
    moved = tracker.run(times, changed, sigmas, keep=("filtered",)).filtered - filtered
    return float(np.nanmax(np.abs(moved), initial=0.0)) / _CHANGE


def _imprecise(error: float, growth: float) -> str:
    return (
        f"in float this filter erred by {error:.2g} m in a trial with plots of "
        f"{_SIGMA:.0f} m noise, since small differences between plots become up to "
        f"{_rounded_up(growth)} times as large in its positions; use the number double"
    )


def _named(errors: tuple[float, float]) -> dict[str, float]:
    return dict(zip(("position", "velocity"), errors, strict=True))


def _tracks(axes: int, number: NumberType) -> tuple[Array, Any, Any]:
    """Times, and plots of turning targets with their noise, in numbers of C."""
    random = np.random.default_rng(1)
    times = np.cumsum(random.uniform(0.5, 1.5, _PLOTS)).round(3)
    turning = random.normal(0.0, 0.02, (_PLOTS, _TRACKS)).cumsum(axis=0) * 0.2
    angle = turning.cumsum(axis=0) + random.uniform(0, 6, _TRACKS)
    phases = np.arange(axes) * np.pi / 2
    plots = _RADIUS * np.cos(angle[..., None] + phases)
    sigmas = random.uniform(0.5 * _SIGMA, 1.5 * _SIGMA, plots.shape)
    plots = plots + random.normal(size=plots.shape) * sigmas
    missed = random.random((_PLOTS, _TRACKS)) < 0.1
    plots[missed] = np.nan
    return times, plots.astype(number.dtype), sigmas.astype(number.dtype)


def _apart(single: Any, exact: Array) -> float:
    """Largest difference, which is one rounding at the least."""
    rounding = float(np.finfo(np.float32).eps) * float(np.nanmax(np.abs(exact), initial=0.0))
    return max(float(np.nanmax(np.abs(single - exact), initial=0.0)), rounding)


def _rounded_up(value: float) -> str:
    """A number above 0 with one digit, not less than it is."""
    step = 10.0 ** np.floor(np.log10(value))
    return f"{float(np.ceil(value / step * (1.0 - 1e-9)) * step):,.6g}"
