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
from fuzzytrack.kernels.language import use_wide_vectors
from fuzzytrack.trackers.markov_chain import MarkovChain
from fuzzytrack.trackers.model_set import COVARIANCE, ModelRows, ModelSet

__all__ = ["FAR", "Pass", "covariance_writer", "in_turn", "mover", "predicted_variance"]

#: A pass: it goes through the first lanes of a buffer, and does one thing to each.
Pass = Callable[[Any, int], None]

#: Differences of models, and innovations in a likelihood, count as no larger (m, m/s, m/s²): their
#: squares stay finite, in single precision as well.
FAR = 1e12

# Keeps a quotient of probabilities finite where all of them are 0.
_TINY = 1e-30


def in_turn(passes: Sequence[Pass]) -> Pass:
    """One pass after another. Compiled code cannot loop over functions."""
    if len(passes) == 1:
        return passes[0]
    # Several at a time: the compiler works on all of them again at each level.
    size = -(-len(passes) // 5)
    parts = [in_turn(passes[k : k + size]) for k in range(0, len(passes), size)]
    first, second, third, fourth, fifth = parts + [_nothing] * (5 - len(parts))

    def together(b: Any, count: int) -> None:
        first(b, count)
        second(b, count)
        third(b, count)
        fourth(b, count)
        fifth(b, count)

    return together


def _nothing(b: Any, count: int) -> None:
    return


def covariance_writer(stride: int) -> Callable[[Any, int, Covariance3], None]:
    """Function that writes a covariance, its numbers `stride` apart."""

    def write(b: Any, at: int, covariance: Covariance3) -> None:
        (
            b[at], b[at + stride], b[at + 2 * stride],
            b[at + 3 * stride], b[at + 4 * stride], b[at + 5 * stride],
        ) = covariance  # fmt: skip

    return write


def mover(numbers: ModelSet, places: ModelRows, stride: int, bounded: Callable[[Any], Any]) -> Pass:
    """Passes that mix the models and predict them, from memory to the rows "moved" of scratch.

    They contain no selections, so that each number of a buffer may also be an array.

    Parameters
    ----------
    numbers, places, stride
        As for `step_function`.
    bounded : callable
        Limits a number to 1e12.
    """
    models = range(places.n_models)
    return in_turn([
        _measure_time(numbers.chain, places, stride),
        *(_enter(numbers.chain, places, j, stride) for j in models),
        *(_spread(places, k, stride, bounded) for k in range(len(places.pairs))),
        *(_predict(numbers, places, j, stride) for j in models),
    ])  # fmt: skip


def predicted_variance(numbers: ModelSet, places: ModelRows, memory: Any, dt: Any) -> Any:
    """Variance of a predicted position, mean of the axes, by the passes of a step.

    Parameters
    ----------
    numbers, places
        As for `step_function`.
    memory : ndarray, shape (n_memory, lanes)
    dt : ndarray, shape (lanes,) or (1,)
    """
    rows, n_axes = places.rows, places.n_axes
    b: list[Any] = [0.0] * rows.total
    b[rows.memory : rows.state], b[rows.dt] = list(memory), dt
    mover(numbers, places, 1, lambda x: np.clip(x, -FAR, FAR))(b, 1)
    models = [places.moved(j) for j in range(places.n_models)]
    chances = np.array([b[places.scratch("chance") + j] for j in range(places.n_models)])
    positions = np.array([b[row : row + n_axes] for row in models])
    variances = np.maximum([b[row + 3 * n_axes] for row in models], 0.0)
    apart = positions - positions[0]
    apart -= (chances[:, None] * apart).sum(axis=0)
    return (chances * (variances + (apart**2).mean(axis=1))).sum(axis=0)


def _measure_time(chain: MarkovChain, places: ModelRows, stride: int) -> Pass:
    """Time in units of τ0, and what the transition probabilities are divided by."""
    denominator, terms = chain.denominator, len(chain.denominator)
    dt_row, rate_row = places.rows.dt, places.rate
    time_row, scale_row = places.scratch("time"), places.scratch("scale")

    def measure_time(b: Any, count: int) -> None:
        use_wide_vectors()
        for i in range(min(count, stride)):
            time, total = b[dt_row * stride + i] * b[rate_row * stride + i], 0.0
            for m in range(terms):
                total = total * time + denominator[m]
            b[time_row * stride + i] = time
            b[scale_row * stride + i] = 1.0 / total

    return measure_time


def _enter(chain: MarkovChain, places: ModelRows, j: int, stride: int) -> Pass:
    """Probability of a model before the plot, and from which models it comes."""
    n, terms = places.n_models, len(chain.denominator)
    numerators = tuple(value for row in chain.numerators for value in row[j])
    time_row, scale_row = places.scratch("time"), places.scratch("scale")
    p_row, c_row, share_row = places.probability, places.scratch("chance") + j, places.shares(j)
    tiny = _TINY

    def enter(b: Any, count: int) -> None:
        use_wide_vectors()
        for i in range(min(count, stride)):
            time, scale = b[time_row * stride + i], b[scale_row * stride + i]
            chance = tiny
            for k in range(n):
                part = 0.0
                for m in range(terms):
                    part = part * time + numerators[k * terms + m]
                part = part * scale * b[(p_row + k) * stride + i]
                b[(share_row + k) * stride + i] = part
                chance = chance + part
            b[c_row * stride + i] = chance
            inverse = 1.0 / chance
            for k in range(n):
                b[(share_row + k) * stride + i] = b[(share_row + k) * stride + i] * inverse

    return enter


def _spread(places: ModelRows, pair: int, stride: int, bounded: Callable[[Any], Any]) -> Pass:
    """Second moments of the difference between two models, mean of all axes."""
    n_axes = places.n_axes
    one, two = map(places.model, places.pairs[pair])
    spread_row = places.scratch("spread") + COVARIANCE * pair
    part, write = 1.0 / n_axes, covariance_writer(stride)

    def spread(b: Any, count: int) -> None:
        use_wide_vectors()
        for i in range(min(count, stride)):
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
    places: ModelRows, j: int, stride: int
) -> tuple[Callable[[Any, int, int], Any], Callable[[Any, int, int], Any]]:
    """Functions for a number of the mean, and one of the covariance, from which a model starts."""
    n, size, n_pairs = places.n_models, places.size, len(places.pairs)
    share_row, own_row, mean_row = places.shares(j), places.model(j), places.model(0)
    p_row, spread_row = mean_row + 3 * places.n_axes, places.scratch("spread")
    # Never empty: compiled code has no index into a tuple without entries.
    first, second = (tuple(pair[side] for pair in places.pairs) or (0,) for side in (0, 1))

    def mean(b: Any, i: int, k: int) -> Any:
        own = b[(own_row + k) * stride + i]
        moved = 0.0
        for m in range(n):
            share = b[(share_row + m) * stride + i]
            moved = moved + share * (b[(mean_row + m * size + k) * stride + i] - own)
        return own + moved

    def covariance(b: Any, i: int, k: int) -> Any:
        total = 0.0
        for m in range(n):
            total = (
                total + b[(share_row + m) * stride + i] * (b[(p_row + m * size + k) * stride + i])
            )
        for m in range(n_pairs):
            both = b[(share_row + first[m]) * stride + i] * b[(share_row + second[m]) * stride + i]
            total = total + both * b[(spread_row + 6 * m + k) * stride + i]
        return total

    return mean, covariance


