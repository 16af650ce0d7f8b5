"""Rule bases as texts in any of the formats, chosen by the suffix of a file."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from fuzzytrack.fuzzy.formats.fis_writer import dumps_fis
from fuzzytrack.fuzzy.formats.fll_writer import dumps_fll
from fuzzytrack.fuzzy.formats.translation import Translation
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.saving import dumps_rulebase

__all__ = ["WRITERS", "translated"]


def _as_yaml(rules: RuleBase) -> Translation:
    return Translation(dumps_rulebase(rules), ())


#: Writers by suffix.
WRITERS: dict[str, Callable[[RuleBase], Translation]] = {
    ".yaml": _as_yaml,
    ".yml": _as_yaml,
    ".fis": dumps_fis,
    ".fll": dumps_fll,
}


def translated(rules: RuleBase, path: str | os.PathLike[str]) -> Translation:
    """A rule base as the text of a file.

    Parameters
    ----------
    rules : RuleBase
    path : str or path
        Its suffix chooses the format: ``.yaml``, ``.yml``, ``.fis`` or ``.fll``. Nothing is
        written.

    Returns
    -------
    Translation
        The text, and where another program computes otherwise from it.

    Raises
    ------
    ValueError
        If the suffix is another.
    RuleBaseError
        If the format cannot have the rule base.

    Examples
    --------
    >>> from fuzzytrack.fuzzy.formats.conversion import translated
    >>> from fuzzytrack.fuzzy.loading import load_rulebase
    >>> translated(load_rulebase("tipper"), "tipper.fis").text.splitlines()[3]
    "Name='tipper'"
    """
    suffix = Path(path).suffix.lower()
    if suffix not in WRITERS:
        raise ValueError(
            f"path: {os.fspath(path)} must end in one of {', '.join(WRITERS)}, by which the format "
            "is chosen"
        )
    return WRITERS[suffix](rules)
