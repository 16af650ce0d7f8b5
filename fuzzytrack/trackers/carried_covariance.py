"""A covariance that goes along with the gains of any scheduler."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzytrack.gains.joseph import (
    NEW,
    ONE_PLOT,
    RUNNING,
    Covariance3,
    correct_ca,
    correct_cv,
    predict_cv,
)
from fuzzytrack.gains.singer import add_onset, fade, predict_singer
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory

__all__ = ["CarriedCovariance"]

#: Numbers in the memory before the covariances: phase, time since the first plot, retention time.
_OWN = 3


@dataclass(frozen=True, repr=False)
class CarriedCovariance(GainScheduler):
    """A scheduler with the covariance that its gains lead to, in Joseph form.

    The gains are those of the scheduler. For each axis the covariance of position and velocity, and
    of acceleration if the scheduler uses it, goes along in the memory.

    Parameters
    ----------
    scheduler : GainScheduler
        Chooses the gains.
    sigma_v : float
        Standard deviation of the target's acceleration, drawn anew for each plot (m/s²), >= 0; with
        acceleration that of its change, and of a new track's acceleration.
    elapsed : bool
        Whether time counts from plot to plot, and not from step to step.

    Notes
    -----
    The model and the numbers are those of `fuzzytrack.trackers.covariance.track_covariance`, after
    a start from two plots. An acceleration that the tracker lets fade is taken to fade in the
    target as well.
    """

    scheduler: GainScheduler
    sigma_v: float
    elapsed: bool = True

    sees_starts = True
    variance_start = "two-point"

    @property
    def sigma_w(self) -> float | None:  # type: ignore[override]
        """As the scheduler."""
        return self.scheduler.sigma_w

    @property
    def needs_sigma(self) -> bool:  # type: ignore[override]
        """Whether plots need a standard deviation: unless `sigma_w` stands for all."""
        return self.scheduler.needs_sigma or self.sigma_w is None

    @property
    def coupled(self) -> bool:  # type: ignore[override]
        """As the scheduler."""
        return self.scheduler.coupled

    @property
    def sees_misses(self) -> bool:  # type: ignore[override]
        """As the scheduler."""
        return self.scheduler.sees_misses

    @property
    def uses_acceleration(self) -> bool:  # type: ignore[override]
        """As the scheduler."""
        return self.scheduler.uses_acceleration

    @property
    def uses_retention(self) -> bool:  # type: ignore[override]
        """As the scheduler."""
        return self.scheduler.uses_retention

    @property
    def _size(self) -> int:
        """Numbers of a covariance."""
        return 6 if self.uses_acceleration else 3

    def initial_memory(self, n_axes: int) -> Memory:
        """No plot yet; then the covariances, and the memory of the scheduler."""
        covariances = (0.0,) * (n_axes * self._size)
        return (NEW, 0.0, math.inf, *covariances, *self.scheduler.initial_memory(n_axes))

    def kernel(self, n_axes: int) -> Kernel:
        """The scheduler's gains, and the covariance after them; see `GainScheduler.kernel`."""
        inner, end = self.scheduler, _OWN + n_axes * self._size
        choose, coupled, fades = inner.kernel(n_axes), self.coupled, self.uses_retention
        one = _one_axis(self.sigma_v**2, self.uses_acceleration)
        correct = _all_axes(one, self._size, n_axes, _plot_variance(self.sigma_w, coupled))
        ones: Any = (1.0,) * n_axes if coupled else 1.0
        by_step = not self.elapsed
        starts, follows = inner.sees_starts, inner.sees_starts or inner.sees_misses

        def carried(
            innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            phase, before, tau = memory[0], memory[1], memory[2]
            own = memory[end:]
            seen = (sigma[0] if coupled else sigma) != math.inf
            update = seen & (phase == RUNNING)
            # Where the scheduler is not told of a plot, it gets harmless numbers.
            told = sigma if update | follows else ones
            alpha, beta, gamma, retention, after = choose(innovation, change, dt, told, own)
            kept = update | (seen & starts) | ((not seen) & follows)

            span = before + dt
            second = phase == ONE_PLOT
            k1 = 1.0 if second else alpha
            k2 = 1.0 / span if second else beta / dt
            k3 = 0.0 if second else gamma / (2.0 * dt * dt)
            gains = (k1 if seen else 0.0, k2 if seen else 0.0, k3 if seen else 0.0)
            phi = fade(dt / tau) if fades else 1.0
            new = phase == NEW
            now = RUNNING if seen else phase
            now = ONE_PLOT if new else now
            # Where time counts from plot to plot, a miss that is counted changes nothing else.
            moves = seen | by_step
            changed = correct(memory, sigma, seen, new, dt, phi, gains)
            covariances = changed if moves else memory[_OWN:end]
            rest = after if kept else own
            now = now if moves else phase
            span = 0.0 if new else span
            span = span if moves else before
            tau = retention if fades & (update | (seen & starts)) else tau
            return alpha, beta, gamma, retention, (now, span, tau, *covariances, *rest)

        return carried

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of a predicted position; see `GainScheduler.prediction_variance`."""
        phase, tau, size = memory[0], memory[2], self._size
        n_axes = self._axes(len(memory)) if self.coupled else 1
        phi = fade(dt / tau) if self.uses_retention else 1.0
        variances = []
        for j in range(n_axes):
            p = memory[_OWN + j * size : _OWN + (j + 1) * size]
            variances.append(_predicted(p, dt, phi, self.sigma_v**2)[0])
        known = np.where(phase == RUNNING, np.stack(variances), np.nan)
        return known if self.coupled else known[0]

    def _axes(self, count: int) -> int:
        """Axes of a lane whose memory has so many numbers."""
        n_axes = 1
        while len(self.initial_memory(n_axes)) < count:
            n_axes += 1
        return n_axes


def _predicted(p: Any, dt: Any, phi: Any, q: float) -> Any:
    """Covariance at the next plot, of 3 or of 6 numbers."""
    g = 0.5 * dt * dt
    if len(p) == 3:
        p11, p12, p22 = p
        return predict_cv(p11, p12, p22, dt, g, q)
    p11, p12, p13, p22, p23, p33 = p
    moved = predict_singer(p11, p12, p13, p22, p23, p33, dt, phi)
    return add_onset(*moved, q, g, dt)


def _one_axis(q: float, accelerates: bool) -> Callable[..., Memory]:
    """Function from the covariance of an axis at its last plot to that after the next one."""

    def with_acceleration(
        p: Covariance3, r: float, new: bool, dt: float, phi: float,
        gains: tuple[float, float, float],
    ) -> Memory:  # fmt: skip
        p11, p12, p13, p22, p23, p33 = p
        k1, k2, k3 = gains
        p11, p12, p13, p22, p23, p33 = predict_singer(p11, p12, p13, p22, p23, p33, dt, phi)
        p11, p12, p13, p22, p23, p33 = add_onset(p11, p12, p13, p22, p23, p33, q, 0.5 * dt * dt, dt)
        n11, n12, n13, n22, n23, n33 = correct_ca(
            p11, p12, p13, p22, p23, p33, k1, k2, k3, p11 + r, r
        )
        return (
            r if new else n11,
            0.0 if new else n12,
            0.0 if new else n13,
            0.0 if new else n22,
            0.0 if new else n23,
            q if new else n33,
        )

    def without(
        p: tuple[float, float, float], r: float, new: bool, dt: float, phi: float,
        gains: tuple[float, float, float],
    ) -> Memory:  # fmt: skip
        p11, p12, p22 = p
        k1, k2, _ = gains
        p11, p12, p22 = predict_cv(p11, p12, p22, dt, 0.5 * dt * dt, q)
        n11, n12, n22 = correct_cv(p11, p12, p22, k1, k2, p11 + r, r)
        return r if new else n11, 0.0 if new else n12, 0.0 if new else n22

    return with_acceleration if accelerates else without


def _plot_variance(sigma_w: float | None, coupled: bool) -> Callable[[Any, int], float]:
    """Function from what a kernel is told of the plot's noise to the variance on an axis."""
    if sigma_w is not None:
        common = sigma_w * sigma_w
        return lambda sigma, axis: common
    if coupled:
        return lambda sigma, axis: sigma[axis] * sigma[axis]
    return lambda sigma, axis: sigma * sigma


def _all_axes(
    one: Callable[..., Memory], size: int, n_axes: int, variance: Callable[[Any, int], float]
) -> Callable[..., Memory]:
    """`one` for every axis of a lane, with covariances of so many numbers.

    Built up axis by axis, since compiled code cannot fill a tuple in a loop.
    """
    if n_axes == 0:

        def nothing(
            memory: Memory, sigma: Any, seen: bool, new: bool, dt: float, phi: float, gains: Any
        ) -> Memory:
            return ()

        return nothing

    before, last = _all_axes(one, size, n_axes - 1, variance), n_axes - 1
    start, stop = _OWN + last * size, _OWN + n_axes * size

    def one_more(
        memory: Memory, sigma: Any, seen: bool, new: bool, dt: float, phi: float, gains: Any
    ) -> Memory:
        r = variance(sigma, last) if seen else 1.0
        return (
            *before(memory, sigma, seen, new, dt, phi, gains),
            *one(memory[start:stop], r, new, dt, phi, gains),
        )

    return one_more
