"""Exported files: compiled with every warning, run, and read."""

import json
import re
import shutil
import subprocess

import numpy as np
import pytest
from c99_bases import COMPILERS, WARNINGS, built, partition_base
from test_conformance import TRACKERS
from typer.testing import CliRunner

import fuzzytrack as ft
from fuzzytrack.cli.app import app
from fuzzytrack.fuzzy.loading import rulebase_path, shipped_rulebases
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.interop.c99.export import export_c
from fuzzytrack.interop.c99.number_types import NUMBERS

compiled = pytest.mark.skipif(not COMPILERS, reason="needs gcc or clang")


def comment_of(made):
    """The comment of a header in one line."""
    return " ".join(made.header.partition("*/")[0].replace("\n *", " ").split())


def run(folder, program, compiler, *options):
    command = [compiler, *WARNINGS, *options, program, "-o", "selftest"]
    subprocess.run(command, cwd=folder, check=True)
    return subprocess.run([folder / "selftest"], capture_output=True, text=True, check=False)


@compiled
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("number", NUMBERS)
def test_self_tests_pass_without_a_warning(number, compiler, tmp_path):
    names = shipped_rulebases() if compiler == COMPILERS[0] else ("stiffness-damping", "tipper")
    for name in names:
        made = export_c(name, number=number, table=True, random=1_000)
        made.write(tmp_path)
        done = run(tmp_path, f"{name}_selftest.c", compiler, "-O1")
        assert (done.returncode, done.stderr) == (0, ""), done.stdout
        assert re.fullmatch(rf"{name}: \d+ values are right\n", done.stdout)


