"""Errors of exported C: every shipped rule base and filter, compiled by this computer's compiler.

Run as ``python -m benchmarks.c99_errors``. Exit status 1 if an error is larger than its bound, or
a float differs from the library by more than 4 units in the last place.
"""

from __future__ import annotations

import argparse
import ctypes
import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from fuzzytrack import AlphaBetaTracker, FuzzySystem, load_rulebase
from fuzzytrack.cli.text_table import table_lines
from fuzzytrack.fuzzy.loading import shipped_rulebases
from fuzzytrack.interop.c99.build import built
from fuzzytrack.interop.c99.compiled_filter import compiled_c
from fuzzytrack.interop.c99.export import CExport, export_c
from fuzzytrack.interop.c99.number_types import NUMBERS, number_type
from fuzzytrack.interop.c99.vectors import library_values

CHUNK, ULPS, PLOTS = 100_000, 4.0, 10_000
C_TYPES = {"double": np.float64, "float": np.float32, "q15": np.int16}


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="benchmarks.c99_errors", description=__doc__)
    parser.add_argument("names", nargs="*", default=list(shipped_rulebases()), help="rule bases")
    parser.add_argument("--inputs", type=int, default=1_000_000, help="random inputs")
    parser.add_argument("--compiler", help="cc, gcc or clang")
    given = parser.parse_args(arguments)
    rows = [
        row
        for name in given.names
        for number in NUMBERS
        for row in infer_rows(name, number, given.inputs, given.compiler)
    ]
    head = ["rule base", "number", "output", "largest error", "ulp or steps", "bound", "holds"]
    print("\n".join(table_lines(head, rows, 120, 3)))
    moving = [
        filter_row(name, number, given.compiler)
        for name in given.names
        if dict(load_rulebase(name).scheduler)
        for number in ("double", "float")
    ]
    print(f"\nFilters over {PLOTS} plots, as {PLOTS // 100} tracks")
    if moving:
        head = ["rule base", "number", "position, m", "velocity, m/s", "holds"]
        print("\n".join(table_lines(head, moving, 120, 2)))
    return 0 if all(row[-1] == "yes" for row in (*rows, *moving)) else 1


def infer_rows(name: str, number: str, inputs: int, compiler: str | None) -> list[list[str]]:
    """For each output the largest error of C over random inputs."""
    made = export_c(name, number=number, random=inputs)
    system, kind = FuzzySystem(name), number_type(number)
    evaluate = compiled(made, compiler)
    random = np.random.default_rng(20)
    outputs = system.rules.output_names
    largest, units = np.zeros(len(outputs)), np.zeros(len(outputs))
    for start in range(0, inputs, CHUNK):
        count = min(CHUNK, inputs - start)
        columns = [kind.random(v.universe, count, random) for v in system.rules.inputs]
        rows = np.stack(columns, axis=1)
        found, exact = evaluate(rows), library_values(system, kind, rows)
        apart = np.abs(found - exact)
        largest = np.maximum(largest, apart.max(axis=0))
        if not kind.whole:
            rounded = exact.astype(kind.dtype)
            apart = np.abs(found - rounded) / np.spacing(np.abs(rounded))
        units = np.maximum(units, apart.max(axis=0))
    answer = []
    for k, output in enumerate(outputs):
        bound = made.figures["errors"][output]["bound"]
        holds = largest[k] <= bound and (number != "float" or units[k] <= ULPS)
        told = [f"{largest[k]:.3g}", f"{units[k]:.3g}", f"{bound:.3g}", "yes" if holds else "no"]
        answer.append([name, number, output, *told])
    return answer


def compiled(made: CExport, compiler: str | None) -> Callable[[Any], Any]:
    """The function of a header over rows of inputs."""
    (head,) = (line for line in made.header.splitlines() if f" {made.prefix}_infer(" in line)
    n_inputs, c_type = head.count(",") + 1, head.partition("(")[2].split()[0]
    n_outputs = len(made.figures["errors"])
    call = ", ".join(f"given[{k}]" for k in range(n_inputs))
    text = (
        f"{made.header}\nextern void driver(int64_t count, const {c_type} *given, void *found);\n"
        f"void driver(int64_t count, const {c_type} *given, void *found)\n{{\n"
        f"    {made.prefix}_outputs *y = found;\n"
        f"    for (int64_t k = 0; k < count; ++k, given += {n_inputs}, ++y) {{\n"
        f"        *y = {made.prefix}_infer({call});\n    }}\n}}\n"
    )
    driver = built(text, compiler=compiler, flags=("-O2",)).driver

    def evaluate(rows: Any) -> Any:
        given = np.ascontiguousarray(rows, C_TYPES[made.number])
        found = np.empty((len(given), n_outputs), given.dtype)
        driver(
            ctypes.c_int64(len(given)), *(ctypes.c_void_p(a.ctypes.data) for a in (given, found))
        )
        return found

    return evaluate


def filter_row(name: str, number: str, compiler: str | None) -> list[str]:
    """Largest errors of a filter over turning tracks with missed plots."""
    figures = export_c(name, number=number, filter=True, random=1).figures["filter"]
    bounds = figures["errors_allowed"]
    random = np.random.default_rng(30)
    times = np.cumsum(random.uniform(0.5, 1.5, 100))
    angle = 0.05 * times[:, None] + random.uniform(0, 6, PLOTS // 100)
    plots = 2_000.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    sigma = random.uniform(5.0, 15.0, plots.shape).astype(C_TYPES[number]).astype(float)
    plots = (plots + random.normal(size=plots.shape) * sigma).astype(C_TYPES[number]).astype(float)
    plots[random.random(angle.shape) < 0.2] = np.nan
    found = compiled_c(name, axes=2, number=number, compiler=compiler).run(times, plots, sigma)
    exact = AlphaBetaTracker(name).run(times, plots, sigma)
    apart = [
        float(np.nanmax(np.abs(mine - theirs)))
        for mine, theirs in ((found.filtered, exact.filtered), (found.velocity, exact.velocity))
    ]
    holds = apart[0] <= bounds["position"] and apart[1] <= bounds["velocity"]
    told = (f"{e:.2g} of {b:.2g}" for e, b in zip(apart, bounds.values(), strict=True))
    return [name, number, *told, "yes" if holds else "no"]


if __name__ == "__main__":
    sys.exit(main())
