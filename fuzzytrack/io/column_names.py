"""Names of columns as people write them: in any case, with a unit or without."""

from __future__ import annotations

import re

__all__ = ["is_unit", "meters_of", "plain_name", "unit_of"]

# Units, each followed by its other spellings, in lower case.
_SPELLINGS = {
    "s": ("sec", "secs", "second", "seconds"),
    "ms": ("msec", "millis", "millisecond", "milliseconds"),
    "us": ("usec", "micros", "microsecond", "microseconds", "µs", "μs"),
    "ns": ("nsec", "nanos", "nanosecond", "nanoseconds"),
    "min": ("minute", "minutes"),
    "h": ("hr", "hour", "hours"),
    "m": ("meter", "meters", "metre", "metres"),
    "mm": ("millimeter", "millimeters", "millimetre", "millimetres"),
    "cm": ("centimeter", "centimeters", "centimetre", "centimetres"),
    "km": ("kilometer", "kilometers", "kilometre", "kilometres"),
    "ft": ("foot", "feet"),
    "yd": ("yard", "yards"),
    "nmi": ("nm", "nautical miles"),
    "deg": ("degree", "degrees", "°", "º"),
    "rad": ("radian", "radians"),
    "m/s": ("mps", "m/sec", "ms-1", "m s-1", "m*s-1", "m_s"),
    "km/h": ("kmh", "kph"),
    "kn": ("kt", "kts", "knot", "knots"),
    "m/s2": ("m/s^2", "m/s²", "ms-2", "m s-2"),
    "px": ("pixel", "pixels"),
}
# Meters of a unit of length.
_METERS = {"mm": 1e-3, "cm": 1e-2, "km": 1e3, "ft": 0.3048, "yd": 0.9144, "nmi": 1852.0}
_UNITS = {word: unit for unit, words in _SPELLINGS.items() for word in (unit, *words)}

# "x [m]", "x (m)", "x {m}", "x <m>"; "x/m" and "x, m"; "x_m".
_IN_BRACKETS = re.compile(
    r"(.*?)\s*(?:\[([^\[\]]*)\]|\(([^()]*)\)|\{([^{}]*)\}|<([^<>]*)>)\s*", re.S
)
_AFTER_A_MARK = re.compile(r"(.*?[^\s/,])\s*[/,]\s*(\S+)\s*", re.S)
_SUFFIX = re.compile(r"(.*?[a-z0-9])_(m_s|[a-z]+)")


def plain_name(name: str) -> tuple[str, str]:
    """Name of a column in lower case, and its unit.

    Parameters
    ----------
    name : str
        Such as ``X [m]``, ``Time (s)``, ``range/km`` or ``t_ms``.

    Returns
    -------
    name : str
        Such as ``x``, ``time``, ``range`` and ``t``: blanks, hyphens and dots are underscores.
    unit : str
        Such as ``m``, ``s``, ``km`` and ``ms``, whatever the spelling (`unit_of`); empty if the
        name has none. After an underscore only units that are known count.
    """
    if found := _IN_BRACKETS.fullmatch(name):
        plain, *units = found.groups()
        unit = next(filter(None, units), "")
        if plain.strip():
            return _joined(plain), unit_of(unit)
    if (found := _AFTER_A_MARK.fullmatch(name)) and found[2].lower() in _UNITS:
        return _joined(found[1]), unit_of(found[2])
    plain = _joined(name)
    if (found := _SUFFIX.fullmatch(plain)) and found[2] in _UNITS:
        return found[1], unit_of(found[2])
    return plain, ""


def unit_of(text: str) -> str:
    """A unit in the spelling s, ms, us, ns, min, h, m, km, ft, nmi, deg, rad, m/s, kn and so on.

    Parameters
    ----------
    text : str
        Such as ``[sec]``, ``Degrees`` or ``µs``, with brackets or without.

    Returns
    -------
    str
        As it is, without brackets, where it is none that is known.
    """
    text = text.strip()
    if len(text) > 1 and text[0] + text[-1] in ("[]", "()", "{}", "<>"):
        text = text[1:-1].strip()
    return _UNITS.get(text.lower(), text)


def meters_of(unit: str) -> float:
    """Meters of a unit of length, as `unit_of` spells it; 1 for any other word."""
    return _METERS.get(unit, 1.0)


def is_unit(cell: str) -> bool:
    """Whether a cell is a unit that is known, or any text in brackets."""
    text = cell.strip()
    in_brackets = len(text) > 2 and text[0] + text[-1] in ("[]", "()", "{}", "<>")
    return (in_brackets or text.lower() in _UNITS) and not text.isdigit()


def _joined(name: str) -> str:
    return re.sub(r"[\s\-.]+", "_", name.strip()).lower()
