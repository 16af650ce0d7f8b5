"""Words of FIS files and what they stand for: shapes with their parameters, methods, hedges."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "AGGREGATIONS", "ANDS", "DEFUZZIFICATIONS", "HEDGES", "IMPLICATIONS", "ORS", "SHAPES", "Order",
]  # fmt: skip

Numbers = tuple[float, ...]


@dataclass(frozen=True)
class Order:
    """Order of the parameters of a shape.

    Attributes
    ----------
    names : tuple of str
        In a file.
    places : tuple of int
        For each parameter here, its place in a file.
    """

    names: tuple[str, ...]
    places: tuple[int, ...]

    def read(self, numbers: Numbers) -> Numbers:
        """Parameters in the order of `fuzzytrack.fuzzy.shapes.SHAPES`."""
        return tuple(numbers[place] for place in self.places)

    def written(self, parameters: Numbers) -> Numbers:
        """Parameters in the order of a file."""
        return tuple(parameters[self.places.index(k)] for k in range(len(parameters)))


def _same(*names: str) -> Order:
    return Order(names, tuple(range(len(names))))


#: Shapes; they have the same names here.
SHAPES: dict[str, Order] = {
    "trimf": _same("a", "b", "c"),
    "trapmf": _same("a", "b", "c", "d"),
    "gaussmf": Order(("sigma", "mean"), (1, 0)),
    "gauss2mf": Order(("sigma1", "mean1", "sigma2", "mean2"), (1, 0, 3, 2)),
    "gbellmf": _same("a", "b", "c"),
    "sigmf": Order(("slope", "offset"), (1, 0)),
    "dsigmf": Order(("slope1", "offset1", "slope2", "offset2"), (1, 0, 3, 2)),
    "psigmf": Order(("slope1", "offset1", "slope2", "offset2"), (1, 0, 3, 2)),
    "smf": _same("a", "b"),
    "zmf": _same("a", "b"),
    "pimf": _same("a", "b", "c", "d"),
    "linsmf": _same("a", "b"),
    "linzmf": _same("a", "b"),
}

#: Methods by their word in a file, for each key.
ANDS = {"min": "min", "prod": "product"}
ORS = {"max": "max", "probor": "algebraic-sum"}
IMPLICATIONS = {"min": "min", "prod": "product"}
AGGREGATIONS = {"max": "max", "sum": "sum", "probor": "algebraic-sum"}
DEFUZZIFICATIONS = {
    "mamdani": {
        "centroid": "centroid", "bisector": "bisector", "mom": "mom", "som": "som", "lom": "lom",
    },
    "sugeno": {"wtaver": "weighted-centers"},
}  # fmt: skip

#: Hedges by the decimals of an index, as Octave's toolkit and sciFLT write them.
HEDGES = {5: ("somewhat",), 20: ("very",), 30: ("extremely",), 40: ("very", "very")}
