"""Rule bases from files and texts."""

from __future__ import annotations

import os
from pathlib import Path

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.formats.fis_reader import loads_fis
from fuzzytrack.fuzzy.formats.fll_reader import loads_fll
from fuzzytrack.fuzzy.formats.source_text import MAX_BYTES
from fuzzytrack.fuzzy.reader import Reader
from fuzzytrack.fuzzy.rulebase import RuleBase, remember_origin
from fuzzytrack.shipped import Shipped
from fuzzytrack.yamltree import Document, quoted

__all__ = [
    "SCHEMA_FILE",
    "as_rulebase",
    "load_rulebase",
    "loads_rulebase",
    "refuse_other_files",
    "rulebase_path",
    "shipped_rulebases",
]

#: File of the JSON Schema, beside the rule bases that name it.
SCHEMA_FILE = "rulebase.schema.json"

_OTHERS = {".fcl": "IEC 61131-7"}
_READERS = {".fis": loads_fis, ".fll": loads_fll}
_PACKED = (".gz", ".zst", ".zip", ".bz2", ".xz")

_SHIPPED = Shipped("rule base", "rulebases", SCHEMA_FILE, RuleBaseError, ".yaml, .fis or .fll")


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
    return Reader(Document(text, file)).rulebase()


def load_rulebase(name_or_path: str | os.PathLike[str]) -> RuleBase:
    """Read a shipped rule base, or a file.

    Parameters
    ----------
    name_or_path : str or path
        A name out of `shipped_rulebases`, or a path: anything that ends in ``.yaml``, ``.yml``,
        ``.fis`` (MATLAB) or ``.fll`` (fuzzylite), holds a separator or is a path object. The suffix
        says how the file is read.

    Returns
    -------
    RuleBase

    Raises
    ------
    RuleBaseError
        If there is no such name, or the file cannot be read, or is no rule base.
    """
    refuse_other_files(name_or_path)
    suffix = _suffix(name_or_path)
    if suffix in _READERS:
        path = Path(name_or_path)
        rules = _READERS[suffix](_content(path), str(path), path.stem)
    else:
        rules = Reader(_SHIPPED.document(name_or_path)).rulebase()
    return remember_origin(rules, _SHIPPED.spelled(name_or_path))


def _suffix(name_or_path: str | os.PathLike[str]) -> str:
    """Suffix of a name or path in small letters; empty for what is neither."""
    text = os.fspath(name_or_path) if isinstance(name_or_path, str | os.PathLike) else ""
    return Path(str(text)).suffix.lower()


def _content(path: Path) -> bytes:
    """Bytes of a file, one more than may be read at the most."""
    try:
        with open(path, "rb") as stream:
            return stream.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) else str(error)
        raise RuleBaseError(f"cannot read rule base {quoted(str(path))}: {why}") from error


def refuse_other_files(name_or_path: str | os.PathLike[str]) -> None:
    """Raise RuleBaseError for files of programs that are not read, and for compressed ones.

    Parameters
    ----------
    name_or_path : str or path
        As for `load_rulebase`.
    """
    suffix = _suffix(name_or_path)
    text = os.fspath(name_or_path) if suffix else ""
    if suffix in _PACKED:
        raise RuleBaseError(f"{text}: is compressed; unpack it, and name the file .yaml")
    program = _OTHERS.get(suffix)
    if program is not None:
        raise RuleBaseError(
            f"{text}: a file of {program}, which is not read; .yaml, .fis (MATLAB) and .fll "
            "(fuzzylite) are"
        )


def as_rulebase(rules: RuleBase | str | os.PathLike[str], name: str = "rules") -> RuleBase:
    """The rule base itself, or the one of a name or path; see `load_rulebase`.

    Every function that takes a rule base takes a name or path as well, by this function.

    Parameters
    ----------
    rules : RuleBase, str or path
    name : str
        Name of the argument, for messages.

    Raises
    ------
    RuleBaseError
        As for `load_rulebase`.
    TypeError
        If it is something else.
    """
    if isinstance(rules, str | os.PathLike):
        return load_rulebase(rules)
    if not isinstance(rules, RuleBase):
        raise TypeError(
            f"{name} must be a RuleBase, the name of a shipped one or the path of a file, "
            f"got {type(rules).__name__}"
        )
    return rules


def shipped_rulebases() -> tuple[str, ...]:
    """Names of the rule bases that come with fuzzytrack, in alphabetical order."""
    return _SHIPPED.names()


def rulebase_path(name_or_path: str | os.PathLike[str]) -> Path:
    """Path of a shipped rule base by name, or the path that was given, of a text in YAML.

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
        If it is the name of no shipped rule base, or of a file of another format, whose text is not
        changed in place.
    """
    refuse_other_files(name_or_path)
    if _suffix(name_or_path) in _READERS:
        text = os.fspath(name_or_path)
        raise RuleBaseError(
            f"{text}: only YAML is edited; first convert it, fuzzytrack rulebase convert {text} "
            f"{Path(str(text)).with_suffix('.yaml')}"
        )
    return _SHIPPED.path(name_or_path)
