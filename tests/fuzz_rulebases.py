"""Fuzz the rule-base loaders: every text must load, or be refused with a located RuleBaseError.

Run as ``python tests/fuzz_rulebases.py --count 1000000 --seed 1 --jobs 2``; with ``--format fis``
or ``fll`` the readers of these formats. A text is made from the seed and its number alone, so that
any finding can be repeated. None may take more than two seconds of CPU time.
"""

from __future__ import annotations

import argparse
import multiprocessing
import random
import re
import resource
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import yaml

from fuzzytrack import yamltree
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.formats.conversion import WRITERS
from fuzzytrack.fuzzy.formats.fis_reader import loads_fis
from fuzzytrack.fuzzy.formats.fll_reader import loads_fll
from fuzzytrack.fuzzy.loading import (
    load_rulebase,
    loads_rulebase,
    rulebase_path,
    shipped_rulebases,
)
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.saving import dumps_rulebase

CHUNK = 500
SECONDS = 2.0
LOADERS: dict[str, Callable[[bytes, str], RuleBase]] = {
    "yaml": loads_rulebase,
    "fis": loads_fis,
    "fll": loads_fll,
}
ROUND_TRIPS = 20  # one accepted text in so many is also written and read again

META = [b"[", b"]", b"{", b"}", b":", b": ", b"- ", b"#", b" #", b"&a ", b"*a", b"!", b"!!str "]
META += [b"|", b">", b"'", b'"', b"%", b"@", b"`", b",", b"?", b"? ", b"<<: ", b"---\n", b"...\n"]
META += [b"\n", b"\r", b"\t", b"\x00", b"\x1b", b"\x85", b"\xc2\x85", b"\xff", b"\xef\xbb\xbf"]
META += [b"\xe2\x80\xa8", b'"\\x00"', b'"\\UFFFFFFFF"', b"\xed\xa0\x80", b"%YAML 1.9\n", b"~", b"="]
NUMBERS = [b"nan", b".nan", b"inf", b"-.inf", b"1e400", b"-1e308", b"1e-400", b"5e-324", b"1e100"]
NUMBERS += [b"0", b"-0.0", b"100001", b"1000000000", b"9" * 400, b"1_0", b"0x10", b"1e-3", b"1e5"]
NUMBERS += ["١".encode(), b"--1", b"", b"1.5", b"2", b"0.1", b"-1", b"true", b"1:30"]
WORDS = [b"no", b"on", b"null", b"nl", b"Z", b"S-L", b"S-L@0.5", b"S@2", b"@", b"-", b"class"]
WORDS += [b"rulebase", b"inputs", b"if", b"if any", b"then", b"table", b"columns", b"default"]
WORDS += [b"sigmf", b"smf", b"gbellmf", b"singleton", b"pimf", b"gauss2mf", b"midpoints", b"max"]
# Words of the formats of other programs.
META += [b"'", b"%", b"(", b")", b" : ", b",", b"[System]\n", b"[Input1]\n", b"[Rules]\n"]
META += [b"% fuzzytrack grids ", b"# fuzzytrack defaults ", b"Engine:\n", b"RuleBlock:\n"]
WORDS += [b"1.20", b"-1", b"-2.05", b"0", b"99", b"'linear',[1", b"'constant',[2]", b"'probor'"]
WORDS += [b"is", b"not", b"very", b"any", b"and", b"or", b"(", b")", b"with", b"none", b"Function"]
WORDS += [b"Linear", b"Discrete", b"AlgebraicSum", b"WeightedAverage", b"Centroid", b"extremely"]

NUMBER = re.compile(rb"[0-9][0-9.]*")
Mutation = Callable[[random.Random, bytes], bytes]


def spot(rng: random.Random, text: bytes) -> int:
    return rng.randrange(len(text) + 1)


def flip(rng: random.Random, text: bytes) -> bytes:
    changed = bytearray(text)
    for _ in range(rng.randint(1, 4)):
        if changed:
            changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
    return bytes(changed)


def insert(rng: random.Random, text: bytes) -> bytes:
    place = spot(rng, text)
    return text[:place] + rng.choice(META) * rng.choice((1, 1, 1, 2, 30)) + text[place:]


def delete(rng: random.Random, text: bytes) -> bytes:
    start = spot(rng, text)
    return text[:start] + text[start + rng.choice((1, 1, 2, 5, 40, 400)) :]


def repeat(rng: random.Random, text: bytes) -> bytes:
    start = spot(rng, text)
    part = text[start : start + rng.choice((1, 3, 20, 200))]
    return text[:start] + part * rng.choice((2, 3, 20)) + text[start:]


