"""A Markov chain in continuous time: which model a target is in after a time of any length."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array

__all__ = ["MarkovChain"]

#: Rate of each transition, by the state that is left and the one that is entered; 0 on the
#: diagonal.
Rates = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class MarkovChain:
    """Transition probabilities over a time t, as quotients of polynomials in t.

    They take the place of exp(Qt), where Q has the rates, and minus their sums on its diagonal. All
    coefficients are >= 0, and those of a row add up to those of the denominator. So for every t
    the probabilities of a row are >= 0 and add up to 1, and after a long time they are those of
    the stationary distribution.

    Attributes
    ----------
    numerators : tuple of tuple of tuple of float
        Coefficients of the probability to get from one state into another, from the highest power
        of t down to 1: of the first into the first, of the first into the second, ...
    denominator : tuple of float
        Coefficients of their common denominator, in the same order.

    Notes
    -----
    (I - Qt/2)⁻², which is two implicit steps of Euler. For two states with the sum of rates r it is
    Π + fade(rt)·(I - Π), where the rows of Π are the stationary distribution, see
    `fuzzytrack.gains.singer.fade`. Rounding: rows of three states add up to 1 within 1e-9 at any
    time; those of five after a thousand mean stays within 1e-8, and after a million within 1e-5.
    """

    numerators: tuple[tuple[tuple[float, ...], ...], ...]
    denominator: tuple[float, ...]

    @classmethod
    def of(cls, rates: Rates) -> MarkovChain:
        """Chain with these rates of transition (1/time)."""
        generator = np.array(rates) - np.diag(np.sum(rates, axis=1))
        matrices, scale = _faded(generator) if len(rates) == 2 else _squared(generator)
        # Rounding makes no probability negative.
        entries = np.maximum(matrices, 0.0)[::-1].transpose(1, 2, 0)
        return cls(tuple(tuple(map(tuple, row)) for row in entries.tolist()), tuple(scale[::-1]))

    def transitions(self, time: float) -> Array:
        """Probability to get from each state (rows) into each (columns) within a time.

        Parameters
        ----------
        time : float

        Returns
        -------
        ndarray, shape (n_states, n_states)
        """
        powers = time ** np.arange(len(self.denominator))[::-1]
        quotients: Array = np.array(self.numerators) @ powers / (powers @ self.denominator)
        return quotients


def _faded(generator: Array) -> tuple[Array, list[float]]:
    """Matrices and numbers that are the coefficients, from 1 on, of a chain of two states."""
    rate = -float(np.trace(generator))
    one = np.eye(2)
    # (I - Qt + Q²t²/2)⁻¹, since Q² = -rQ.
    first = rate * one + generator
    return np.array([one, first, 0.5 * rate * first]), [1.0, rate, 0.5 * rate**2]


def _squared(generator: Array) -> tuple[Array, list[float]]:
    """The same of any number of states.

    (I - Qh)⁻¹ is its adjugate over its determinant, both by the algorithm of Faddeev and LeVerrier;
    here h = t/2.
    """
    one = np.eye(len(generator))
    adjugate, determinant = [one], [1.0]
    for k in range(1, _rank(generator) + 1):
        product = _product(generator, adjugate[-1])
        determinant.append(-float(np.trace(product)) / k)
        adjugate.append(product + determinant[-1] * one)
    count = 2 * len(adjugate) - 1
    matrices, scale = np.zeros((count, *one.shape)), [0.0] * count
    for k, left in enumerate(adjugate):
        for m, right in enumerate(adjugate):
            half = 0.5 ** (k + m)
            matrices[k + m] += half * _product(left, right)
            scale[k + m] += half * determinant[k] * determinant[m]
    return matrices, scale


def _rank(generator: Array) -> int:
    """Rank of a generator, which is the degree of the determinant and of the reduced adjugate.

    States minus the classes that are never left, counted in the graph: what rounding leaves of the
    coefficients above would outgrow the others after a long time.
    """
    count = len(generator)
    reach = np.linalg.matrix_power((generator != 0) | np.eye(count, dtype=np.bool_), count)
    returns = np.all(reach <= reach.T, axis=1)
    return count - len(np.unique(reach[returns], axis=0))


def _product(left: Array, right: Array) -> Array:
    """Product of two matrices, the same to the last bit on every machine."""
    product: Array = (left[:, :, None] * right).sum(axis=1)
    return product
