"""Fuzz the reader of CSV: every file is read, or refused with a DataError.

Run as ``python tests/fuzz_files.py --rows 1000000 --seed 1 --jobs 2``: so many rows are changed. A
file is made from the seed and its number alone, so that any finding can be repeated.
One file in ten is also read as large files are, which must give the same tables.
"""

from __future__ import annotations

import argparse
import gzip
import math
import multiprocessing
import os
import random
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from fuzzytrack.errors import DataError
from fuzzytrack.io import csv_blocks, read_tracks
from fuzzytrack.io.formats import open_table
from fuzzytrack.io.text_form import MISSING, TextForm

# Files of a task.
CHUNK = 200
# Limits of a file: CPU seconds, and MiB of the process.
SECONDS, MEBIBYTES = 1.0, 300

NUMBERS = ["0", "-0", "1e308", "-1e308", "1e309", "5e-324", "1e-400", "nan", "inf", "-inf", "1_0"]
NUMBERS += [
    "9" * 400,
    "0." + "0" * 400 + "1",
    "0x1p3",
    "١٢",
    "１",
    "1,5",
    "1.000,5",
    "1'000",
    "--1",
]
NUMBERS += ["9.96921e36", "-99999", "1e5", "+3", ".5", "5.", "1e", "1d5", "1 2", "2**3", "1j"]
CELLS = ["2024-02-30T25:61:61Z", "23:59:60", "2024-01-01", "=1+1", "time", "x", "'", "a;b", "a\tb"]
CELLS += ["\ufeff", "\u200b1", "\u2028", "é", "\U0001f600", "[m]", "#N/A", "# c", "sep=;", "\x85"]
MARKS = [
    b'"',
    b'""',
    b",",
    b";",
    b"\t",
    b"|",
    b" ",
    b"\r",
    b"\r\n",
    b"\n",
    b"\0",
    b"#",
    b"\\",
    b"'",
]
MARKS += [b"\xff", b"\xc3", b"\xed\xa0\x80", b"\xef\xbb\xbf", b"\xff\xfe", b"\x1f\x8b", b"\x1a"]
NAMES = ["time,id,x,y", "t,x", "Time (s),track,X [m],Y [m]", "t_ms,x_m,y_m,z_m", "time,id,x,y,"]
NAMES += ["date,time,latitude,longitude", "t,range,azimuth", '"time","x","y"', "# time,x,y", ""]

Mutation = Callable[[random.Random, bytes], bytes]


# -------------------------------------------------------------------- rows


def flip(rng: random.Random, row: bytes) -> bytes:
    changed = bytearray(row)
    for _ in range(rng.randint(1, 3)):
        if changed:
            changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
    return bytes(changed)


def mark(rng: random.Random, row: bytes) -> bytes:
    place = rng.randrange(len(row) + 1)
    return row[:place] + rng.choice(MARKS) * rng.choice((1, 1, 1, 2, 20)) + row[place:]


def delete(rng: random.Random, row: bytes) -> bytes:
    place = rng.randrange(len(row) + 1)
    return row[:place] + row[place + rng.choice((1, 1, 3, 30)) :]


def cell(rng: random.Random, row: bytes) -> bytes:
    cells = row.split(b",")
    new = rng.choice((*NUMBERS, *CELLS, *MISSING)).encode()
    cells[rng.randrange(len(cells))] = b'"%s"' % new if rng.random() < 0.3 else new
    return b",".join(cells)


def swap(rng: random.Random, row: bytes) -> bytes:
    cells = row.split(b",")
    rng.shuffle(cells)
    return b",".join(cells[: rng.choice((len(cells), rng.randint(0, len(cells))))])


def extreme(rng: random.Random, row: bytes) -> bytes:
    cells = row.split(b",")
    exponent = rng.choice((rng.uniform(-330, 330), rng.uniform(-3, 12)))
    text = f"{rng.uniform(-9.9, 9.9):.{rng.choice((0, 3, 17))}f}e{exponent:.0f}"
    with suppress(OverflowError):
        text = rng.choice((text, repr(float(text)), f"{float(text):.3f}"))
    cells[rng.randrange(len(cells))] = text.encode()
    return b",".join(cells)


def huge(rng: random.Random, row: bytes) -> bytes:
    place = rng.randrange(len(row) + 1)
    filler = rng.choice((b"1", b",", b'"', b" ", b"\r", b"x", b"\xc3\xa9", b'",', b"\n", b"#\n"))
    # Each of many empty lines takes a microsecond.
    most = 2_000_000 if filler not in (b"\r", b"\n", b"#\n") else 400_000
    return row[:place] + filler * rng.choice((300, 40_000, 140_000, most)) + row[place:]


