"""The rule base maneuver written by hand, as a Numba loop over tracks of two axes.

It knows its one rule base and number of axes, and has no results but the predictions: the rules are
a product of two ramps, the gains are used as they are and not as α, β and γ, and all plots of a
track have the same noise. The rest is as in `benchmarks.handwritten`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from benchmarks.compiling import inline, loop, wide
from fuzzytrack.lanes.layout import aligned

__all__ = ["maneuver"]

Array = NDArray[np.float64]

# Fewer tracks than elsewhere: a track has more numbers.
BLOCK = 160
# Of either axis: position, velocity, acceleration, smoothed and last normalized innovation, and the
# last plot until the second one.
(
    X0, V0, A0, S0, NU0, X1, V1, A1, S1, NU1,
    AGREEMENT, RETENTION, P11, P12, P13, P22, P23, P33, UNIT, VARIANCE, TIME, PLOTS,
) = (k * BLOCK for k in range(22))  # fmt: skip
SIZE = 22

TIME_CONSTANT, AGREEMENT_TIME, CLIP = 6.5, 16.0, 4.0
DELAY, GAP, START = 1.0, 0.6, 0.65
CALM, BRISK, STRONG, VIOLENT = 0.09, 1.4, 2.2, 2.7
SHORT, LONG = 0.3, 7.0


@inline
def _fade(x):
    return 1.0 / (1.0 + x + 0.5 * x * x)


@inline
def _ramp(x, low, high):
    x = (x - low) * (1.0 / (high - low))
    x = 0.0 if x < 0.0 else x
    return 1.0 if x > 1.0 else x


@inline
def _rules(surprise, agreement):
    """Noise in a0 and retention in τ0."""
    u, w = _ramp(surprise, 0.8, 4.0), _ramp(agreement, 1.5, 6.0)
    calm = CALM + u * (BRISK - CALM)
    change = (STRONG - CALM) + u * ((VIOLENT - BRISK) - (STRONG - CALM))
    return calm + w * change, SHORT + u * (LONG - SHORT)


@inline
def _lane(b, i, dt, a0, plots, predicted):
    """A step of a track that has started; 1 is returned where its plot is missing."""
    z0, z1, tau0, r = plots[2 * i], plots[2 * i + 1], b[UNIT + i], b[VARIANCE + i]
    seen = (z0 == z0) & (z1 == z1)
    # Prediction.
    phi = _fade(dt / b[RETENTION + i])
    half = 0.5 * dt * dt
    a, c = phi * b[A0 + i], phi * b[A1 + i]
    x, y = b[X0 + i] + b[V0 + i] * dt + a * half, b[X1 + i] + b[V1 + i] * dt + c * half
    predicted[2 * i], predicted[2 * i + 1] = x, y
    e, f = (z0 - x if seen else 0.0), (z1 - y if seen else 0.0)
    p12, p22 = b[P12 + i], b[P22 + i]
    p13, p23, p33 = phi * b[P13 + i], phi * b[P23 + i], phi * phi * b[P33 + i]
    a12, a13, a23 = p12 + dt * p22 + half * p23, p13 + dt * p23 + half * p33, p23 + dt * p33
    n11 = (b[P11 + i] + dt * p12 + half * p13) + dt * a12 + half * a13
    n12, n22 = a12 + dt * a13, (p22 + dt * p23) + dt * a23
    n11 = n11 if n11 > 0.0 else 0.0
    # Surprise and agreement.
    steps, d = dt / tau0, dt + DELAY * tau0
    noisy, g = (1.0 - phi * phi) / (1.0 + steps * (1.0 / GAP)), 0.5 * d * d
    quiet = CALM * a0 * g
    rest = 1.0 / (n11 + noisy * quiet * quiet + r)
    excess = (e * e + f * f) * rest * (1.0 / (CLIP * CLIP))
    excess = excess if excess > 1.0 else 1.0
    scale = math.sqrt(rest / excess)
    nu, mu = e * scale, f * scale
    keep, keep_product = _fade(steps * (1.0 / TIME_CONSTANT)), _fade(steps * (1.0 / AGREEMENT_TIME))
    weight, product = math.sqrt(1.0 - keep * keep), nu * b[NU0 + i] + mu * b[NU1 + i]
    s, t = keep * b[S0 + i] + weight * nu, keep * b[S1 + i] + weight * mu
    agreement = (
        keep_product * b[AGREEMENT + i] + math.sqrt(1.0 - keep_product * keep_product) * product
    )
    noise, retention = _rules(math.sqrt(s * s + t * t), agreement)
    # Correction.
    noise = noise * a0
    q = noisy * noise * noise
    q1, q2 = q * g, q * d
    n11, n12, n13 = n11 + q1 * g, n12 + q1 * d, a13 + q1
    n22, n23, n33 = n22 + q2 * d, a23 + q2, p33 + q
    share = 1.0 / (n11 + r)
    k1, k2, k3, left = n11 * share, n12 * share, n13 * share, r * share
    n22, n33 = n22 - k2 * n12, n33 - k3 * n13
    b[X0 + i] = x + k1 * e if seen else b[X0 + i]
    b[X1 + i] = y + k1 * f if seen else b[X1 + i]
    b[V0 + i] = b[V0 + i] + a * dt + k2 * e if seen else b[V0 + i]
    b[V1 + i] = b[V1 + i] + c * dt + k2 * f if seen else b[V1 + i]
    b[A0 + i] = a + k3 * e if seen else b[A0 + i]
    b[A1 + i] = c + k3 * f if seen else b[A1 + i]
    b[S0 + i] = s if seen else b[S0 + i]
    b[S1 + i] = t if seen else b[S1 + i]
    b[NU0 + i] = nu if seen else b[NU0 + i]
    b[NU1 + i] = mu if seen else b[NU1 + i]
    b[AGREEMENT + i] = agreement if seen else b[AGREEMENT + i]
    b[RETENTION + i] = retention * tau0 if seen else b[RETENTION + i]
    b[P11 + i] = left * n11 if seen else b[P11 + i]
    b[P12 + i] = left * n12 if seen else b[P12 + i]
    b[P13 + i] = left * n13 if seen else b[P13 + i]
    b[P22 + i] = (n22 if n22 > 0.0 else 0.0) if seen else b[P22 + i]
    b[P23 + i] = n23 - k2 * n13 if seen else b[P23 + i]
    b[P33 + i] = (n33 if n33 > 0.0 else 0.0) if seen else b[P33 + i]
    return 0 if seen else 1


@loop
def _together(b, dt, a0, plots, predicted):
    wide()
    missing = 0
    for i in range(min(len(plots) // 2, BLOCK)):
        missing += _lane(b, i, dt, a0, plots, predicted)
    return missing


@loop
def _apart(b, t, a0, plots, predicted):
    wide()
    missing = 0
    for i in range(min(len(plots) // 2, BLOCK)):
        last = b[TIME + i]
        gone = _lane(b, i, t - last, a0, plots, predicted)
        b[TIME + i] = last if gone else t
        missing += gone
    return missing


@loop
def _part(b, plots, before, t):
    """Give each track the time of its last plot, after all of them had one at the same time."""
    for i in range(min(len(plots) // 2, BLOCK)):
        z = plots[2 * i] + plots[2 * i + 1]
        b[TIME + i] = t if z == z else before


@inline
def _start(b, i, t, a0, z0, z1, sigma):
    """The first plot of a track, or the second one."""
    r = sigma * sigma
    if b[PLOTS + i] == 0.0:
        b[UNIT + i], b[VARIANCE + i] = math.sqrt(sigma / a0), r
    else:
        # The rules at inputs of 0 say how long the acceleration lasts.
        span = t - b[TIME + i]
        q, rate = START * a0 * START * a0, 1.0 / span
        b[V0 + i], b[V1 + i] = (z0 - b[X0 + i]) * rate, (z1 - b[X1 + i]) * rate
        b[P11 + i], b[P12 + i] = r, r * rate
        b[P22 + i] = 2.0 * r * rate * rate + 0.25 * q * span * span
        b[P23 + i], b[P33 + i] = 0.5 * q * span, q
        b[RETENTION + i] = SHORT * b[UNIT + i]
    b[X0 + i], b[X1 + i], b[TIME + i] = z0, z1, t
    b[PLOTS + i] += 1.0


@loop
def _first(b, t, a0, plots, predicted, sigmas):
    """A first step of a block, one track after the other; whether all have started."""
    started = True
    for i in range(len(plots) // 2):
        z0, z1 = plots[2 * i], plots[2 * i + 1]
        seen = (z0 == z0) & (z1 == z1)
        if b[PLOTS + i] < 2.0:
            predicted[2 * i] = predicted[2 * i + 1] = np.nan
            if seen:
                _start(b, i, t, a0, z0, z1, sigmas[i])
            started = started & (b[PLOTS + i] >= 2.0)
        elif not _lane(b, i, t - b[TIME + i], a0, plots, predicted):
            b[TIME + i] = t
    return started


@loop
def _maneuver(b, times, plots, predicted, sigmas, a0):
    steps, numbers = plots.shape
    for first in range(0, numbers, 2 * BLOCK):
        last = min(first + 2 * BLOCK, numbers)
        b[:] = 0.0
        # The step at which all tracks had their last plot, if it was the same for all.
        started, together = False, -1
        for k in range(steps):
            z, into = plots[k, first:last], predicted[k, first:last]
            if not started:
                started = _first(b, times[k], a0, z, into, sigmas[first // 2 : last // 2])
            elif together < 0:
                missing = _apart(b, times[k], a0, z, into)
                together = k if missing == 0 else -1
            else:
                before = times[together]
                missing = _together(b, times[k] - before, a0, z, into)
                together = k if missing == 0 else -1
                if missing:
                    _part(b, z, before, times[k])


def maneuver(
    times: Array, plots: Array, sigmas: Array, level: float, out: Array | None = None
) -> Array:
    """Predictions with the gains of the rule base maneuver, maybe in an array for them.

    Plots have the shape (n_steps, n_tracks, 2), the standard deviations of their noise (n_tracks,).
    """
    predicted = np.empty_like(plots) if out is None else out
    rows = len(plots), -1
    _maneuver(
        aligned(SIZE * BLOCK), times, plots.reshape(rows), predicted.reshape(rows), sigmas,
        level / 3.0,
    )  # fmt: skip
    return predicted
