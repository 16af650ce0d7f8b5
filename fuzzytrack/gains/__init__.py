"""Theory of gains: pure functions over broadcasting arrays; they know nothing of fuzzy sets."""

from fuzzytrack.gains.wdomain import alpha_beta_from_w, w_from_alpha_beta

__all__ = ["alpha_beta_from_w", "w_from_alpha_beta"]
