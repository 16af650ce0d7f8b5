"""
Which gains are stable?
=======================

Those in a triangle, for α-β filters; with γ those in a volume. The place of a pair in the triangle
determines how the filter responds.
"""

# %%
# The regions differ in their poles. Underdamped filters (Ia, Ib) overshoot, overdamped ones (IIa)
# approach slowly; on the other side of the triangle (IIb) the estimate changes sign at every scan.
import numpy as np

from fuzzytrack import gains
from fuzzytrack.plotting import plot_stability_regions, plot_stability_volume

plot_stability_regions()

# %%
# In numbers, for three pairs of gains:
for alpha, beta in ((0.5, 0.2), (0.5, 0.05), (0.7, 2.5)):
    largest = np.abs(gains.poles(alpha, beta)).max()
    print(f"α = {alpha}, β = {beta}: {gains.region(alpha, beta)}, largest pole {largest:.3f}")

# %%
# A third gain γ, for the acceleration, makes a volume of the triangle. It has a curved face,
# γ = 4αβ/(2 - α), and ends in the triangle at γ = 0.
plot_stability_volume()

# %%
# In other coordinates the volume is a prism: an α-β-γ filter is an α-β filter with gains a and b,
# and one more pole -c. Any a and b of the triangle can be combined with any c between -1 and 1.
plot_stability_volume("abc")
print(
    "(a, b, c) = (0.5, 0.3, -0.6) is (α, β, γ) = ({:.2f}, {:.2f}, {:.2f})".format(
        *gains.from_abc(0.5, 0.3, -0.6)
    )
)