@compiled
@pytest.mark.parametrize("number", NUMBERS)
def test_self_tests_pass_under_sanitizers(number, tmp_path):
    for name in ("stiffness-damping", "valve-confidence"):
        export_c(name, number=number, random=2_000).write(tmp_path)
        options = ("-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
        done = run(tmp_path, f"{name}_selftest.c", COMPILERS[0], *options)
        assert (done.returncode, done.stderr) == (0, ""), done.stdout


@compiled
@pytest.mark.parametrize(
    ("number", "right", "wrong"), [("float", "0.35f", "0.34f"), ("q15", "65535U", "65000U")]
)
def test_a_self_test_finds_a_wrong_number(number, right, wrong, tmp_path):
    made = export_c("stiffness-damping", number=number, random=100)
    made.write(tmp_path)
    (tmp_path / "stiffness-damping.h").write_text(made.header.replace(right, wrong, 1))
    done = run(tmp_path, "stiffness-damping_selftest.c", COMPILERS[0])
    assert done.returncode == 1
    assert re.fullmatch(r"stiffness-damping: \d+ values are wrong\n", done.stdout)


@compiled
@pytest.mark.parametrize("number", ["double", "float"])
@pytest.mark.parametrize("name", ["stiffness-damping", "valve-confidence"])
def test_nan_and_numbers_beyond_the_ends_are_as_in_the_library(name, number, tmp_path):
    system = ft.FuzzySystem(name)
    n = len(system.rules.inputs)
    some = [np.nan, np.inf, -np.inf, -7.0, 50.0, 0.2, -0.0, 1e-45]
    rows = np.stack([a.ravel() for a in np.meshgrid(*[some] * n)], axis=1)
    rows = rows.astype(np.float32 if number == "float" else float)
    found = built(export_c(name, number=number, random=100), tmp_path)(rows)
    expected = np.stack(list(system.evaluate(rows.astype(float)).values()), axis=1)
    np.testing.assert_allclose(found, expected, rtol=5e-7)


@compiled
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("number", ["double", "float"])
def test_formulas_are_within_four_units_in_the_last_place(number, compiler, tmp_path):
    made = export_c("tipper", number=number, random=500)
    assert made.figures["method"] == "formulas"
    made.write(tmp_path)
    assert run(tmp_path, "tipper_selftest.c", compiler).returncode == 0
    random = np.random.default_rng(2)
    dtype = np.float32 if number == "float" else np.float64
    rows = random.uniform(-1, 11, (10_000, 2)).astype(dtype)
    rows[:5] = [[np.nan, 1], [1, np.nan], [np.inf, 3], [-np.inf, 3], [0, 10]]
    found = built(made, tmp_path, compiler)(rows)[:, 0]
    expected = ft.FuzzySystem("tipper").evaluate(rows.astype(float))["tip"]
    assert np.isnan(found[:2]).all()
    np.testing.assert_array_max_ulp(
        found[2:], expected.astype(dtype)[2:], 4 if number == "float" else 64
    )


def test_what_has_no_formulas_needs_a_table():
    rules = ft.load_rulebase("tipper")
    middle = type(rules.operators)("min", "max", "bisector")
    other = type(rules)("tipper", rules.inputs, rules.outputs, rules.rules, middle)
    with pytest.raises(ValueError, match="table: tipper has defuzzification bisector, for which"):
        export_c(other, random=10)
    assert export_c(other, table=True, nodes=9, random=10).figures["nodes"] == [9, 13]
    with pytest.raises(ValueError, match=r"nodes: tipper is written as formulas; `table` writes"):
        export_c("tipper", nodes=9)


@pytest.mark.parametrize("compiler", [name for name in ("g++", "clang++") if shutil.which(name)])
def test_headers_in_a_program_of_cpp(compiler, tmp_path):
    export_c("stiffness-damping", number="float", filter=True, random=100).write(tmp_path)
    made = export_c("maneuver", filter=True, axes=1, random=100)
    assert "_step: 1 axis, plots in m" in made.header
    assert re.search(r"Error bound +position 1e-09 m, velocity 1e-09 m/s", made.header)
    made.write(tmp_path)
    export_c("valve", number="q15", random=100).write(tmp_path)
    (tmp_path / "all.cpp").write_text(
        '#include "stiffness-damping.h"\n#include "maneuver.h"\n#include "valve.h"\n'
        "int main()\n{\n    maneuver_filter_state track;\n    maneuver_filter_init(&track);\n"
        "    const double plot[1] = { 3.0 }, sigma[1] = { 1.0 };\n"
        "    const int status = maneuver_filter_step(&track, 0.0, plot, sigma);\n"
        "    const bool right = track.position[0] == 3.0 && valve_infer(0).opening < 32767;\n"
        "    return right ? status : 1;\n"
        "}\n"
    )
    # Compound literals are an extension of these compilers.
    command = [compiler, "-std=c++17", "-Wall", "-Wextra", "-Wno-c99-extensions", "-Werror"]
    subprocess.run([*command, "all.cpp", "-o", "all"], cwd=tmp_path, check=True)
    assert subprocess.run([tmp_path / "all"], check=False).returncode == 0


@compiled
def test_names_that_are_no_identifiers(tmp_path):
    base = partition_base()
    words = {"a": "double", "b": "k"}
    inputs = tuple(Variable(words[v.name], v.universe, v.sets, label="*/ ??/") for v in base.inputs)
    rules = tuple(
        type(r)(tuple((words[n], s) for n, s in r.conditions), r.consequents) for r in base.rules
    )
    odd = type(base)(
        '2 "Regler" \\ */ für \n#error', inputs, base.outputs, rules, base.operators,
        description="a\\",
    )  # fmt: skip
    for number in NUMBERS:
        made = export_c(odd, number=number, random=100)
        assert made.prefix == "rules_2_Regler_fur_error"
        made.write(tmp_path)
        done = run(tmp_path, f"{made.name}_selftest.c", COMPILERS[0])
        assert (done.returncode, done.stdout.count("\n")) == (0, 1)


@compiled
@pytest.mark.parametrize(
    ("name", "file", "prefix"),
    [("double", "double.h", "double"), ("M", "M.h", "rules_M"),
     ("math", "math_rules.h", "math_rules"),
     ("time_t", "time_t.h", "time_t"), ("a" * 30 + " bc", "a" * 30 + ".h", "a" * 30)],
)  # fmt: skip
def test_names_that_mean_something_in_c(name, file, prefix, tmp_path):
    made = export_c("omega-schedule", number="float", filter=True, name=name, random=100)
    assert (next(iter(made.files)), made.prefix) == (file, prefix)
    made.write(tmp_path)
    assert "__" not in re.sub(r"__(cplusplus|clang|GNUC)_*|#.*", "", made.header)
    assert run(tmp_path, f"{made.name}_selftest.c", COMPILERS[0], "-I.").returncode == 0


@compiled
def test_two_headers_in_one_program(tmp_path):
    for name, number in (("stiffness-damping", "float"), ("valve", "q15")):
        export_c(name, number=number, random=100).write(tmp_path)
    (tmp_path / "both.c").write_text(
        '#include "stiffness-damping.h"\n#include "valve.h"\n#include "valve.h"\n'
        "int main(void)\n{\n    const float s = stiffness_damping_infer(0.0f, 0.0f).stiffness;\n"
        "    return ((s > 0.0f) && (valve_infer(0).opening < 32767)) ? 0 : 1;\n}\n"
    )
    assert run(tmp_path, "both.c", COMPILERS[0]).returncode == 0


def test_the_same_rule_base_gives_the_same_bytes(tmp_path):
    one, other = (export_c("valve", number="float", random=500) for _ in range(2))
    assert one.files == other.files
    copy = tmp_path / "valve.yaml"
    copy.write_bytes(rulebase_path("valve").read_bytes())
    assert export_c(copy, number="float", random=500).files == one.files


def test_files_of_other_programs_are_exported(tmp_path):
    file = tmp_path / "mine.fis"
    convert = ["rulebase", "convert", "tipper", str(file)]
    assert CliRunner().invoke(app, convert).exit_code == 0
    made = export_c(file, random=100)
    assert list(made.files) == ["mine.h", "mine_selftest.c"]
    assert "mine.fis, SHA-256" in made.header


def test_a_rule_base_that_was_made_in_python():
    rules = ft.load_rulebase("valve")
    made = export_c(rules, random=100, name="my valve")
    assert list(made.files) == ["my_valve.h", "my_valve_selftest.c"]
    assert "valve as JSON, SHA-256" in made.header
    assert repr(made).startswith('<CExport: name="my_valve", number="double"')


def test_the_comment_states_what_the_figures_state():
    made = export_c("stiffness-damping", number="float", random=1_000)
    comment = made.header.partition("*/")[0]
    assert "Input         E: normalized error, -1 to 1" in comment
    assert f"{made.figures['rom_bytes']} bytes of constants" in comment
    assert f"{made.figures['operations']['additions']} additions" in comment
    assert f"1,000 random inputs and {made.figures['vectors']} break" in comment
    bound = made.figures["errors"]["stiffness"]["bound"]
    assert f"stiffness {bound:.3g}" in comment
    q15 = export_c("stiffness-damping", number="q15", random=100).header
    assert "stiffness: 0.25 to 0.35; value = 0.3 + stiffness * 1.52587890625e-06" in q15


def test_no_double_literal_is_in_float_code():
    for name in ("stiffness-damping", "valve-confidence"):
        header = export_c(name, number="float", random=100).header
        code = re.sub(r"/\*.*?\*/", "", header, flags=re.DOTALL)
        assert not re.findall(r"\d\.\d+(e[-+]\d+)?(?![\df.e])", code)
        assert "double" not in code


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"number": "q7"}, r"number: unknown 'q7'; one of double, float, q15"),
        ({"random": 0}, r"random: at least 1 input is needed, got 0"),
        ({"nodes": 9}, r"nodes: valve is tabulated at the break points of its sets, which is"),
    ],
)
def test_what_cannot_be_exported_is_refused(options, message):
    with pytest.raises(ValueError, match=message):
        export_c("valve", **options)