def again(rng: random.Random, row: bytes) -> bytes:
    return rng.choice((row + b"\n" + row, b"", b",,,", rng.choice(NAMES).encode(), b"[s],[m],[m]"))


ROWS: list[Mutation] = [flip, mark, delete, cell, swap, extreme, huge, again]
ROW_WEIGHTS = [4, 4, 2, 8, 1, 5, 0.004, 0.5]


# -------------------------------------------------------------------- files


def other_marks(rng: random.Random, text: bytes) -> bytes:
    text = text.replace(b",", rng.choice((b";", b"\t", b"|", b" ", b", ")))
    return text.replace(b".", b",") if rng.random() < 0.5 else text


def other_ends(rng: random.Random, text: bytes) -> bytes:
    return text.replace(b"\n", rng.choice((b"\r\n", b"\r", b"\n\n", b" \n", b"")))


def other_encoding(rng: random.Random, text: bytes) -> bytes:
    encoding = rng.choice(("utf-16", "utf-16-le", "utf-16-be", "utf-32", "utf-8-sig", "latin-1"))
    return text.decode("utf-8", "replace").encode(encoding, "replace")


_ROWS = b"1,2,3\n" * 100_000


def packed(rng: random.Random, text: bytes) -> bytes:
    if rng.random() < 0.02:
        # Rows that can be read are fewer: ten million of them are a recording, and take their time.
        text += rng.choice((b"0" * 10_000_000, b"," * 10_000_000, b"\n" * 10_000_000, _ROWS))
    return gzip.compress(text, 1)


def cut(rng: random.Random, text: bytes) -> bytes:
    return text[: rng.randrange(len(text) + 1)]


def shaken(rng: random.Random, text: bytes) -> bytes:
    rows = text.split(b"\n")
    rng.shuffle(rows)
    return b"\n".join(rows)


FILES: list[Mutation] = [other_marks, other_ends, other_encoding, packed, cut, flip, shaken]
FILE_WEIGHTS = [4, 3, 3, 1, 1, 1, 1]


def plain_row(rng: random.Random, names: str, k: int) -> bytes:
    width = names.count(",") + 1
    values = [f"{k * 0.5:g}", *(f"{rng.gauss(0, 1e3):.2f}" for _ in range(width - 1))]
    return ",".join(values).encode()


def mutant(seed: int, index: int) -> tuple[bytes, int]:
    """A file, and how many of its rows have been changed."""
    rng = random.Random(f"{seed}/{index}")
    names = rng.choice(NAMES)
    rows = [plain_row(rng, names, k) for k in range(rng.choice((1, 5, 20, 60)))]
    share = rng.choice((0.05, 0.5, 1.0))
    changed = 0
    for k, row in enumerate(rows):
        if rng.random() < share or k == 0:
            (change,) = rng.choices(ROWS, ROW_WEIGHTS)
            rows[k] = change(rng, row)
            changed += 1
    head = names.encode()
    text = b"\n".join([mark(rng, head) if rng.random() < 0.1 else head, *rows, b""])
    if rng.random() < 0.3:
        (change,) = rng.choices(FILES, FILE_WEIGHTS)
        text, changed = change(rng, text), len(rows)
    return text, changed


def form_of(rng: random.Random) -> TextForm:
    if rng.random() < 0.6:
        return TextForm()
    return TextForm(
        delimiter=rng.choice((None, ",", ";", "\t", "|", " ")),
        decimal=rng.choice((None, ".", ",")),
        na=rng.choice(((), ("-99999",), ("x", "1e308"))),
        comment=rng.choice(("#", "", "//")),
        columns=rng.choice((None, None, ("time", "x"), ("time", "id", "x", "y"))),
    )


# -------------------------------------------------------------------- trying


@dataclass
class Report:
    """What came of some files."""

    rows: int = 0
    files: int = 0
    accepted: int = 0
    slowest: float = 0.0
    slowest_index: int = -1
    peak: float = 0.0
    failures: list[str] = field(default_factory=list)

    def add(self, other: Report) -> None:
        self.rows += other.rows
        self.files += other.files
        self.accepted += other.accepted
        if other.slowest > self.slowest:
            self.slowest, self.slowest_index = other.slowest, other.slowest_index
        self.peak = max(self.peak, other.peak)
        self.failures += other.failures


