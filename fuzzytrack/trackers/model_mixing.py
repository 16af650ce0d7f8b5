"""Several models from one plot to the next: they change, mix and move on.

The functions run in plain Python over a list and compiled over arrays, with the same results to the
last bit; and over a list of arrays, each with a number of many tracks.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from fuzzytrack.gains.joseph import Covariance3, predict_cv
from fuzzytrack.gains.singer import add_onset, fade, predict_singer
from fuzzytrack.trackers.markov_chain import MarkovChain
from fuzzytrack.trackers.model_set import COVARIANCE, ModelRows, ModelSet

__all__ = ["FAR", "Part", "covariance_writer", "in_turn", "mover", "predicted_variance"]

#: A part of a step: it does one thing to a lane of a buffer.
Part = Callable[[Any, int], None]

#: Differences of models, and innovations in a likelihood, count as no larger (m, m/s, m/s²): their
#: squares stay finite, in single precision as well.
FAR = 1e12

# Keeps a quotient of probabilities finite where all of them are 0.
_TINY = 1e-30


def in_turn(passes: Sequence[Part]) -> Part:
    """One part after another. Compiled code cannot loop over functions."""
    if len(passes) == 1:
        return passes[0]
    # Several at a time: the compiler works on all of them again at each level.
    size = -(-len(passes) // 5)
    parts = [in_turn(passes[k : k + size]) for k in range(0, len(passes), size)]
    first, second, third, fourth, fifth = parts + [_nothing] * (5 - len(parts))

    def together(b: Any, i: int) -> None:
        first(b, i)
        second(b, i)
        third(b, i)
        fourth(b, i)
        fifth(b, i)

    return together


def _nothing(b: Any, i: int) -> None:
    return


def covariance_writer(stride: int) -> Callable[[Any, int, Covariance3], None]:
    """Function that writes a covariance, its numbers `stride` apart."""

    def write(b: Any, at: int, covariance: Covariance3) -> None:
        (
            b[at], b[at + stride], b[at + 2 * stride],
            b[at + 3 * stride], b[at + 4 * stride], b[at + 5 * stride],
        ) = covariance  # fmt: skip

    return write


def mover(numbers: ModelSet, places: ModelRows, stride: int, bounded: Callable[[Any], Any]) -> Part:
    """Parts of a step that mix the models and predict them, into the rows "moved" of scratch.

    They contain no selections, so that each number of a buffer may also be an array.

    Parameters
    ----------
    numbers : ModelSet
    places : ModelRows
    stride : int
        Numbers between rows.
    bounded : callable
        Limits a number to `FAR`.
    """
    enter = _entered(numbers.chain, places, stride)
    spread = _spread(places, stride, bounded)
    straight = _predict_straight(places, numbers.gap_rate, stride)
    turning = _predict_turning(places, numbers.gap_rate, stride)

    # Each of these functions is compiled once, for all models.
    def entered(j: int) -> Part:
        numerators = tuple(value for row in numbers.chain.numerators for value in row[j])
        chance_row, share_row = places.scratch("chance") + j, places.shares(j)
        return lambda b, i: enter(b, i, numerators, chance_row, share_row)

    def apart(k: int) -> Part:
        one, two = map(places.model, places.pairs[k])
        spread_row = places.scratch("spread") + COVARIANCE * k
        return lambda b, i: spread(b, i, one, two, spread_row)

    def predicted(j: int) -> Part:
        model, own, share, moved = (
            numbers.models[j], places.model(j), places.shares(j), places.moved(j)
        )  # fmt: skip
        q, keeps = model.noise**2, math.isinf(model.retention)
        if not model.accelerates:
            return lambda b, i: straight(b, i, own, share, moved, q)
        decay = 1.0 / model.retention
        return lambda b, i: turning(b, i, own, share, moved, q, decay, keeps)

    models = range(places.n_models)
    return in_turn([
        _measure_time(numbers.chain, places, stride),
        *map(entered, models), *map(apart, range(len(places.pairs))), *map(predicted, models),
    ])  # fmt: skip


def predicted_variance(numbers: ModelSet, places: ModelRows, memory: Any, dt: Any) -> Any:
    """Variance of a predicted position, mean of the axes, by the parts of a step.

    Parameters
    ----------
    numbers, places
        As for `mover`.
    memory : ndarray, shape (n_memory, lanes)
    dt : ndarray, shape (lanes,) or (1,)
    """
    rows, n_axes = places.rows, places.n_axes
    b: list[Any] = [0.0] * rows.total
    b[rows.memory : rows.state], b[rows.dt] = list(memory), dt
    mover(numbers, places, 1, lambda x: np.clip(x, -FAR, FAR))(b, 0)
    models = [places.moved(j) for j in range(places.n_models)]
    chances = np.array([b[places.scratch("chance") + j] for j in range(places.n_models)])
    positions = np.array([b[row : row + n_axes] for row in models])
    variances = np.maximum([b[row + 3 * n_axes] for row in models], 0.0)
    apart = positions - positions[0]
    apart -= (chances[:, None] * apart).sum(axis=0)
    apart = np.clip(apart, -FAR, FAR)
    return (chances * (variances + (apart**2).mean(axis=1))).sum(axis=0)


def _measure_time(chain: MarkovChain, places: ModelRows, stride: int) -> Part:
    """Time in units of τ0, and what the transition probabilities are divided by."""
    denominator, terms = chain.denominator, len(chain.denominator)
    dt_row, rate_row = places.rows.dt, places.rate
    time_row, scale_row = places.scratch("time"), places.scratch("scale")

    def measure_time(b: Any, i: int) -> None:
        time, total = b[dt_row * stride + i] * b[rate_row * stride + i], 0.0
        for m in range(terms):
            total = total * time + denominator[m]
        b[time_row * stride + i] = time
        b[scale_row * stride + i] = 1.0 / total

    return measure_time


def _entered(
    chain: MarkovChain, places: ModelRows, stride: int
) -> Callable[[Any, int, tuple[float, ...], int, int], None]:
    """Function for the probability of a model before the plot, and from which models it comes."""
    n, terms = places.n_models, len(chain.denominator)
    time_row, scale_row, p_row = (
        places.scratch("time"), places.scratch("scale"), places.probability
    )  # fmt: skip
    tiny = _TINY

    def enter(
        b: Any, i: int, numerators: tuple[float, ...], chance_row: int, share_row: int
    ) -> None:
        time, scale = b[time_row * stride + i], b[scale_row * stride + i]
        chance = tiny
        for k in range(n):
            part = 0.0
            for m in range(terms):
                part = part * time + numerators[k * terms + m]
            part = part * scale * b[(p_row + k) * stride + i]
            b[(share_row + k) * stride + i] = part
            chance = chance + part
        b[chance_row * stride + i] = chance
        inverse = 1.0 / chance
        for k in range(n):
            b[(share_row + k) * stride + i] = b[(share_row + k) * stride + i] * inverse

    return enter


def _spread(
    places: ModelRows, stride: int, bounded: Callable[[Any], Any]
) -> Callable[[Any, int, int, int, int], None]:
    """Function for the second moments of the difference of two models, mean of all axes."""
    n_axes, part, write = places.n_axes, 1.0 / places.n_axes, covariance_writer(stride)

    def spread(b: Any, i: int, one: int, two: int, spread_row: int) -> None:
        xx, xv, xa, vv, va, aa = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for j in range(n_axes):
            x = bounded(b[(two + j) * stride + i] - b[(one + j) * stride + i])
            k = j + n_axes
            v = bounded(b[(two + k) * stride + i] - b[(one + k) * stride + i])
            k = k + n_axes
            a = bounded(b[(two + k) * stride + i] - b[(one + k) * stride + i])
            xx, xv, xa = xx + x * x, xv + x * v, xa + x * a
            vv, va, aa = vv + v * v, va + v * a, aa + a * a
        write(
            b, spread_row * stride + i,
            (part * xx, part * xv, part * xa, part * vv, part * va, part * aa),
        )  # fmt: skip

    return spread


def _mixture(
    places: ModelRows, stride: int
) -> tuple[Callable[[Any, int, int, int, int], Any], Callable[[Any, int, int, int], Any]]:
    """Functions for a number of the mean, and one of the covariance, from which a model starts."""
    n, size, n_pairs, first_row = places.n_models, places.size, len(places.pairs), places.model(0)
    p_row, spread_row = first_row + 3 * places.n_axes, places.scratch("spread")
    # Never empty: compiled code has no index into a tuple without entries.
    first, second = (tuple(pair[side] for pair in places.pairs) or (0,) for side in (0, 1))

    def mean(b: Any, i: int, k: int, own_row: int, share_row: int) -> Any:
        own, moved = b[(own_row + k) * stride + i], 0.0
        for m in range(n):
            share = b[(share_row + m) * stride + i]
            moved = moved + share * (b[(first_row + m * size + k) * stride + i] - own)
        return own + moved

    def covariance(b: Any, i: int, k: int, share_row: int) -> Any:
        total = 0.0
        for m in range(n):
            share = b[(share_row + m) * stride + i]
            total = total + share * b[(p_row + m * size + k) * stride + i]
        for m in range(n_pairs):
            both = b[(share_row + first[m]) * stride + i] * b[(share_row + second[m]) * stride + i]
            total = total + both * b[(spread_row + 6 * m + k) * stride + i]
        return total

    return mean, covariance


def _predict_straight(
    places: ModelRows, gap_rate: float, stride: int
) -> Callable[[Any, int, int, int, int, float], None]:
    """Function that mixes all models into one without acceleration, and predicts it."""
    n_axes = places.n_axes
    mean, covariance = _mixture(places, stride)
    write = covariance_writer(stride)
    noise_row, time_row, dt_row = places.noise_unit, places.scratch("time"), places.rows.dt

    def straight(b: Any, i: int, own: int, share: int, moved: int, q: float) -> None:
        dt, time = b[dt_row * stride + i], b[time_row * stride + i]
        for k in range(n_axes):
            v = mean(b, i, n_axes + k, own, share)
            b[(moved + k) * stride + i] = mean(b, i, k, own, share) + v * dt
            b[(moved + n_axes + k) * stride + i] = v
            b[(moved + 2 * n_axes + k) * stride + i] = 0.0
        driven = q * b[noise_row * stride + i] / (1.0 + time * gap_rate)
        p11, p12, p22 = predict_cv(
            covariance(b, i, 0, share), covariance(b, i, 1, share), covariance(b, i, 3, share),
            dt, 0.5 * dt * dt, driven,
        )  # fmt: skip
        write(b, (moved + 3 * n_axes) * stride + i, (p11, p12, 0.0, p22, 0.0, 0.0))

    return straight


def _predict_turning(
    places: ModelRows, gap_rate: float, stride: int
) -> Callable[[Any, int, int, int, int, float, float, bool], None]:
    """Function that mixes all models into one with an acceleration, and predicts it."""
    n_axes = places.n_axes
    mean, covariance = _mixture(places, stride)
    write = covariance_writer(stride)
    noise_row, time_row, dt_row = places.noise_unit, places.scratch("time"), places.rows.dt

    def turning(
        b: Any, i: int, own: int, share: int, moved: int, q: float, decay: float, keeps: bool
    ) -> None:
        dt, time = b[dt_row * stride + i], b[time_row * stride + i]
        phi = fade(time * decay)
        g = 0.5 * dt * dt
        for k in range(n_axes):
            a = phi * mean(b, i, 2 * n_axes + k, own, share)
            v = mean(b, i, n_axes + k, own, share)
            b[(moved + k) * stride + i] = mean(b, i, k, own, share) + v * dt + a * g
            b[(moved + n_axes + k) * stride + i] = v + a * dt
            b[(moved + 2 * n_axes + k) * stride + i] = a
        renewed = 1.0 if keeps else 1.0 - phi * phi
        driven = q * b[noise_row * stride + i] * renewed / (1.0 + time * gap_rate)
        p11, p12, p13, p22, p23, p33 = predict_singer(
            covariance(b, i, 0, share), covariance(b, i, 1, share), covariance(b, i, 2, share),
            covariance(b, i, 3, share), covariance(b, i, 4, share), covariance(b, i, 5, share),
            dt, phi,
        )  # fmt: skip
        after = add_onset(p11, p12, p13, p22, p23, p33, driven, g, dt)
        write(b, (moved + 3 * n_axes) * stride + i, after)

    return turning
