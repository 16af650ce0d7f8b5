"""Fuzz the readers of ASTERIX, AIS and GPX: every file is read, or refused with a DataError.

Run as ``python tests/fuzz_readers.py --count 100000 --seed 1 --jobs 2``: so many files of each
format. A file is made from the seed and its number alone, so that any finding can be repeated. None
may take more than a second of CPU time, and no process more than 300 MB.
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import random
import resource
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial, reduce
from operator import xor
from pathlib import Path

import pyais
from asterix import generated
from fuzz_rulebases import Report, delete, flip, lines, repeat, show, spot

from fuzzytrack.errors import DataError
from fuzzytrack.io.formats import open_table

CHUNK = 250
SECONDS = 1.0
MEGABYTES = 300.0
# Bytes of a file of ASTERIX: three of any bytes may be a record, which takes 0.2 ms to decode.
LONGEST = 8_192

Mutation = Callable[[random.Random, bytes], bytes]


def insert(words: list[bytes], rng: random.Random, text: bytes) -> bytes:
    place = spot(rng, text)
    word = rng.choice(words) if rng.random() < 0.7 else rng.randbytes(rng.choice((1, 2, 3, 40)))
    return text[:place] + word * rng.choice((1, 1, 1, 2, 30)) + text[place:]


def cut(rng: random.Random, text: bytes) -> bytes:
    return text[: spot(rng, text)]


def splice(sources: list[bytes], rng: random.Random, text: bytes) -> bytes:
    other = rng.choice(sources)
    return text[: spot(rng, text)] + other[spot(rng, other) :]


def large(words: list[bytes], sizes: tuple[int, ...], rng: random.Random, text: bytes) -> bytes:
    filler = rng.choice(words) or b"x"
    place = spot(rng, text)
    return (
        text[:place] + filler * (rng.choice((1_000, 30_000, 200_000)) // len(filler)) + text[place:]
    )


# -------------------------------------------------------------------- ASTERIX


def _encoded(category: int, *records: dict[str, object]) -> bytes:
    edition = generated.manifest["CATS"][category][-1]
    made = [edition.cv_record.create(record) for record in records]
    return bytes(edition.create(made).unparse().to_bytes())


SOURCE = {"010": (("SAC", 1), ("SIC", 2))}
PLACE = {"LAT": (45.5, "°"), "LON": (7.25, "°")}
RADAR = {
    **SOURCE,
    "140": (3600.0, "s"),
    "020": ((5, 0, 0, 0, 0, None),),
    "040": (("RHO", (10.0, "NM")), ("THETA", (45.0, "°"))),
    "070": 0o1234,
    "090": 400,
    "130": {"SRL": (10.0, "°"), "SRR": 3},
    "220": 0x4840D6,
    "240": "ABC1234 ",
    "250": [0x1234567890ABCDEF] * 3,
    "161": (0, 17),
    "170": ((0, 0, 0, 0, 0, 0, None),),
}
AIRCRAFT = {
    **SOURCE,
    "040": ((0, 0, 0, 0, None),),
    "131": tuple(PLACE.items()),
    "080": 0xABCDEF,
    "073": (86399.5, "s"),
    "140": (10000.0, "ft"),
    "090": ((0, 0, 1), (0, 0, 10, None)),
    "170": "ABC1234 ",
}
SYSTEM = {
    **SOURCE,
    "070": (12.5, "s"),
    "040": 4711,
    "105": tuple(PLACE.items()),
    "100": (("X", (-1000.5, "m")), ("Y", (2000.0, "m"))),
    "380": {"ADR": 0x4840D6, "ID": "ABC1234 "},
    "500": {"APC": (("X", (20.0, "m")), ("Y", (30.5, "m")))},
}
PUBLISHED = bytes.fromhex("01001AF7C619C9A00EB2767F189408AA42D8033405C8800D400E")
BLOCKS = [
    PUBLISHED,
    _encoded(48, RADAR),
    _encoded(48, *[RADAR] * 5),
    _encoded(21, AIRCRAFT, AIRCRAFT),
    _encoded(62, SYSTEM, SYSTEM),
    b"\x22\x00\x0b\xf0\x01\x02\x02\x03\x00\x00\x0c",
]
MIXED = [b"".join(BLOCKS), BLOCKS[1] * 20, BLOCKS[3] + BLOCKS[4] * 3, PUBLISHED * 5, *BLOCKS]
HEADS = [b"\x30\x00\x08", b"\x30\xff\xff", b"\x3e\x00\x03", b"\x01\x00\x00", b"\xff" * 8]
HEADS += [b"\x30\x01\x00\xff\xff\xff\xff", b"\x00", b"\x15\x10\x00", b"\x22\x00\x04\x00", b"\x30"]


def length(rng: random.Random, data: bytes) -> bytes:
    """Another length of the first block, or of what looks like one."""
    place = rng.choice((0, spot(rng, data)))
    new = rng.choice((0, 3, 4, 0xFFFF, len(data), rng.randrange(300))).to_bytes(4, "big")[2:]
    return data[: place + 1] + new + data[place + 3 :]


# -------------------------------------------------------------------- AIS


def checked(body: bytes) -> bytes:
    return b"%b*%02X" % (body, reduce(xor, body, 0))


def _sentences() -> Iterator[bytes]:
    yield b"!AIVDM,1,1,,B,15NG6V0P01G?cFhE`R2IU?wn28R>,0*05"
    yield b"!AIVDM,2,1,4,A,55O0W7`00001L@gCWGA2uItLth@DqtL5@F22220j1h742t0Ht0000000,0*08"
    yield b"!AIVDM,2,2,4,A,000000000000000,2*20"
    for kind in (1, 2, 3, 18, 19, 27, 4, 5, 21, 24):
        fields = {"type": kind, "mmsi": 244123456, "lat": 37.8, "lon": -122.3}
        yield from (line.encode() for line in pyais.encode_dict(fields))


SENTENCES = list(_sentences())
TIMES = [b"1700000000 ", b"2023-11-14T22:13:20Z ", b"\\" + checked(b"c:1700000000") + b"\\"]
TIMES += [b"\\" + checked(b"g:1-2-7,s:x,c:1700000000") + b"\\", b"\\c:1*00\\"]
LOGS = [b"".join(time + line + b"\r\n" for line in SENTENCES) for time in TIMES]
LOGS += [b"\n".join(SENTENCES)]
MARKS = [b"!", b"$", b"\\", b"*", b",", b"\n", b"\r", b"\x00", b"\xff", b"!AIVDM,", b"!AIVDO,9,1,"]
MARKS += [b"*0", b"*ZZ", b"c:", b"c:99999999999999999999,", b"g:1-2-3", b"~", b"`", b"w" * 70]


def rewritten(rng: random.Random, text: bytes) -> bytes:
    """Sentences of another payload, whose checksums are right, so that they are decoded."""
    rows = text.split(b"\n")
    for index in rng.choices(range(len(rows)), k=rng.choice((1, 3, len(rows)))):
        head, mark, tail = rows[index].partition(b"!")
        cells = tail.partition(b"*")[0].split(b",")
        if not mark or len(cells) < 7:
            continue
        act = rng.randrange(4)
        if act == 0:
            cells[5] = bytes(rng.randrange(48, 120) for _ in range(rng.randrange(90)))
        elif act == 1:
            cells[5] = flip(rng, cells[5])
        elif act == 2:
            cells[5] = cells[5][: rng.randrange(len(cells[5]) + 1)]
        else:
            cells[rng.randrange(1, 7)] = rng.choice((b"", b"0", b"9", b"-1", b"999", b"x", b"2"))
        body = b",".join(cells)
        rows[index] = head + b"!" + checked(body) + b"\r"
    return b"\n".join(rows)


# -------------------------------------------------------------------- GPX

POINT = b'<trkpt lat="45.5" lon="7.25"><ele>1200</ele><time>2024-05-01T10:00:%02dZ</time></trkpt>\n'
POINTS = b"".join(POINT % k for k in range(20))
GPX = [
    b'<?xml version="1.0" encoding="UTF-8"?>\n'
    b'<gpx version="1.1" creator="x" xmlns="http://www.topografix.com/GPX/1/1">\n'
    b"<metadata><name>a</name></metadata>\n<trk><name>one</name>\n<trkseg>\n" + POINTS
    + b"</trkseg>\n</trk>\n<trk><trkseg>" + POINTS + b"</trkseg></trk>\n</gpx>\n",
]  # fmt: skip
GPX += [GPX[0].decode().replace("UTF-8", "UTF-16").encode("utf-16")]
TAGS = [b"<", b">", b"&", b'"', b"/>", b"</trkpt>", b"<trkpt>", b"<trkpt ", b"<!--", b"-->", b"]]>"]
TAGS += [
    b"<![CDATA[",
    b"<?x ?>",
    b"&amp;",
    b"&#0;",
    b"&#x110000;",
    b"&x;",
    b"\x00",
    b"\xff",
    b"<a>",
]
TAGS += [b'<!DOCTYPE gpx [<!ENTITY a "aaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]>', b"<trk>", b"<a>"]
TAGS += [
    b'<?xml version="1.0" encoding="ebcdic-cp-us"?>',
    b"xmlns:a='b' ",
    b"<a:",
    b"nan",
    b"1e400",
]


def nest(rng: random.Random, text: bytes) -> bytes:
    place, depth = spot(rng, text), rng.choice((3, 300, 5_000))
    name = rng.choice((b"trkpt", b"trk", b"a", b"name"))
    return text[:place] + b"<%b>" % name * depth + text[place:]


def entities(rng: random.Random, text: bytes) -> bytes:
    rows = [b'<!ENTITY e0 "aaaaaaaaaa">']
    rows += [b'<!ENTITY e%d "%b">' % (k, b"&e%d;" % (k - 1) * 20) for k in range(1, 12)]
    head, mark, tail = text.partition(b"<gpx")
    return head + b"<!DOCTYPE gpx [%b]>" % b"".join(rows) + mark + tail.replace(b"one", b"&e11;")


# -------------------------------------------------------------------- the formats

ANY: list[tuple[Mutation, float]] = [(flip, 4), (delete, 3), (repeat, 1), (cut, 1)]


def _mutations(
    sources: list[bytes], words: list[bytes], sizes: tuple[int, ...] = (1_000, 30_000, 200_000)
) -> list[tuple[Mutation, float]]:
    several: list[tuple[Mutation, float]] = [
        (partial(insert, words), 3),
        (partial(splice, sources), 1),
        (partial(large, words, sizes), 0.1),
    ]
    return ANY + several


FORMATS: dict[str, tuple[list[bytes], list[tuple[Mutation, float]]]] = {
    "asterix": (MIXED, [*_mutations(MIXED, HEADS, (1_000, 3_000)), (length, 3)]),
    "ais": (LOGS, [*_mutations(LOGS, MARKS), (rewritten, 8), (lines, 2)]),
    "gpx": (GPX, [*_mutations(GPX, TAGS), (nest, 0.3), (entities, 0.3), (lines, 2)]),
}


def mutant(format: str, seed: int, index: int) -> bytes:
    """File number `index` of a format."""
    rng = random.Random(f"{format}/{seed}/{index}")
    sources, mutations = FORMATS[format]
    text = rng.choice(sources)
    kinds, weights = zip(*mutations, strict=True)
    for mutation in rng.choices(kinds, weights, k=rng.choice((1, 1, 1, 2, 3, 6))):
        text = mutation(rng, text)
    return text[:LONGEST] if format == "asterix" else text


def read(file: str, format: str) -> str:
    """Read all columns; what is wrong with them, empty if nothing is."""
    with open_table(file, format=format) as source:
        kinds = {name: "gaps" if t == "number" else "text" for name, t in source.types.items()}
        kinds["time"] = "time"
        if "id" in kinds:
            kinds["id"] = "word"
        for table in source.tables(kinds, 1_000):
            if any(map(math.isinf, table.numbers.get("lat", ()))):
                return "infinite latitude"
        if not all(isinstance(note, str) for note in source.notes):
            return "a note that is no text"
    return ""


def attempt(format: str, data: bytes, file: Path, index: int, report: Report) -> None:
    file.write_bytes(data)
    started = time.process_time()  # others may be using the machine
    wrong = ""
    try:
        wrong = read(str(file), format)
        report.accepted += not wrong
    except DataError:
        report.refused += 1
    except Exception as error:
        wrong = f"{type(error).__name__}: {error}"
    elapsed = time.process_time() - started
    if elapsed > report.slowest:
        report.slowest, report.slowest_index = elapsed, index
    if not wrong and elapsed > SECONDS:
        wrong = f"{elapsed:.2f} s"
    if wrong:
        report.failures.append(f"{format} {index}: {wrong}")


def run(format: str, seed: int, start: int, count: int) -> Report:
    """Try files number `start` to ``start + count``."""
    report = Report()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "fuzz"
        for index in range(start, start + count):
            attempt(format, mutant(format, seed, index), file, index, report)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    report.peak_kib = peak // 1024 if sys.platform == "darwin" else peak
    if report.peak_kib * 1024 > MEGABYTES * 1e6:
        report.failures.append(f"{format} {start}: a process of {report.peak_kib / 1024:.0f} MiB")
    return report


def _chunk(task: tuple[str, int, int, int]) -> Report:
    return run(*task)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=100_000, help="number of files of a format")
    parser.add_argument("--seed", type=int, default=1, help="which files")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--first", type=int, default=0, help="number of the first file")
    parser.add_argument("--format", choices=FORMATS, help="one format only")
    options = parser.parse_args()
    stop = options.first + options.count
    failed = False
    for format in [options.format] if options.format else FORMATS:
        tasks = [
            (format, options.seed, start, min(CHUNK, stop - start))
            for start in range(options.first, stop, CHUNK)
        ]
        done, started, shown = Report(), time.perf_counter(), 0.0
        pause = 0.5 if sys.stderr.isatty() else 30.0
        # A process for each format: what one of them holds is not counted for another.
        with multiprocessing.get_context("spawn").Pool(options.jobs) as pool:
            for report in pool.imap_unordered(_chunk, tasks):
                done.add(report)
                if time.perf_counter() - shown > pause:
                    shown = time.perf_counter()
                    show(done, options.count, started, last=False)
        show(done, options.count, started, last=True)
        print(
            f"{format}: {done.accepted:,} read, {done.refused:,} refused, "
            f"{len(done.failures)} failures; slowest (CPU) {done.slowest * 1e3:.0f} ms "
            f"(file {done.slowest_index}), peak memory {done.peak_kib / 1024:.0f} MiB a process, "
            f"{done.total / (time.perf_counter() - started):,.0f} files/s"
        )
        print(*done.failures[:50], sep="\n", end="\n" if done.failures else "")
        failed |= bool(done.failures)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
