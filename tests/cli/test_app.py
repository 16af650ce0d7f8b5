import json
import subprocess
import sys
import warnings

import pytest

import fuzzytrack
from fuzzytrack.cli import trackers as listing
from fuzzytrack.cli.app import COMMANDS, load_command
from fuzzytrack.errors import PluginWarning
from fuzzytrack.trackers.catalog import CatalogEntry

MAIN = [sys.executable, "-m", "fuzzytrack"]


def command(*words, **options):
    return subprocess.run([*MAIN, *map(str, words)], capture_output=True, text=True, **options)


def test_version(run):
    assert run("--version").stdout == f"fuzzytrack {fuzzytrack.__version__}\n"


def test_help(run):
    assert "rulebase" in run("--help").stdout
    assert "--trackers" in run("compare", "-h").stdout
    for words in ([], ["rulebase"]):
        result = run(*words)
        assert "Usage:" in result.output


HEAVY = {"numba", "scipy", "skfuzzy", "matplotlib", "pyarrow", "pandas", "dask", "distributed"}
OTHERS = {f"fuzzytrack.{name}" for name in ("papers", "plotting", "cli.testbed", "cli.gains")}
TRACK = ("track", "a.csv", "--time", "t", "--axes", "x,y", "--tracker", "stiffness-damping")


@pytest.mark.parametrize(
    ("words", "unused"),
    [
        (("--help",), {"numpy", "yaml", "rich.table", "fuzzytrack.cli.track"}),
        (("--version",), {"numpy", "yaml", "rich.table", "fuzzytrack.cli.track"}),
        (("rulebase", "list"), {"fuzzytrack.trackers", "fuzzytrack.io", "fuzzytrack.testbed"}),
        (TRACK, {"fuzzytrack.recordings.large_jobs", "fuzzytrack.fuzzy.saving"}),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else "",
)
def test_a_command_imports_what_it_needs(words, unused, tmp_path):
    rows = "".join(f"{k},{3 * k},{k * k % 7}\n" for k in range(1000))
    (tmp_path / "a.csv").write_text("t,x,y\n" + rows)
    code = (
        "import atexit, sys\n"
        "atexit.register(lambda: print(*sys.modules, file=sys.stderr))\n"
        "from fuzzytrack.cli import main; main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, *words], capture_output=True, text=True, cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    loaded = set(done.stderr.split())
    assert "fuzzytrack.cli.app" in loaded
    assert (HEAVY | OTHERS | unused) & loaded == set()


@pytest.mark.parametrize("name", COMMANDS)
def test_the_list_of_commands_says_what_they_say_of_themselves(name):
    help = load_command(name).help
    assert " ".join(help.split("\n\n")[0].split()) == COMMANDS[name][1]


def test_unknown_command(fails):
    assert "No such command 'trak'" in fails("trak")


def test_trackers(run):
    text = run("trackers").stdout
    assert "stiffness-damping" in text
    assert "alpha, beta, gamma=0.0" in text
    found = json.loads(run("trackers", "--json").stdout)
    assert {"kind", "name", "parameters", "source", "package"} == set(found[0])
    assert {"rule base", "scheduler", "tracker", "normalization"} == {row["kind"] for row in found}
    assert all(row["source"] for row in found)
    assert "Eqs. 3.20-3.21, after Chan" in " ".join(text.split())


def test_plugins_name_their_package(run, monkeypatch):
    entry = CatalogEntry("scheduler", "mine", (), "my paper", "my-package")
    monkeypatch.setattr(listing, "catalog", lambda: (entry,))
    assert "my paper (from my-package)" in run("trackers").stdout


def test_warnings_are_one_line_on_stderr(run, monkeypatch):
    def warn():
        warnings.warn("plug-in 'x' of y\ncould not be loaded", PluginWarning, stacklevel=2)
        return ()

    monkeypatch.setattr(listing, "catalog", warn)
    result = run("trackers", "--json")
    assert result.stderr == "warning: plug-in 'x' of y could not be loaded\n"
    assert result.stdout == "[]\n"


def test_bugs_are_not_hidden(run, monkeypatch):
    def bug():
        raise ZeroDivisionError

    monkeypatch.setattr(listing, "catalog", bug)
    assert isinstance(run("trackers").exception, ZeroDivisionError)


def test_processes_end_with_one_line_and_status_2(tmp_path):
    (tmp_path / "a.csv").write_text("t,x,t2\n0,0,0\n1,abc,0\n")
    done = command("track", "a.csv", "-o", "b.csv", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == (
        "error: a.csv: row 3, column x: 'abc'; expected a finite number, or an empty cell or nan "
        "for a missed plot\n"
    )
    assert [p.name for p in tmp_path.iterdir()] == ["a.csv"]
    good = command("track", "a.csv", "--axes", "t2", "--json", cwd=tmp_path)
    assert (good.returncode, good.stderr) == (0, "")
    assert json.loads(good.stdout)["axes"] == ["t2"]


def test_reader_that_goes_away():
    with subprocess.Popen(
        [*MAIN, "rulebase", "schema"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        process.stdout.close()
        assert b"Traceback" not in process.stderr.read()


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_interrupted_process(tmp_path):
    code = (
        "import signal\n"
        # A process started in the background of a script ignores the signal.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from fuzzytrack.cli import main, track as tracking\n"
        "tracking.track_recording = lambda *a, **k: signal.raise_signal(signal.SIGINT)\n"
        "import sys; sys.argv = ['fuzzytrack', 'track', 'a.csv']\n"
        "main()\n"
    )
    (tmp_path / "a.csv").write_text("t,x\n0,0\n")
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path
    )
    assert (done.returncode, done.stderr) == (130, "interrupted\n")


def test_help_puts_options_that_belong_together_under_their_heading(run):
    text = run("track", "--help").stdout
    order = ["Arguments:", "Options:", "Columns of the plots:", "Noise of the plots:"]
    order += ["Faults of the plots:", "Form of the file:", "Large recordings:", "Live feeds:"]
    places = [text.index(f"\n{heading}\n") for heading in order]
    assert places == sorted(places)
    at = dict(zip(order, places, strict=True))
    assert at["Options:"] < text.index("  -o, --output") < at["Columns of the plots:"]
    assert at["Noise of the plots:"] < text.index("  --sigma-range") < at["Faults of the plots:"]
    assert at["Live feeds:"] < text.index("  --state")
    assert text.count("\n  --sigma ") == 1