def _predict(numbers: ModelSet, places: ModelRows, j: int, stride: int) -> Pass:
    """Mix all models into the one that a model starts from, and predict it."""
    model, n_axes, gap_rate = numbers.models[j], places.n_axes, numbers.gap_rate
    q, accelerates, keeps = model.noise**2, model.accelerates, math.isinf(model.retention)
    decay = 0.0 if keeps or not accelerates else 1.0 / model.retention
    mean, covariance = _mixture(places, j, stride)
    write = covariance_writer(stride)
    moved_row, p_row = places.moved(j), places.moved(j) + 3 * n_axes
    noise_row, time_row, dt_row = places.noise_unit, places.scratch("time"), places.rows.dt

    def straight(b: Any, count: int) -> None:
        use_wide_vectors()
        for i in range(min(count, stride)):
            dt, time = b[dt_row * stride + i], b[time_row * stride + i]
            for k in range(n_axes):
                v = mean(b, i, n_axes + k)
                b[(moved_row + k) * stride + i] = mean(b, i, k) + v * dt
                b[(moved_row + n_axes + k) * stride + i] = v
                b[(moved_row + 2 * n_axes + k) * stride + i] = 0.0
            driven = q * b[noise_row * stride + i] / (1.0 + time * gap_rate)
            p11, p12, p22 = predict_cv(
                covariance(b, i, 0), covariance(b, i, 1), covariance(b, i, 3), dt,
                0.5 * dt * dt, driven,
            )  # fmt: skip
            write(b, p_row * stride + i, (p11, p12, 0.0, p22, 0.0, 0.0))

    def turning(b: Any, count: int) -> None:
        use_wide_vectors()
        for i in range(min(count, stride)):
            dt, time = b[dt_row * stride + i], b[time_row * stride + i]
            phi = fade(time * decay)
            g = 0.5 * dt * dt
            for k in range(n_axes):
                a = phi * mean(b, i, 2 * n_axes + k)
                v = mean(b, i, n_axes + k)
                b[(moved_row + k) * stride + i] = mean(b, i, k) + v * dt + a * g
                b[(moved_row + n_axes + k) * stride + i] = v + a * dt
                b[(moved_row + 2 * n_axes + k) * stride + i] = a
            renewed = 1.0 if keeps else 1.0 - phi * phi
            driven = q * b[noise_row * stride + i] * renewed / (1.0 + time * gap_rate)
            p11, p12, p13, p22, p23, p33 = predict_singer(
                covariance(b, i, 0), covariance(b, i, 1), covariance(b, i, 2),
                covariance(b, i, 3), covariance(b, i, 4), covariance(b, i, 5), dt, phi,
            )  # fmt: skip
            after = add_onset(p11, p12, p13, p22, p23, p33, driven, g, dt)
            write(b, p_row * stride + i, after)

    return turning if accelerates else straight
