"""
Which gains are best for a turn?
================================

On a circle a filter with fixed gains trails behind by a fixed distance. Larger gains bring it
closer and pass on more noise; somewhere between there is a best pair.
"""

# %%
# A submarine at 3 knots on a circle of 45 m, a plot every 3 s. The cost is the square of the
# distance plus a hundredth of the variance of the predicted position.
import numpy as np

from fuzzytrack import gains
from fuzzytrack.plotting import plot_circle_cost, plot_circle_gains, plot_optimal_gains

rate, dt, radius = 1.5433 / 45, 3.0, 45.0
best = gains.optimal_on_circle(rate, dt, radius, sigma=200**0.5, kappa=0.01)
print(f"α = {best.alpha:.3f}, β = {best.beta:.3f}: {best.error:.2f} m behind")
plot_circle_cost(rate, dt, radius)

# %%
# The larger the weight of the noise, the smaller the gains, up to a weight at which it costs less
# not to follow the circle and to stay at its center. There the thick line ends.
plot_circle_gains(rate, dt, radius, kappas=10 ** np.arange(-2, 3.5, 0.25))

# %%
# On a straight line one index combines the motion, the sampling time and the noise. With a third
# gain for the acceleration:
plot_optimal_gains(order=3)
