"""``--plugin FILE.py``, on its own and with other processes and computers at work."""

import json
import re
from pathlib import Path

import pytest
from waiting import PATIENCE

from fuzzytrack.fuzzy.loading import rulebase_path
from fuzzytrack.lanes import runner
from fuzzytrack.normalizations import normalizations
from fuzzytrack.plugins import scripts
from fuzzytrack.schedulers import schedulers
from fuzzytrack.trackers import trackers

SCRIPT = """
from dataclasses import dataclass

from fuzzytrack.normalizations import Normalization, normalizations
from fuzzytrack.schedulers import GainScheduler, schedulers


@schedulers.register("scripted")
@dataclass(frozen=True)
class Scripted(GainScheduler):
    uses_acceleration = False
    alpha: float = 0.5

    def kernel(self, n_axes):
        alpha = self.alpha

        def scripted(innovation, change, dt, sigma, memory):
            return alpha, 0.2, 0.0, 1.0, memory

        return scripted


@normalizations.register("scripted")
@dataclass(frozen=True)
class Halved(Normalization):
    signals = ("half the error", "nothing")

    def initial_memory(self, n_axes):
        return ()

    def kernel(self, n_axes):
        def halved(innovation, change, dt, sigma, memory):
            return (max(-1.0, min(1.0, 0.5 * innovation)), 0.0), memory

        return halved
"""


@pytest.fixture
def script(csv, monkeypatch):
    """A script with a scheduler and a normalization, both called "scripted"."""
    # What the test before has loaded is not sent to other processes.
    monkeypatch.setattr(scripts, "_loaded", {})
    yield csv(SCRIPT, "mine.py")
    for registry in (schedulers, normalizations):
        if "scripted" in registry.names():
            registry.unregister("scripted")


def numbers(result):
    """Numbers that a command prints as JSON, without the names of what was asked for."""
    assert (result.exit_code, result.stderr) == (0, "")
    found = json.loads(result.stdout)
    return found.get("total") or [
        {key: value for key, value in row.items() if key != "name"} for row in found["trackers"]
    ]


def test_track_with_a_scheduler_of_a_script(run, plots, script):
    words = ("track", plots, "--json", "--tracker")
    again = script.parent / "." / "mine.py"
    mine = run(*words, "scripted:alpha=0.3", "--plugin", script, "--plugin", again)
    assert numbers(mine) == numbers(run(*words, "fixed:alpha=0.3:beta=0.2"))


def test_compare_and_trackers(run, plots, script, csv):
    truth = csv("t,x\n0,0\n1,10\n2,20\n3,31\n4,44\n", "truth.csv")
    chosen = ("--trackers", "scripted,fixed:alpha=.5:beta=.2", "--plugin", script)
    one, other = numbers(run("compare", truth, "--noise", 2, "--runs", 3, "--json", *chosen))
    assert one == other
    listed = {row["name"]: row for row in json.loads(
        run("trackers", "--plugin", script, "--json").stdout
    )}  # fmt: skip
    assert listed["scripted"]["package"] == str(script)


def test_a_rule_base_on_a_normalization_of_a_script(run, fails, csv, script):
    text = rulebase_path("stiffness-damping").read_text()
    rules = csv(text.replace("normalization: chan", "normalization: scripted"), "mine.yaml")
    assert run("rulebase", "check", rules, "--plugin", script).exit_code == 0
    normalizations.unregister("scripted")
    assert "unknown normalization 'scripted'" in run("rulebase", "check", rules).stderr


@pytest.mark.parametrize(
    ("page", "name", "wanted"),
    [
        ("write-a-scheduler", "settling:longest=10", "growing-memory:limit=10"),
        (
            "write-a-tracker",
            "averaged:quiet=0.4:agile=0.4",
            "bank:lowest=0.4:highest=0.4:members=1:selection=best",
        ),
    ],
)
def test_the_first_example_of_a_page_is_a_script(run, csv, script, page, name, wanted):
    text = (Path(__file__).parents[2] / "docs" / f"{page}.md").read_text()
    path = csv(re.search(r"^```python\n(.*?)^```", text, re.M | re.S)[1], f"{page}.py")
    file = csv("t,x\n0,0\n1,10\n2,21\n3,30\n4,44\n")
    words = ("track", file, "--json", "--tracker")
    try:
        assert numbers(run(*words, name, "--plugin", path)) == numbers(run(*words, wanted))
    finally:
        registry = schedulers if "scheduler" in page else trackers
        registry.unregister(name.partition(":")[0])


