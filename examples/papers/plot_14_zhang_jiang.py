"""
Zhang & Jiang: track quality
============================

*Improved α-β filter for vessel traffic services.*

**What the paper claims.** A quality factor N, raised by every hit and lowered by every miss, gives
both the gains of the filter and the size of the gate; the tracker beats a Kalman filter and a plain
α-β filter in range and angle.

**What we found.** The formulas are right: α is that of a line through N + 2 plots, β Kalata's with
it, and the gate factor is the standard deviation of a prediction. Its table does not follow from
them: F is infinite at N = 1, not 3, and 0.37 at N = 30, not 0.3. The table of errors cannot be
reproduced: noise, trajectories, gains and units are missing. With 30 steps of quality the gains
fall to α = 0.12, and a vessel that turns leaves its gate. The experiment counts this, with 200
vessels around a radar: of vessels that turn by up to 1 °/s, each loses its track four to five times
in 14 minutes, and 0.2 times with the safe gate and a cap of 10. The 32 sectors save 15 of 16 pairs.

**How it is read.** ``QualityGains()`` stops at N = 10, which keeps vessels that turn;
``QualityGains.as_published()`` goes to 30. A miss lowers it by 3; the paper has only "larger" than
1.
"""

# %%
from fuzzytrack.papers import reproduce

found = reproduce("zhang-jiang")
print(found)

# %%
# The lag of the filter behind a steady turn grows faster than its noise falls.
for n in (1, 5, 10, 15, 30):
    lag, alpha = found.ours(f"lag in a turn, over a T², at N = {n}"), found.ours(f"α at N = {n}")
    print(f"N = {n:2}: α = {alpha:.3f}, {lag:6.1f} a T² behind")
found.pictures["gains-and-gates"]()
