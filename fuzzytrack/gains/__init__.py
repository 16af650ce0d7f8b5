"""Theory of gains: pure functions over broadcasting arrays, without fuzzy sets."""

from fuzzytrack.gains.abc_space import abc_preimages, from_abc, to_abc
from fuzzytrack.gains.card import gain_card
from fuzzytrack.gains.circle import CircleOptimum, optimal_on_circle
from fuzzytrack.gains.conventions import GAMMA_CONVENTIONS, convert_gamma
from fuzzytrack.gains.cost import Optimum, TrackingCost
from fuzzytrack.gains.design import (
    benedict_bordner,
    critically_damped,
    fading_memory,
    growing_memory,
    kalata,
    quality,
    tracking_index,
)
from fuzzytrack.gains.optimal import (
    acceleration_index,
    optimal_alpha_beta_gamma,
    optimal_for_acceleration,
    optimal_for_steady_error,
    optimal_for_velocity,
    steady_index,
    velocity_index,
)
from fuzzytrack.gains.performance import (
    NoisyOutput,
    circular_error,
    covariance,
    frequency_response,
    noise_ratio,
    steady_error,
    transient_cost,
)
from fuzzytrack.gains.period import resampled_gains
from fuzzytrack.gains.search import optimal_gains
from fuzzytrack.gains.stability import (
    Region,
    eigenfrequency,
    in_closed_region,
    is_stable,
    jury,
    poles,
    region,
)
from fuzzytrack.gains.systems import transfer_function
from fuzzytrack.gains.wdomain import (
    alpha_beta_from_s,
    alpha_beta_from_w,
    alpha_beta_gamma_from_w,
    kalata_damping,
    s_from_alpha_beta,
    w_from_alpha_beta,
    w_from_alpha_beta_gamma,
)

__all__ = [
    "GAMMA_CONVENTIONS",
    "CircleOptimum",
    "NoisyOutput",
    "Optimum",
    "Region",
    "TrackingCost",
    "abc_preimages",
    "acceleration_index",
    "alpha_beta_from_s",
    "alpha_beta_from_w",
    "alpha_beta_gamma_from_w",
    "benedict_bordner",
    "circular_error",
    "convert_gamma",
    "covariance",
    "critically_damped",
    "eigenfrequency",
    "fading_memory",
    "frequency_response",
    "from_abc",
    "gain_card",
    "growing_memory",
    "in_closed_region",
    "is_stable",
    "jury",
    "kalata",
    "kalata_damping",
    "noise_ratio",
    "optimal_alpha_beta_gamma",
    "optimal_for_acceleration",
    "optimal_for_steady_error",
    "optimal_for_velocity",
    "optimal_gains",
    "optimal_on_circle",
    "poles",
    "quality",
    "region",
    "resampled_gains",
    "s_from_alpha_beta",
    "steady_error",
    "steady_index",
    "to_abc",
    "tracking_index",
    "transfer_function",
    "transient_cost",
    "velocity_index",
    "w_from_alpha_beta",
    "w_from_alpha_beta_gamma",
]
