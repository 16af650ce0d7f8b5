"""Parts of two roles and a sensor, small enough to be written down in a test."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzytrack.errors import ScannerError
from fuzzytrack.plugins import Registry
from fuzzytrack.scan.part import Part, parameter, word
from fuzzytrack.scan.scanners.reader import Configuration, ScannerReader
from fuzzytrack.yamltree import Document


@dataclass(frozen=True, repr=False)
class SmallSensor(Part):
    """A sensor."""

    noise: float = parameter(1.0, "noise of a plot", "m", least=0, above=True)
    detection: float = parameter(0.9, "probability of a plot", "", least=0, most=1)


class Gate(Part):
    """Which plots are near enough."""


@dataclass(frozen=True, repr=False)
class Round(Gate):
    """A circle."""

    radius: float = parameter(50.0, "radius of the circle", "m", least=0, above=True)
    shape: str = word("circle", "what it looks like", "circle", "square")


@dataclass(frozen=True, repr=False)
class Ring(Gate):
    """Between two circles."""

    inner: float = parameter(1.0, "inner radius", "m", least=0)
    outer: float = parameter(2.0, "outer radius", "m", least=0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.inner >= self.outer:
            raise ValueError(f"inner must be less than outer, got {self.inner:g}")


@dataclass(frozen=True, repr=False)
class Broken(Gate):
    """A plug-in with a mistake of its author."""

    size: float = parameter(0.0, "size")

    def __post_init__(self) -> None:
        super().__post_init__()
        _ = 1 / self.size


class Kind(Part):
    """What a target is."""


@dataclass(frozen=True, repr=False)
class NoKind(Kind):
    """No decision."""


@dataclass(frozen=True, repr=False)
class Bank(Kind):
    """A bank of hypotheses."""

    hits: int = parameter(3, "plots before a decision", "hits", least=1, whole=True)
    tracker: str = word("kalman-cv:sigma_v=1", "tracker of the hypothesis")


@dataclass(frozen=True, repr=False)
class Unregistered(Kind):
    """A part without a name."""


def a_function() -> Kind:
    """No class, although a registry takes it."""
    return NoKind()


GATES: Registry[type[Gate]] = Registry("gate", "fuzzytrack.test.gate", Gate)
KIND: Registry[type[Kind]] = Registry("kind", "fuzzytrack.test.kind", Kind)
for each, name in ((Round, "round"), (Ring, "ring"), (Broken, "broken")):
    GATES.register(name)(each)
for each, name in ((NoKind, "none"), (Bank, "bank"), (a_function, "function")):
    KIND.register(name)(each)

ROLES = {"gate": GATES, "kind": KIND}
MEANINGS = {"sensor": "The sensor.", "gate": "Which plots are near.", "kind": "What it is."}

BASE = """\
scanner: 1
name: base
sensor: {noise: 2, detection: .8}
gate: {part: round, radius: 30}
"""


def read(text: str | bytes, file: str = "mine.yaml") -> Configuration:
    """Configuration of a text; it may be based on `base`."""

    def base(name):
        if name != "base":
            raise ScannerError(f"unknown configuration {name!r}")
        return read(BASE)

    return ScannerReader(
        Document(text, file, failure=ScannerError), SmallSensor, ROLES, base
    ).configuration()
