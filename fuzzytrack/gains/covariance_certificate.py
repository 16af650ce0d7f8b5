"""Certified stability of gains from a covariance whose noise a schedule chooses at each plot.

The theorem (Deyst & Price 1968, with the correction of 1973; Jazwinski 1970, theorem 7.4): if a
Kalman filter's model is uniformly completely observable and controllable, with bounded noise, its
covariance P is bounded from above and from below, and its error e is uniformly exponentially
stable: V = eᵀP⁻¹e falls, over some number of plots, at least by a factor below 1. The proof uses
only bounds. So it holds on each path, for process noise and retention that are chosen at each plot
in any way, also by the data, and for any times between plots and variances of plots.

The model here is that of `fuzzytrack.gains.singer`: F = [[1, s, φs²/2], [0, 1, φs], [0, 0, φ]] with
φ = fade(s/τ), process noise b·σ²·GGᵀ with G = (d²/2, d, 1) and d = s + delay.

- Observable over three plots: positions x₁, x₂, x₃ give the acceleration, since the slope changes
  by φa(s₂ + φ's₃)/2 with φ, φ' > 0, then the velocity.
- Controllable: otherwise there is a direction n that no noise reaches, n·G = 0 at each plot of a
  long window, with n ← Fᵀn from each plot to the one before. Let n = (1, v, w); backward v grows by
  s at each plot. n·G = 0 at two successive plots, the earlier one with s' and d' = s' + delay,
  means d'²/2 + (v + s)d' = φ(s·delay + delay²/2 + v·delay). Here the left side is larger if
  v >= 0, and smaller if v is below some bound; between the two, v stays for a bounded number of
  plots only. For n = (0, 1, w) it means d' = φ·delay, where d' is larger, and n = (0, 0, 1) is
  never at right angles to G.

All limits are closed intervals, so both hold uniformly.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.gains.elapsed_times import ElapsedTimes
from fuzzytrack.gains.singer import fade
from fuzzytrack.html_reprs import block, facts, paragraph, table
from fuzzytrack.plurals import counted
from fuzzytrack.reprs import summary

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["CovarianceCertificate", "CovarianceLimits", "certify_covariance", "contraction"]

#: Plots before those of the contraction: they choose the covariance at which these begin.
_BEFORE = 20
_SEQUENCES = 192
_ROUNDS = 60
_CHANGED = 0.06
_AT_A_LIMIT = 0.7


@dataclass(frozen=True)
class CovarianceLimits:
    """What a schedule of process noise can do, with accelerations in a₀ and times in τ₀ = √(σ₀/a₀).

    σ₀ is the standard deviation of a track's first plot.

    Parameters
    ----------
    noise : (float, float)
        Least and largest σ, the standard deviation of the acceleration, in a₀.
    retention : (float, float)
        Least and largest retention time τ, in τ₀; infinity keeps the acceleration.
    delay : float
        Time by which a maneuver is older than the plot before it is noticed, >= 0.
    gap : float
        Interval between plots at which the noise is halved, > 0.
    times : ElapsedTimes
        Times between plots.
    sigma_ratio : float
        Largest ratio, >= 1, of the standard deviation of a plot to σ₀, or of σ₀ to it.

    Raises
    ------
    ValueError
        If a limit is out of range.
    """

    noise: tuple[float, float]
    retention: tuple[float, float]
    delay: float = 0.0
    gap: float = math.inf
    times: ElapsedTimes = ElapsedTimes()  # noqa: RUF009 (it is frozen)
    sigma_ratio: float = 1.0

    def __post_init__(self) -> None:
        for name, (low, high) in (("noise", self.noise), ("retention", self.retention)):
            if not 0 <= low <= high:
                raise ValueError(f"{name}: must be 0 <= least <= largest, got {low:g}, {high:g}")
        if not 0 <= self.delay < math.inf:
            raise ValueError(f"delay: must be finite and >= 0, got {self.delay:g}")
        if not self.gap > 0:
            raise ValueError(f"gap: must be > 0, got {self.gap:g}")
        if not 1 <= self.sigma_ratio < math.inf:
            raise ValueError(f"sigma_ratio: must be finite and >= 1, got {self.sigma_ratio:g}")

    def missing(self) -> str:
        """Hypothesis of the theorem that does not hold; empty if all hold."""
        if not (self.noise[0] > 0 and self.noise[1] < math.inf):
            return f"the noise must be above 0 and bounded, and is in {_interval(self.noise)}"
        if not (self.retention[0] > 0 and self.retention[1] < math.inf):
            limits = _interval(self.retention)
            return f"the retention must be above 0 and bounded, and is in {limits}"
        return ""


def _interval(limits: tuple[float, float]) -> str:
    return f"[{limits[0]:g}, {limits[1]:g}]"


@dataclass(frozen=True, eq=False)
class CovarianceCertificate:
    """Result of the stability check of gains from a covariance.

    Attributes
    ----------
    verdict : {"certified", "not decided"}
        ``certified``: the error is uniformly exponentially stable, by the theorem.
    limits : CovarianceLimits
    missing : str
        Hypothesis of the theorem that does not hold; empty if certified.
    contraction : mapping of int to float
        For numbers of plots the largest share of √(eᵀP⁻¹e) that is left after so many, in the worst
        sequence that a search found: sampled, not proven. Empty unless certified.
    """

    verdict: str
    limits: CovarianceLimits
    missing: str
    contraction: Mapping[int, float]

    def __repr__(self) -> str:
        return summary(self, "verdict", "missing", "contraction")

    @property
    def covered(self) -> str:
        """The times and plots that the verdict is about, in words."""
        times = self.limits.times
        if times.low == times.high:
            time = f"constant T = {times.low:g} τ₀"
        else:
            time = f"time between rows in [{times.low:g}, {times.high:g}] τ₀, changing in any way"
        if times.missed:
            return f"{time}, up to {counted(times.missed, 'missed plot')} in a row"
        return f"{time}, no missed plots"

    def plot(self) -> Figure:
        """Picture of how the error shrinks."""
        from fuzzytrack.plotting import plot_certificate

        return plot_certificate(self)[0]

    def _repr_html_(self) -> str:
        """The verdict and how fast errors shrink, for notebooks."""
        title = f"Stability of gains from a covariance: {self.verdict}"
        covered = paragraph(f"Covered: {self.covered}.")
        if self.missing:
            missing = paragraph(f"The theorem does not apply: {self.missing}.")
            return block(title, covered, missing)
        limits = facts(
            {
                "noise (a₀)": _interval(self.limits.noise),
                "retention (τ₀)": _interval(self.limits.retention),
            }
        )
        rows = [[f"{plots}", f"{share:.3f}"] for plots, share in self.contraction.items()]
        left = table(["plots", "share of the error that is left at most (sampled)"], rows)
        return block(title, covered, limits, left)


def certify_covariance(
    limits: CovarianceLimits, plots: tuple[int, ...] = (10, 20, 40), seed: int = 0
) -> CovarianceCertificate:
    """Certify gains from a covariance with noise and retention that switch arbitrarily.

    Parameters
    ----------
    limits : CovarianceLimits
    plots : tuple of int
        Numbers of plots, >= 1, whose contraction is searched.
    seed : int
        Of the search.

    Returns
    -------
    CovarianceCertificate

    Notes
    -----
    The search for the worst contraction begins with sequences that change once, from some limits of
    times, noise, retention and variance to others. It changes them at random, keeps those with the
    least contraction, and begins again with these. The true bound may be larger.

    Examples
    --------
    >>> found = certify_covariance(CovarianceLimits((0.12, 2), (1, 4), delay=1, gap=0.5), (20,))
    >>> found.verdict, found.contraction[20] < 0.5
    ('certified', True)
    """
    missing = limits.missing()
    if missing:
        return CovarianceCertificate("not decided", limits, missing, {})
    rng = np.random.default_rng(seed)
    worst = {count: _worst_contraction(limits, count, rng) for count in plots}
    return CovarianceCertificate("certified", limits, "", worst)


def _worst_contraction(limits: CovarianceLimits, plots: int, rng: np.random.Generator) -> float:
    sequences = _sudden_changes(plots)
    left = contraction(limits, sequences, plots)
    for _ in range(_ROUNDS):
        kept = np.argsort(-left)[:_SEQUENCES]
        sequences, left = sequences[kept], left[kept]
        mutants = sequences[rng.integers(0, _SEQUENCES // 4, _SEQUENCES)]
        changed = rng.random(mutants.shape) < _CHANGED
        mutants = np.where(changed, _random_shares(rng, mutants.shape), mutants)
        sequences = np.concatenate([sequences, mutants])
        left = np.concatenate([left, contraction(limits, mutants, plots)])
    return float(left.max())


def _sudden_changes(plots: int) -> Array:
    """All sequences that stay at some limits at first, and at some limits from one plot on."""
    ends = np.array(list(product((0.0, 1.0), repeat=5)))
    before, after = np.repeat(ends, len(ends), axis=0), np.tile(ends, (len(ends), 1))
    return np.stack([before] * _BEFORE + [after] * plots, axis=1)


def _random_shares(rng: np.random.Generator, shape: tuple[int, ...]) -> Array:
    """Places between limits, many at these."""
    at_a_limit = rng.random(shape) < _AT_A_LIMIT
    return np.where(at_a_limit, rng.integers(0, 2, shape), rng.random(shape))


def contraction(limits: CovarianceLimits, shares: Array, plots: int) -> Array:
    """Share of √(eᵀP⁻¹e) that is left at most after the last plots of sequences.

    Parameters
    ----------
    limits : CovarianceLimits
    shares : ndarray, shape (n, length, 5)
        Where time step, missed plots, noise, retention and standard deviation of each plot are
        between their limits, 0 to 1, on a logarithmic scale.
    plots : int
        How many, at most `length`; those before them lead to the covariance at which they begin.

    Returns
    -------
    ndarray, shape (n,)
        Largest singular value of P⁻¹ᐟ² Φ P₀¹ᐟ², Φ the product of (I - K H)F.
    """
    times, ratio = limits.times, limits.sigma_ratio
    missed = np.floor(shares[..., 1] * (times.missed + 1)).clip(max=times.missed)
    elapsed = _between((times.low, times.high), shares[..., 0]) * (1 + missed)
    noise = _between(limits.noise, shares[..., 2])
    retention = _between(limits.retention, shares[..., 3])
    variance = _between((1 / ratio, ratio), shares[..., 4]) ** 2
    first = shares.shape[1] - plots
    p: Array = np.broadcast_to(np.eye(3), (len(shares), 3, 3))
    root, product = p, p
    for k in range(shares.shape[1]):
        if k == first:
            root, product = _root(p), np.broadcast_to(np.eye(3), p.shape)
        model = elapsed[:, k], noise[:, k], retention[:, k], limits.delay, limits.gap
        p, error = _plot(p, *model, variance[:, k])
        product = error @ product
    after = np.linalg.solve(_root(p), product @ root)
    return np.asarray(np.linalg.norm(after, ord=2, axis=(1, 2)))


def _root(p: Array) -> Array:
    return np.asarray(np.linalg.cholesky(p), dtype=np.float64)


def _between(limits: tuple[float, float], shares: Array) -> Array:
    low, high = np.log(limits)
    return np.asarray(np.exp(low + shares * (high - low)))


def _plot(
    p: Array, s: Array, noise: Array, retention: Array, delay: float, gap: float, variance: Array
) -> tuple[Array, Array]:
    """Covariance after a plot, and the matrix (I - K H)F by which the error is multiplied."""
    # A scalar function, which takes arrays as well.
    ratio: Any = s / retention
    phi: Any = fade(ratio)
    zero, one = np.zeros_like(s), np.ones_like(s)
    rows = [one, s, phi * s * s / 2], [zero, one, phi * s], [zero, zero, phi]
    f = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    d = s + delay
    g = np.stack([d * d / 2, d, one], axis=-1) * noise[:, None]
    b = (1 - phi * phi) / (1 + s / gap)
    p = f @ p @ np.swapaxes(f, 1, 2) + b[:, None, None] * g[:, :, None] * g[:, None, :]
    k = p[:, :, 0] / (p[:, :1, 0] + variance[:, None])
    keep = np.eye(3) - k[:, :, None] * np.array([1.0, 0.0, 0.0])
    # The Joseph form stays positive definite.
    noise_part = variance[:, None, None] * k[:, :, None] * k[:, None, :]
    p = keep @ p @ np.swapaxes(keep, 1, 2) + noise_part
    return 0.5 * (p + np.swapaxes(p, 1, 2)), keep @ f
