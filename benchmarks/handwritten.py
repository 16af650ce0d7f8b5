"""The same filters written by hand: Numba loops, and plain NumPy.

The loops know one filter each, so they do what the general runner cannot: no acceleration, no
scheduler's memory, sets that add up to 1, membership as differences of six ramps. Blocks of tracks
stay in L1 with time outermost; missed plots, irregular times and the two-point start are in.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

__all__ = ["bare", "fixed", "fuzzy", "vectorised"]

Array = NDArray[np.float64]

BLOCK = 512

# The sets of the rule base stiffness-damping: centres, and levels of its outputs.
SZ, SS, SM, SL = 0.25, 0.25 + 0.1 / 3.0, 0.25 + 0.2 / 3.0, 0.35
DZ, DS, DM, DL = 0.54, 0.54 + 0.35 / 3.0, 0.54 + 0.7 / 3.0, 0.89

_inline = numba.njit(error_model="numpy", forceinline=True)
_loop = numba.njit(error_model="numpy", nogil=True, cache=True)


@_inline
def _ramp(x, start, per_unit):
    r = (x - start) * per_unit
    r = r if r > 0.0 else 0.0
    return r if r < 1.0 else 1.0


@_inline
def _memberships(x):
    """Grades of nl, nm, ns, ze, ps, pm, pl."""
    a = _ramp(x, -0.6, 1.0 / 0.3)
    b = _ramp(x, -0.3, 5.0)
    c = _ramp(x, -0.1, 10.0)
    d = _ramp(x, 0.0, 10.0)
    e = _ramp(x, 0.1, 5.0)
    f = _ramp(x, 0.3, 1.0 / 0.3)
    return 1.0 - a, a - b, b - c, c - d, d - e, e - f, f


@_inline
def _row(g, nl, nm, ns, ze, ps, pm, pl):
    """One row of the rule table over the sets of the error."""
    return (
        g[0] * nl + g[1] * nm + g[2] * ns + g[3] * ze + g[4] * ps + g[5] * pm + g[6] * pl
    )  # fmt: skip


@_inline
def _stiffness(g, h):
    return (
        h[0] * _row(g, SS, SM, SL, SL, SS, SZ, SZ)
        + h[1] * _row(g, SS, SM, SL, SL, SM, SZ, SS)
        + h[2] * _row(g, SZ, SS, SM, SL, SM, SS, SM)
        + h[3] * _row(g, SZ, SS, SM, SL, SM, SS, SZ)
        + h[4] * _row(g, SM, SS, SM, SL, SM, SS, SZ)
        + h[5] * _row(g, SS, SZ, SM, SL, SL, SM, SS)
        + h[6] * _row(g, SZ, SZ, SS, SL, SL, SM, SS)
    )


@_inline
def _damping(g, h):
    return (
        h[0] * _row(g, DL, DL, DL, DL, DL, DM, DS)
        + h[1] * _row(g, DM, DM, DL, DL, DM, DS, DZ)
        + h[2] * _row(g, DS, DM, DL, DL, DM, DZ, DZ)
        + h[3] * _row(g, DZ, DS, DM, DL, DM, DS, DZ)
        + h[4] * _row(g, DZ, DZ, DM, DL, DL, DM, DS)
        + h[5] * _row(g, DZ, DS, DM, DL, DL, DM, DM)
        + h[6] * _row(g, DS, DM, DL, DL, DL, DL, DL)
    )


@_inline
def _relative(part, whole):
    size, other = abs(part), abs(whole)
    largest = size if size > other else other
    return part / largest if largest > 0.0 else 0.0


@_inline
def _correct(b, i, z, dt, prediction, alpha, beta, e):
    """New state of a lane: position, velocity, last plot, gap, number of plots up to 2."""
    v = b[BLOCK + i]
    last = b[2 * BLOCK + i]
    gap = b[3 * BLOCK + i] + dt
    plots = b[4 * BLOCK + i]
    seen = z == z
    running = plots >= 2.0
    start = (z - last) / gap if plots == 1.0 else 0.0
    x_new = prediction + alpha * e if running else z
    v_new = v + (beta / dt) * e if running else start
    b[i] = x_new if seen else prediction
    b[BLOCK + i] = v_new if seen else v
    b[2 * BLOCK + i] = z if seen else last
    b[3 * BLOCK + i] = 0.0 if seen else gap
    more = plots + 1.0 if plots < 2.0 else 2.0
    b[4 * BLOCK + i] = more if seen else plots


# A step is a function of the buffer alone, whole blocks at a time: then the compiler knows that
# nothing overlaps, and works on neighbouring tracks at once.
@_loop
def _fixed_step(b, dt, alpha, beta):
    for i in range(BLOCK):
        z = b[6 * BLOCK + i]
        running = b[4 * BLOCK + i] >= 2.0
        prediction = b[i] + b[BLOCK + i] * dt
        e = z - prediction if (z == z) & running else 0.0
        b[7 * BLOCK + i] = prediction if running else np.nan
        _correct(b, i, z, dt, prediction, alpha, beta, e)


@_loop
def _fuzzy_step(b, dt):
    for i in range(BLOCK):
        z = b[6 * BLOCK + i]
        running = b[4 * BLOCK + i] >= 2.0
        update = (z == z) & running
        prediction = b[i] + b[BLOCK + i] * dt
        e = z - prediction if update else 0.0
        change = z - b[2 * BLOCK + i] if update else 0.0
        before = b[5 * BLOCK + i]
        error = _relative(e, change)
        g = _memberships(error)
        h = _memberships(_relative(error - before, before))
        omega0, zeta = _stiffness(g, h), _damping(g, h)
        twice = 2.0 * zeta * omega0
        square = omega0 * omega0
        scale = 1.0 / (1.0 + twice + square)
        b[7 * BLOCK + i] = prediction if running else np.nan
        b[5 * BLOCK + i] = error if update else before
        _correct(b, i, z, dt, prediction, 2.0 * twice * scale, 4.0 * square * scale, e)


@_inline
def _start(b):
    b[:] = 0.0
    b[:BLOCK] = np.nan
    b[2 * BLOCK : 3 * BLOCK] = np.nan


@_inline
def _copy(source, target):
    for i in range(len(target)):
        target[i] = source[i]


@_loop
def _fixed(b, dts, plots, predicted, alpha, beta):
    steps, tracks = plots.shape
    for first in range(0, tracks, BLOCK):
        count = min(BLOCK, tracks - first)
        _start(b)
        for k in range(steps):
            _copy(plots[k, first : first + count], b[6 * BLOCK : 6 * BLOCK + count])
            _fixed_step(b, dts[k], alpha, beta)
            _copy(b[7 * BLOCK : 7 * BLOCK + count], predicted[k, first : first + count])


@_loop
def _fuzzy(b, dts, plots, predicted):
    steps, tracks = plots.shape
    for first in range(0, tracks, BLOCK):
        count = min(BLOCK, tracks - first)
        _start(b)
        for k in range(steps):
            _copy(plots[k, first : first + count], b[6 * BLOCK : 6 * BLOCK + count])
            _fuzzy_step(b, dts[k])
            _copy(b[7 * BLOCK : 7 * BLOCK + count], predicted[k, first : first + count])


@_loop
def _bare_step(b, dt, alpha, beta):
    for i in range(BLOCK):
        prediction = b[i] + b[BLOCK + i] * dt
        e = b[6 * BLOCK + i] - prediction
        b[7 * BLOCK + i] = prediction
        b[i] = prediction + alpha * e
        b[BLOCK + i] = b[BLOCK + i] + (beta / dt) * e


@_loop
def _bare(b, dts, plots, predicted, alpha, beta):
    steps, tracks = plots.shape
    for first in range(0, tracks, BLOCK):
        count = min(BLOCK, tracks - first)
        b[:] = 0.0
        for k in range(steps):
            _copy(plots[k, first : first + count], b[6 * BLOCK : 6 * BLOCK + count])
            _bare_step(b, dts[k], alpha, beta)
            _copy(b[7 * BLOCK : 7 * BLOCK + count], predicted[k, first : first + count])


def _steps(times: Array) -> Array:
    # The first step has no length; its value is not used.
    return np.concatenate([[1.0], np.diff(times)])


def fixed(times: Array, plots: Array, alpha: float, beta: float) -> Array:
    """Predictions with fixed gains; plots of shape (n_steps, n_tracks)."""
    predicted = np.empty_like(plots)
    _fixed(np.empty(8 * BLOCK), _steps(times), plots, predicted, alpha, beta)
    return predicted


def bare(times: Array, plots: Array, alpha: float, beta: float) -> Array:
    """Predictions of the recursion alone, from position and velocity 0; no plot may be missed."""
    predicted = np.empty_like(plots)
    _bare(np.empty(8 * BLOCK), _steps(times), plots, predicted, alpha, beta)
    return predicted


def fuzzy(times: Array, plots: Array) -> Array:
    """Predictions with the gains of the rule base stiffness-damping, exact."""
    predicted = np.empty_like(plots)
    _fuzzy(np.empty(8 * BLOCK), _steps(times), plots, predicted)
    return predicted


def vectorised(times: Array, plots: Array, alpha: Array, beta: Array) -> Array:
    """Predictions in NumPy with gains for each track and axis, started by one plot.

    Plots have the shape (n_steps, n_tracks, n_axes); none of the first may be missed.
    """
    predicted = np.empty_like(plots)
    predicted[0] = np.nan
    x, v = plots[0].copy(), np.zeros_like(plots[0])
    for k, dt in enumerate(np.diff(times), start=1):
        x += v * dt
        predicted[k] = x
        e = plots[k] - x
        e[np.isnan(e)] = 0.0
        x += alpha * e
        v += (beta / dt) * e
    return predicted
