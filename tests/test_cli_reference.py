"""The page of all commands and options, which the documentation generates."""

import importlib.util
import re
import shlex
from pathlib import Path

import pytest
from typer.main import get_command

from fuzzytrack.cli.app import app

PATH = Path(__file__).resolve().parents[1] / "docs" / "_extensions" / "cli_reference.py"


@pytest.fixture(scope="module")
def reference():
    spec = importlib.util.spec_from_file_location("cli_reference", PATH)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def sections(reference, tmp_path_factory):
    """Text about each command, by what is typed to call it."""
    folder = tmp_path_factory.mktemp("page")
    reference.write(folder)
    (page,) = folder.iterdir()
    assert page.name == "cli-reference.md"
    parts = re.split(r"^##+ (fuzzytrack.*)\n", page.read_text("utf-8"), flags=re.M)[1:]
    return dict(zip(parts[::2], parts[1::2], strict=True))


def test_every_option_of_every_command_is_described(reference, sections):
    found = dict(reference.commands(get_command(app)))
    assert sections.keys() == found.keys()
    assert "fuzzytrack rulebase new" in found
    for path, command in found.items():
        described = re.findall(r"^(`.*)\n: \S", sections[path], flags=re.M)
        named = {name for line in described for name in re.findall(r"`([^`]+)`", line)}
        for parameter in command.params:
            names = parameter.opts + parameter.secondary_opts
            argument = parameter.param_type_name == "argument"
            if not getattr(parameter, "hidden", False):
                assert {parameter.metavar} if argument else {*names} <= named, (path, names)


@pytest.mark.parametrize(
    ("path", "lines"),
    [
        ("track", ["`--gate` `K|auto|none`", ": .*prediction. Default: `auto` \\(20\\)."]),
        ("track", ["`--id` `COL`", ": Column that identifies the track. Default: one track."]),
        ("track", ["`--compile`, `--no-compile`", ": .* Default: `--compile`."]),
        ("track", ["`--time` `COL`", ": Column of time .* Default: t, time…"]),
        ("track", ["`--stale`", ": Take a position that repeats as a missed plot."]),
        ("track", ["`--plugin` `FILE.py`", ": Load plug-ins from a script; may be repeated."]),
        ("track", ["`--valid` `COL=LOW:HIGH`", ": .* missed plots. May be repeated."]),
        ("surface", ["`--points` `N`", ": Points on each axis.* From 2 to 1001. Default: `101`."]),
        ("surface", ["`--even`", ": Write `--csv` without the corners of the sets."]),
        ("gains", ["`--alpha` `A`", ": Position gain. Required."]),
        ("demo", ["`-o`, `--output` `DIR`", ": .*Default: `demo`."]),
        ("demo", ["`--runs` `N`", ": Monte Carlo runs. At least 1. Default: `100`."]),
        ("design w", ["`--omega3` `W3`", ": Third pole, .*Default: `0`."]),
        ("sample", ["`[NAME]`", ": radar, ais, adsb, sonar, scans; none lists them."]),
    ],
)
def test_an_option_has_its_unit_limits_and_default(sections, path, lines):
    option, told = lines
    text = sections[f"fuzzytrack {path}"]
    assert re.search(rf"^{re.escape(option)}\n{told}$", text, flags=re.M), text


def test_the_form_of_a_call_and_the_commands_of_a_group(sections):
    assert (
        "\n```text\nfuzzytrack surface [OPTIONS] RULEBASE\n```\n" in sections["fuzzytrack surface"]
    )
    assert "\n```text\nfuzzytrack rulebase COMMAND\n```\n" in sections["fuzzytrack rulebase"]
    assert "Commands: `list`, `show`, " in sections["fuzzytrack rulebase"]
    assert "--line" not in sections["fuzzytrack completion"]


def test_examples_on_the_page_of_commands_use_what_there_is(reference):
    """Each command of an example exists, and each of its options."""
    page = (PATH.parents[1] / "cli.md").read_text("utf-8")
    examples = re.findall(r"^    (?:[\w-]+ \| )?(fuzzytrack .*)", page, flags=re.M)
    known = dict(reference.commands(get_command(app)))
    for example in examples:
        words = shlex.split(example)
        path = max((p for p in known if example.startswith(p)), key=len)
        options = {word for word in words if re.match("--?[a-z]", word)}
        names = {name for parameter in known[path].params for name in parameter.opts}
        assert options <= names, example
        assert not hasattr(known[path], "commands"), example
    assert {example.split()[1] for example in examples} >= {"track", "compare", "design"}
