"""Scheduler settings of a rule base: their keys and words, and how they are read.

The fuzzy engine does not interpret the settings; it keeps each word with its place in the file.
"""

from __future__ import annotations

import inspect
import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzytrack.errors import Location, RuleBaseError
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.gains.period import poles_in_time
from fuzzytrack.normalizations import Normalization, normalizations
from fuzzytrack.numerals import is_number
from fuzzytrack.schedulers.gain_outputs import (
    GAIN_SETTINGS,
    ConvertedOutputs,
    GainOutputs,
    choices,
    find_converted_outputs,
    numbers_of,
)
from fuzzytrack.yamltree import suggestion

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
    outputs : ConvertedOutputs
        Makes gains of its outputs.
    numbers : dict of str to float
        Numbers that this conversion takes.
    opens : bool
        Whether a new track has the gains of a growing memory first.
    period : float or None
        Sampling time to which the gains of the rules belong (s); None if they are used at any.
    """

    normalization: Normalization
    outputs: ConvertedOutputs
    numbers: dict[str, float]
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
    gains = settings.get("gains")
    if gains is not None and gains not in GAIN_SETTINGS:
        raise _unknown("gains", gains, GAIN_SETTINGS)
    own = numbers_of(gains)
    words = {key: word for key, word in settings.items() if key not in KEYS}
    normalization = _normalization(
        settings["normalization"], {k: w for k, w in words.items() if k not in own}, tuple(own)
    )
    if gains is None:
        raise _missing(rules, "gains")
    numbers = _numbers(f"gains {str(gains)!r}", {k: w for k, w in words.items() if k in own})
    _enough_signals(rules, normalization, settings["normalization"])
    outputs = _outputs(rules, gains)
    opening = settings.get("opening")
    if opening is not None and opening not in OPENINGS:
        raise _unknown("opening", opening, OPENINGS)
    period = _period(rules, outputs, settings.get("period"))
    _go_together(settings, normalization, outputs)
    _check_numbers(rules, outputs, numbers, words)
    return SchedulerSettings(normalization, outputs, numbers, opening is not None, period)


def _check_numbers(
    rules: RuleBase, outputs: ConvertedOutputs, numbers: dict[str, float], words: dict[str, str]
) -> None:
    """Raise RuleBaseError if the conversion does not take its numbers."""
    try:
        outputs.converter(rules.output_names, (1.0,) * len(rules.outputs), **numbers)
    except ValueError as error:
        named = {key: words[key] for key in numbers}
        raise RuleBaseError(str(error), _place_of(named, error)) from error


def _go_together(
    settings: dict[str, str], normalization: Normalization, outputs: ConvertedOutputs
) -> None:
    """Raise RuleBaseError for settings of which each is right, but not beside the others."""
    name, gains = settings["normalization"], settings["gains"]
    if normalization.uses_expectation and not outputs.has_covariance:
        raise RuleBaseError(
            f"normalization {str(name)!r} needs gains: covariance, got {str(gains)!r}",
            _location(gains),
        )
    if not outputs.has_covariance:
        return
    if normalization.variance_start is not None:
        raise RuleBaseError(
            f"normalization {str(name)!r} has a covariance of its own; beside gains: "
            f"{gains} use another one, such as surprise",
            _location(name),
        )
    if "opening" in settings:
        raise RuleBaseError(
            f"opening: gains {str(gains)!r} open a track themselves; remove it",
            _location(settings["opening"]),
        )


def check_period(
    rules: RuleBase, outputs: ConvertedOutputs, period: float, place: Location | None = None
) -> None:
    """Raise RuleBaseError unless the gains of a rule base can belong to a sampling time.

    Parameters
    ----------
    rules : RuleBase
    outputs : ConvertedOutputs
        Conversion of its outputs to gains.
    period : float
        Sampling time (s).
    place : Location, optional
        Where it stands in the file.
    """
    if not 0 < period < math.inf:
        raise RuleBaseError(f"period must be positive and finite (s), got {period:g}", place)
    if not isinstance(outputs, GainOutputs):
        raise RuleBaseError(
            f"period: the gains of {rules.name} belong to no sampling time, since its covariance "
            "follows the time; remove it",
            place,
        )
    if "gamma" in outputs.gain_names:
        raise RuleBaseError(
            f"period: {rules.name} gives gamma; only alpha and beta can be converted to another "
            "sampling time at every plot",
            place,
        )
    # Real poles become negative where the outputs are large: so at their largest, if anywhere.
    highest = {name: np.array(rules.output(name).universe.high) for name in outputs.names}
    try:
        poles_in_time(**outputs.gains(highest))
    except ValueError as error:
        limits = ", ".join(f"{name}={float(value):g}" for name, value in highest.items())
        raise RuleBaseError(
            f"period: at {limits}, the largest values of the outputs, {error}", place
        ) from error


def scheduler_schema() -> dict[str, Any]:
    """JSON Schema of the settings, for `fuzzytrack.fuzzy.schema.rulebase_schema`."""
    words = {
        key: {"description": text, "type": "string", "minLength": 1}
        for key, text in _DESCRIPTIONS.items()
    }
    words_and_period = words | {
        "period": {"description": _PERIOD, "type": "number", "exclusiveMinimum": 0}
    }
    described = {**_numbers_of_normalizations(), **numbers_of()}
    numbers = {
        key: {"description": text, "type": "number"} for key, text in sorted(described.items())
    }
    return {
        "description": "How a gain scheduler uses the rule base.",
        "type": "object",
        "properties": words_and_period | numbers,
        "required": [],
        "additionalProperties": {
            "description": "A number that the normalization takes, by its name.",
            "type": "number",
        },
        "minProperties": 1,
        "if": {"not": {"required": ["normalization"]}},
        "then": {"propertyNames": {"enum": list(KEYS)}},
    }


def _numbers_of_normalizations() -> dict[str, str]:
    """Numbers that normalizations of the package take, and what each is."""
    return {
        key: text
        for name in normalizations.built_in()
        for key, text in normalizations.get(name).numbers.items()
    }


def _location(word: str) -> Location | None:
    return getattr(word, "location", None)


def _place_of(words: dict[str, str], error: ValueError) -> Location | None:
    """Place of the first of some settings that a message names."""
    # As a whole word: one name may be part of another.
    named = re.findall(r"[\w-]+", str(error))
    return next((_location(word) for key, word in words.items() if key in named), None)


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


def _normalization(name: str, words: dict[str, str], others: tuple[str, ...]) -> Normalization:
    """Make the normalization with the numbers that stand beside its name."""
    if name not in normalizations.names():
        raise _unknown("normalization", name, normalizations.names())
    factory = normalizations.get(name)
    parameters = inspect.signature(factory).parameters
    for key in words:
        if key not in parameters:
            raise RuleBaseError(
                f"unknown scheduler setting {str(key)!r} for normalization {str(name)!r}"
                f"{suggestion(key, (*KEYS, *parameters, *others))}",
                _location(key),
            )
    numbers = _numbers(f"normalization {str(name)!r}", words)
    missing = [key for key, p in parameters.items() if p.default is p.empty and key not in numbers]
    if missing:
        raise RuleBaseError(
            f"normalization {str(name)!r} needs the scheduler settings {', '.join(missing)}",
            _location(name),
        )
    try:
        made: Normalization = factory(**numbers)
    except ValueError as error:
        raise RuleBaseError(str(error), _place_of(words, error) or _location(name)) from error
    return made


def _period(rules: RuleBase, outputs: ConvertedOutputs, word: str | None) -> float | None:
    if word is None:
        return None
    if not is_number(word):
        raise RuleBaseError(
            f"period must be a number of seconds, got {str(word)!r}", _location(word)
        )
    period = float(word)
    check_period(rules, outputs, period, _location(word))
    return period


def _numbers(owner: str, words: dict[str, str]) -> dict[str, float]:
    for key, word in words.items():
        if not is_number(word):
            raise RuleBaseError(
                f"{key} of {owner} must be a number, got {str(word)!r}", _location(word)
            )
    return {str(key): float(word) for key, word in words.items()}


def _enough_signals(rules: RuleBase, normalization: Normalization, name: str) -> None:
    signals = normalization.signals
    if len(rules.inputs) > len(signals):
        raise RuleBaseError(
            f"normalization {str(name)!r} gives {len(signals)} signals ({', '.join(signals)}); "
            f"{rules.name} has {len(rules.inputs)} inputs",
            _location(name),
        )


def _outputs(rules: RuleBase, gains: str) -> ConvertedOutputs:
    outputs = find_converted_outputs(rules.output_names, gains)
    if outputs is None:
        raise RuleBaseError(
            f"gains {str(gains)!r} need outputs {choices(gains)}; {rules.name} has "
            f"{', '.join(rules.output_names)}",
            _location(gains),
        )
    return outputs
