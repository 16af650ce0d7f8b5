"""Scheduler settings of a rule base: their keys and words, and how they are read.

The fuzzy engine does not interpret the settings; it keeps each word with its place in the file.
"""

from __future__ import annotations

import inspect
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzytrack.errors import Location, RuleBaseError
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.gains.period import poles_in_time
from fuzzytrack.normalizations import Normalization, normalizations
from fuzzytrack.schedulers.gain_outputs import (
    GAIN_SETTINGS,
    GainOutputs,
    choices,
    find_gain_outputs,
)
from fuzzytrack.yamltree import is_number, suggestion

__all__ = [
    "KEYS",
    "OPENINGS",
    "SchedulerSettings",
    "check_period",
    "read_settings",
    "scheduler_schema",
]

KEYS = ("normalization", "gains", "opening", "period")
OPENINGS = ("growing-memory",)

_DESCRIPTIONS = {
    "normalization": "How innovations become the inputs, e.g. chan.",
    "gains": f"What the outputs are: {', '.join(GAIN_SETTINGS[:-1])} or {GAIN_SETTINGS[-1]}.",
    "opening": f"Gains of a new track: {OPENINGS[0]}. Without it, those of the rules.",
}
_PERIOD = "Sampling time to which the gains belong (s). Without it they are used at any time step."


@dataclass(frozen=True)
class SchedulerSettings:
    """How a rule base schedules gains.

    Attributes
    ----------
    normalization : Normalization
        Makes the inputs of the rule base.
    outputs : GainOutputs
        Makes gains of its outputs.
    opens : bool
        Whether a new track has the gains of a growing memory first.
    period : float or None
        Sampling time to which the gains of the rules belong (s); None if they are used at any.
    """

    normalization: Normalization
    outputs: GainOutputs
    opens: bool
    period: float | None


def read_settings(rules: RuleBase) -> SchedulerSettings:
    """Read the scheduler settings of a rule base.

    Raises
    ------
    RuleBaseError
        If a key is unknown or missing, a word is unknown, a number does not fit, or the settings do
        not fit the inputs and outputs; names the place in the file where there is one.
    """
    settings = dict(rules.scheduler)
    if "normalization" not in settings:
        _only_known_keys(settings)
        raise _missing(rules, "normalization")
    normalization = _normalization(settings)
    if "gains" not in settings:
        raise _missing(rules, "gains")
    _enough_signals(rules, normalization, settings["normalization"])
    outputs = _outputs(rules, settings["gains"])
    opening = settings.get("opening")
    if opening is not None and opening not in OPENINGS:
        raise _unknown("opening", opening, OPENINGS)
    period = _period(rules, outputs, settings.get("period"))
    return SchedulerSettings(normalization, outputs, opening is not None, period)


def check_period(
    rules: RuleBase, outputs: GainOutputs, period: float, place: Location | None = None
) -> None:
    """Raise RuleBaseError unless the gains of a rule base can belong to a sampling time.

    Parameters
    ----------
    rules : RuleBase
    outputs : GainOutputs
        Conversion of its outputs to gains.
    period : float
        Sampling time (s).
    place : Location, optional
        Where it stands in the file.
    """
    if not 0 < period < math.inf:
        raise RuleBaseError(f"period must be positive and finite (s), got {period:g}", place)
    if "gamma" in outputs.gain_names:
        raise RuleBaseError(
            f"period: {rules.name} gives gamma; only alpha and beta can be converted to another "
            "sampling time at every plot",
            place,
        )
    # Real poles become negative where the outputs are large: so at their largest, if anywhere.
    highest = {name: np.array(_highest(rules.output(name))) for name in outputs.names}
    try:
        poles_in_time(**outputs.gains(highest))
    except ValueError as error:
        limits = ", ".join(f"{name}={float(value):g}" for name, value in highest.items())
        raise RuleBaseError(
            f"period: at {limits}, the largest values of the outputs, {error}", place
        ) from error


def _highest(output: Variable) -> float:
    """Largest value of an output: the upper limit of its universe, or its default."""
    high = output.universe.high
    return high if output.default is None else max(high, output.default)


