"""Which outputs of a rule base are gains of a tracker, and how they become α, β and γ.

The scheduler, the certificate of stability, the review, the pictures and the command line use it.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.gains.wdomain import alpha_beta_from_w, bilinear, kalata_damping

__all__ = ["GAIN_SETTINGS", "Conversion", "GainOutputs", "choices", "find_gain_outputs", "gains_of"]

#: From the outputs, in the order of the rule base, to (α, β, γ, retention of acceleration).
Conversion = Callable[[tuple[float, ...]], tuple[float, float, float, float]]


@dataclass(frozen=True)
class GainOutputs(ABC):
    """Outputs of a rule base that together determine the gains of a tracker.

    Attributes
    ----------
    names : tuple of str
        Names of the outputs.
    setting : str
        Their name in the scheduler setting ``gains``.
    """

    setting: ClassVar[str]
    names: tuple[str, ...]

    @property
    def gain_names(self) -> tuple[str, ...]:
        """Names of the gains that follow: alpha, beta and maybe gamma."""
        return ("alpha", "beta", "gamma") if "gamma" in self.names else ("alpha", "beta")

    def gains(self, outputs: Mapping[str, Array]) -> dict[str, Array]:
        """Gains from values of the outputs.

        Parameters
        ----------
        outputs : mapping of str to ndarray
            Values of the outputs, all of one shape; NaN where no rule fires. Others are ignored.

        Returns
        -------
        dict of str to ndarray
            For each of `gain_names` an array of that shape; NaN where an output is.

        Raises
        ------
        ValueError
            If a stiffness or a damping is negative.
        """
        given = np.stack([np.asarray(outputs[name], dtype=np.float64) for name in self.names])
        known = ~np.isnan(given).any(axis=0)
        found = {name: np.full(known.shape, np.nan) for name in self.gain_names}
        for values, part in zip(found.values(), self._gains(*given[:, known]), strict=True):
            values[known] = part
        return found

    @abstractmethod
    def _gains(self, *outputs: Array) -> Sequence[Array]:
        """Gains from the values of `names`, all finite."""

    @abstractmethod
    def conversion(self, output_names: Sequence[str]) -> Conversion:
        """Scalar function to the gains, for a scheduler's kernel.

        Parameters
        ----------
        output_names : sequence of str
            All outputs of the rule base, in the order in which the function gets their values.
        """


class _WDomain(GainOutputs):
    """Frequency and damping in the w-domain; every positive pair is stable."""

    setting = "w-domain"

    def _gains(self, *outputs: Array) -> Sequence[Array]:
        return alpha_beta_from_w(*outputs)

    def conversion(self, output_names: Sequence[str]) -> Conversion:
        stiffness, damping = map(output_names.index, self.names)

        def from_w(outputs: tuple[float, ...]) -> tuple[float, float, float, float]:
            # `fuzzytrack.gains.wdomain.bilinear` with a single division.
            omega0, zeta = outputs[stiffness], outputs[damping]
            shared = 4.0 * omega0 / (1.0 + omega0 * (zeta + zeta + omega0))
            return zeta * shared, omega0 * shared, 0.0, 1.0

        return from_w


class _Kalata(GainOutputs):
    """Frequency alone, with the damping at which the gains are optimal for a tracking index."""

    setting = "kalata"

    def _gains(self, *outputs: Array) -> Sequence[Array]:
        (stiffness,) = outputs
        return alpha_beta_from_w(stiffness, kalata_damping(stiffness))

    def conversion(self, output_names: Sequence[str]) -> Conversion:
        (stiffness,) = map(output_names.index, self.names)

        def from_stiffness(outputs: tuple[float, ...]) -> tuple[float, float, float, float]:
            omega0 = outputs[stiffness]
            alpha, beta = bilinear(omega0, math.sqrt(0.5 + 0.25 * omega0 * omega0))
            return alpha, beta, 0.0, 1.0

        return from_stiffness


class _Direct(GainOutputs):
    """The gains themselves."""

    setting = "direct"

    def _gains(self, *outputs: Array) -> Sequence[Array]:
        return outputs

    def conversion(self, output_names: Sequence[str]) -> Conversion:
        alpha, beta, *rest = map(output_names.index, self.names)
        if not rest:

            def direct(outputs: tuple[float, ...]) -> tuple[float, float, float, float]:
                return outputs[alpha], outputs[beta], 0.0, 1.0

            return direct
        (gamma,) = rest

        def direct_gamma(outputs: tuple[float, ...]) -> tuple[float, float, float, float]:
            return outputs[alpha], outputs[beta], outputs[gamma], 1.0

        return direct_gamma


_ALL: tuple[GainOutputs, ...] = (
    _WDomain(("stiffness", "damping")),
    _Kalata(("stiffness",)),
    _Direct(("alpha", "beta")),
    _Direct(("alpha", "beta", "gamma")),
)

#: Words for the scheduler setting ``gains``.
GAIN_SETTINGS = tuple(dict.fromkeys(outputs.setting for outputs in _ALL))


def find_gain_outputs(output_names: Collection[str]) -> GainOutputs | None:
    """Outputs of a rule base that are gains; None if they are not gains."""
    return next((found for found in _ALL if set(found.names) == set(output_names)), None)


def choices(setting: str | None = None) -> str:
    """Outputs that are gains, for messages; of one setting, or all."""
    allowed = (found.names for found in _ALL if setting in (None, found.setting))
    return " or ".join(", ".join(names) for names in allowed)


def gains_of(outputs: Mapping[str, Array]) -> dict[str, Array]:
    """α and β behind the outputs of a rule base, where these are not the gains themselves.

    Parameters
    ----------
    outputs : mapping of str to ndarray
        Values of all outputs.

    Returns
    -------
    dict of str to ndarray
        Empty if the outputs are gains already, or none.
    """
    found = find_gain_outputs(outputs)
    return {} if found is None or found.gain_names == found.names else found.gains(outputs)
