"""Readers of files of plots, by name or by suffix: those of this package, and plug-ins."""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import ClassVar

from fuzzytrack import specs
from fuzzytrack.errors import PluginWarning
from fuzzytrack.io.source import Source
from fuzzytrack.io.text_form import PLAIN, TextForm
from fuzzytrack.plugins import Registry
from fuzzytrack.yamltree import suggestion

__all__ = ["Reader", "make_reader", "reader_of", "readers"]


class Reader(ABC):
    """Reads files of plots in one format.

    A subclass is registered under the name of its format. Its parameters, if it has any, are what
    a user can write after that name: ``asterix:category=62``.

    Attributes
    ----------
    suffixes : tuple of str
        Ends of the names of files in this format, in lower case: ``(".gpx",)``.
    form : TextForm
        How text is written, as far as the user says so; for readers of text.
    """

    suffixes: ClassVar[tuple[str, ...]] = ()
    form: TextForm = PLAIN

    def reads(self, file: str) -> bool:
        """Whether a file is in this format, as far as its name says so; it may be compressed."""
        name = file.lower().removesuffix(".gz").removesuffix(".zst")
        return name.endswith(self.suffixes)

    def check(self, file: str) -> None:  # noqa: B027
        """Raise a DataError if what the format needs is not installed.

        Parameters
        ----------
        file : str
            Name of the file, for the message.
        """

    @abstractmethod
    def open_source(self, file: str) -> AbstractContextManager[Source]:
        """Open a file that is read; any error in it, now or later, is a DataError."""


#: Readers by the names of their formats.
readers: Registry[Callable[..., Reader]] = Registry("reader", "fuzzytrack.readers", Reader)


def make_reader(format: str) -> Reader:
    """Make a reader of what a user wrote.

    Parameters
    ----------
    format : str
        Name of a format, and parameters of its reader after it, each as ``:name=value``.

    Raises
    ------
    ValueError
        If there is no such format or parameter, or a value does not fit; lists what is allowed.
    """
    name, options = specs.split(format, "format")
    if name not in readers.names():
        raise ValueError(f"format: unknown {name!r}{suggestion(name, readers.names())}")
    factory = readers.get(name)
    try:
        specs.check_options(options, specs.parameters_of(factory))
        made = specs.call_with(factory, options, {})
    except (TypeError, ValueError) as error:
        raise ValueError(f"format {format!r}: {error}") from error
    if not isinstance(made, Reader):
        raise ValueError(f"format {format!r}: its plug-in makes no Reader, got {made!r}")
    return made


def reader_of(file: str) -> Reader | None:
    """Reader whose format the name of a file says; None if no reader knows it.

    Readers of this package go first; plug-ins are loaded only for files that none of those reads.
    """
    for name in readers.built_in():
        reader: Reader = readers.get(name)()
        if reader.reads(file):
            return reader
    for plugin in readers:
        try:
            if not plugin.built_in and (reader := plugin.factory()).reads(file):
                return reader
        except Exception as error:
            warnings.warn(
                f"reader {plugin.name!r} of package {plugin.package} cannot be used: {error!r}; "
                "it is skipped",
                PluginWarning,
                stacklevel=3,
            )
    return None