def test_processes_know_the_script(run, script):
    words = ("testbed", "constant-velocity", "--runs", 130, "--json", "--trackers")
    mine = run(*words, "scripted:alpha=0.4", "--plugin", script, "--jobs", 2)
    assert numbers(mine) == numbers(run(*words, "fixed:alpha=0.4:beta=0.2"))


def test_a_cluster_knows_the_script(run, script, monkeypatch):
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr("fuzzytrack.workers._PATIENCE", PATIENCE)
    words = ("testbed", "constant-velocity", "--runs", 5, "--json", "--trackers")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, dashboard_address=":0"
    ) as cluster:
        address = cluster.scheduler_address
        mine = run(*words, "scripted:alpha=0.4", "--plugin", script, "--scheduler", address)
    assert numbers(mine) == numbers(run(*words, "fixed:alpha=0.4:beta=0.2"))


@pytest.mark.parametrize(
    "words",
    [
        ("track", "plots.csv"),
        ("compare", "plots.csv", "--noise", "1"),
        ("testbed", "mixed"),
        ("simulate", "mixed", "-o", "out.csv"),
        ("trackers",),
        ("rulebase", "check", "chan-style"),
    ],
    ids=lambda words: words[0],
)
def test_a_mistake_in_a_script_is_one_line(fails, csv, words):
    path = csv("import math\n\nmath.no_such_function(1)\n", "mine.py")
    assert fails(*words, "--plugin", path) == (
        f"{path}:3:1: AttributeError: module 'math' has no attribute 'no_such_function'"
    )


MISTAKEN = """
from dataclasses import dataclass

from fuzzytrack.schedulers import GainScheduler, schedulers


@schedulers.register("scripted")
@dataclass(frozen=True)
class Mistaken(GainScheduler):
    def initial_memory(self, n_axes):
        return (0.0,)

    def kernel(self, n_axes):
        def kernel(innovation, change, dt, sigma, memory):
            alpha = 0.5
            return alpha, 0.2, 0.0, 1.0, memory

        return kernel
"""
MORE = "; fuzzytrack.testing.check_scheduler or check_tracker says more"


@pytest.mark.parametrize(
    ("right", "wrong", "told"),
    [
        ("return (0.0,)", "return 0.0",
         ":10:1: Mistaken.initial_memory must return a tuple of numbers, got 0.0"),
        ("change, ", "",
         ":14:1: the kernel of Mistaken must take the five arguments "
         "(innovation, change, dt, sigma, memory), takes (innovation, dt, sigma, memory)"),
        ("0.2, 0.0, 1.0, memory", "0.2",
         ":14:1: the kernel of Mistaken must return (alpha, beta, gamma, retention, memory), "
         "got (0.5, 0.2)"),
        ("0.5", "0.5 / (innovation * 0.0)",
         ":15:21: ZeroDivisionError: float division by zero, in a step of Mistaken" + MORE),
        ("0.5", "max(-1.0) + abs(innovation)",
         ":15:21: TypeError: 'float' object is not iterable, in a step of Mistaken" + MORE),
        # A ValueError, too: the place tells it from a bad argument of the command.
        ("0.5", "float('half')",
         ":15:21: ValueError: could not convert string to float: 'half', in a step of Mistaken"
         + MORE),
    ],
)  # fmt: skip
def test_a_mistake_in_a_kernel_is_one_line(fails, plots, script, right, wrong, told):
    assert MISTAKEN.count(right) == 1
    script.write_text(MISTAKEN.replace(right, wrong))
    line = fails("track", plots, "--plugin", script, "--tracker", "scripted")
    assert line == f"{script}{told}"


