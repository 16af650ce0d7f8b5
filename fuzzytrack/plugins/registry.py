"""Plug-ins of one kind by name: registered in this process, or offered by installed packages."""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import metadata
from importlib.metadata import EntryPoint
from typing import Any, Generic, TypeVar

from fuzzytrack.errors import PluginWarning

__all__ = ["Plugin", "Registry"]

# Colons separate a name from the parameters after it.
_NAME = re.compile(r"[\w.-]+")

T = TypeVar("T", bound=Callable[..., Any])


@dataclass(frozen=True)
class Plugin:
    """A registered factory and where it comes from.

    Attributes
    ----------
    name : str
        Name by which users ask for it.
    factory : callable
        Class, or function that makes an object of it.
    package : str
        Package that it comes from; for a script, its file.
    """

    name: str
    factory: Callable[..., Any]
    package: str

    @property
    def source(self) -> str:
        """Paper or other source, as the factory declares in its attribute ``source``."""
        return str(getattr(self.factory, "source", ""))

    @property
    def built_in(self) -> bool:
        """Whether it is part of fuzzytrack."""
        return self.package == "fuzzytrack"


class Registry(Generic[T]):
    """Plug-ins of one kind, by name.

    The names of installed plug-ins are known without loading any. A plug-in is loaded when it is
    asked for by name, and all of them when they are listed.

    Parameters
    ----------
    kind : str
        What a plug-in is, in words ("scheduler").
    group : str
        Entry-point group searched for plug-ins of installed packages.
    base : type
        Class or protocol of the objects that a plug-in makes.

    Notes
    -----
    A plug-in of a package that has the name of a built-in one is reported by a `PluginWarning` and
    skipped. Of two packages with the same name the first in alphabetical order counts, and the
    other one is reported. What is registered in this process goes before what is installed.
    """

    def __init__(self, kind: str, group: str, base: type = object) -> None:
        self.kind = kind
        self.group = group
        self.base = base
        self._local: dict[str, Plugin] = {}
        # Factories of this package that are imported when they are asked for.
        self._own: dict[str, EntryPoint] = {}
        # Of an installed plug-in that cannot be loaded, the reason.
        self._loaded: dict[str, Plugin | str] = {}
        self._reported: set[str] = set()

    def register(self, name: str) -> Callable[[T], T]:
        """Class decorator that registers a factory in this process.

        Parameters
        ----------
        name : str
            Name by which users ask for it.

        Raises
        ------
        TypeError
            If the factory makes nothing of this kind, or the name is no text.
        ValueError
            If the name has characters that a name cannot have, or is taken by another factory. A
            class of the same module and name, defined again, takes the place of the earlier one; so
            does one of another script, with a `PluginWarning`.
        """
        if not isinstance(name, str):
            raise TypeError(
                f"name: needs a text, got {name!r}; write the decorator as register(name)"
            )
        if not _NAME.fullmatch(name):
            raise ValueError(f"name: needs letters, digits, '_', '-' and '.' only; got {name!r}")

        def decorate(factory: T) -> T:
            self._check(name, factory)
            taken = self._local.get(name) or self._own_plugin(name)
            plugin = Plugin(name, factory, _script(factory) or _module(factory).partition(".")[0])
            if taken is not None and not _same(taken.factory, factory):
                if not (_script(factory) and _script(taken.factory)):
                    raise ValueError(
                        f"{self.kind} {name!r} is already registered by {taken.package}; choose "
                        "another name"
                    )
                _warn(f"{self.kind} {name!r} of {plugin.package} replaces that of {taken.package}")
            self._local[name] = plugin
            return factory

        return decorate

    def register_later(self, name: str, place: str) -> None:
        """Register a factory of this package that is imported when it is asked for.

        Parameters
        ----------
        name : str
            Name by which users ask for it.
        place : str
            Its module and name, as ``package.module:name``.
        """
        self._own[name] = EntryPoint(name, place, self.group)

    def unregister(self, name: str) -> None:
        """Forget a factory registered in this process."""
        del self._local[name]

    def __iter__(self) -> Iterator[Plugin]:
        installed = {name: self._load(point) for name, point in self._installed.items()}
        for problem in installed.values():
            if isinstance(problem, str) and problem not in self._reported:
                self._reported.add(problem)
                _warn(f"{problem}; it is skipped")
        own = {name: self._own_plugin(name) for name in self._own}
        everything = {**installed, **own, **self._local}
        found = [plugin for plugin in everything.values() if isinstance(plugin, Plugin)]
        return iter(sorted(found, key=lambda plugin: plugin.name))

    def names(self) -> tuple[str, ...]:
        """Names of all plug-ins, sorted; no installed plug-in is loaded for it."""
        return tuple(sorted({**self._installed, **self._own, **self._local}))

    def built_in(self) -> tuple[str, ...]:
        """Names of the plug-ins that are part of fuzzytrack."""
        local = (name for name, plugin in self._local.items() if plugin.built_in)
        return (*local, *self._own)

    def package(self, name: str) -> str:
        """Package that offers a name; no installed plug-in is loaded for it."""
        if name in self._local:
            return self._local[name].package
        return _package(self._own.get(name) or self._installed[name])

    def get(self, name: str) -> Any:
        """Factory by name; no other plug-in is loaded for it.

        Raises
        ------
        ValueError
            If there is none, naming the known ones; or if it cannot be loaded.
        """
        if name not in self.names():
            raise ValueError(f"unknown {self.kind} {name!r}; one of {', '.join(self.names())}")
        own = self._local.get(name) or self._own_plugin(name)
        found = own or self._load(self._installed[name])
        if isinstance(found, str):
            raise ValueError(found)
        return found.factory

    def _own_plugin(self, name: str) -> Plugin | None:
        """Plug-in of this package that is registered for later, if there is one of that name."""
        if name not in self._own:
            return None
        return Plugin(name, self._own[name].load(), "fuzzytrack")

    @cached_property
    def _installed(self) -> dict[str, EntryPoint]:
        """What packages offer under names of their own."""
        offered: dict[str, EntryPoint] = {}
        for point in sorted(entry_points(group=self.group), key=lambda p: (p.name, _package(p))):
            what = f"{self.kind} {point.name!r} of package {_package(point)}"
            if point.name in self.built_in():
                _warn(f"{what} has the name of a built-in {self.kind}; it is skipped")
            elif point.name in offered:
                first = _package(offered[point.name])
                _warn(f"{what} has the name of one of package {first}; it is skipped")
            else:
                offered[point.name] = point
        return offered

    def _load(self, point: EntryPoint) -> Plugin | str:
        """Load an installed plug-in, or say why that cannot be done."""
        if point.name not in self._loaded:
            self._loaded[point.name] = self._loading(point)
        return self._loaded[point.name]

    def _loading(self, point: EntryPoint) -> Plugin | str:
        package = _package(point)
        try:
            factory = point.load()
            self._check(point.name, factory)
        except KeyboardInterrupt:
            raise
        # Whatever a foreign package raises, sys.exit included, must not affect other plug-ins.
        except BaseException as error:
            return f"{self.kind} {point.name!r} of package {package} could not be loaded: {error!r}"
        return Plugin(point.name, factory, package)

    def _check(self, name: str, factory: Any) -> None:
        fits = issubclass(factory, self.base) if isinstance(factory, type) else callable(factory)
        if not fits:
            raise TypeError(
                f"{self.kind} {name!r} must be a {self.base.__name__} class, or a function that "
                f"makes a {self.base.__name__}, got {factory!r}"
            )


def entry_points(group: str) -> Iterable[EntryPoint]:
    """What installed packages offer in a group; all packages are looked through once."""
    found: Iterable[EntryPoint] = _every_entry_point().select(group=group)
    return found


@cache
def _every_entry_point() -> Any:
    # Of a class that depends on the version of Python; all have `select`.
    return metadata.entry_points()


def _same(one: Any, other: Any) -> bool:
    """Whether one factory is the other, or the other defined again."""
    names = ("__module__", "__qualname__")
    return one is other or all(getattr(one, n, one) == getattr(other, n, other) for n in names)


def _module(factory: Any) -> str:
    return str(getattr(factory, "__module__", ""))


def _script(factory: Any) -> str | None:
    """File of the script that defines a factory; None if a module does that was imported."""
    module = sys.modules.get(_module(factory))
    if module is None or module.__spec__ is not None:
        return None
    return getattr(module, "__file__", None)


def _package(point: EntryPoint) -> str:
    return point.dist.name if point.dist else point.module.partition(".")[0]


def _warn(message: str) -> None:
    warnings.warn(message, PluginWarning, stacklevel=4)
