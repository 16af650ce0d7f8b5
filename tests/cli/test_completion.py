import shutil
import subprocess
import sys

import pytest
from typer.main import get_command

from fuzzytrack.cli.app import COMMANDS, app, load_command
from fuzzytrack.cli.completion import VALUES, candidates
from fuzzytrack.fuzzy.loading import shipped_rulebases
from fuzzytrack.papers.catalog import PAPERS
from fuzzytrack.simulation import SAMPLES
from fuzzytrack.simulation.scenario_files import shipped_scenarios

PROGRAM = get_command(app)


def values(*words):
    return [found.value for found in candidates(words, PROGRAM)]


def parameters():
    """All parameters of all commands."""
    stack = [load_command(name) for name in COMMANDS]
    while stack:
        command = stack.pop()
        stack.extend(getattr(command, "commands", {}).values())
        if not hasattr(command, "commands"):
            yield from command.params


def test_commands_are_completed():
    assert values("") == list(COMMANDS)
    assert values() == list(COMMANDS)
    assert values("tra") == ["track", "trackers"]
    assert values("rulebase", "s") == ["show", "set", "schema"]
    assert values("design", "k") == ["kalata"]
    assert values("nothing", "") == values("rulebase", "nothing", "") == []
    assert ("trackers", COMMANDS["trackers"][1]) in candidates(["tra"], PROGRAM)


def test_options_are_completed_but_those_that_were_given():
    assert values("track", "a.csv", "--sigma-") == [
        "--sigma-range",
        "--sigma-azimuth",
        "--sigma-elevation",
    ]
    assert "--dt" in values("design", "kalata", "-")
    assert values("surface", "tipper", "-o", "a.png", "--o") == []
    # An option that may be repeated is offered again.
    assert values("track", "--plugin", "a.py", "--plu") == ["--plugin"]
    assert values("completion", "bash", "--l") == []
    (found,) = candidates(["track", "--quote"], PROGRAM)
    assert found == ("--quote-formulas", "In CSV, quote text that a spreadsheet would run.")


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("surface", ""), list(shipped_rulebases())),
        (("rulebase", "show", "val"), ["valve", "valve-confidence"]),
        (("rulebase", "new", "tip"), ["tipper"]),
        (("testbed", ""), list(shipped_scenarios())),
        (("tune", "a.csv", "str"), ["strong"]),
        (("reproduce", ""), [*PAPERS, "all"]),
        (("sample", ""), list(SAMPLES)),
        (("completion", ""), ["bash", "zsh", "fish"]),
        (("rulebase", "export", "valve", "--number", ""), ["double", "float", "q15"]),
        (("track", "--tracker", "kalman-c"), ["kalman-ca", "kalman-cv"]),
        (("track", "--tracker=imm-th"), ["--tracker=imm-three"]),
        (("compare", "a", "--trackers", "fixed,tip"), []),
        (("compare", "a", "--trackers", "fixed:alpha=1,omega"), ["fixed:alpha=1,omega-schedule"]),
        (("track", "--azimuth-from", ""), ["north", "east"]),
        (("track", "--gate", ""), ["auto", "none"]),
        (("surface", "tipper", "--method", "r"), ["relation"]),
        (("track", "a", "--format", "as"), ["asterix"]),
        # Files may stand there, or anything.
        (("track", ""), []),
        (("track", "a", "-o", ""), []),
        (("track", "--json=", ""), []),
        (("track", "--json="), []),
        (("track", "--", "--ti"), []),
        (("surface", "tipper", ""), []),
        (("trackers", ""), []),
        (("surface", "--no-such", "tip"), ["tipper"]),
    ],
)
def test_values_are_completed(words, expected):
    assert values(*words) == expected


def test_what_has_values_is_in_use():
    used = {p.metavar if p.param_type_name == "argument" else p.opts[0] for p in parameters()}
    assert set(VALUES) - used == set()