# -------------------------------------------------------------------- filters


@compiled
@pytest.mark.parametrize("name", ["stiffness-damping", "maneuver", "omega-schedule"])
def test_a_filter_passes_its_self_test(name, tmp_path):
    made = export_c(name, filter=True, random=100)
    assert made.figures["filter"]["axes"] == 2
    assert made.figures["filter"]["errors_met"] is None
    assert made.figures["filter"]["errors_allowed"] == {"position": 1e-9, "velocity": 1e-9}
    made.write(tmp_path)
    for compiler in COMPILERS:
        done = run(tmp_path, f"{name}_selftest.c", compiler)
        assert (done.returncode, done.stderr) == (0, ""), done.stdout


@pytest.mark.untraced
def test_a_filter_in_which_roundings_grow_is_warned_of():
    # Its gains do not suit irregular times either, which says nothing of a user's tracks.
    with pytest.warns() as warned:
        made = export_c("stiffness-damping-wide", number="float", filter=True, random=100)
    assert [each.category for each in warned] == [ft.PrecisionWarning]
    assert re.match(r"in float this filter erred by [\d.]+ m in a trial", str(warned[0].message))
    figures = made.figures["filter"]
    assert figures["errors_met"]["position"] > 0.1
    # It is not single precision that makes them grow.
    tracker = ft.AlphaBetaTracker("stiffness-damping-wide")
    times = np.arange(1.0, 101.0)
    random = np.random.default_rng(3)
    plots = random.normal(30.0 * times[:, None, None], 10.0, (100, 300, 2))
    changed = plots + random.uniform(-1e-9, 1e-9, plots.shape)
    apart = np.abs(tracker.run(times, plots).filtered - tracker.run(times, changed).filtered)
    assert apart.max() > 1e-7
    assert figures["growth"] > 1e4


