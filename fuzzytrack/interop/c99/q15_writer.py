"""The function of a table in C with integers of 16 bits."""

from __future__ import annotations

from fuzzytrack.interop.c99.lookup_writer import LookupWriter
from fuzzytrack.interop.c99.q15_lookup import EXTRA, MOST_WEIGHED, Q15Axis, Q15Lookup
from fuzzytrack.interop.c99.signature import Signature

__all__ = ["Q15Writer"]


class Q15Writer(LookupWriter):
    """Writes a table as `fuzzytrack.interop.c99.q15_lookup.Q15Lookup` computes it."""

    cell = "uint16_t"

    def __init__(self, names: Signature, lookup: Q15Lookup) -> None:
        super().__init__(names, lookup)
        self.weighed = f"{names.prefix}_weighed"
        self.called: set[str] = set()

    def helpers(self) -> list[str]:
        """The functions between two nodes that were called."""
        interpolates = [
            "/* Value between two nodes, both from 0 to 65535; share, from 0 to 65536, is the part",
            " * of the interval below it. Rounded to the nearest, halves up, without overflow. */",
            f"FUZZYTRACK_INLINE uint32_t {self.between}("
            "uint32_t low, uint32_t high, uint32_t share)",
            "{",
            "    const uint32_t rest = UINT32_C(65536) - share;",
            "    return ((low * rest) + (high * share) + UINT32_C(32768)) >> 16U;",
            "}",
        ]
        weighs = [
            "/* 65536 times the value between two nodes, not rounded. */",
            f"FUZZYTRACK_INLINE uint64_t {self.weighed}("
            "uint64_t low, uint64_t high, uint32_t share)",
            "{",
            "    const uint32_t rest = UINT32_C(65536) - share;",
            "    return (low * rest) + (high * share);",
            "}",
        ]
        written = {self.between: interpolates, self.weighed: weighs}
        texts = [lines for name, lines in written.items() if name in self.called]
        return [line for lines in texts for line in (*lines, "")][:-1]

    def count_call(self, helper: str) -> None:
        """Count the operations of a call of one of them."""
        self.called.add(helper)
        rounds = helper == self.between
        self.operations.update(
            {"additions": 2 + rounds, "multiplications": 2, "shifts": int(rounds)}
        )

    def axis(self, k: int, axis: Q15Axis) -> tuple[str, ...]:
        """Lines for the interval of an input; its index and its shares."""
        name, last = self.names.inputs[k], len(axis.nodes) - 1
        said = (
            f"Nodes of {self.alike(axis)}, of 2^{16 + EXTRA}, and 2^{16 + axis.shift} over the "
            "widths of the intervals."
        )
        nodes = self.array("uint32_t", f"{name}_nodes", list(axis.nodes), said)
        rates = self.array("uint32_t", f"{name}_rates", list(axis.rates))
        x = self.variable("uint32_t", f"{name}_inside")
        if k:
            self.body.append("")
        self.body.append(f"{x} = (uint32_t)((int32_t){name} + INT32_C(32768)) << {EXTRA}U;")
        self.operations.update({"additions": 1, "shifts": 1})
        self.clipped(
            x,
            x,
            f"{nodes}[0]" if axis.nodes[0] > 0 else "",
            f"{nodes}[{last}]" if axis.nodes[last] < 1 << (16 + EXTRA) else "",
        )
        index = self.interval(name, x, nodes, last)
        share = self.variable("uint32_t", f"{name}_share")
        part = self.variable("uint64_t", f"{name}_part")
        half = f"UINT64_C({1 << (axis.shift - 1)})"
        self.body += [
            f"{part} = (uint64_t)({x} - {nodes}[{index}]) * {rates}[{index}];",
            f"{share} = (uint32_t)(({part} + {half}) >> {axis.shift}U);",
        ]
        self.operations.update({"additions": 2, "multiplications": 1, "shifts": 1})
        return index, share

    def output(self, name: str, target: str, place: str, shares: list[list[str]]) -> None:
        """Lines for an output."""
        word = target.partition(".")[2]
        self.body.append("")
        silent = self.lookup.is_silent(name)
        wide = "uint64_t" if silent else "uint32_t"
        value = self.variable(wide, f"{word}_place")
        if name not in self.lookup.totals:
            table = self.table(f"{word}_table", self.lookup.moments[name])
            self.assign(value, self.interpolation(table, place, shares))
        else:
            moments = self.table(f"{word}_moments", self.lookup.moments[name])
            totals = self.table(f"{word}_totals", self.lookup.totals[name])
            total = self.variable(wide, f"{word}_total")
            helper = self.weighed if silent else self.between
            self.assign(value, self.interpolation(moments, place, shares, helper))
            self.assign(total, self.interpolation(totals, place, shares, helper))
            if silent and len(shares) == MOST_WEIGHED:
                self._leave_room(value, total)
            self._quotient(value, total, self.lookup.defaults[name], silent)
        self.body.append(f"{target} = (int16_t)((int32_t){value} - INT32_C(32768));")
        self.operations.update({"additions": 1})

    def _leave_room(self, value: str, total: str) -> None:
        """Lines that make room for a shift by 16 bits: such large numbers have bits to spare."""
        self.body += [
            f"if ({total} >= (UINT64_C(1) << 47U)) {{",
            *(f"    {name} = {name} >> 16U;" for name in (value, total)),
            "}",
        ]
        self.operations.update({"comparisons": 1, "shifts": 3})

    def _quotient(self, value: str, total: str, default: int, silent: bool) -> None:
        lines = [
            f"{value} = (({value} << 16U) + ({total} >> 1U)) / {total};",
            f"{value} = ({value} > 65535U) ? 65535U : {value};",
        ]
        if silent:
            lines = [
                f"if ({total} == 0U) {{",
                f"    {value} = {default}U; /* No rule fires. */",
                "} else {",
                *(f"    {line}" for line in lines),
                "}",
            ]
        self.body += lines
        self.operations.update(
            {"additions": 1, "divisions": 1, "comparisons": 1 + silent, "shifts": 2}
        )
