"""The engine against the systems and expected answers that pyfuzzylite carries.

pyfuzzylite is under the GPL and no part of this package: install it by hand with
``pip install --no-deps pyfuzzylite``. Its files are read where they lie; its code is not run.
"""

from functools import cache
from importlib.util import find_spec
from pathlib import Path

import pytest
from fll import referee

TOLERANCE = 1e-6
DOCUMENT = Path(__file__).parents[2] / "docs" / "referee.md"

SPEC = find_spec("fuzzylite")
if SPEC is None or not SPEC.submodule_search_locations:
    pytest.skip(
        "pyfuzzylite is not installed (pip install --no-deps pyfuzzylite)", allow_module_level=True
    )
ROOT = Path(SPEC.submodule_search_locations[0]) / "examples"
FILES = {p.relative_to(ROOT).with_suffix("").as_posix(): p for p in sorted(ROOT.rglob("*.fll"))}
if not FILES:
    pytest.skip("this pyfuzzylite carries no examples", allow_module_level=True)

# Systems that are not compared, and what they need.
UNSUPPORTED = {
    "hybrid/tipper": "disjunction AlgebraicSum",
    "mamdani/octave/investment_portfolio": "hedge 'extremely'",
    "mamdani/octave/mamdani_tip_calculator": "aggregation AlgebraicSum",
    "takagi_sugeno/approximation": "locks its previous value",
    "takagi_sugeno/octave/sugeno_tip_calculator": "hedge 'extremely'",
    "tsukamoto/tsukamoto": "Tsukamoto",
}
# Systems whose answers differ, and by how much at the most.
DIFFERENT = {"terms/discrete": 1e-4}


@cache
def result(name):
    return referee(FILES[name], ROOT)


@pytest.mark.parametrize("name", FILES)
def test_system(name):
    outcome = result(name)
    assert outcome.rows > 100
    if name in UNSUPPORTED:
        assert UNSUPPORTED[name] in outcome.reason
    elif name in DIFFERENT:
        assert not outcome.reason
        assert TOLERANCE < outcome.error < DIFFERENT[name]
    else:
        assert not outcome.reason
        assert outcome.error <= TOLERANCE


def test_most_of_the_systems_match():
    results = [result(name) for name in FILES]
    rest = [r for r in results if not r.error <= TOLERANCE]
    for r in rest:
        why = r.reason or f"differs by up to {r.error:.1e}"
        print(f"{r.name:45} {why}")
    print(f"{len(results) - len(rest)} of {len(results)} match to {TOLERANCE:g}")
    assert len(results) - len(rest) >= 40


def test_the_document_lists_the_rest():
    text = DOCUMENT.read_text(encoding="utf-8")
    rest = {name for name in FILES if not result(name).error <= TOLERANCE}
    listed = {name for name in FILES if f"`{name}`" in text}
    assert listed == rest
    assert f"{len(FILES) - len(rest)} of {len(FILES)}" in text


def test_the_comparison_can_fail(tmp_path):
    path = FILES["mamdani/matlab/tipper"]
    rule = "if service is good then tip is average"
    text = path.read_text(encoding="utf-8")
    assert rule in text
    changed = tmp_path / "changed.fll"
    changed.with_suffix(".fld").write_bytes(path.with_suffix(".fld").read_bytes())
    changed.write_text(text, encoding="utf-8")
    assert referee(changed, tmp_path).error <= TOLERANCE
    changed.write_text(text.replace(rule, rule.replace("average", "generous")), encoding="utf-8")
    assert referee(changed, tmp_path).error > 1.0
    changed.write_text(text.replace("is good then", "is very good then"), encoding="utf-8")
    assert referee(changed, tmp_path).reason == "hedge 'very'"
