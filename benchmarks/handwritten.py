"""The same filters written by hand: Numba loops, and plain NumPy.

Each loop knows its one filter, and is written as fast as we can. It has no acceleration, no checks
and no results but the predictions; the fuzzy one has its rule base worked out by hand. Missed
plots, irregular times and the two-point start are in: the time step of a track is the time since
its last plot. Blocks of tracks stay in the first cache with time outermost; once all tracks of a
block have started, a shorter step does the rest, and where all of them had a plot at the step
before, one that has a single time step for all. These read the plots and write the predictions
where they are, in the widest vectors there are.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.compiling import inline, loop, wide
from fuzzytrack.lanes.layout import aligned

__all__ = ["bare", "fixed", "fuzzy", "vectorized"]

Array = NDArray[np.float64]

BLOCK = 240
# Where in its buffer a block has position, velocity, last plot and its time, previous error, and,
# until all its tracks have started, the number of plots up to 2.
V, LAST, TIME, ERROR, PLOTS, SIZE = (k * BLOCK for k in range(1, 7))


# Of the ways to write it, the one that compiles to the fewest instructions.
@inline
def _clip(r):
    r = 0.0 if r < 0.0 else r
    return 1.0 if r > 1.0 else r


@inline
def _ramps(x):
    """How far each of the sets nm, ns, ze, ps, pm and pl has taken over from the one below it."""
    outer, middle, inner = x * (1.0 / 0.3), x * 5.0, x * 10.0
    return (
        _clip(outer + 2.0), _clip(middle + 1.5), _clip(inner + 1.0),
        _clip(inner), _clip(middle - 0.5), _clip(outer - 1.0),
    )  # fmt: skip


@inline
def _rules(error, rate):
    """Stiffness and damping of the rule base stiffness-damping.

    With Z, S, M, L as 0, 1, 2, 3, the differences of the rule table along both inputs are the
    weights of the products of ramps: a sum over seven terms of the error, each of a few of the
    rate. What several terms share is computed once.
    """
    a, b, c, d, e, f = _ramps(error)
    p, q, r, s, t, u = _ramps(rate)
    twice, falls, hump, late = s + s, q + u, s - t, r - u
    stiffness = (
        ((twice - falls) - t)
        + (a * ((1.0 + u) - twice) + b * (1.0 + (t - u)))
        + ((c * falls + d * ((p + t) - 2.0)) + (e * ((q - 1.0) - p) + f * (p - (r + r))))
    )
    top = q - r
    damping = (
        (a * (q - hump) - ((p + q) + late))
        + (b * (p + hump) + c * late)
        + (d * (s - p) + (e * ((u - 1.0) - top) + f * ((t - 1.0) + top)))
    )
    return (8.5 + stiffness) * (0.1 / 3.0), 0.89 + damping * (0.35 / 3.0)


@inline
def _larger(x, y):
    x, y = abs(x), abs(y)
    return x if x > y else y


@inline
def _relative(part, whole):
    # What is smaller than this is as good as none, and 0 comes out.
    return part / _larger(_larger(part, whole), 1e-300)


@inline
def _fuzzy_terms(e, change, before):
    """Corrections of position and of velocity times T, and the normalized error."""
    error = _relative(e, change)
    omega0, zeta = _rules(error, _relative(error - before, before))
    # The gains are 4ζω₀/(1 + 2ζω₀ + ω₀²) and 4ω₀²/(...): one division serves both.
    shared = 4.0 * omega0 * e / (1.0 + omega0 * (zeta + zeta + omega0))
    return zeta * shared, omega0 * shared, error


@inline
def _start(b, i, z, t):
    """A plot of a track that has not seen two before: position, velocity, and the count."""
    plots, last = b[PLOTS + i], b[LAST + i]
    if z == z:
        b[V + i] = (z - last) / (t - b[TIME + i]) if plots == 1.0 else 0.0
        b[i] = b[LAST + i] = z
        b[TIME + i] = t
        b[PLOTS + i] = plots + 1.0


# A missed plot changes nothing. What these return is 1 where it is missed.
@inline
def _fixed_lane(b, i, dt, alpha, per_dt, plots, predicted):
    z, x, v = plots[i], b[i], b[V + i]
    seen = z == z
    prediction = x + v * dt
    e = z - prediction
    b[i] = prediction + alpha * e if seen else x
    b[V + i] = v + per_dt * e if seen else v
    predicted[i] = prediction
    return 0 if seen else 1


@inline
def _fuzzy_lane(b, i, dt, rate, plots, predicted):
    z, x, v, last, before = plots[i], b[i], b[V + i], b[LAST + i], b[ERROR + i]
    seen = z == z
    prediction = x + v * dt
    e = z - prediction if seen else 0.0
    change = z - last if seen else 0.0
    x_term, v_term, error = _fuzzy_terms(e, change, before)
    b[i] = prediction + x_term if seen else x
    b[V + i] = v + v_term * rate if seen else v
    b[LAST + i] = z if seen else last
    b[ERROR + i] = error if seen else before
    predicted[i] = prediction
    return 0 if seen else 1


# One step of a block: with one time step for all tracks, or to a time from that of each track's
# last plot. Returned is how many plots are missing.
@loop
def _fixed_together(b, dt, alpha, beta, plots, predicted):
    wide()
    missing, per_dt = 0, beta / dt
    for i in range(min(len(plots), BLOCK)):
        missing += _fixed_lane(b, i, dt, alpha, per_dt, plots, predicted)
    return missing


@loop
def _fixed_apart(b, t, alpha, beta, plots, predicted):
    wide()
    missing = 0
    for i in range(min(len(plots), BLOCK)):
        last = b[TIME + i]
        dt = t - last
        gone = _fixed_lane(b, i, dt, alpha, beta / dt, plots, predicted)
        b[TIME + i] = last if gone else t
        missing += gone
    return missing


@loop
def _fuzzy_together(b, dt, plots, predicted):
    wide()
    missing, rate = 0, 1.0 / dt
    for i in range(min(len(plots), BLOCK)):
        missing += _fuzzy_lane(b, i, dt, rate, plots, predicted)
    return missing


@loop
def _fuzzy_apart(b, t, plots, predicted):
    wide()
    missing = 0
    for i in range(min(len(plots), BLOCK)):
        last = b[TIME + i]
        dt = t - last
        gone = _fuzzy_lane(b, i, dt, 1.0 / dt, plots, predicted)
        b[TIME + i] = last if gone else t
        missing += gone
    return missing


@loop
def _part(b, plots, before, t):
    """Give each track the time of its last plot, after all of them had one at the same time."""
    for i in range(min(len(plots), BLOCK)):
        b[TIME + i] = t if plots[i] == plots[i] else before


@loop
def _bare_step(b, dt, alpha, beta, plots, predicted):
    wide()
    per_dt = beta / dt
    for i in range(min(len(plots), BLOCK)):
        v = b[V + i]
        prediction = b[i] + v * dt
        e = plots[i] - prediction
        b[i] = prediction + alpha * e
        b[V + i] = v + per_dt * e
        predicted[i] = prediction


# The first steps of a block, one track after the other; whether all have started.
@loop
def _fixed_first(b, t, alpha, beta, plots, predicted):
    started = True
    for i in range(len(plots)):
        z, dt = plots[i], t - b[TIME + i]
        if b[PLOTS + i] < 2.0:
            predicted[i] = np.nan
            _start(b, i, z, t)
            started = started & (b[PLOTS + i] >= 2.0)
            continue
        predicted[i] = prediction = b[i] + b[V + i] * dt
        if z == z:
            e = z - prediction
            b[i] = prediction + alpha * e
            b[V + i] += beta / dt * e
            b[TIME + i] = t
    return started


@loop
def _fuzzy_first(b, t, plots, predicted):
    started = True
    for i in range(len(plots)):
        z, dt = plots[i], t - b[TIME + i]
        if b[PLOTS + i] < 2.0:
            predicted[i] = np.nan
            _start(b, i, z, t)
            started = started & (b[PLOTS + i] >= 2.0)
            continue
        predicted[i] = prediction = b[i] + b[V + i] * dt
        if z == z:
            x_term, v_term, error = _fuzzy_terms(z - prediction, z - b[LAST + i], b[ERROR + i])
            b[i] = prediction + x_term
            b[V + i] += v_term / dt
            b[LAST + i], b[TIME + i], b[ERROR + i] = z, t, error
    return started


@loop
def _fixed(b, times, plots, predicted, alpha, beta):
    steps, tracks = plots.shape
    for first in range(0, tracks, BLOCK):
        last = min(first + BLOCK, tracks)
        b[:] = 0.0
        # The step at which all tracks had their last plot, if it was the same for all.
        started, together = False, -1
        for k in range(steps):
            z, into = plots[k, first:last], predicted[k, first:last]
            if not started:
                started = _fixed_first(b, times[k], alpha, beta, z, into)
            elif together < 0:
                missing = _fixed_apart(b, times[k], alpha, beta, z, into)
                together = k if missing == 0 else -1
            else:
                before = times[together]
                missing = _fixed_together(b, times[k] - before, alpha, beta, z, into)
                together = k if missing == 0 else -1
                if missing:
                    _part(b, z, before, times[k])


@loop
def _fuzzy(b, times, plots, predicted):
    steps, tracks = plots.shape
    for first in range(0, tracks, BLOCK):
        last = min(first + BLOCK, tracks)
        b[:] = 0.0
        # The step at which all tracks had their last plot, if it was the same for all.
        started, together = False, -1
        for k in range(steps):
            z, into = plots[k, first:last], predicted[k, first:last]
            if not started:
                started = _fuzzy_first(b, times[k], z, into)
            elif together < 0:
                missing = _fuzzy_apart(b, times[k], z, into)
                together = k if missing == 0 else -1
            else:
                before = times[together]
                missing = _fuzzy_together(b, times[k] - before, z, into)
                together = k if missing == 0 else -1
                if missing:
                    _part(b, z, before, times[k])


@loop
def _bare(b, dts, plots, predicted, alpha, beta):
    steps, tracks = plots.shape
    for first in range(0, tracks, BLOCK):
        last = min(first + BLOCK, tracks)
        b[:] = 0.0
        for k in range(steps):
            _bare_step(b, dts[k], alpha, beta, plots[k, first:last], predicted[k, first:last])


def _steps(times: Array) -> Array:
    # The first step has no length; its value is not used.
    return np.concatenate([[1.0], np.diff(times)])


def fixed(times: Array, plots: Array, alpha: float, beta: float, out: Array | None = None) -> Array:
    """Predictions with fixed gains, maybe in an array for them; plots (n_steps, n_tracks)."""
    predicted = np.empty_like(plots) if out is None else out
    _fixed(aligned(SIZE), times, plots, predicted, alpha, beta)
    return predicted


def bare(times: Array, plots: Array, alpha: float, beta: float, out: Array | None = None) -> Array:
    """Predictions of the recursion alone, from position and velocity 0; no plot may be missed."""
    predicted = np.empty_like(plots) if out is None else out
    _bare(aligned(SIZE), _steps(times), plots, predicted, alpha, beta)
    return predicted


def fuzzy(times: Array, plots: Array) -> Array:
    """Predictions with the gains of the rule base stiffness-damping, exact."""
    predicted = np.empty_like(plots)
    _fuzzy(aligned(SIZE), times, plots, predicted)
    return predicted


def vectorized(
    times: Array, plots: Array, alpha: Array, beta: Array, out: Array | None = None
) -> Array:
    """Predictions in NumPy with gains for each track and axis, started by one plot.

    Plots have the shape (n_steps, n_tracks, n_axes), as has the array for the predictions, if there
    is one; none of the first may be missed.
    """
    predicted = np.empty_like(plots) if out is None else out
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
