"""The function of a table in C with floating-point numbers."""

from __future__ import annotations

from fuzzytrack.interop.c99.c_text import literal
from fuzzytrack.interop.c99.float_lookup import FloatAxis, FloatLookup
from fuzzytrack.interop.c99.lookup_writer import LookupWriter
from fuzzytrack.interop.c99.signature import Signature

__all__ = ["FloatWriter"]


class FloatWriter(LookupWriter):
    """Writes a table as `fuzzytrack.interop.c99.float_lookup.FloatLookup` computes it."""

    def __init__(self, names: Signature, lookup: FloatLookup) -> None:
        super().__init__(names, lookup)
        self.number = self.cell = names.c_type
        self.suffix = "f" if names.c_type == "float" else ""

    def helpers(self) -> list[str]:
        """The function that interpolates between two nodes."""
        t = self.number
        return [
            "/* Value between two nodes, from the shares of the interval below and above it. The",
            " * smaller share is used: it is the more precise one. */",
            f"FUZZYTRACK_INLINE {t} {self.between}({t} low, {t} high, {t} below, {t} above)",
            "{",
            "    return (below <= above) ? (low + (below * (high - low))) : "
            "(high - (above * (high - low)));",
            "}",
        ]

    def count_call(self, helper: str) -> None:
        """Count the operations of a call of it."""
        self.operations.update({"comparisons": 1, "additions": 2, "multiplications": 1})

    def axis(self, k: int, axis: FloatAxis) -> tuple[str, ...]:
        """Lines for the interval of an input; its index and its shares."""
        name, last = self.names.inputs[k], len(axis.nodes) - 1
        said = f"Nodes of {self.alike(axis)}, and the inverse widths of the intervals."
        nodes = self.array(self.number, f"{name}_nodes", list(axis.nodes), said)
        rates = self.array(self.number, f"{name}_rates", list(axis.rates))
        rests = ""
        if axis.rests is not None:
            said = "What is to be added to each node, which a float cannot hold."
            rests = self.array(self.number, f"{name}_rests", list(axis.rests), said)
        x = self.variable(self.number, f"{name}_inside")
        if k:
            self.body.append("")
        self.clipped(x, name, f"{nodes}[0]", f"{nodes}[{last}]")
        index = self.interval(name, x, nodes, last)
        below = self.variable(self.number, f"{name}_below")
        above = self.variable(self.number, f"{name}_above")
        i, j = index, f"{index} + 1U"
        self.body += [f"{below} = {x} - {nodes}[{i}];", f"{above} = {nodes}[{j}] - {x};"]
        self.operations.update({"additions": 3, "multiplications": 2})
        if not rests:
            self.body += [f"{share} = {share} * {rates}[{i}];" for share in (below, above)]
            return index, below, above
        zero = f"0.0{self.suffix}"
        self.body += [
            f"{below} = ({below} - {rests}[{i}]) * {rates}[{i}];",
            f"{above} = ({above} + {rests}[{j}]) * {rates}[{i}];",
            *(f"{share} = ({share} < {zero}) ? {zero} : {share};" for share in (below, above)),
        ]
        self.operations.update({"additions": 3, "comparisons": 2})
        return index, below, above

    def output(self, name: str, target: str, place: str, shares: list[list[str]]) -> None:
        """Lines for an output."""
        word = target.partition(".")[2]
        self.body.append("")
        if name not in self.lookup.totals:
            table = self.table(f"{word}_table", self.lookup.moments[name])
            self.assign(target, self.interpolation(table, place, shares))
            return
        moments = self.table(f"{word}_moments", self.lookup.moments[name])
        totals = self.table(f"{word}_totals", self.lookup.totals[name])
        moment = self.variable(self.number, f"{word}_moment")
        total = self.variable(self.number, f"{word}_total")
        self.assign(moment, self.interpolation(moments, place, shares))
        self.assign(total, self.interpolation(totals, place, shares))
        self.operations["divisions"] += 1
        if self.lookup.totals[name].min() > 0:
            self.body.append(f"{target} = {moment} / {total};")
            return
        default = literal(self.lookup.axes[0].nodes.dtype.type(self.lookup.defaults[name]))
        if default == "NAN":
            self.includes.add("math.h")
            default = f"({self.number})NAN"
        self.body += [
            "/* If the total is 0, no rule fires. */",
            f"{target} = ({total} <= 0.0{self.suffix}) ? {default} : ({moment} / {total});",
        ]
        self.operations["comparisons"] += 1
