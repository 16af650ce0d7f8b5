"""
Njonjo et al.: fading memory against a Kalman filter
====================================================

*A. W. Njonjo, B.-F. Pan and T.-G. Jeong (2017), α-β-γ filter and Kalman filter for a high dynamic
warship.*

**What the paper claims.** On a weaving warship of 50 m/s, an α-β-γ filter with its three gains out
of one number ξ = 0.64 is nearly as good as a tuned Kalman filter: 19,622 m against 19,104 m of
prediction error, added up over 1000 scans, and 10,653 m against 10,492 m of estimation error.

**What we found.** All four totals are reproduced. ξ = 0.64 is best for the estimate; for the
prediction it is 0.60. The tuned Kalman filter has R = 1, although the noise has a variance of
100 m²: only the ratio of Q to R matters once the filter has settled.

**How it is read.** w = 0.0168 rad/s, for which the way to the second sample, over 3 s, gives the
published 50.4 m/s. Both filters start at the first plot, with no velocity; that sample counts with
the error of its plot. The acceleration gain is 2γ/T² as printed
(``FadingMemory(0.64, "njonjo")``), which is not the critically damped filter that the text
describes; ``"mahafza"``, the default, is.
"""

# %%
# 20 runs; the command ``fuzzytrack reproduce njonjo`` makes 100.
from fuzzytrack.papers import reproduce

found = reproduce("njonjo", runs=20)
print(found)

# %%
# The best ξ: of the prediction and of the estimate.
found.pictures["xi"]()

# %%
# Tuning of the Kalman filter, as the paper did it, on a grid of decades.
found.pictures["fig6-7-sweep-q"]()