def lines(rng: random.Random, text: bytes) -> bytes:
    rows = text.split(b"\n")
    a, b = rng.randrange(len(rows)), rng.randrange(len(rows))
    act = rng.randrange(4)
    if act == 0:
        rows[a], rows[b] = rows[b], rows[a]
    elif act == 1:
        rows.insert(a, rows[b])
    elif act == 2:
        del rows[a]
    else:
        rows[a] = b" " * rng.randint(0, 9) + rows[a].lstrip()
    return b"\n".join(rows)


def words(rng: random.Random, text: bytes) -> bytes:
    parts = text.split(b" ")
    a, b = rng.randrange(len(parts)), rng.randrange(len(parts))
    if rng.random() < 0.5:
        parts[a], parts[b] = parts[b], parts[a]
    else:
        parts[a] = rng.choice(WORDS) + parts[a][-1:]
    return b" ".join(parts)


def number(rng: random.Random, text: bytes) -> bytes:
    found = NUMBER.search(text, rng.randrange(len(text) + 1))
    if found is None:
        return text
    new = rng.choice(NUMBERS) if rng.random() < 0.6 else b"%.4g" % rng.uniform(-1, 1)
    return text[: found.start()] + new + text[found.end() :]


def nest(rng: random.Random, text: bytes) -> bytes:
    place, depth = spot(rng, text), rng.choice((3, 15, 300, 5000))
    opening, closing = rng.choice(((b"[", b"]"), (b"{a: ", b"}"), (b"- ", b""), (b"? ", b"")))
    inside = text[place : place + 5]
    return text[:place] + opening * depth + inside + closing * depth + text[place + 5 :]


def bomb(rng: random.Random, text: bytes) -> bytes:
    width, levels = rng.choice((2, 9, 40)), rng.choice((2, 5, 20))
    rows = [b"a0: &a0 [1, 2]"]
    for level in range(1, levels):
        inner = b", ".join([b"*a%d" % (level - 1)] * width)
        rows.append(b"a%d: &a%d [%s]" % (level, level, inner))
    return b"\n".join(rows) + b"\n" + text if rng.random() < 0.5 else text + b"\n".join(rows)


def tag(rng: random.Random, text: bytes) -> bytes:
    tags = (b"!!python/object/apply:os.system ", b"!!binary ", b"!x ", b"!<tag:y> ", b"!!set ")
    place = text.find(b": ", spot(rng, text)) + 2
    return text[:place] + rng.choice(tags) + text[place:]


def anchors(rng: random.Random, text: bytes) -> bytes:
    first, second = sorted((spot(rng, text), spot(rng, text)))
    return text[:first] + b"&b " + text[first:second] + b" *b " + text[second:]


def splice(rng: random.Random, text: bytes) -> bytes:
    form = "fis" if b"[System]" in text else "fll" if b"Engine:" in text else "yaml"
    other = rng.choice(sources(form))
    return text[: spot(rng, text)] + other[spot(rng, other) :]


def large(rng: random.Random, text: bytes) -> bytes:
    filler = rng.choice((b"#", b" ", b"\n", b"x", b"[", b"a: 1\n", b"- 1\n", b"x, ", b"\xc3\xa9"))
    place = spot(rng, text)
    size = rng.choice((1_000, 30_000, yamltree.MAX_BYTES)) // len(filler)
    return text[:place] + filler * size + text[place:]


MUTATIONS: list[Mutation] = [flip, insert, delete, repeat, lines, words, number, nest, bomb, tag]
MUTATIONS += [anchors, splice, large]
# Small changes are the ones that reach the checks behind the parser.
WEIGHTS = [3, 3, 3, 1, 4, 6, 8, 0.5, 0.3, 0.3, 0.5, 1, 0.1]
SOURCES = [rulebase_path(name).read_bytes() for name in shipped_rulebases()]


@cache
def sources(form: str) -> list[bytes]:
    """Texts in a format that load: shipped rule bases, and in other formats random ones as well."""
    if form == "yaml":
        return SOURCES
    sys.path.insert(0, str(Path(__file__).resolve().parent / "fuzzy"))
    from random_bases import random_base

    bases = [*map(load_rulebase, shipped_rulebases()), *map(random_base, range(150))]
    texts = []
    for rules in bases:
        try:
            texts.append(WRITERS[f".{form}"](rules).text.encode())
        except RuleBaseError:  # the format lacks something
            continue
    return texts


def mutants(seed: int, start: int, count: int, form: str = "yaml") -> Iterator[bytes]:
    """Texts number `start` to ``start + count``."""
    for index in range(start, start + count):
        rng = random.Random(f"{seed}/{index}")
        text = rng.choice(sources(form))
        for mutation in rng.choices(MUTATIONS, WEIGHTS, k=rng.choice((1, 1, 1, 2, 3, 6))):
            text = mutation(rng, text)
        yield text


