"""
Gains at another sampling time
==============================

Gains were tuned at one sampling time. Which gains at another one? The report of Llinas et al.
(1998) leaves it as future work: the stiffness should follow the sampling time.
"""

# %%
# Let gains be the best ones at T = 1 for a target that accelerates steadily, in noise. With the
# same filter in continuous time, which is what `period` does, the frequency ω₀ is proportional to
# T. The best gains for such a target at each T follow ω₀ ~ T^0.8.
import matplotlib.pyplot as plt
import numpy as np

from fuzzytrack import gains
from fuzzytrack.gains.track_noise import largest_noise

index = 0.1  # a T²/σ at T = 1
alpha, beta = gains.optimal_for_steady_error(index)
omega0, zeta = gains.w_from_alpha_beta(alpha, beta)

laws = {
    "unchanged": lambda t: (np.full(t.shape, alpha), np.full(t.shape, beta)),
    "period": lambda t: gains.resampled_gains(alpha, beta, period=1, dt=t)[:2],
    "ω₀ ~ T^0.8": lambda t: gains.alpha_beta_from_w(omega0 * t**0.8, zeta),
}


def error(pair, t):
    """Root mean square error of a prediction at a constant T, in σ: noise, and lag."""
    return np.sqrt(gains.noise_ratio(*pair) + (index * t**2 / pair[1]) ** 2)


# %%
# At a constant T, T^0.8 is within 1 % of the best; the same filter loses little where T changes by
# a factor of two, and unchanged gains lose much.
times = np.array([0.25, 0.5, 1.0, 2.0, 4.0])
best = error(gains.optimal_for_steady_error(index * times**2), times)
print("error over the best one, %")
print(f"{'T':12}", *(f"{t:6g}" for t in times))
for name, law in laws.items():
    excess = 100 * (error(law(times), times) / best - 1)
    print(f"{name:12}", *(f"{percent:6.1f}" for percent in excess.round(1) + 0))

curve = np.geomspace(0.25, 4, 100)
best = error(gains.optimal_for_steady_error(index * curve**2), curve)
figure, axes = plt.subplots(layout="constrained")
for (name, law), color in zip(laws.items(), ("#D55E00", "#0072B2", "#009E73"), strict=True):
    excess = 100 * (error(law(curve), curve) / best - 1)
    axes.semilogx(curve, excess, label=name, color=color, linewidth=2)
axes.set(xlabel="T, in units of the period", ylabel="error of a prediction over the best one (%)")
axes.set(xlim=(0.25, 4), ylim=(-2, 60))
axes.set_xticks(times, [f"{t:g}" for t in times])
axes.minorticks_off()
axes.grid(color="0.9")
axes.legend(loc="upper center")

# %%
# Where T changes from plot to plot, another thing counts: how much noise of the plots remains in
# the track, in σ. Here T is random, log-uniform, with the largest over the smallest as given.
random = np.random.default_rng(1)
exponents = random.uniform(-0.5, 0.5, (100, 300))
print("\nlargest noise of the filtered position, median of tracks")
print(f"{'ratio of T':12}", *(f"{ratio:9g}" for ratio in (2, 10, 30, 100, 1000)))
for name, law in laws.items():
    noise = []
    for ratio in (2, 10, 30, 100, 1000):
        elapsed = float(ratio) ** exponents
        noise.append(np.median(largest_noise(elapsed, *law(elapsed))))
    print(f"{name:12}", *(f"{value:9.3g}" for value in noise))

# %%
# The same filter in continuous time is safe at any times. T^0.8 is better as long as T does not
# differ by more than about thirty times, and worse beyond.