def test_a_mistake_that_the_compiler_finds_is_one_line(fails, plots, script, monkeypatch):
    monkeypatch.setattr(runner, "COMPILE_ABOVE", 1)
    script.write_text(MISTAKEN.replace("0.5", "0.5 if innovation < 1e9 else 'half'"))
    line = fails("track", plots, "--plugin", script, "--tracker", "scripted")
    assert line.startswith(f"{script}: TypingError: ")
    assert line.endswith(f", in a step of Mistaken{MORE}")


def test_a_mistake_of_form_is_one_sentence_when_compiled(fails, plots, script, monkeypatch):
    monkeypatch.setattr(runner, "COMPILE_ABOVE", 1)
    script.write_text(MISTAKEN.replace("0.2, 0.0, 1.0, memory", "0.2"))
    line = fails("track", plots, "--plugin", script, "--tracker", "scripted")
    assert line.startswith(f"{script}:14:1: the kernel of Mistaken must return (alpha, beta,")


def test_a_mistake_in_another_process_is_one_line(fails, script):
    script.write_text(MISTAKEN.replace("0.5", "0.5 / (innovation * 0.0)"))
    words = ("testbed", "constant-velocity", "--runs", 130, "--jobs", 2, "--trackers", "scripted")
    line = fails(*words, "--plugin", script)
    assert (
        line == f"{script}: ZeroDivisionError: float division by zero, in a step of Mistaken{MORE}"
    )


def test_a_mistake_in_a_normalization_is_one_line(fails, plots, csv, script):
    text = rulebase_path("stiffness-damping").read_text()
    rules = csv(text.replace("normalization: chan", "normalization: scripted"), "mine.yaml")
    script.write_text(SCRIPT.replace("innovation)), 0.0), memory", "innovation)), 0.0)"))
    line = fails("track", plots, "--plugin", script, "--tracker", rules)
    assert line.startswith((f"{script}: TypeError: ", f"{script}: ValueError: "))
    assert line.endswith(f", in a step of FuzzyScheduler{MORE}")


def test_a_bad_file_beside_a_script_keeps_its_message(fails, csv, script):
    bad = csv("t,x\n0,0\n1,word\n", "bad.csv")
    without = fails("track", bad)
    assert fails("track", bad, "--plugin", script, "--tracker", "scripted") == without


def test_a_bad_parameter_of_a_class_of_a_script_keeps_its_message(fails, plots, script):
    check = "    def __post_init__(self):\n        raise ValueError('alpha: too small')\n\n    def "
    script.write_text(MISTAKEN.replace("    def ", check, 1))
    line = fails("track", plots, "--plugin", script, "--tracker", "scripted")
    assert line.startswith("error: ")
    assert line.endswith("alpha: too small")


def test_a_mistake_of_the_package_is_not_hidden(run, plots, monkeypatch):
    monkeypatch.setattr(scripts, "_loaded", {})

    def broken(*words, **extra):
        raise KeyError("ours")

    monkeypatch.setattr(runner.Runner, "__call__", broken)
    assert isinstance(run("track", plots).exception, KeyError)


def test_a_script_that_is_not_there(fails, plots, tmp_path):
    path = tmp_path / "none.py"
    assert fails("track", plots, "--plugin", path) == f"error: {path}: No such file or directory"


@pytest.mark.parametrize(
    ("made", "place", "message"),
    [
        ("1 / 0", "5:15", "ZeroDivisionError: division by zero"),
        ("[][0]", "5:15", "IndexError: list index out of range"),
        ("int('a')", None, "tracker 'failing': invalid literal for int() with base 10: 'a'"),
    ],
)
def test_a_mistake_while_a_plugin_of_a_script_is_used_is_one_line(
    fails, csv, plots, monkeypatch, made, place, message
):
    monkeypatch.setattr(scripts, "_loaded", {})
    path = csv(
        "from fuzzytrack.schedulers import schedulers\n\n"
        "@schedulers.register('failing')\n"
        "def failing():\n"
        f"    return    {made}\n",
        "mine.py",
    )
    try:
        line = fails("track", plots, "--plugin", path, "--tracker", "failing")
    finally:
        schedulers.unregister("failing")
    assert line == (f"{path}:{place}: {message}" if place else f"error: {message}")
