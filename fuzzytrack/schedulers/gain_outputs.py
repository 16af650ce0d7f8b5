"""Which outputs of a rule base determine the gains of a tracker, and how they become α, β and γ.

The scheduler, the certificate of stability, the review, the pictures and the command line use it.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.gains.wdomain import alpha_beta_from_w, bilinear, kalata_damping
from fuzzytrack.schedulers.converter import Conversion, Converter, Memoryless
from fuzzytrack.schedulers.maneuver_covariance import ManeuverCovariance

__all__ = [
    "GAIN_SETTINGS", "ConvertedOutputs", "GainOutputs", "choices", "find_converted_outputs",
    "find_gain_outputs", "gains_of", "numbers_of",
]  # fmt: skip


@dataclass(frozen=True)
class ConvertedOutputs(ABC):
    """Outputs of a rule base that a conversion turns into the gains of a tracker.

    Attributes
    ----------
    names : tuple of str
        Names of the outputs.
    setting : str
        Name of the conversion in the scheduler setting ``gains``.
    numbers : mapping of str to str
        Numbers that it takes from the scheduler settings, and what each is.
    parameters : tuple of str
        Parameters of the scheduler that it takes.
    has_covariance : bool
        Whether it keeps a covariance, which says what variance an innovation should have.
    uses_acceleration : bool
        Whether γ can be other than 0.
    """

    setting: ClassVar[str]
    numbers: ClassVar[Mapping[str, str]] = {}
    parameters: ClassVar[tuple[str, ...]] = ()
    has_covariance: ClassVar[bool] = False
    names: tuple[str, ...]

    @property
    @abstractmethod
    def uses_acceleration(self) -> bool:
        """Whether γ can be other than 0."""

    @abstractmethod
    def converter(
        self, output_names: Sequence[str], quiet: tuple[float, ...], **given: Any
    ) -> Converter:
        """What turns the outputs into gains in a scheduler's kernel.

        Parameters
        ----------
        output_names : sequence of str
            All outputs of the rule base, in the order in which their values come.
        quiet : tuple of float
            Their values where all inputs are 0.
        **given
            Those of `numbers` and `parameters` that the user gives.

        Raises
        ------
        ValueError
            If one of them is out of range.
        """


class GainOutputs(ConvertedOutputs):
    """Outputs of a rule base that together are the gains of a tracker, whatever came before.

    Attributes
    ----------
    names : tuple of str
        Names of the outputs.
    setting : str
        Their name in the scheduler setting ``gains``.
    """

    parameters = ("period",)

    @property
    def gain_names(self) -> tuple[str, ...]:
        """Names of the gains that follow: alpha, beta and maybe gamma."""
        return ("alpha", "beta", "gamma") if self.uses_acceleration else ("alpha", "beta")

    @property
    def uses_acceleration(self) -> bool:
        """Whether one of them is γ."""
        return "gamma" in self.names

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

    def converter(
        self, output_names: Sequence[str], quiet: tuple[float, ...], **given: Any
    ) -> Converter:
        """See `ConvertedOutputs.converter`."""
        return Memoryless(self.conversion(output_names), **given)


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


class _Covariance(ConvertedOutputs):
    """Noise and retention of a maneuver, for a covariance from which the gains follow."""

    setting = "covariance"
    numbers: ClassVar[Mapping[str, str]] = {
        "delay": "Time by which a maneuver is older than the plot before it is noticed, in τ₀.",
        "gap": "Interval between plots at which the noise is halved, in τ₀.",
        "start": "Standard deviation of the acceleration of a new track, in a₀.",
    }
    parameters = ("level", "velocity_sigma", "axes")
    has_covariance = True

    @property
    def uses_acceleration(self) -> bool:
        """Whether γ can be other than 0: yes."""
        return True

    def converter(
        self, output_names: Sequence[str], quiet: tuple[float, ...], **given: Any
    ) -> Converter:
        """See `ConvertedOutputs.converter`."""
        noise, retention = map(output_names.index, self.names)
        return ManeuverCovariance((noise, retention), (quiet[noise], quiet[retention]), **given)


_GAINS: tuple[GainOutputs, ...] = (
    _WDomain(("stiffness", "damping")),
    _Kalata(("stiffness",)),
    _Direct(("alpha", "beta")),
    _Direct(("alpha", "beta", "gamma")),
)
_ALL: tuple[ConvertedOutputs, ...] = (*_GAINS, _Covariance(("noise", "retention")))

#: Words for the scheduler setting ``gains``.
GAIN_SETTINGS = tuple(dict.fromkeys(outputs.setting for outputs in _ALL))


def find_gain_outputs(output_names: Collection[str]) -> GainOutputs | None:
    """Outputs of a rule base that are gains; None if they are not gains."""
    return next((found for found in _GAINS if set(found.names) == set(output_names)), None)


def find_converted_outputs(output_names: Collection[str], setting: str) -> ConvertedOutputs | None:
    """Outputs of a rule base for a word of the setting ``gains``; None if they are others."""
    fitting = (found for found in _ALL if found.setting == setting)
    return next((found for found in fitting if set(found.names) == set(output_names)), None)


def numbers_of(setting: str | None = None) -> dict[str, str]:
    """Numbers that a word of the setting ``gains`` takes, or that all take, and what each is."""
    found = [outputs for outputs in _ALL if setting in (None, outputs.setting)]
    return {name: text for outputs in found for name, text in outputs.numbers.items()}


def choices(setting: str | None = None) -> str:
    """Outputs that a word of the setting ``gains`` needs, or that are gains, for messages."""
    fitting = _GAINS if setting is None else [found for found in _ALL if found.setting == setting]
    return " or ".join(", ".join(found.names) for found in fitting)


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
