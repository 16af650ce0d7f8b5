"""Registries of plug-ins: entry points of installed packages, and a decorator in process."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.metadata import entry_points
from typing import Any, Generic, TypeVar

from fuzzytrack.errors import PluginWarning

__all__ = ["Plugin", "Registry"]

T = TypeVar("T", bound=Callable[..., Any])


@dataclass(frozen=True)
class Plugin:
    """A registered factory and where it comes from."""

    name: str
    factory: Callable[..., Any]
    package: str

    @property
    def source(self) -> str:
        """Paper or other source, as the factory declares in its attribute ``source``."""
        return str(getattr(self.factory, "source", ""))


class Registry(Generic[T]):
    """Plug-ins of one kind, by name.

    Parameters
    ----------
    kind : str
        What a plug-in is, in words ("scheduler").
    group : str
        Entry-point group searched for plug-ins of installed packages.
    """

    def __init__(self, kind: str, group: str) -> None:
        self.kind = kind
        self.group = group
        self._local: dict[str, Plugin] = {}
        self._installed: dict[str, Plugin] | None = None

    def register(self, name: str) -> Callable[[T], T]:
        """Class decorator that registers a factory in this process.

        Parameters
        ----------
        name : str
            Name by which users ask for it.

        Raises
        ------
        ValueError
            If the name is taken by another factory.
        """

        def decorate(factory: T) -> T:
            taken = self._local.get(name)
            if taken is not None and taken.factory is not factory:
                raise ValueError(f"{self.kind} {name!r} is already registered")
            package = str(getattr(factory, "__module__", "")).partition(".")[0]
            self._local[name] = Plugin(name, factory, package)
            return factory

        return decorate

    def unregister(self, name: str) -> None:
        """Forget a factory registered in this process."""
        del self._local[name]

    def __iter__(self) -> Iterator[Plugin]:
        everything = {**self._entry_points(), **self._local}
        return iter(sorted(everything.values(), key=lambda plugin: plugin.name))

    def names(self) -> tuple[str, ...]:
        """Names of all plug-ins, sorted."""
        return tuple(plugin.name for plugin in self)

    def get(self, name: str) -> Any:
        """Factory by name.

        Raises
        ------
        ValueError
            If there is none; names the known ones.
        """
        if name in self._local:
            return self._local[name].factory
        if name in self._entry_points():
            return self._entry_points()[name].factory
        raise ValueError(f"unknown {self.kind} {name!r}; one of {', '.join(self.names())}")

    def _entry_points(self) -> dict[str, Plugin]:
        if self._installed is None:
            self._installed = dict(_load(self.kind, self.group))
        return self._installed


def _load(kind: str, group: str) -> Iterator[tuple[str, Plugin]]:
    for point in entry_points(group=group):
        package = point.dist.name if point.dist else point.module.partition(".")[0]
        try:
            factory = point.load()
        # Whatever a foreign package does wrong must not take the others with it.
        except Exception as error:
            warnings.warn(
                f"{kind} {point.name!r} of {package} could not be loaded and is skipped: {error!r}",
                PluginWarning,
                stacklevel=2,
            )
            continue
        yield point.name, Plugin(point.name, factory, package)