def scheduler_schema() -> dict[str, Any]:
    """JSON Schema of the settings, for `fuzzytrack.fuzzy.schema.rulebase_schema`."""
    return {
        "description": "How a gain scheduler uses the rule base.",
        "type": "object",
        "properties": {
            key: {"description": text, "type": "string", "minLength": 1}
            for key, text in _DESCRIPTIONS.items()
        }
        | {"period": {"description": _PERIOD, "type": "number", "exclusiveMinimum": 0}},
        "required": [],
        "additionalProperties": {
            "description": "A number that the normalization takes, by its name.",
            "type": "number",
        },
        "minProperties": 1,
        "if": {"not": {"required": ["normalization"]}},
        "then": {"propertyNames": {"enum": list(KEYS)}},
    }


def _location(word: str) -> Location | None:
    return getattr(word, "location", None)


def _missing(rules: RuleBase, key: str) -> RuleBaseError:
    places = [_location(word) for word, _ in rules.scheduler]
    return RuleBaseError(
        f"{rules.name} cannot schedule gains: no scheduler setting {key!r}; it needs "
        "scheduler: {normalization: chan, gains: w-domain} or the like",
        places[0] if places else None,
    )


def _unknown(key: str, word: str, allowed: tuple[str, ...]) -> RuleBaseError:
    return RuleBaseError(
        f"unknown {key} {str(word)!r}; one of {', '.join(allowed)}", _location(word)
    )


def _only_known_keys(settings: dict[str, str]) -> None:
    for key in settings:
        if key not in KEYS:
            raise RuleBaseError(
                f"unknown scheduler setting {str(key)!r}{suggestion(key, KEYS)}; beside a "
                "normalization also the numbers that it takes",
                _location(key),
            )


def _normalization(settings: dict[str, str]) -> Normalization:
    """Make the normalization with the numbers that stand beside its name."""
    name = settings["normalization"]
    if name not in normalizations.names():
        raise _unknown("normalization", name, normalizations.names())
    factory = normalizations.get(name)
    parameters = inspect.signature(factory).parameters
    numbers = {}
    for key, word in settings.items():
        if key in KEYS:
            continue
        if key not in parameters:
            raise RuleBaseError(
                f"unknown scheduler setting {str(key)!r} for normalization {str(name)!r}"
                f"{suggestion(key, (*KEYS, *parameters))}",
                _location(key),
            )
        if not is_number(word):
            raise RuleBaseError(
                f"{key} of normalization {str(name)!r} must be a number, got {str(word)!r}",
                _location(word),
            )
        numbers[str(key)] = float(word)
    missing = [key for key, p in parameters.items() if p.default is p.empty and key not in numbers]
    if missing:
        raise RuleBaseError(
            f"normalization {str(name)!r} needs the scheduler settings {', '.join(missing)}",
            _location(name),
        )
    try:
        made: Normalization = factory(**numbers)
    except ValueError as error:
        places = [_location(settings[key]) for key in numbers if key in str(error)]
        raise RuleBaseError(str(error), places[0] if places else _location(name)) from error
    return made


def _period(rules: RuleBase, outputs: GainOutputs, word: str | None) -> float | None:
    if word is None:
        return None
    if not is_number(word):
        raise RuleBaseError(
            f"period must be a number of seconds, got {str(word)!r}", _location(word)
        )
    period = float(word)
    check_period(rules, outputs, period, _location(word))
    return period


def _enough_signals(rules: RuleBase, normalization: Normalization, name: str) -> None:
    signals = normalization.signals
    if len(rules.inputs) > len(signals):
        raise RuleBaseError(
            f"normalization {str(name)!r} gives {len(signals)} signals ({', '.join(signals)}); "
            f"{rules.name} has {len(rules.inputs)} inputs",
            _location(name),
        )


def _outputs(rules: RuleBase, gains: str) -> GainOutputs:
    if gains not in GAIN_SETTINGS:
        raise _unknown("gains", gains, GAIN_SETTINGS)
    outputs = find_gain_outputs(rules.output_names)
    if outputs is None or outputs.setting != gains:
        raise RuleBaseError(
            f"gains {str(gains)!r} need outputs {choices(gains)}; {rules.name} has "
            f"{', '.join(rules.output_names)}",
            _location(gains),
        )
    return outputs
