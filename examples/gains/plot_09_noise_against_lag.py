"""
How much noise for how much lag?
================================

Gains that smooth more also lag more. How much lag does less noise cost, and which gains are best
for a known target?
"""

# %%
# The noise ratio ρ² is the variance of the predicted position per variance of the plots. Below the
# curve of 1 a prediction is better than a plot.
from fuzzytrack import gains
from fuzzytrack.plotting import plot_noise_against_lag, plot_noise_ratio, plot_optimal_curves

plot_noise_ratio()

# %%
# A target with acceleration *a* is predicted too late by *a* T²/β. All designs are close to the
# best that is possible; what has to be chosen is the place on the curve.
fixed = (0.5377, 0.2018)
plot_noise_against_lag({"fixed pair": fixed})
lag = gains.steady_error(*fixed, acceleration=1)
print(f"ρ² = {gains.noise_ratio(*fixed):.3f}, lag = {lag:.2f} a T²")

# %%
# The place depends on the target. For a motion and a noise there is one index, and for each index
# one pair of gains; the dots are the indices 0.1, 1 and 10.
plot_optimal_curves()
index = gains.velocity_index(velocity=3, dt=2, sigma=10)
alpha, beta = gains.optimal_for_velocity(index)
print(f"3 m/s, T = 2 s, σ = 10 m: index {index:.3f}, α = {alpha:.3f}, β = {beta:.3f}")
