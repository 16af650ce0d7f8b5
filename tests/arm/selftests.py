"""Exported C on an ARM Cortex-M4: self-tests under qemu, and sizes.

Run by ``make arm``. Needs arm-none-eabi-gcc with newlib, and qemu-system-arm (Debian:
gcc-arm-none-eabi, libnewlib-arm-none-eabi, qemu-system-arm). Exit status 1 if a self-test fails.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from fuzzytrack.cli.text_table import table_lines
from fuzzytrack.fuzzy.loading import shipped_rulebases
from fuzzytrack.interop.c99.export import CExport, export_c
from fuzzytrack.interop.c99.number_types import NUMBERS

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
    rows, wrong = [], False
    for name in given.names:
        for number in NUMBERS:
            made = export_c(name, number=number, random=given.random)
            with TemporaryDirectory() as folder:
                passed, says = selftest(made, Path(folder))
                code, stack = sizes(made, Path(folder))
            wrong = wrong or not passed
            rows.append(
                [
                    name, number, made.figures["method"], str(made.figures["rom_bytes"]),
                    str(code), str(stack), error(made), says,
                ]
            )  # fmt: skip
            print(f"{name} {number}: {says}", file=sys.stderr)
    text = "\n".join(line.rstrip() for line in table_lines(list(COLUMNS), rows, 120, 3)) + "\n"
    print(text, end="")
    if given.output:
        given.output.write_text(markdown(rows), encoding="utf-8")
    return 1 if wrong else 0


def markdown(rows: list[list[str]]) -> str:
    """The table for a page of the documentation, without what the self-tests say."""
    lines = [COLUMNS[:-1], ("---",) * 3 + ("--:",) * 4, *(row[:-1] for row in rows)]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def selftest(made: CExport, folder: Path) -> tuple[bool, str]:
    """Whether the self-test passes under qemu, and what it says of its values."""
    made.write(folder)
    program = folder / "selftest.elf"
    link = (
        "-nostartfiles",
        "-T",
        str(HERE / "board.ld"),
        "--specs=rdimon.specs",
        "-Wl,--no-warn-rwx-segments",
    )
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
        return False, "hangs"
    says = done.stdout.strip().partition(": ")[2]
    return done.returncode == 0, says or f"exit status {done.returncode}"


def sizes(made: CExport, folder: Path) -> tuple[int, int]:
    """Bytes of a program that is one call, with what it needs of libraries, and of its stack."""
    head = next(line for line in made.header.splitlines() if f" {made.prefix}_infer(" in line)
    head = head.removeprefix("FUZZYTRACK_INLINE ").replace(f"{made.prefix}_infer", "entry")
    names = ", ".join(part.split()[-1] for part in head.rstrip(")").partition("(")[2].split(", "))
    (folder / "entry.c").write_text(
        f'#include "{made.name}.h"\n{head};\n{head}\n{{\n'
        f"    return {made.prefix}_infer({names});\n}}\n"
    )
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
