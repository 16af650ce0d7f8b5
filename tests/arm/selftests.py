"""Exported C on an ARM Cortex-M4: self-tests under qemu, and sizes.

Run by ``make arm``. Needs arm-none-eabi-gcc with newlib, and qemu-system-arm (Debian:
gcc-arm-none-eabi, libnewlib-arm-none-eabi, qemu-system-arm). Exit status 1 if a self-test fails.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from fuzzytrack.cli.text_table import table_lines
from fuzzytrack.fuzzy.loading import load_rulebase, shipped_rulebases
from fuzzytrack.interop.c99.export import CExport, export_c
from fuzzytrack.interop.c99.number_types import NUMBERS

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
COLUMNS = ("rule base", "number", "method", "data", "code and data", "stack", "error", "self-test")


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
        print("\n".join(table_lines(list(columns), table, 120, words)) + "\n")
    if given.output:
        parts = (markdown(COLUMNS, rows, 3), markdown(FILTER_COLUMNS, filters, 2))
        given.output.write_text("\n".join(parts), encoding="utf-8")
    return 0 if all(row[-1].endswith(RIGHT) for row in (*rows, *filters)) else 1


def infer_row(made: CExport) -> list[str]:
    """Sizes and self-test of a rule base."""
    with TemporaryDirectory() as folder:
        says = selftest(made, Path(folder))
        code, stack = sizes(made, Path(folder), infer_entry(made))
    method, data = made.figures["method"], str(made.figures["rom_bytes"])
    return [made.name, made.number, method, data, str(code), str(stack), error(made), says]


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
    program = folder / "selftest.elf"
    link = (
        "-nostartfiles", "-T", str(HERE / "board.ld"), "--specs=rdimon.specs",
        "-Wl,--no-warn-rwx-segments",
    )  # fmt: skip
    sources = (str(HERE / "startup.c"), f"{made.name}_selftest.c")
    subprocess.run(
        ["arm-none-eabi-gcc", *CORE, *WARNINGS, "-O2", *sources, *link, "-o", program],
        cwd=folder, check=True,
    )  # fmt: skip
    try:
        done = subprocess.run(
            [*BOARD, program], capture_output=True, text=True, timeout=60, check=False
        )
    except subprocess.TimeoutExpired:
        return "hangs"
    says = done.stdout.strip().partition(": ")[2]
    return says if done.returncode == 0 else f"{says or 'nothing'}, exit status {done.returncode}"


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
