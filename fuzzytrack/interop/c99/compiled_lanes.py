"""Many tracks side by side in C: the step of a tracker over a block of lanes.

Compiled for one processor with all its vectors, it is what this package's own compiled runs are
compared with in speed, and one more way to the same numbers.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.interop.c99.build import built
from fuzzytrack.interop.c99.compiled import DTYPES, whole_source
from fuzzytrack.interop.c99.function_writer import written_function
from fuzzytrack.interop.c99.program import Program
from fuzzytrack.interop.c99.values import Room, Whole
from fuzzytrack.lanes.layout import BLOCK
from fuzzytrack.trackers.catalog import as_lane_tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker

__all__ = ["FAST", "CompiledLanes"]

#: Options for speed that leave all results as they are: no rounding and no order of operations
#: changes, only flags and errno, which nobody reads.
FAST = (
    "-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math",
    "-DFUZZYTRACK_SQRT=__builtin_sqrt",
    "-DFUZZYTRACK_INLINE=static inline __attribute__((always_inline))",
)  # fmt: skip


class CompiledLanes:
    """Predictions of many tracks with common times, by C code that works on lanes side by side.

    Parameters
    ----------
    tracker : LaneTracker or str
    axes : int
        Axes of space.
    compiler, flags
        As for `fuzzytrack.interop.c99.build.built`.

    Raises
    ------
    CompilerError
        If there is no compiler, or it does not compile the code.
    TranslationError
        If the tracker cannot be written in C.
    """

    def __init__(
        self,
        tracker: LaneTracker | str,
        *,
        axes: int = 1,
        compiler: str | None = None,
        flags: Sequence[str] = FAST,
    ) -> None:
        self.tracker = as_lane_tracker(tracker)
        self.axes = axes
        self.lane_axes = axes if self.tracker.coupled else 1
        program = self.tracker.program(self.lane_axes)
        parts = Program("lanes", "double")
        step: Any = program.step(BLOCK)
        forms = (Room(program.rows.total * BLOCK), Whole(0.0, float(BLOCK)))
        written = written_function(parts, step, forms)
        restored = 0 if program.keeps_state or self.tracker.missed == "step" else program.rows.state
        self._rows, self._memory = program.rows, program.memory
        text = whole_source(parts.definitions(), self._driver(written.name, restored))
        self._library = built(text, compiler=compiler, flags=flags)
        self._library.run.restype = None

    def __call__(
        self, t: ArrayLike, z: ArrayLike, sigma: ArrayLike | None = None
    ) -> NDArray[np.float64]:
        """Predictions (m) in the shape of the plots.

        Parameters
        ----------
        t : array_like, shape (n_steps,)
            Times (s), increasing.
        z : array_like, shape (n_steps, tracks, axes)
            Plots (m); NaN where missed.
        sigma : array_like, optional
            Standard deviation of the plots (m), broadcast against `z`.
        """
        dtype = DTYPES["double"]
        plots, times = np.ascontiguousarray(z, dtype=dtype), np.ascontiguousarray(t, dtype=dtype)
        lanes = plots.size // len(plots) // self.lane_axes if len(plots) else 0
        if sigma is None:
            sigmas = np.full(1, math.nan)
        else:
            sigmas = np.ascontiguousarray(np.broadcast_to(sigma, plots.shape), dtype=dtype)
        predicted = np.empty(plots.shape)
        start = np.zeros(self._rows.kept)
        for first in (self._rows.position, self._rows.now):
            start[first : first + self._rows.n_axes] = math.nan
        start[self._rows.memory : self._rows.state] = self._memory
        self._library.run(
            ctypes.c_int64(len(plots)), ctypes.c_int64(lanes), ctypes.c_int64(sigmas.size > 1),
            *(ctypes.c_void_p(a.ctypes.data) for a in (times, plots, sigmas, start, predicted)),
        )  # fmt: skip
        return predicted

    def _driver(self, step: str, restored: int) -> str:
        """Function in C that runs blocks of lanes over time."""
        rows, n = self._rows, self._rows.n_axes
        elapsed = self.tracker.missed == "elapsed"
        head = (
            "void run(int64_t steps, int64_t lanes, int64_t own_sigmas, const double *times, "
            "const double *plots, const double *sigmas, const double *start, double *predicted)"
        )
        keep, give_back = [], []
        if restored:
            keep = [f"            memcpy(before, b, sizeof(double) * {restored * BLOCK});"]
            give_back = [
                "                if (!seen) {",
                f"                    for (int32_t r = 0; r < {restored}; ++r) {{",
                f"                        b[r * {BLOCK} + i] = before[r * {BLOCK} + i];",
                "                    }",
                "                }",
            ]
        return "\n".join(
            [
                f"extern {head};",
                head,
                "{",
                f"    static double b[{rows.total * BLOCK}];",
                f"    static double before[{max(restored, 1) * BLOCK}];",
                "    (void)before;",
                f"    for (int64_t first = 0; first < lanes; first += {BLOCK}) {{",
                f"        const int32_t count = lanes - first < {BLOCK} ? "
                f"(int32_t)(lanes - first) : {BLOCK};",
                f"        double last[{BLOCK}];",
                "        memset(b, 0, sizeof b);",
                f"        for (int32_t r = 0; r < {rows.kept}; ++r) {{",
                f"            for (int32_t i = 0; i < {BLOCK}; ++i) {{",
                f"                b[r * {BLOCK} + i] = start[r];",
                "            }",
                "        }",
                f"        for (int32_t i = 0; i < {BLOCK}; ++i) {{",
                "            last[i] = (double)NAN;",
                "        }",
                "        for (int64_t k = 0; k < steps; ++k) {",
                f"            const int64_t place = (k * lanes + first) * {n};",
                "            const double time = times[k];",
                *keep,
                "            for (int32_t i = 0; i < count; ++i) {",
                f"                b[{rows.dt * BLOCK} + i] = last[i] == last[i] ? time - last[i] "
                ": 0.0;",
                f"                for (int32_t j = 0; j < {n}; ++j) {{",
                f"                    b[({rows.plot} + j) * {BLOCK} + i] = "
                f"plots[place + i * {n} + j];",
                f"                    b[({rows.sigma} + j) * {BLOCK} + i] = "
                f"sigmas[own_sigmas ? place + i * {n} + j : 0];",
                "                }",
                "            }",
                f"            {step}(b, count);",
                "            for (int32_t i = 0; i < count; ++i) {",
                "                bool seen = true;",
                f"                for (int32_t j = 0; j < {n}; ++j) {{",
                f"                    const double z = b[({rows.plot} + j) * {BLOCK} + i];",
                f"                    predicted[place + i * {n} + j] = "
                f"b[({rows.predicted} + j) * {BLOCK} + i];",
                "                    seen = seen & (z == z);",
                "                }",
                f"                last[i] = {'seen ? time : last[i]' if elapsed else 'time'};",
                *give_back,
                "            }",
                "        }",
                "    }",
                "}\n",
            ]
        )