# Peaks of this process that have been reported.
_PEAKS = [0.0]


def tables(path: str, form: TextForm) -> list[object]:
    """All that a file holds, in a form that can be compared; raises a DataError."""
    found: list[object] = []
    with open_table(path, form) as source:
        names = [name for name in source.types if name]
        kinds = dict.fromkeys(names, "gaps")
        if names:
            kinds[names[0]] = "time"
        if len(names) > 2:
            kinds[names[1]] = "word"
        for table in source.tables(kinds, 16):
            found.append(
                (
                    table.rows.tolist(),
                    {name: values.tobytes() for name, values in table.numbers.items()},
                    {name: list(words) for name, words in table.words.items()},
                    {name: list(cells) for name, cells in table.cells.items()},
                )
            )
        found.append(sorted(source.notes))
    return found


def outcome(path: str, form: TextForm) -> object:
    try:
        return tables(path, form)
    except DataError as error:
        # Bytes that are not UTF-8 are found earlier or later, as they are decoded.
        return "UTF" if "UTF" in str(error) else str(error)


def attempt(path: str, seed: int, index: int, report: Report) -> None:
    text, changed = mutant(seed, index)
    Path(path).write_bytes(text)
    form = form_of(random.Random(f"form {seed}/{index}"))
    started = time.process_time()  # others may be using the machine
    try:
        found = outcome(path, form)
        report.accepted += not isinstance(found, str)
        with suppress(DataError):
            read_tracks(path)
    except Exception as error:
        report.failures.append(f"file {index}: {type(error).__name__}: {error}")
        return
    finally:
        elapsed = time.process_time() - started
        report.rows += changed
        report.files += 1
    if elapsed > report.slowest:
        report.slowest, report.slowest_index = elapsed, index
    if elapsed > SECONDS:
        report.failures.append(f"file {index}: {elapsed:.2f} s")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    if peak > max(_PEAKS[-1], MEBIBYTES):
        report.failures.append(f"file {index}: {peak:.0f} MiB")
        _PEAKS.append(peak)
    report.peak = max(report.peak, peak)
    if index % 10 == 0 and len(text) < 100_000:
        large, block = csv_blocks.LARGE, csv_blocks.BLOCK
        csv_blocks.LARGE, csv_blocks.BLOCK = 0, 256
        try:
            if (other := outcome(path, form)) != found:
                report.failures.append(
                    f"file {index}: by blocks {other!r:.300}, not {found!r:.300}"
                )
        except Exception as error:
            report.failures.append(f"file {index}: by blocks {type(error).__name__}: {error}")
        finally:
            csv_blocks.LARGE, csv_blocks.BLOCK = large, block


def run(task: tuple[int, int, int]) -> Report:
    """Try files number `first` to ``first + count``."""
    seed, first, count = task
    report = Report()
    with tempfile.TemporaryDirectory(dir=_memory()) as folder:
        for index in range(first, first + count):
            attempt(os.path.join(folder, "f.csv"), seed, index, report)
    return report


def _memory() -> str | None:
    return "/dev/shm" if os.path.isdir("/dev/shm") else None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=int, default=1_000_000, help="number of changed rows")
    parser.add_argument("--seed", type=int, default=1, help="which files")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--first", type=int, default=0, help="number of the first file")
    options = parser.parse_args()
    done, started, shown = Report(), time.perf_counter(), 0.0
    tasks = (
        (options.seed, first, CHUNK)
        for first in range(options.first, options.first + options.rows, CHUNK)
    )
    with multiprocessing.Pool(options.jobs) as pool:
        for report in pool.imap_unordered(run, tasks):
            done.add(report)
            for failure in report.failures:
                print(failure, file=sys.stderr, flush=True)
            if done.rows >= options.rows:
                break
            if time.perf_counter() - shown > 30.0:
                shown = time.perf_counter()
                print(_line(done, started), file=sys.stderr, flush=True)
        pool.terminate()
    print(_line(done, started))
    print(
        f"slowest (CPU) {done.slowest * 1e3:.0f} ms (file {done.slowest_index}), "
        f"peak memory {done.peak:.0f} MiB a process"
    )
    return 1 if done.failures else 0


def _line(done: Report, started: float) -> str:
    rate = done.rows / max(time.perf_counter() - started, math.ulp(1.0))
    return (
        f"{done.rows:,} changed rows in {done.files:,} files  {rate:,.0f} rows/s  "
        f"{done.accepted:,} files accepted  {len(done.failures)} failures"
    )


if __name__ == "__main__":
    sys.exit(main())
