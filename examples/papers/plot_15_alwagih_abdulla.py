"""
Al-Wagih & Abdulla: five ways to select gains
=============================================

*K. S. M. Al-Wagih and M. F. Abdulla, A study of αβ tracker with some new algorithms for selecting
α and β parameters.*

**What the paper claims.** Two classical ways to select α and β, small fixed ones (M1) and those of
a line through all plots so far (M2), are beaten by three new ones: a β between the two (M3), a
search for α over a moving window (M4), and a bank of filters in parallel, of which the one nearest
to the plot counts (M5). M5 is best, then M4, then M3.

**What we found.** The averages of the paper's tables are reproduced, except that of M4 in one
coordinate. But M5 chooses its prediction by the very plot that it predicts, so it cannot track. Its
gain over M1 in Y, 94 %, comes from larger gains in the bank: one fixed α of 0.4 does as well in
white noise. M4 acts late, and in Y is three to four times worse than M3, which there is worse than
M2. Of the 84 numbers that the paper derives from its own tables 15 do not follow; 99.0708 should be
7.0792.

**How it is read.** The paper gives neither tracks nor noise, nor the parameters of M3 to M5.
Scenario S3 was made so that its errors come near to the averages, with α = 0.05 in M1, a weight of
0.05 in M3, a window of 80 of 100 plots in M4 and ten filters from α = 0.1 to 0.999 in M5: it shows
that such tables are possible, not that they are right. We recommend ``ParallelBank()``, which
weighs its members by how well they predicted the plots before.
"""

# %%
# 40 runs; the command ``fuzzytrack reproduce alwagih-abdulla`` makes 500, and prints every number.
from fuzzytrack.papers import reproduce

found = reproduce("alwagih-abdulla", runs=40)
for row in found.rows:
    if row.table == "Table 1" and row.published is not None:
        print(f"{row.quantity:16}  published {row.published:5.1f}  ours {row.ours:5.1f}")

# %%
# Root mean square errors of the five methods, in white noise and in colored noise.
found.pictures["fig7-white"]()

# %%
found.pictures["fig8-coloured"]()

# %%
# M5 without hindsight: by the last plot alone it is worse than the plots themselves; with memory it
# is about as good as the best fixed gain, which is not known beforehand.
for name in ("M5", "M5 last", "M5 best", "M5 soft", "fixed α = 0.4", "plots"):
    white, coloured = (found.ours(f"{name}: Y, {noise} (m)") for noise in ("white", "coloured"))
    print(f"{name:14}  RMSE in Y {white:4.1f} m in white noise, {coloured:4.1f} m in colored noise")

# %%
# M4 is M1 until its window is full, after 82 plots.
found.pictures["error-y"]()

# %%
# Numbers that do not follow from the paper's own Tables 1 and 2.
for row in found.rows:
    if row.table in ("Table 3", "Table 4", "Table 5", "Table 6") and row.verdict == "differs":
        print(f"{row.table}, {row.quantity}: {row.published} should be {row.ours:.4f}")
# sphinx_gallery_thumbnail_number = 3
