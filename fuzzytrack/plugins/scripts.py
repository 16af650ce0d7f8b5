"""Plug-ins in a script: a Python file that is run for the classes that it registers.

A script that is loaded here is also loaded in the processes and on the computers that share a job,
which get its text: they need the classes to read the trackers that are sent to them.
"""

from __future__ import annotations

import hashlib
import os
import sys
import traceback
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType

from fuzzytrack.errors import Location, PluginError

__all__ = ["Script", "load_script", "load_scripts", "loaded_scripts", "place_in_script"]


@dataclass(frozen=True)
class Script:
    """A Python file that registers plug-ins.

    Attributes
    ----------
    path : str
        Where it lies, without links; the file need not exist where the script is loaded.
    text : bytes
        Its text.
    """

    path: str
    text: bytes = field(repr=False)

    @property
    def module(self) -> str:
        """Name of the module that it becomes: the same wherever it is loaded."""
        place = hashlib.sha256(self.path.encode(errors="surrogateescape")).hexdigest()[:8]
        return f"fuzzytrack_plugin_{Path(self.path).stem}_{place}"


_loaded: dict[str, Script] = {}


def load_script(path: str | os.PathLike[str]) -> None:
    """Run a Python file that registers plug-ins by their decorators.

    Parameters
    ----------
    path : str or path
        The file. It stands alone: modules beside it are not found. Loaded again, it is not run
        unless it has changed; then its classes take the place of the earlier ones.

    Raises
    ------
    PluginError
        If it raises anything, or is no Python; names file and line.
    OSError
        If it cannot be read.
    """
    place = Path(path).resolve()
    load_scripts([Script(str(place), place.read_bytes())])


def load_scripts(scripts: Iterable[Script]) -> None:
    """Run scripts that were read before, maybe on another computer.

    Parameters
    ----------
    scripts : iterable of Script

    Raises
    ------
    PluginError
        As `load_script`.
    """
    for script in scripts:
        if _loaded.get(script.module) != script:
            _loaded.pop(script.module, None)
            _run(script)
            _loaded[script.module] = script


def loaded_scripts() -> tuple[Script, ...]:
    """Scripts that were loaded in this process."""
    return tuple(_loaded.values())


def place_in_script(error: BaseException) -> Location | None:
    """Place in a loaded script from which an error comes; None if it comes from elsewhere."""
    return _last_place([script.path for script in _loaded.values()], error)


def _run(script: Script) -> None:
    module = ModuleType(script.module)
    module.__file__ = script.path
    # Dataclasses and pickle find a class through its module.
    sys.modules[script.module] = module
    try:
        exec(compile(script.text, script.path, "exec", dont_inherit=True), module.__dict__)
    except KeyboardInterrupt:
        raise
    # sys.exit included: a script may do anything, and the message must name the place.
    except BaseException as error:
        del sys.modules[script.module]
        message = f"{type(error).__name__}: {getattr(error, 'msg', None) or error}"
        raise PluginError(message, _place(script.path, error)) from error


def _place(path: str, error: BaseException) -> Location:
    """Place in a script where an error comes from."""
    if isinstance(error, SyntaxError) and error.filename == path:
        return Location(path, error.lineno or 1, error.offset or 1)
    return _last_place([path], error) or Location(path, 1, 1)


def _last_place(paths: Collection[str], error: BaseException) -> Location | None:
    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename in paths]
    if not frames:
        return None
    last = frames[-1]
    return Location(last.filename, last.lineno or 1, (last.colno or 0) + 1)
