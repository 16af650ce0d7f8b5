"""How a recording is read: all that a user can say about it, as one value."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from fuzzytrack.io.cleaning_rules import Cleaning
from fuzzytrack.io.description import PlotDescription
from fuzzytrack.io.text_form import TextForm

__all__ = ["Reading", "option_names"]


@dataclass(frozen=True, kw_only=True)
class Reading:
    """How a recording is read.

    Attributes
    ----------
    description : PlotDescription
        What its columns mean.
    cleaning : Cleaning
        What becomes of faults of its plots.
    form : TextForm
        How text files are written.
    format : str or None
        Format of the files; None goes by their names.
    sort : bool
        Whether the plots of each track are put in order of time.
    """

    description: PlotDescription = field(default_factory=PlotDescription)
    cleaning: Cleaning = field(default_factory=Cleaning)
    form: TextForm = field(default_factory=TextForm)
    format: str | None = None
    sort: bool = False

    @classmethod
    def of(cls, **options: Any) -> Reading:
        """Make one of options by their names.

        Parameters
        ----------
        **options
            Attributes of `PlotDescription`, `Cleaning` and `TextForm`, and `format` and `sort`.

        Raises
        ------
        TypeError
            If there is no such option.
        ValueError
            If the value of one is wrong; names it.
        """
        parts: dict[str, Any] = {}
        for name, part in (
            ("description", PlotDescription),
            ("cleaning", Cleaning),
            ("form", TextForm),
        ):
            mine = {key: options.pop(key) for key in _names(part) if key in options}
            parts[name] = part(**mine)
        own = {key: options.pop(key) for key in ("format", "sort") if key in options}
        _check_all_used(options)
        if not isinstance(own.get("format"), str | None):
            raise ValueError(f"format: must be the name of a format, got {own['format']!r}")
        return cls(**parts, **own)


def _names(part: Any) -> tuple[str, ...]:
    return tuple(each.name for each in fields(part))


def option_names() -> tuple[str, ...]:
    """Names of all options of a reading."""
    parts = (PlotDescription, Cleaning, TextForm)
    # The period of a clock is in two of them.
    return (*dict.fromkeys(name for part in parts for name in _names(part)), "format", "sort")


def _check_all_used(options: Mapping[str, Any]) -> None:
    for name in options:
        close = difflib.get_close_matches(name, option_names(), 1)
        more = f"; did you mean {close[0]!r}?" if close else ""
        raise TypeError(f"no option {name!r} of a recording{more}")
