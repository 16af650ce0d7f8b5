"""The innovation over the standard deviation that noise alone gives it, for the gains in use."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fuzzytrack.gains.joseph import NEW, ONE_PLOT, RUNNING, correct_ca, predict_ca
from fuzzytrack.kernels.language import Memory
from fuzzytrack.normalizations.base import Feedback, Normalization, Normalize, normalizations

__all__ = ["Predicted"]


@normalizations.register("predicted")
@dataclass(frozen=True, repr=False)
class Predicted(Normalization):
    """Innovation over the standard deviation that noise alone gives it, and its change.

    E = e/√S and ΔE = E - E′ (E′ = 0 at first). S = P₁₁ + σ² is the variance of the innovation of a
    target that does not maneuver, with P the covariance that the noise of the plots has left in the
    prediction through the gains that were in use. So E has variance 1 on a straight run with any
    gains: after large gains, and after missed plots, E is smaller than with `Scale`. Unbounded: a
    rule base takes values outside its universe at the nearest end.

    Notes
    -----
    Prediction P⁻ = ΦPΦᵀ without process noise; correction in Joseph form,
    P = (I - KH)P⁻(I - KH)ᵀ + Kσ²Kᵀ with K = (α, β/T, γ/(2T²)), which holds for any gains. At
    constant gains, T and σ, S settles at σ²(1 + ρ²), ρ² as in `fuzzytrack.gains.noise_ratio`.
    The track is taken to start from two plots, as is the default of trackers; until then E = 0. The
    memory is (phase, P₁₁, P₁₂, P₁₃, P₂₂, P₂₃, P₃₃, time since the first plot (s), E), with a phase
    of 0 before the first plot, 1 before the second and 2 from then on.
    """

    source: ClassVar[str] = "innovation scaled by its standard deviation for the gains in use"
    signals: ClassVar[tuple[str, ...]] = (
        "innovation over its predicted standard deviation",
        "change of that",
    )
    needs_sigma: ClassVar[bool] = True
    sees_starts: ClassVar[bool] = True
    variance_start: ClassVar[str | None] = "two-point"

    def initial_memory(self, n_axes: int) -> Memory:
        """No plot yet."""
        return (NEW, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    def kernel(self, n_axes: int) -> Normalize:
        """Predict the covariance and divide; see `Normalization.kernel`."""

        def predicted(
            innovation: float, change: float, dt: float, sigma: float, memory: Memory
        ) -> tuple[tuple[float, ...], Memory]:
            phase, p11, p12, p13, p22, p23, p33, span, before = memory
            g = 0.5 * dt * dt
            p11, p12, p13, p22, p23, p33 = predict_ca(p11, p12, p13, p22, p23, p33, dt, g)
            seen = sigma != math.inf
            known = seen & (phase == RUNNING)
            s = p11 + (sigma * sigma if seen else 1.0)
            error = innovation / math.sqrt(s) if known else 0.0
            signals = (error, error - before if known else 0.0)
            last = error if known else before
            return signals, (phase, p11, p12, p13, p22, p23, p33, span + dt, last)

        return predicted

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of a predicted position; see `Normalization.prediction_variance`."""
        phase, p11, p12, p13, p22, p23, p33, _, _ = memory
        p11 = predict_ca(p11, p12, p13, p22, p23, p33, dt, 0.5 * dt * dt)[0]
        return np.where(phase == RUNNING, p11, np.nan)

    def feedback(self, n_axes: int) -> Feedback:
        """Correct the covariance for the gains; see `Normalization.feedback`."""

        def corrected(
            memory: Memory, alpha: float, beta: float, gamma: float, dt: float, sigma: float
        ) -> Memory:
            phase, p11, p12, p13, p22, p23, p33, span, last = memory
            seen = sigma != math.inf
            r = sigma * sigma if seen else 1.0
            # The second plot gives position and, by its distance from the first, velocity.
            second = phase == ONE_PLOT
            k1 = 1.0 if second else alpha
            k2 = 1.0 / span if second else beta / dt
            k3 = 0.0 if second else gamma / (2.0 * dt * dt)
            k1 = k1 if seen else 0.0
            k2 = k2 if seen else 0.0
            k3 = k3 if seen else 0.0

            n11, n12, n13, n22, n23, n33 = correct_ca(
                p11, p12, p13, p22, p23, p33, k1, k2, k3, p11 + r, r
            )

            new = phase == NEW
            after = RUNNING if seen else phase
            after = ONE_PLOT if new else after
            return (
                after,
                r if new else n11,
                0.0 if new else n12,
                0.0 if new else n13,
                0.0 if new else n22,
                0.0 if new else n23,
                0.0 if new else n33,
                0.0 if new else span,
                last,
            )

        return corrected
