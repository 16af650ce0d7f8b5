"""
Llinas et al.: five trackers in a field of sensors
==================================================

*J. Llinas, T. Singh, T. Chen and D. Tenne (1998), Application of fuzzy logic to target tracking.*

**What the report claims.** Gains scheduled by a fuzzy rule base, through the w-domain, mostly
improve the tracker with fixed gains; a submarine, four maneuvers, 50 runs.

**What we found.** Trackers 1 and 4 are as printed, within the spread of 50 runs. The two
differ by about 1 %, and the fixed gains are ahead in three maneuvers of four. Readings, errata and
all tables are on :doc:`a page of their own </papers/llinas>`.
"""

# %%
# 50 runs, as many as the report; the command ``fuzzytrack reproduce llinas`` makes 2000, and prints
# all 204 numbers. Mean prediction error, dense field, Table 5.3:
from fuzzytrack.papers import reproduce

found = reproduce("llinas", runs=50)
for row in found.rows:
    if row.table == "Table 5.3" and row.quantity.endswith("mean error (m)"):
        ours = f"{row.ours:.0f} ± {row.se:.0f}"
        print(f"{row.quantity:40} {row.published:5.0f} {ours:>9}  {row.verdict}")

# %%
# The proposed tracker over the fixed one; the noise is the same, so small differences show.
for name in ("M1", "M2", "M3", "M4"):
    print(f"{name}: {found.ours(f'{name}: mean error of T4 over that of T1'):.3f}")

# %%
# One run of the fourth maneuver with the proposed tracker. Hollow marks are scans in which no
# sensor saw the target: the track coasts, and the turn is lost.
found.pictures["fig5-1-track"]()

# %%
# Gains visited with the limits of Table 5.1: a small cloud about the fixed pair.
found.pictures["fig5-2-gains"]()

# %%
# Errors over time in the fourth maneuver.
found.pictures["error-m4"]()

# %%
# The Kalman filter over its process noise, after Fig. A.1: for an accelerating target one value is
# best, for a straight course none is.
found.pictures["figa-1-noise"]()
