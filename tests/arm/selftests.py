"""Exported C on an ARM Cortex-M4: self-tests under qemu, and sizes.

Run by ``make arm``. Needs arm-none-eabi-gcc with newlib, and qemu-system-arm (Debian:
gcc-arm-none-eabi, libnewlib-arm-none-eabi, qemu-system-arm). Exit status 1 if a self-test fails.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fuzzytrack.cli.text_table import table_lines
from fuzzytrack.fuzzy.loading import load_rulebase, shipped_rulebases
from fuzzytrack.interop.c99.export import CExport, export_c
from fuzzytrack.interop.c99.number_types import NUMBERS, number_type
from fuzzytrack.interop.c99.selftest import constant_rows

#: Calls that are timed together, inputs that are tried, and instructions in a tick of the clock of
#: the board: qemu counts one for a nanosecond, and the clock has 25 MHz.
CALLS, INPUTS, TICK = 400, 64, 40
#: How the line of a self-test ends that has passed.
RIGHT = "values are right"
HERE = Path(__file__).resolve().parent
CORE = ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16")
WARNINGS = (
    "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-Wshadow",
    "-Wdouble-promotion", "-Werror",
)  # fmt: skip
BOARD = (
    "qemu-system-arm", "-M", "mps2-an386", "-nographic", "-monitor", "none", "-serial", "none",
    "-semihosting-config", "enable=on,target=native", "-kernel",
)  # fmt: skip
FILTER_COLUMNS = ("filter", "number", "track", "code and data", "stack", "self-test")
COLUMNS = ("rule base", "number", "method", "data", "code and data", "stack",
    "instructions", "error", "self-test",
)  # fmt: skip


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="make arm", description=__doc__)
    parser.add_argument("names", nargs="*", default=list(shipped_rulebases()), help="rule bases")
    parser.add_argument("--random", type=int, default=1_000_000, help="inputs for the error")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="write it as Markdown")
    given = parser.parse_args(arguments)
    for program in ("arm-none-eabi-gcc", BOARD[0]):
        if shutil.which(program) is None:
            print(f"make arm: {program} is not installed", file=sys.stderr)
            return 2
    rows, filters = [], []
    for name in given.names:
        for number in NUMBERS:
            rows.append(infer_row(export_c(name, number=number, random=given.random)))
            print(f"{name} {number}: {rows[-1][-1]}", file=sys.stderr)
        if dict(load_rulebase(name).scheduler):
            for number in ("double", "float"):
                filters.append(filter_row(export_c(name, number=number, filter=True, random=1_000)))
                print(f"{name} {number} filter: {filters[-1][-1]}", file=sys.stderr)
    for columns, table, words in ((COLUMNS, rows, 3), (FILTER_COLUMNS, filters, 2)):
        print("\n".join(table_lines(list(columns), table, 140, words)) + "\n")
    if given.output:
        parts = (markdown(COLUMNS, rows, 3), markdown(FILTER_COLUMNS, filters, 2))
        given.output.write_text("\n".join(parts), encoding="utf-8")
    return 0 if all(row[-1].endswith(RIGHT) for row in (*rows, *filters)) else 1


def infer_row(made: CExport) -> list[str]:
    """Sizes and self-test of a rule base."""
    with TemporaryDirectory() as folder:
        says = selftest(made, Path(folder))
        code, stack = sizes(made, Path(folder), infer_entry(made))
        most = instructions(made, Path(folder))
    figures = [made.figures["rom_bytes"], code, stack, most]
    words = [made.name, made.number, made.figures["method"]]
    return [*words, *map(str, figures), error(made), says]


def filter_row(made: CExport) -> list[str]:
    """Sizes and self-test of a filter."""
    with TemporaryDirectory() as folder:
        says = selftest(made, Path(folder))
        code, stack = sizes(made, Path(folder), filter_entry(made))
    track = str(made.figures["filter"]["ram_bytes_per_track"])
    return [made.name, made.number, track, str(code), str(stack), says]


def markdown(columns: Sequence[str], rows: list[list[str]], words: int) -> str:
    """A table for a page of the documentation, without what the self-tests say."""
    rule = ("---",) * words + ("--:",) * (len(columns) - 1 - words)
    lines = [columns[:-1], rule, *(row[:-1] for row in rows)]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def selftest(made: CExport, folder: Path) -> str:
    """What the self-test says of its values under qemu."""
    made.write(folder)
    linked(folder, f"{made.name}_selftest.c", "selftest.elf")
    board = [*BOARD, folder / "selftest.elf"]
    try:
        done = subprocess.run(board, capture_output=True, text=True, timeout=60, check=False)
    except subprocess.TimeoutExpired:
        return "hangs"
    says = done.stdout.strip().partition(": ")[2]
    return says if done.returncode == 0 else f"{says or 'nothing'}, exit status {done.returncode}"


def linked(folder: Path, source: str, program: str) -> None:
    """Compile a program for the board."""
    link = (
        "-nostartfiles", "-T", str(HERE / "board.ld"), "--specs=rdimon.specs",
        "-Wl,--no-warn-rwx-segments",
    )  # fmt: skip
    sources = (str(HERE / "startup.c"), source)
    subprocess.run(
        ["arm-none-eabi-gcc", *CORE, *WARNINGS, "-O2", *sources, *link, "-o", program],
        cwd=folder, check=True,
    )  # fmt: skip


def instructions(made: CExport, folder: Path) -> int:
    """Most instructions of a call, over some random inputs, without those of the loop around it."""
    inputs = load_rulebase(made.name).inputs
    kind, random = number_type(made.number), np.random.default_rng(4)
    rows = np.stack([kind.random(v.universe, INPUTS, random) for v in inputs], axis=1)
    given = ", ".join(f"given[row][{k}]" for k in range(len(inputs)))
    outputs = re.search(r"{([^}]*)} \w+_outputs;", made.header)[1]
    members = re.findall(r"\w+ (\w+);", outputs)
    lines = [
        f'#include "{made.name}.h"',
        "#include <stdio.h>",
        *constant_rows(f"volatile {kind.c_type}", "given", rows),
        f"static volatile {kind.c_type} sink[{max(len(members), len(inputs))}];",
        "static uint32_t timed(uint32_t row, int works)",
        "{",
        "    volatile uint32_t *const clock = (volatile uint32_t *)0xE000E010U;",
        "    uint32_t start;",
        "    uint32_t k;",
        "    clock[1] = 0xFFFFFFU;",
        "    clock[2] = 0U;",
        "    clock[0] = 5U;",
        "    start = clock[2];",
        f"    for (k = 0U; k < {CALLS}U; k++) {{",
        "        if (works != 0) {",
        f"            const {made.prefix}_outputs y = {made.prefix}_infer({given});",
        *(f"            sink[{k}] = y.{member};" for k, member in enumerate(members)),
        "        } else {",
        *(f"            sink[{k}] = given[row][{k}];" for k in range(len(inputs))),
        "        }",
        "    }",
        "    return (start - clock[2]) & 0xFFFFFFU;",
        "}",
        "int main(void)",
        "{",
        "    uint32_t most = 0U;",
        "    uint32_t row;",
        f"    for (row = 0U; row < {INPUTS}U; row++) {{",
        "        const uint32_t spent = timed(row, 1) - timed(row, 0);",
        "        most = (spent > most) ? spent : most;",
        "    }",
        '    (void)printf("%u\\n", (unsigned int)most);',
        "    return 0;",
        "}",
    ]
    (folder / "count.c").write_text("\n".join(lines) + "\n")
    linked(folder, "count.c", "count.elf")
    board = [*BOARD[:-1], "-icount", "shift=0", "-kernel", folder / "count.elf"]
    done = subprocess.run(board, capture_output=True, text=True, timeout=60, check=True)
    return round(int(done.stdout) * TICK / CALLS)


def infer_entry(made: CExport) -> str:
    """A program that is one call of the function of a rule base."""
    head = next(line for line in made.header.splitlines() if f" {made.prefix}_infer(" in line)
    head = head.removeprefix("FUZZYTRACK_INLINE ").replace(f"{made.prefix}_infer", "entry")
    names = ", ".join(part.split()[-1] for part in head.rstrip(")").partition("(")[2].split(", "))
    return f"{head};\n{head}\n{{\n    return {made.prefix}_infer({names});\n}}\n"


def filter_entry(made: CExport) -> str:
    """A program that is a start and a step of a filter."""
    name, number = f"{made.prefix}_filter", made.number
    head = (
        f"int32_t entry({name}_state *track, double time, const {number} plot[2], "
        f"const {number} sigma[2])"
    )
    return (
        f"{head};\n{head}\n{{\n    if (time < 0.0) {{\n        {name}_init(track);\n    }}\n"
        f"    return {name}_step(track, time, plot, sigma);\n}}\n"
    )


def sizes(made: CExport, folder: Path, entry: str) -> tuple[int, int]:
    """Bytes of a program, with what it needs of libraries, and of the stack of its functions."""
    (folder / "entry.c").write_text(f'#include "{made.name}.h"\n{entry}')
    subprocess.run(
        [
            "arm-none-eabi-gcc", *CORE, *WARNINGS, "-Os", "-ffunction-sections", "-fdata-sections",
            "-fstack-usage", "-nostartfiles", "-Wl,--gc-sections", "-Wl,-e,entry", "entry.c",
            "-nostdlib", "-lc", "-lgcc", "-o", "entry.elf",
        ],
        cwd=folder, check=True,
    )  # fmt: skip
    stacks = [int(line.split("\t")[1]) for line in next(folder.glob("*.su")).open()]
    return sum(_sections(folder / "entry.elf")), sum(stacks)


def _sections(program: Path) -> Iterator[int]:
    """Bytes of the sections that are kept in ROM."""
    listed = subprocess.run(
        ["arm-none-eabi-size", "-A", program], capture_output=True, text=True, check=True
    )
    for line in listed.stdout.splitlines():
        words = line.split()
        if words and words[0].startswith((".text", ".rodata", ".data", ".ARM")):
            yield int(words[1])


def error(made: CExport) -> str:
    """Largest error over all outputs."""
    errors = made.figures["errors"].values()
    if made.number == "q15":
        return f"{max(e['largest'] for e in errors):.2f} steps"
    return f"{max(e['ulps'] for e in errors):.0f} ulp"


if __name__ == "__main__":
    sys.exit(main())