@pytest.mark.parametrize(
    ("shell", "line", "expected"),
    [
        ("bash", "fuzzytrack trac", ["track", "trackers"]),
        ("bash", "fuzzytrack surface ", list(shipped_rulebases())),
        ("bash", "fuzzytrack track --azimuth-from=n", ["north"]),
        ("bash", "fuzzytrack track --trackers fixed:alpha=1,omega", []),
        ("bash", "fuzzytrack compare --trackers fixed:alpha=1,omega", ["1,omega-schedule"]),
        ("bash", "fuzzytrack track 'my file.csv' --azimuth-from ", ["north", "east"]),
        ("bash", "fuzzytrack sample 'so", ["sonar"]),
        ("bash", 'fuzzytrack track "a', []),
        ("bash", "fuzzytrack track '\"a", []),
        ("bash", "", list(COMMANDS)),
        ("zsh", "fuzzytrack cac", [f"cache:{COMMANDS['cache'][1]}"]),
        (
            "zsh",
            "fuzzytrack compare --trackers fixed:alpha=1,omega",
            ["fixed\\:alpha=1,omega-schedule"],
        ),
        ("fish", "fuzzytrack cac", [f"cache\t{COMMANDS['cache'][1]}"]),
        ("fish", "fuzzytrack sample r", ["radar"]),
    ],
)
def test_words_as_each_shell_takes_them(run, shell, line, expected):
    result = run("completion", shell, "--line", line)
    assert result.exit_code == 0, result.stderr
    assert result.stdout.splitlines() == expected


def test_an_unknown_shell_is_refused(fails):
    assert fails("completion", "cmd") == "error: no script for 'cmd'; allowed: bash, zsh, fish"


@pytest.fixture
def program(tmp_path):
    """The command as a file that a shell finds; gives its path."""
    file = tmp_path / "fuzzytrack"
    file.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m fuzzytrack "$@"\n')
    file.chmod(0o755)
    return file


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("tra", ["track", "trackers"]),
        ("reproduce kim", ["kim-lee"]),
        ("track --azimuth-from=ea", ["east"]),
        ("track ./no", [""]),
    ],
)
def test_bash_completes_with_the_script(run, program, line, expected):
    script = run("completion", "bash").stdout
    typed = f"{program} {line}"
    asked = (
        f"{script}\ncomplete -p fuzzytrack >/dev/null || exit 1\n"
        f"COMP_LINE='{typed} rest'; COMP_POINT={len(typed)}\n"
        f"_fuzzytrack_completion '{program}'\nprintf '%s\\n' \"${{COMPREPLY[@]}}\""
    )
    done = subprocess.run(["bash", "--norc", "-c", asked], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.split("\n")[:-1] == expected


@pytest.mark.skipif(shutil.which("fish") is None, reason="needs fish")
def test_fish_completes_with_the_script(run, program):
    script = run("completion", "fish").stdout
    asked = f"{script}\ncomplete -C '{program} track --azimuth-from n'"
    done = subprocess.run(["fish", "--no-config", "-c", asked], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("north\n", "")


@pytest.mark.skipif(shutil.which("zsh") is None, reason="needs zsh")
def test_zsh_takes_the_script(run, program):
    # zsh completes in an interactive shell only: its functions are replaced by ones that print.
    script = run("completion", "zsh").stdout
    asked = (
        "compdef() { :; }; _files() { print files; }; _describe() { print -l -- ${(P)2}; }\n"
        f"{script}\nwords=('{program}' reproduce kim); CURRENT=3 PREFIX=kim\n_fuzzytrack\n"
        f"words=('{program}' track a); CURRENT=3 PREFIX=a\n_fuzzytrack"
    )
    done = subprocess.run(["zsh", "-f", "-c", asked], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("kim-lee\nfiles\n", "")


@pytest.mark.parametrize(
    ("words", "unused"),
    [
        (["tra"], ["numpy", "yaml", "rich", "fuzzytrack.cli.track"]),
        (["track", "--sig"], ["matplotlib", "numba", "scipy", "fuzzytrack.testbed"]),
        (["testbed", "str"], ["matplotlib", "numba", "scipy", "fuzzytrack.reports"]),
    ],
    ids=lambda value: value[0],
)
def test_little_is_imported_to_complete_a_word(words, unused):
    code = (
        "import sys\nfrom typer.main import get_command\nfrom fuzzytrack.cli.app import app\n"
        "from fuzzytrack.cli.completion import candidates\n"
        f"assert candidates({words!r}, get_command(app))\n"
        f"print([m for m in {unused!r} if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("[]\n", "")
