"""The noise of the plots in a track, along the times and gains of a run."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.gains import joseph

__all__ = ["largest_noise"]

# Plots after which a piece of a track tells what the whole tells.
_PIECE = 100


def largest_noise(
    elapsed: Array, alpha: Array, beta: Array, gamma: Array | None = None, dt: Array | None = None
) -> Array:
    """Largest standard deviation that the noise of plots gives to a position of a track.

    Parameters
    ----------
    elapsed : ndarray, shape (n_steps, n_tracks)
        Time since the last plot (s), > 0; anything where no gains were used.
    alpha, beta : ndarray, shape (n_steps, n_tracks)
        Gains that were used; NaN where there was no plot to correct with.
    gamma : ndarray, optional
        Acceleration gain, as γ/(2T²); none unless given.
    dt : ndarray, optional
        The T of β/T and γ/(2T²) (s); `elapsed` unless given.

    Returns
    -------
    ndarray, shape (n_tracks,)
        Of the filtered position, in standard deviations of a plot. It is at most 1 with the gains
        of a Kalman filter, at any times; with those of a filter that is fixed and stable, at
        constant T, it is √ of its `noise_ratio`, seldom more than 2. Infinity where it cannot be
        represented.

    Notes
    -----
    By the covariance in the Joseph form, from plots of variance 1. It begins without any error, and
    anew after 100 plots, or √n of n if these are more: so it misses what grows more slowly.

    Examples
    --------
    Plots 20 ms and 980 ms apart in turn, with gains that suit 0.5 s:

    >>> import numpy as np
    >>> from fuzzytrack.gains.track_noise import largest_noise
    >>> elapsed = np.tile([[0.02], [0.98]], (10, 1))
    >>> alpha, beta = np.full(elapsed.shape, 0.5), np.full(elapsed.shape, 0.2)
    >>> largest_noise(elapsed, alpha, beta).round(-3)
    array([67000.])
    """
    n_steps, n_tracks = alpha.shape
    step = elapsed if dt is None else dt
    columns = [elapsed, alpha, beta / step]
    if gamma is not None and (np.nan_to_num(gamma) != 0).any():
        columns.append(gamma / (2 * step * step))
    # Without a time and gains nothing changes.
    columns = [np.where(np.isnan(alpha), 0.0, column) for column in columns]
    # Pieces of a track are treated as tracks, so that there are few steps, of many tracks.
    length = max(min(_PIECE, n_steps), math.isqrt(n_steps), 1)
    pieces = max(-(-n_steps // length), 1)
    rows = [_in_pieces(column, length, pieces) for column in columns]
    covariance = (np.zeros(pieces * n_tracks),) * (3 if len(columns) == 3 else 6)
    largest = covariance[0]
    with np.errstate(over="ignore", invalid="ignore"):
        for span, *gain in zip(*rows, strict=True):
            covariance = _after_plot(covariance, span, gain)
            # The difference of infinities is NaN, but something was infinite before.
            largest = np.fmax(largest, covariance[0])
    return np.asarray(np.sqrt(largest.reshape(pieces, n_tracks).max(axis=0)))


# Scalar functions of a kernel, which take arrays as well.
_predict_cv: Any = joseph.predict_cv
_predict_ca: Any = joseph.predict_ca
_correct_cv: Any = joseph.correct_cv
_correct_ca: Any = joseph.correct_ca


def _after_plot(covariance: tuple[Array, ...], span: Array, gain: list[Array]) -> tuple[Array, ...]:
    """Covariance after a plot of variance 1, a time `span` later."""
    if len(gain) == 2:
        p = _predict_cv(*covariance, span, 0.0, 0.0)
        return tuple(_correct_cv(*p, *gain, p[0] + 1.0, 1.0))
    p = _predict_ca(*covariance, span, 0.5 * span * span)
    return tuple(_correct_ca(*p, *gain, p[0] + 1.0, 1.0))


def _in_pieces(values: Array, length: int, pieces: int) -> Array:
    """Tracks as shorter ones side by side; 0 where nothing is left."""
    n_steps, n_tracks = values.shape
    padded = np.zeros((pieces * length, n_tracks))
    padded[:n_steps] = values
    by_piece = padded.reshape(pieces, length, n_tracks)
    return by_piece.swapaxes(0, 1).reshape(length, pieces * n_tracks)
