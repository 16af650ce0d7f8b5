"""Products of matrices of a set that grow, found by a beam search."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array

__all__ = ["growing_sequence"]

_BEAM = 400
#: A longer sequence is worth its length only if it grows faster by more than this.
_GAIN = 1e-9
#: Longer sequences, which are hard to read, are tried only while none grows.
_SHORT = 8

Order = NDArray[np.intp]


def growing_sequence(matrices: Array, p: Array, max_length: int) -> tuple[Order, float]:
    """Sequence of matrices that grows fastest when it is repeated, of those a beam search finds.

    Parameters
    ----------
    matrices : ndarray, shape (n, 2, 2)
    p : ndarray, shape (2, 2)
        Products are compared in the norm √(eᵀPe). That of `fuzzytrack.gains.lyapunov` treats all
        directions alike.
    max_length : int
        Longest sequence that is tried; those above 8 only while none grows.

    Returns
    -------
    order : ndarray of int, shape (length,)
        Indices of the matrices, first one first; empty if there are no matrices.
    growth : float
        Growth per matrix: spectral radius of the product, to the power of 1/length.
    """
    best, growth = np.empty(0, dtype=np.intp), 0.0
    if not len(matrices):
        return best, growth
    for orders, products in _beam(matrices, p, max_length):
        radius = np.abs(np.linalg.eigvals(products)).max(axis=-1) ** (1 / orders.shape[1])
        top = int(np.argmax(radius))
        if radius[top] > growth * (1 + _GAIN):
            best, growth = orders[top], float(radius[top])
        if growth > 1 + _GAIN and orders.shape[1] >= _SHORT:
            break
    return _turned(best), growth


def _turned(order: Order) -> Order:
    """The same cycle begun at another matrix: the last of its turns in alphabetical order.

    All turns grow alike, so that rounding, which differs between processors, would choose.
    """
    turns = [np.roll(order, -k).tolist() for k in range(len(order))]
    return np.array(max(turns, default=[]), dtype=np.intp)


def _beam(matrices: Array, p: Array, max_length: int) -> Iterator[tuple[Order, Array]]:
    """For each length the largest products, with the order of their matrices, last one leftmost."""
    root = np.linalg.cholesky(p).T
    back = np.linalg.inv(root)
    count = len(matrices)
    orders: Order = np.arange(count)[:, None]
    products = matrices
    yield orders, products
    for _ in range(max_length - 1):
        last = np.tile(np.arange(count), len(orders))
        orders = np.column_stack([np.repeat(orders, count, axis=0), last])
        products = (matrices[None] @ products[:, None]).reshape(-1, 2, 2)
        if len(orders) > _BEAM:
            size = np.linalg.norm(root @ products @ back, ord=2, axis=(-2, -1))
            keep = np.argsort(-size, kind="stable")[:_BEAM]
            orders, products = orders[keep], products[keep]
        yield orders, products