@compiled
@pytest.mark.untraced
def test_a_filter_of_floats_is_within_its_stated_error(tmp_path):
    made = export_c("chan-style", number="float", filter=True, axes=3, random=100)
    met, allowed = (made.figures["filter"][f"errors_{word}"] for word in ("met", "allowed"))
    assert 1e-4 < met["position"] < 0.02
    assert allowed == {word: 4.0 * error for word, error in met.items()}
    comment = comment_of(made)
    stated = re.search(
        r"Error met position (\S+) m, velocity \S+ m/s. THIS IS NOT A BOUND", comment
    )
    assert met["position"] <= float(stated[1]) < 2.0 * met["position"]
    growth = float(re.search(r"became up to ([\d,]+) times as large", comment)[1].replace(",", ""))
    assert made.figures["filter"]["growth"] <= growth < 2.0 * made.figures["filter"]["growth"]
    made.write(tmp_path)
    done = run(tmp_path, "chan-style_selftest.c", COMPILERS[0])
    assert (done.returncode, done.stderr) == (0, ""), done.stdout


@compiled
@pytest.mark.untraced
@pytest.mark.parametrize("compiler", COMPILERS)
def test_a_step_that_floats_cannot_calculate_is_in_double_inside(compiler, tmp_path):
    tracker = TRACKERS["imm"]
    made = export_c(tracker, number="float")
    figures = made.figures["filter"]
    assert (figures["inside"], figures["needs"]) == ("double", [])
    # One rounding of 2 km, and noise.
    assert figures["errors_met"]["position"] < 2.0**-12
    assert "It calculates in double, and rounds results." in comment_of(made)
    made.write(tmp_path)
    done = run(tmp_path, f"{made.name}_selftest.c", compiler, "-O1")
    assert (done.returncode, done.stderr) == (0, ""), done.stdout


