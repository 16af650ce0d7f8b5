"""Performance of gains: noise in the outputs, steady lag, cost of transients.

Every function takes the gains of the recursion

    x⁻ = x + v T + a T²/2,  v⁻ = v + a T,  x = x⁻ + α e,  v = v⁻ + (β/T) e,  a = a⁻ + (γ/(2T²)) e,

where e = observation - x⁻. γ = 0 is the filter without acceleration, which has two poles. All
functions are closed forms, and their arguments broadcast.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import finite, nonnegative, positive, stable_gains

__all__ = [
    "NoisyOutput",
    "circular_error",
    "covariance",
    "frequency_response",
    "noise_ratio",
    "steady_error",
    "transient_cost",
]


NoisyOutput = Literal["predicted", "filtered", "velocity", "acceleration", "interval"]

# Numerators of the variance ratios over the common denominator u w, where u = 4 - 2α - β and
# w = 4αβ - γ(2 - α): steady state of the discrete Lyapunov equation of the filtered state.
_NUMERATORS: dict[str, Callable[[Any, Any, Any, Any], Any]] = {
    "predicted": lambda a, b, g, u: 4 * b * (a * (2 * a + b) + 2 * b) - a * g * u,
    "filtered": lambda a, b, g, u: 4 * b * (a * (2 * a - 3 * b) + 2 * b) - a * g * u,
    "velocity": lambda a, b, g, u: 4 * b * b * (2 * b - g) + g * g * (2 - a),
    "acceleration": lambda a, b, g, u: 2 * b * g * g,
    "interval": lambda a, b, g, u: (
        4 * b * (a * (2 * a - b) + 2 * b - b * b / 3) - a * g * (u + 2 * b / 3) + b * g * g / 60
    ),
}


def straight_cost(a: Any, b: Any, g: Any, t: Any, v: Any, acc: Any) -> Any:
    """`transient_cost` without checks, for one kind of filter: without γ where `g` is None."""
    start, bend = v * t, acc * t * t
    u = 4 - 2 * a - b
    if g is None:
        moving = start * start * (2 - a) / (u * a * b)
        turning = bend * (bend * (2 * a * a + a * b + 2 * b) / (4 * a * b) - start) / (b * b)
    else:
        w = 4 * a * b - g * (2 - a)
        moving = 4 * start * start * (2 - a) / (u * w)
        turning = 4 * bend * bend * a / (g * w)
    return t * (moving + turning)


def variance_ratio(a: Any, b: Any, g: Any, of: str = "predicted") -> Any:
    """`noise_ratio` without checks."""
    u = 4 - 2 * a - b
    return _NUMERATORS[of](a, b, g, u) / (u * (4 * a * b - g * (2 - a)))


def squared_distance(a: Any, b: Any, g: Any, sine: Any, cosine: Any) -> Any:
    """Square of `circular_error` without checks on a unit circle; sine and cosine of ωT/2 > 0."""
    square = sine * sine
    ahead = sine * (b - 2 * (2 - a) * square)
    aside = cosine * (2 * a * square - g / 4)
    return 16 * square**3 / (ahead * ahead + aside * aside)


def noise_ratio(
    alpha: ArrayLike, beta: ArrayLike, gamma: ArrayLike = 0.0, *, of: NoisyOutput = "predicted"
) -> Array:
    """Variance of an output of the filter per variance of white observation noise.

    Parameters
    ----------
    alpha, beta, gamma : array_like
        Stable gains, dimensionless; they broadcast.
    of : str
        The output, all at the observation unless said otherwise:

        ``"predicted"``
            position predicted for the next observation, one interval T ahead;
        ``"filtered"``
            position just after the observation;
        ``"interval"``
            position extrapolated from the observation, its variance averaged over the interval T
            that follows (what is shown on a display between two observations);
        ``"velocity"``
            velocity times T, so that it has the unit of the observation;
        ``"acceleration"``
            acceleration times T²; 0 where `gamma` is 0.

    Returns
    -------
    ndarray
        Ratio of variances ρ² (its root is the ratio of standard deviations), dimensionless, of
        the broadcast shape (a number for numbers).

    Raises
    ------
    ValueError
        If gains are not stable, or `of` names no output.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.68 and 2.69, from the steady state of the discrete Lyapunov
    equation: Eq. 2.68 as printed carries a spurious factor 4b. The three columns of their Table
    2.4 for α = 0.5, β = 0.7 are the ratios of three different outputs: 1.9565 is ``"predicted"``,
    1.2058 (Sklansky) is ``"interval"`` and 0.7391 (Benedict and Bordner) is ``"filtered"``.

    Examples
    --------
    >>> for of in ("predicted", "interval", "filtered"):
    ...     print(f"{noise_ratio(0.5, 0.7, of=of):.4f}")
    1.9565
    1.2058
    0.7391
    """
    if of not in _NUMERATORS:
        raise ValueError(f"of must be one of {', '.join(map(repr, _NUMERATORS))}; got {of!r}")
    a, b, g = stable_gains(alpha, beta, gamma)
    return np.asarray(variance_ratio(a, b, g, of))[()]


def covariance(
    alpha: ArrayLike,
    beta: ArrayLike,
    sigma_w: ArrayLike,
    dt: ArrayLike,
    sigma_v: ArrayLike = 0.0,
) -> Array:
    """Steady covariance of the error of filtered position and velocity of an alpha-beta filter.

    The target moves with constant velocity, disturbed in each interval by a constant acceleration
    that is white from one interval to the next: the model under which the gains of Kalata are
    optimal. The covariance holds for any stable pair.

    Parameters
    ----------
    alpha, beta : array_like
        Stable gains, dimensionless.
    sigma_w : array_like
        Standard deviation of the observation noise, m, >= 0.
    dt : array_like
        Sampling time T, s, > 0.
    sigma_v : array_like
        Standard deviation of the target's acceleration, m/s², >= 0. At 0, the default, the
        covariance is that of the noise alone.

    Returns
    -------
    ndarray
        Shape (..., 2, 2), where ... is the broadcast shape of all arguments: variance of
        position (m²), covariance (m²/s), variance of velocity (m²/s²).

    Raises
    ------
    ValueError
        If gains are not stable, or a standard deviation or `dt` is out of its range.

    Notes
    -----
    Closed form of P = A P Aᵀ + K Kᵀ σ_w² + (I - K H) G Gᵀ (I - K H)ᵀ σ_v², G = (T²/2, T). At the
    gains for the tracking index σ_v T²/σ_w it equals Kim and Lee, Eq. 12.

    Examples
    --------
    >>> print(covariance(0.75, 0.5, sigma_w=1, dt=1, sigma_v=1))
    [[0.75 0.5 ]
     [0.5  1.  ]]
    """
    a, b, _ = stable_gains(alpha, beta)
    w, t, v = nonnegative("sigma_w", sigma_w), positive("dt", dt), nonnegative("sigma_v", sigma_v)
    noise = w * w / (a * (4 - 2 * a - b))
    target = (v * t * t) ** 2 / (4 * a * b)
    position = noise * (2 * a * a - 3 * a * b + 2 * b) + target * 2 * (1 - a) ** 2
    cross = (noise * b * (2 * a - b) + target * (1 - a) * (2 * a - b)) / t
    velocity = (noise * 2 * b * b + target * (2 * a * a - 3 * a * b + 2 * b)) / t**2
    return np.stack([position, cross, cross, velocity], axis=-1).reshape((*position.shape, 2, 2))


def steady_error(
    alpha: ArrayLike,
    beta: ArrayLike,
    gamma: ArrayLike = 0.0,
    dt: ArrayLike = 1.0,
    acceleration: ArrayLike = 0.0,
    jerk: ArrayLike = 0.0,
) -> Array:
    """Steady lag of the prediction behind a target of constant acceleration or constant jerk.

    Parameters
    ----------
    alpha, beta, gamma : array_like
        Stable gains, dimensionless.
    dt : array_like
        Sampling time T, s, > 0.
    acceleration : array_like
        Acceleration of the target, m/s².
    jerk : array_like
        Its constant rate of change, m/s³.

    Returns
    -------
    ndarray
        True minus predicted position, m, of the broadcast shape: a T²/β where `gamma` is 0, and
        2 j T³/γ elsewhere, whatever the acceleration. Where `gamma` is 0 and the target has a
        jerk, the lag grows without bound: infinite, with the sign of the jerk.

    Raises
    ------
    ValueError
        If gains are not stable, `dt` is not positive, or a motion is not finite.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.82 and 2.83; the lag under jerk follows from Eq. 2.72.

    Examples
    --------
    >>> print(f"{steady_error(0.5, 0.7, dt=2, acceleration=0.2):.6f}")
    1.142857
    """
    _, b, g = stable_gains(alpha, beta, gamma)
    t, acc, j = positive("dt", dt), finite("acceleration", acceleration), finite("jerk", jerk)
    g, b, t, acc, j = np.broadcast_arrays(g, b, t, acc, j)
    without = np.where(j == 0, acc * t**2 / b, np.copysign(np.inf, j))
    return np.divide(2 * j * t**3, g, out=without, where=g > 0)[()]


def circular_error(
    alpha: ArrayLike,
    beta: ArrayLike,
    gamma: ArrayLike,
    angular_rate: ArrayLike,
    dt: ArrayLike,
    radius: ArrayLike,
) -> Array:
    """Steady distance between the prediction and a target that flies a circle.

    Parameters
    ----------
    alpha, beta, gamma : array_like
        Stable gains, dimensionless, the same for both axes.
    angular_rate : array_like
        Turn rate of the target, rad/s, of either sign.
    dt : array_like
        Sampling time T, s, > 0.
    radius : array_like
        Radius of the circle, m, >= 0.

    Returns
    -------
    ndarray
        Distance, m, of the broadcast shape. It is the same at every observation.

    Raises
    ------
    ValueError
        If gains are not stable, or another argument is out of its range.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.76 and 2.77, with one root over everything. The expression under
    the root is written as a sum of two squares, which keeps its precision for slow turns.

    Examples
    --------
    >>> print(f"{circular_error(0.5, 0.4, 0.1, angular_rate=0.3, dt=1, radius=100):.6f}")
    26.786931
    """
    a, b, g = stable_gains(alpha, beta, gamma)
    rate, t = finite("angular_rate", angular_rate), positive("dt", dt)
    r = nonnegative("radius", radius)
    half = rate * t / 2
    s, c = np.sin(half), np.cos(half)
    square = s * s
    numerator = 4 * r * square * np.abs(s)
    root = np.hypot(s * (b - 2 * (2 - a) * square), c * (2 * a * square - g / 4))
    distance: Array = np.zeros(np.broadcast_shapes(numerator.shape, root.shape))
    np.divide(numerator, root, out=distance, where=root > 0)
    return distance[()]


def transient_cost(
    alpha: ArrayLike,
    beta: ArrayLike,
    gamma: ArrayLike,
    dt: ArrayLike,
    velocity: ArrayLike,
    acceleration: ArrayLike,
) -> Array:
    """Sum of T e² while a filter at rest catches up with a target on a straight line.

    The target starts at the filter's position with a velocity and a constant acceleration that the
    filter does not know; e is the error of the prediction, without noise.

    Parameters
    ----------
    alpha, beta, gamma : array_like
        Stable gains, dimensionless.
    dt : array_like
        Sampling time T, s, > 0.
    velocity : array_like
        Initial velocity of the target, m/s.
    acceleration : array_like
        Its acceleration, m/s².

    Returns
    -------
    ndarray
        Cost, m² s, of the broadcast shape. Where `gamma` is 0, the steady lag a T²/β is
        subtracted from e, since the sum would not converge otherwise; hence the cost with an
        acceleration does not tend to that of γ = 0 as γ tends to 0, but to infinity.

    Raises
    ------
    ValueError
        If gains are not stable, `dt` is not positive, or a motion is not finite.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.88 and 2.91, corrected: the last term of 2.88 is negative, and
    in 2.91 (1 - c)² must read (1 + c)². Because the lag is subtracted, a decelerating target
    costs more than an accelerating one when `gamma` is 0.

    Examples
    --------
    >>> print(f"{transient_cost(0.5, 0.7, 0, dt=2, velocity=3, acceleration=0.2):.6f}")
    118.767905
    """
    a, b, g = stable_gains(alpha, beta, gamma)
    t = positive("dt", dt)
    v, acc = finite("velocity", velocity), finite("acceleration", acceleration)
    a, b, g, t, v, acc = np.broadcast_arrays(a, b, g, t, v, acc)
    cost = np.empty(a.shape)
    with_gamma = g > 0
    for chosen, third in ((~with_gamma, None), (with_gamma, g[with_gamma])):
        cost[chosen] = straight_cost(a[chosen], b[chosen], third, t[chosen], v[chosen], acc[chosen])
    return cost[()]


def frequency_response(
    alpha: ArrayLike,
    beta: ArrayLike,
    gamma: ArrayLike,
    frequencies: ArrayLike,
    dt: ArrayLike,
    *,
    of: Literal["predicted", "filtered"] = "predicted",
) -> NDArray[np.complex128]:
    """Complex gain from the true position to the predicted or the filtered one.

    Parameters
    ----------
    alpha, beta, gamma : array_like
        Stable gains, dimensionless.
    frequencies : array_like
        Angular frequencies, rad/s; the response repeats itself beyond the Nyquist rate π/T.
    dt : array_like
        Sampling time T, s, > 0.
    of : str
        ``"predicted"``, the position predicted for an observation from those before it, compared
        with that observation; or ``"filtered"``, with the observation taken in.

    Returns
    -------
    ndarray of complex
        Gain, dimensionless, of the broadcast shape of all arguments: 1 at frequency 0.

    Raises
    ------
    ValueError
        If gains are not stable, another argument is out of its range, or `of` names no output.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.7 and 2.45, at z = exp(jωT).

    Examples
    --------
    >>> import numpy as np
    >>> print(abs(frequency_response(0.5, 0.7, 0, [0, np.pi], dt=1)).round(4))
    [1.     0.7391]
    """
    if of not in ("predicted", "filtered"):
        raise ValueError(f"of must be one of 'predicted', 'filtered'; got {of!r}")
    a, b, g = stable_gains(alpha, beta, gamma)
    rate, t = finite("frequencies", frequencies), positive("dt", dt)
    delta = np.expm1(1j * rate * t)  # z - 1, exact at low frequencies
    a, b, g, delta = np.broadcast_arrays(a, b, g, delta)
    # In δ = z - 1 the polynomials have no cancelling terms; without γ both lose a factor δ.
    low = np.where(g > 0, ((a + b + g / 4) * delta + b + 3 * g / 4) * delta + g / 2, 0)
    low = np.where(g > 0, low, (a + b) * delta + b)
    high = np.where(g > 0, delta**3, delta**2)
    error = high / (high + low)
    return np.asarray(1 - error if of == "predicted" else 1 - (1 - a) * error)[()]
