"""Trackers that a text names, with numbers of the text free: ``kalman-cv:sigma_v=...``."""

from __future__ import annotations

import inspect
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from fuzzytrack import specs
from fuzzytrack.gains import kalata
from fuzzytrack.numerals import is_number
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import make_tracker, tracker_parameters
from fuzzytrack.tuning.candidates import Candidates, Choice, chosen
from fuzzytrack.tuning.parameters import Numbers, Parameter, Space

__all__ = ["KALATA", "FreeNumber", "Specification", "specification", "specification_families"]

#: The family of fixed gains on Kalata's curve, by their tracking index.
KALATA = "kalata"
_INDEX = "tracking_index"


@dataclass(frozen=True)
class FreeNumber:
    """How a number of a tracker is searched.

    Attributes
    ----------
    start, low, high : float
        In units of σ/T² if it is an acceleration.
    scale : str
        See `fuzzytrack.tuning.parameters.Parameter`.
    acceleration : bool
        Whether it is an acceleration (m/s²).
    """

    start: float
    low: float
    high: float
    scale: str = "log"
    acceleration: bool = False

    def parameter(self, name: str, given: float | None, unit: float) -> Parameter:
        """The parameter; it begins at the number that a user gave, if any.

        Parameters
        ----------
        name : str
        given : float or None
        unit : float
            σ/T² of the plots (m/s²).
        """
        factor = unit if self.acceleration else 1.0
        start = factor * self.start if given is None else given
        low, high = factor * self.low, factor * self.high
        return Parameter(name, start, min(low, start), max(high, start), self.scale)


def _acceleration(start: float) -> FreeNumber:
    return FreeNumber(start, 1e-4, 1e3, acceleration=True)


_GAIN = FreeNumber(0.5, 0.01, 1.0, "probability")
_STAY = FreeNumber(0.95, 0.3, 0.9999, "probability")

#: Numbers that are free unless a user says which, for each family; None for those that begin at
#: their default and are searched by factors.
_FREE: dict[str, dict[str, FreeNumber | None]] = {
    "fixed": {"alpha": _GAIN, "beta": FreeNumber(0.3, 1e-3, 2.0)},
    KALATA: {_INDEX: FreeNumber(0.5, 1e-4, 1e3)},
    "fading-memory": {"xi": FreeNumber(0.6, 0.01, 0.99, "probability")},
    "benedict-bordner": {"alpha": _GAIN},
    "kalman-cv": {"sigma_v": _acceleration(0.5)},
    "kalman-ca": {"sigma_v": _acceleration(0.2), "acceleration_sigma": _acceleration(0.5)},
    "track-quality": {"cap": FreeNumber(5.0, 1.0, 50.0)},
    "bank": {
        "lowest": FreeNumber(0.2, 0.02, 0.9, "probability"),
        "forget": FreeNumber(0.9, 0.3, 0.999, "probability"),
    },
    "imm": {
        "quiet_sigma": _acceleration(0.05),
        "maneuver_sigma": _acceleration(0.5),
        "quiet_stay": _STAY,
        "maneuver_stay": FreeNumber(0.9, 0.3, 0.9999, "probability"),
    },
    "imm-two": dict.fromkeys(
        ("straight_noise", "maneuver_noise", "retention", "begin_rate", "end_rate", "gap")
    ),
    "imm-three": dict.fromkeys(
        (
            *("straight_noise", "moderate_noise", "strong_noise"),
            *("moderate_retention", "strong_retention"),
            *("moderate_rate", "strong_rate", "weaken_rate", "end_rate", "gap"),
        )
    ),
}
# Numbers that are searched in a way of their own where a user names them.
_NAMED = {"level": _acceleration(3.0)}


def specification_families() -> tuple[str, ...]:
    """Families whose numbers are free without being named."""
    return tuple(_FREE)


@dataclass(frozen=True)
class Specification(Candidates):
    """Trackers that a text names; some of its numbers are free.

    Attributes
    ----------
    name : str
        Name of the tracker or scheduler, or `KALATA`.
    options : tuple of (str, str)
        Parameters that are not free.
    """

    name: str
    options: tuple[tuple[str, str], ...] = ()

    def text(self, numbers: Numbers) -> str:
        """See `Candidates.text`."""
        free = {p.name: n for p, n in zip(self.space.parameters, numbers, strict=True)}
        name = self.name
        if name == KALATA:
            alpha, beta = kalata(free.pop(_INDEX))
            name, free = "fixed", {"alpha": float(alpha), "beta": float(beta)}
        written = {**dict(self.options), **{key: repr(float(n)) for key, n in free.items()}}
        return name + "".join(f":{key}={value}" for key, value in written.items())

    def tracker(self, numbers: Numbers) -> Tracker:
        """See `Candidates.tracker`."""
        return make_tracker(self.text(numbers))

    def restricted(self, kept: Sequence[int]) -> Specification:
        """See `Candidates.restricted`."""
        rest = (p for k, p in enumerate(self.space.parameters) if k not in kept)
        options = (*self.options, *((p.name, repr(p.start)) for p in rest))
        return replace(self, space=self.space.restricted(kept), options=options)


def specification(text: str, free: Collection[str] | None, unit: float) -> Specification:
    """Trackers that a text names, some of its numbers free.

    Parameters
    ----------
    text : str
        As `fuzzytrack.trackers.catalog.make_tracker` reads it, or ``kalata``. A number that it
        gives is where the search begins.
    free : collection of str or None
        Parameters that are free; those of the family unless given.
    unit : float
        σ/T² of the plots (m/s²), for accelerations.

    Raises
    ------
    ValueError
        If there is no such tracker or number, or nothing is free; lists what is allowed.
    """
    name, options = specs.split(text, "tracker")
    known, factory = _FREE.get(name, {}), _parameters(name)
    specs.check_options(options, factory)
    choices = []
    for key, parameter in factory.items():
        given, default = options.get(key, ""), parameter.default
        number = known.get(key) or _NAMED.get(key)
        if number is None:
            start = float(given) if is_number(given) else default
            if isinstance(start, bool) or not isinstance(start, int | float) or not start > 0:
                continue
            number = FreeNumber(float(start), start / 30, start * 30)
        value = float(given) if is_number(given) else None
        choices.append(Choice(number.parameter(key, value, unit)))
    wanted = free if free is not None else [key for key in known if key in factory]
    picked = chosen(choices, wanted, f"tracker {name!r}")
    space = Space(tuple(choices[k].parameter for k in picked))
    names = {p.name for p in space.parameters}
    fixed = tuple((key, value) for key, value in options.items() if key not in names)
    return Specification(text, space, name, fixed)


def _parameters(name: str) -> Mapping[str, inspect.Parameter]:
    if name == KALATA:
        return {_INDEX: inspect.Parameter(_INDEX, inspect.Parameter.KEYWORD_ONLY)}
    try:
        return tracker_parameters(name)
    except ValueError as error:
        raise ValueError(f"tracker {name!r}: {error}") from None
