"""Round trips of rule bases through FIS and FLL: shipped ones, and many random ones.

Run as ``python tests/round_trips.py --count 1000``. Each is written, read and compared at 1,000
points; the largest difference may be 1e-12. `tests/fuzzy/test_conversion.py` tries fewer.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "fuzzy"))

from random_bases import expressible, largest_gap

from fuzzytrack.fuzzy.formats.conversion import translated
from fuzzytrack.fuzzy.formats.fis_reader import loads_fis
from fuzzytrack.fuzzy.formats.fll_reader import loads_fll
from fuzzytrack.fuzzy.loading import load_rulebase, shipped_rulebases

READERS = {".fis": loads_fis, ".fll": loads_fll}
POINTS = 1000
TOLERANCE = 1e-12


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=1000, help="random rule bases of each format")
    count = parser.parse_args().count
    shipped = [load_rulebase(name) for name in shipped_rulebases()]
    worst = 0.0
    for suffix, read in READERS.items():
        bases = [*shipped, *(expressible(seed, suffix) for seed in range(count))]
        gaps = [
            largest_gap(rules, read(translated(rules, f"x{suffix}").text, "x"), POINTS)
            for rules in bases
        ]
        print(
            f"{suffix}: {len(shipped)} shipped and {count} random rule bases, {POINTS} points "
            f"each: largest difference {max(gaps):.1e}"
        )
        worst = max(worst, *gaps)
    return 0 if worst <= TOLERANCE else 1


if __name__ == "__main__":
    sys.exit(main())