@compiled
@pytest.mark.parametrize(
    "subject",
    [ft.FixedGains(0.5, 0.2), ft.AlphaBetaTracker("kalman-cv:sigma_v=0.5", start="one-point")],
)
def test_any_scheduler_or_tracker_is_exported_as_a_filter(subject, tmp_path):
    made = export_c(subject, axes=1)
    assert made.name == type(subject).__name__
    made.write(tmp_path)
    done = run(tmp_path, f"{made.name}_selftest.c", COMPILERS[0])
    assert (done.returncode, done.stdout.count("\n")) == (0, 1)
    # A filter that is wrong is found.
    broken = re.sub(r"\+ (?=\(b\[)", "- ", made.header)
    assert broken != made.header
    (tmp_path / f"{made.name}.h").write_text(broken)
    assert run(tmp_path, f"{made.name}_selftest.c", COMPILERS[0]).returncode == 1


@pytest.mark.parametrize(
    ("subject", "options", "message"),
    [
        ("valve", {"filter": True}, "valve cannot schedule gains: no scheduler setting"),
        ("stiffness-damping", {"filter": True, "number": "q15"}, "filter: there is none in integ"),
        ("stiffness-damping", {"filter": True, "axes": 0}, "axes must be a whole number from 1 to"),
        (ft.FixedGains(0.5, 0.2), {"axes": 13}, "axes must be a whole number from 1 to 12"),
        (ft.FixedGains(0.5, 0.2), {"number": "q15"}, "filter: there is none in integers"),
    ],
)
def test_what_has_no_filter_is_refused(subject, options, message):
    with pytest.raises(ValueError, match=message):
        export_c(subject, **options)


# -------------------------------------------------------------------- the command


def call(*words):
    return CliRunner().invoke(app, ["rulebase", "export", *map(str, words)])


def test_the_command_writes_and_says_so(tmp_path):
    folder = tmp_path / "out"
    words = ("omega-schedule", "--to", "c99", "--number", "q15", "-o", folder)
    done = call(*words)
    assert done.exit_code == 0, done.output
    assert sorted(p.name for p in folder.iterdir()) == [
        "omega-schedule.h", "omega-schedule_selftest.c",
    ]  # fmt: skip
    assert "method      break points, 7 nodes" in done.stdout
    assert "error       stiffness: 1.49 steps at most; bound 1.49 steps" in done.stdout
    assert f"wrote {folder / 'omega-schedule.h'}" in done.stdout
    again = call(*words)
    assert (again.exit_code, again.stderr.count("\n")) == (2, 1)
    assert "replace them with --force" in again.stderr
    figures = json.loads(call(*words, "--force", "--json").stdout)
    assert figures["rom_bytes"] == 66
    assert figures["errors"]["stiffness"]["bound"] < 1.5


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("valve", "--to", "ada"), "--to: unknown language 'ada'; one of c99"),
        (("valve", "--to", "c99", "--number", "q31"), "--number: unknown 'q31'"),
        (("valve", "--to", "c99", "--nodes", "3"), "--nodes: valve is tabulated"),
        (("maneuver", "--to", "c99", "--number", "q15", "--filter"), "--filter: there is none"),
        (("chan-style", "--to", "c99", "--filter", "--axes", "100000"), "--axes"),
        (("valfe", "--to", "c99"), "unknown rule base 'valfe'"),
        (("valve",), "Missing option '--to'"),
    ],
)
def test_a_mistake_is_one_line_and_leaves_no_files(words, message, tmp_path):
    done = call(*words, "-o", tmp_path / "out")
    assert done.exit_code == 2
    assert done.stderr.count("\n") == 1
    assert message in done.stderr
    assert not (tmp_path / "out").exists()


def test_files_appear_together_or_not_at_all(tmp_path):
    made = export_c("valve", random=100)
    (tmp_path / "valve_selftest.c").mkdir()
    with pytest.raises(IsADirectoryError):
        made.write(tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["valve_selftest.c"]
