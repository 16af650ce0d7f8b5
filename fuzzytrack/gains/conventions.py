"""Conventions for γ: the acceleration gain is q/T², and γ is 2q, q or q/2."""

from __future__ import annotations

from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.gains.checks import finite

__all__ = ["GAMMA_CONVENTIONS", "convert_gamma"]

GAMMA_CONVENTIONS = MappingProxyType(
    {"llinas": 2.0, "kalata": 2.0, "mahafza": 1.0, "brookner": 0.5, "filterpy": 0.5, "njonjo": 0.5}
)
"""γ/q by convention, for an acceleration correction of q/T² times the innovation."""


def convert_gamma(gamma: ArrayLike, source: str, target: str) -> NDArray[np.float64]:
    """γ of one convention in another; the filter stays the same.

    Parameters
    ----------
    gamma : array_like
        γ of the convention `source`, dimensionless, finite.
    source, target : str
        Conventions: ``"llinas"`` and ``"kalata"`` (gain γ/(2T²), that of all of `fuzzytrack`),
        ``"mahafza"`` (γ/T²), ``"brookner"`` (his k), ``"filterpy"`` and ``"njonjo"`` (2γ/T²).

    Returns
    -------
    ndarray
        γ of the convention `target`, of the shape of `gamma` (a number for a number). α and β are
        the same in all. Exact: the factors are powers of two.

    Raises
    ------
    ValueError
        If `gamma` is not finite or a convention is unknown.

    Notes
    -----
    Stability, γ < 4αβ/(2 - α) here, is γ < 2αβ/(2 - α) in Mahafza's convention and γ < αβ/(2 - α)
    in Brookner's. The filter of Njonjo et al. (2017) is critically damped, as its authors claim,
    only when its γ is read as Mahafza's; its printed equations are the convention named here.

    Examples
    --------
    >>> float(convert_gamma(0.05, "njonjo", "llinas"))
    0.2
    """
    value = finite("gamma", gamma)
    return np.asarray(value / _factor("source", source) * _factor("target", target))[()]


def _factor(name: str, convention: str) -> float:
    try:
        return GAMMA_CONVENTIONS[convention]
    except (KeyError, TypeError):
        allowed = ", ".join(GAMMA_CONVENTIONS)
        raise ValueError(f"{name} must be one of {allowed}, got {convention!r}") from None