@dataclass
class Report:
    """What came of some texts."""

    accepted: int = 0
    refused: int = 0
    slowest: float = 0.0
    slowest_index: int = -1
    peak_kib: int = 0
    failures: list[str] = field(default_factory=list)

    def add(self, other: Report) -> None:
        self.accepted += other.accepted
        self.refused += other.refused
        if other.slowest > self.slowest:
            self.slowest, self.slowest_index = other.slowest, other.slowest_index
        self.peak_kib = max(self.peak_kib, other.peak_kib)
        self.failures += other.failures

    @property
    def total(self) -> int:
        return self.accepted + self.refused + len(self.failures)


def attempt(text: bytes, index: int, report: Report, form: str = "yaml") -> None:
    started = time.process_time()  # others may be using the machine
    rules = None
    try:
        rules = LOADERS[form](text, f"fuzz.{form}")
        report.accepted += 1
    except RuleBaseError as error:
        if error.location is None:
            report.failures.append(f"text {index}: no location: {error}")
        elif "\n" in str(error):
            report.failures.append(f"text {index}: more than one line: {error}")
        else:
            report.refused += 1
    except Exception as error:
        report.failures.append(f"text {index}: {type(error).__name__}: {error}")
    elapsed = time.process_time() - started
    if elapsed > report.slowest:
        report.slowest, report.slowest_index = elapsed, index
    if elapsed > SECONDS:
        report.failures.append(f"text {index}: {elapsed:.2f} s")
    if rules is not None and index % ROUND_TRIPS == 0:
        try:
            if form == "yaml":
                dumps_rulebase(rules)  # reads again what it wrote, and compares
            else:
                write(rules, form)
        except Exception as error:
            report.failures.append(f"text {index}: cannot be written: {error}")


def write(rules: RuleBase, form: str) -> None:
    """Write a rule base in every format that has it, and read what was written in its own."""
    for suffix, writer in WRITERS.items():
        try:
            text = writer(rules).text
        except RuleBaseError:  # the format lacks something
            continue
        if suffix == f".{form}":
            LOADERS[form](text.encode(), "again")


def run(seed: int, start: int, count: int, form: str = "yaml") -> Report:
    """Try texts number `start` to ``start + count``."""
    report = Report()
    for index, text in enumerate(mutants(seed, start, count, form), start):
        attempt(text, index, report, form)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    report.peak_kib = peak // 1024 if sys.platform == "darwin" else peak
    return report


def _chunk(task: tuple[int, int, int, bool, str]) -> Report:
    seed, start, count, pure, form = task
    if pure:
        yamltree._LOADER = yaml.SafeLoader
    warnings.simplefilter("error")
    return run(seed, start, count, form)


def show(done: Report, count: int, started: float, last: bool) -> None:
    elapsed = time.perf_counter() - started
    rate = done.total / elapsed
    left = (count - done.total) / rate if rate else 0.0
    line = (
        f"{done.total:,}/{count:,} texts  {rate:,.0f}/s  {left / 60:.1f} min left  "
        f"{done.accepted:,} accepted  {done.refused:,} refused  {len(done.failures)} failures"
    )
    if sys.stderr.isatty():
        print(f"\r{line}\033[K", end="\n" if last else "", file=sys.stderr, flush=True)
    else:
        print(line, file=sys.stderr, flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=100_000, help="number of texts")
    parser.add_argument("--seed", type=int, default=1, help="which texts")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--first", type=int, default=0, help="number of the first text")
    parser.add_argument("--pure", action="store_true", help="use PyYAML's parser without libyaml")
    parser.add_argument("--format", choices=LOADERS, default="yaml", help="which reader")
    options = parser.parse_args()
    sources(options.format)
    stop = options.first + options.count
    tasks = [
        (options.seed, start, min(CHUNK, stop - start), options.pure, options.format)
        for start in range(options.first, stop, CHUNK)
    ]
    done, started, shown = Report(), time.perf_counter(), 0.0
    pause = 0.5 if sys.stderr.isatty() else 30.0
    with multiprocessing.Pool(options.jobs) as pool:
        for report in pool.imap_unordered(_chunk, tasks):
            done.add(report)
            if time.perf_counter() - shown > pause:
                shown = time.perf_counter()
                show(done, options.count, started, last=False)
    show(done, options.count, started, last=True)
    print(
        f"slowest (CPU) {done.slowest * 1e3:.1f} ms (text {done.slowest_index}), "
        f"peak memory {done.peak_kib / 1024:.0f} MiB a process, "
        f"{done.total / (time.perf_counter() - started):,.0f} texts/s"
    )
    for failure in done.failures[:50]:
        print(failure)
    return 1 if done.failures else 0


if __name__ == "__main__":
    sys.exit(main())
