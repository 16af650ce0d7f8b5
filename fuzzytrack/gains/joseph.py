"""Covariance of position, velocity and acceleration from plot to plot, for any gains.

Scalar functions, written so that compiled code can inline them: the Kalman filters, the
normalization ``predicted`` and the interacting models share them. A covariance is given by the
numbers on and above its diagonal, row by row, and a filter's gain as K = (α, β/T, γ/(2T²)).

Correction is in Joseph form, P = (I - KH)P⁻(I - KH)ᵀ + KrKᵀ, which holds for every K, not only for
that of a Kalman filter.
"""

from __future__ import annotations

__all__ = ["NEW", "ONE_PLOT", "RUNNING", "correct_ca", "correct_cv", "predict_ca", "predict_cv"]

#: Phase of a track, as the memory of a scheduler holds it: no plot yet; position known, but not
#: velocity; both known.
NEW, ONE_PLOT, RUNNING = 0.0, 1.0, 2.0

#: P₁₁, P₁₂, P₂₂
Covariance2 = tuple[float, float, float]
#: P₁₁, P₁₂, P₁₃, P₂₂, P₂₃, P₃₃
Covariance3 = tuple[float, float, float, float, float, float]


def predict_cv(p11: float, p12: float, p22: float, dt: float, g: float, q: float) -> Covariance2:
    """ΦPΦᵀ + GGᵀq of constant velocity over a time `dt`, with G = (g, dt); `g` is dt²/2."""
    return (
        p11 + dt * (2.0 * p12 + dt * p22) + q * g * g,
        p12 + dt * p22 + q * g * dt,
        p22 + q * dt * dt,
    )


def predict_ca(
    p11: float, p12: float, p13: float, p22: float, p23: float, p33: float, dt: float, g: float
) -> Covariance3:
    """ΦPΦᵀ of constant acceleration over a time `dt`, without process noise; `g` is dt²/2."""
    # Rows of ΦP.
    a11 = p11 + dt * p12 + g * p13
    a12 = p12 + dt * p22 + g * p23
    a13 = p13 + dt * p23 + g * p33
    a22 = p22 + dt * p23
    a23 = p23 + dt * p33
    return a11 + dt * a12 + g * a13, a12 + dt * a13, a13, a22 + dt * a23, a23, p33


def correct_cv(
    p11: float, p12: float, p22: float, k1: float, k2: float, s: float, r: float
) -> Covariance2:
    """Covariance after a plot of variance `r`, where the innovation has the variance `s`."""
    rest = 1.0 - k1
    return (
        rest * rest * p11 + k1 * k1 * r,
        rest * (p12 - k2 * p11) + k1 * k2 * r,
        p22 - k2 * (2.0 * p12 - k2 * s),
    )


def correct_ca(
    p11: float, p12: float, p13: float, p22: float, p23: float, p33: float,
    k1: float, k2: float, k3: float, s: float, r: float,
) -> Covariance3:  # fmt: skip
    """As `correct_cv`, with acceleration."""
    n11, n12, n22 = correct_cv(p11, p12, p22, k1, k2, s, r)
    return (
        n11,
        n12,
        (1.0 - k1) * (p13 - k3 * p11) + k1 * k3 * r,
        n22,
        p23 - k2 * p13 - k3 * (p12 - k2 * s),
        p33 - k3 * (2.0 * p13 - k3 * s),
    )
