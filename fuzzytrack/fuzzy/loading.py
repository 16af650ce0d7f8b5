"""Rule bases from files and texts."""

from __future__ import annotations

import os
from pathlib import Path

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.reader import Reader
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.yamltree import MAX_BYTES, Document, quoted, suggestion

__all__ = ["load_rulebase", "loads_rulebase", "rulebase_path", "shipped_rulebases"]

SCHEMA_FILE = "rulebase.schema.json"


def loads_rulebase(text: str | bytes, file: str = "<text>") -> RuleBase:
    """Read a rule base from YAML text.

    Parameters
    ----------
    text : str or bytes
        At most 128 KiB; bytes are UTF-8.
    file : str
        Name for messages.

    Returns
    -------
    RuleBase

    Raises
    ------
    RuleBaseError
        If the text is not a complete and consistent rule base; names file, line, column, the
        offending word and the allowed words.

    Examples
    --------
    >>> from fuzzytrack.fuzzy.saving import dumps_rulebase
    >>> rules = load_rulebase("tipper")
    >>> loads_rulebase(dumps_rulebase(rules)) == rules
    True
    """
    document = Document(text, file)
    return Reader(document).rulebase()


def load_rulebase(name_or_path: str | os.PathLike[str]) -> RuleBase:
    """Read a shipped rule base, or a file.

    Parameters
    ----------
    name_or_path : str or path
        A name out of `shipped_rulebases`, or a path: anything that ends in ``.yaml`` or ``.yml``,
        holds a separator or is a path object.

    Returns
    -------
    RuleBase

    Raises
    ------
    RuleBaseError
        If there is no such name, or the file cannot be read, or is no rule base.
    """
    path = rulebase_path(name_or_path)
    try:
        with open(path, "rb") as stream:
            # One byte more than allowed is enough to refuse the rest.
            text = stream.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) else str(error)
        raise RuleBaseError(f"cannot read rule base {quoted(str(path))}: {why}") from error
    return loads_rulebase(text, str(path))


def shipped_rulebases() -> tuple[str, ...]:
    """Names of the rule bases that come with fuzzytrack, in alphabetical order."""
    return tuple(sorted(path.stem for path in _shipped_directory().glob("*.yaml")))


def rulebase_path(name_or_path: str | os.PathLike[str]) -> Path:
    """Path of a shipped rule base by name, or the path that was given.

    Parameters
    ----------
    name_or_path : str or path
        As for `load_rulebase`.

    Returns
    -------
    Path
        The file need not exist if a path was given.

    Raises
    ------
    RuleBaseError
        If it is the name of no shipped rule base.
    """
    if not isinstance(name_or_path, str) or _is_path(name_or_path):
        return Path(name_or_path)
    names = shipped_rulebases()
    if name_or_path not in names:
        raise RuleBaseError(
            f"unknown rule base {quoted(name_or_path)}{suggestion(name_or_path, names)}; "
            "or a path that ends in .yaml"
        )
    return _shipped_directory() / f"{name_or_path}.yaml"


def _is_path(text: str) -> bool:
    separators = {"/", os.sep}
    return text.endswith((".yaml", ".yml")) or any(s in text for s in separators)


def _shipped_directory() -> Path:
    package = Path(__file__).resolve().parent.parent
    # Inside an installed package, or beside it in a source checkout.
    for directory in (package / "rulebases", package.parent / "rulebases"):
        if (directory / SCHEMA_FILE).is_file():
            return directory
    raise RuleBaseError(f"the shipped rule bases are missing; they belong in {package}")
