"""Stable gains of every size, for optima to be compared with."""

import numpy as np

RNG = np.random.default_rng(7)
SHARES = 1 / (1 + np.exp(-RNG.uniform([[-9], [-14], [-9]], [[6], [5], [5]], (3, 30_000))))
ALPHA = 2 * SHARES[0]
BETA = (4 - 2 * ALPHA) * SHARES[1]
GAMMA = 4 * ALPHA * BETA / (2 - ALPHA) * SHARES[2]
