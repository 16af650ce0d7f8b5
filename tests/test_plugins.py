import sys
from importlib.metadata import EntryPoint

import pytest

from fuzzytrack import PluginWarning
from fuzzytrack.plugins import Registry, load_script, load_scripts, loaded_scripts, registry
from fuzzytrack.plugins.scripts import Script
from fuzzytrack.schedulers import FixedGains, GainScheduler, schedulers
from fuzzytrack.trackers import trackers
from fuzzytrack.trackers.catalog import catalog, make_tracker


class Nothing:
    source = "nowhere"


class Package:
    """What a test says that a package is called."""

    def __init__(self, name):
        self.name = name


@pytest.fixture
def installed(monkeypatch):
    """Lets a test say which entry points installed packages have."""

    def install(*points, **more):
        found = [EntryPoint(name, value, "test.group") for name, value in more.items()]
        for name, value, package in points:
            point = EntryPoint(name, value, "test.group")
            vars(point)["dist"] = Package(package)
            found.append(point)
        monkeypatch.setattr(registry, "entry_points", lambda group: found)

    return install


@pytest.fixture
def module(tmp_path, monkeypatch):
    """Write a module that can be imported; gives its name."""
    monkeypatch.syspath_prepend(tmp_path)
    written = []

    def write(name, text):
        (tmp_path / f"{name}.py").write_text(text)
        written.append(name)
        return name

    yield write
    for name in written:
        sys.modules.pop(name, None)


def test_a_decorator_registers_in_process(installed):
    installed()
    registry = Registry("thing", "test.group")
    assert registry.register("nothing")(Nothing) is Nothing
    registry.register("nothing")(Nothing)
    assert registry.get("nothing") is Nothing
    (plugin,) = registry
    assert (plugin.name, plugin.source, plugin.package) == ("nothing", "nowhere", "test_plugins")
    with pytest.raises(ValueError, match="'nothing' is already registered by test_plugins"):
        registry.register("nothing")(int)
    registry.unregister("nothing")
    assert registry.names() == ()


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("import sys\nsys.exit(3)", r"SystemExit\(3\)"),
        ("raise BaseException('rude')", r"BaseException\('rude'\)"),
        ("import no_such_module", "no_such_module"),
        ("thing = 5", "TypeError.*thing 'bad' must be a dict class.*got 5"),
        ("class thing: pass", "TypeError.*must be a dict class"),
        ("other = dict", "has no attribute 'thing'"),
        ("from fuzzytrack.schedulers import schedulers\nschedulers.register('fixed')(print)",
         "TypeError|ValueError"),
    ],
)  # fmt: skip
def test_a_broken_plugin_is_named_and_skipped(installed, module, text, reason):
    installed(("bad", module("broken_plugin", text) + ":thing", "evil"), good="builtins:dict")
    things = Registry("thing", "test.group", dict)
    # Names are known without loading anything.
    assert things.names() == ("bad", "good")
    message = f"thing 'bad' of package evil could not be loaded: .*{reason}"
    with pytest.warns(PluginWarning, match=f"{message}.*it is skipped"):
        assert [plugin.name for plugin in things] == ["good"]
    # Reported once, not at every look; but whoever asks for it by name is told.
    assert [plugin.name for plugin in things] == ["good"]
    assert things.get("good") is dict
    with pytest.raises(ValueError, match=message):
        things.get("bad")


def test_a_name_is_one_that_users_can_write():
    things = Registry("thing", "test.group", dict)
    for name in ("", "a b", "a:b", "a\nb"):
        with pytest.raises(ValueError, match=r"^name: needs letters, digits, .* only; got '"):
            things.register(name)
    for name in (3, None, dict):
        with pytest.raises(
            TypeError, match=r"^name: needs a text, got .*; write .* register\(name\)"
        ):
            things.register(name)
    assert list(things) == []


def test_an_interruption_is_no_fault_of_a_plugin(installed, module):
    installed(bad=module("interrupted_plugin", "raise KeyboardInterrupt") + ":thing")
    with pytest.raises(KeyboardInterrupt):
        list(Registry("thing", "test.group"))


def test_only_what_is_asked_for_is_loaded(installed, module):
    slow = module("slow_plugin", "class thing: pass")
    installed(slow=f"{slow}:thing", good="builtins:dict")
    things = Registry("thing", "test.group")
    assert things.names() == ("good", "slow")
    assert things.get("good") is dict
    with pytest.raises(ValueError, match="unknown thing 'fast'; one of good, slow"):
        things.get("fast")
    assert slow not in sys.modules
    assert [plugin.name for plugin in things] == ["good", "slow"]
    assert slow in sys.modules


def test_of_two_packages_with_a_name_the_first_by_alphabet_counts(installed):
    installed(("one", "builtins:int", "zebra"), ("one", "builtins:float", "Aardvark"))
    things = Registry("thing", "test.group")
    message = "thing 'one' of package zebra has the name of one of package Aardvark; it is skipped"
    with pytest.warns(PluginWarning, match=message):
        assert things.get("one") is float
    assert things.package("one") == "Aardvark"
    assert next(iter(things)).source == ""


def test_no_plugin_takes_the_name_of_something_built_in(installed):
    installed(("fixed", "builtins:int", "evil"))
    registry = Registry("scheduler", "test.group")
    registry.register("fixed")(FixedGains)
    message = "scheduler 'fixed' of package evil has the name of a built-in scheduler"
    with pytest.warns(PluginWarning, match=message):
        assert registry.names() == ("fixed",)
    assert registry.get("fixed") is FixedGains
    with pytest.raises(ValueError, match="already registered by fuzzytrack; choose another name"):
        registry.register("fixed")(Nothing)


def test_names_are_shared_by_all_that_makes_a_tracker():
    trackers.register("fixed")(lambda: make_tracker("chan-style"))
    trackers.register("stiffness-damping")(lambda: make_tracker("chan-style"))
    schedulers.register("imm")(lambda: FixedGains(0.5, 0.2))
    schedulers.register("both")(lambda: FixedGains(0.5, 0.2))
    trackers.register("both")(lambda: make_tracker("chan-style"))
    specs = (
        "fixed:alpha=.4:beta=.1", "stiffness-damping", "imm:quiet_sigma=.2:maneuver_sigma=3", "both"
    )  # fmt: skip
    try:
        with pytest.warns(PluginWarning) as caught:
            made, listed = [make_tracker(spec) for spec in specs], catalog()
        assert made[0].scheduler == FixedGains(0.4, 0.1)
        assert made[1].scheduler.rules.name == "stiffness-damping"
        assert type(made[2]).__name__ == "InteractingPair"
        assert made[3].scheduler == FixedGains(0.5, 0.2)
        assert sorted(str(warning.message) for warning in caught) == [
            "scheduler 'imm' of test_plugins has the name of a tracker; it is skipped",
            "tracker 'both' of test_plugins has the name of a scheduler; it is skipped",
            "tracker 'fixed' of test_plugins has the name of a scheduler; it is skipped",
            "tracker 'stiffness-damping' of test_plugins has the name of a rule base; "
            "it is skipped",
        ]
        names = [(entry.kind, entry.name) for entry in listed]
        assert len({name for _, name in names}) == len(names)
        assert {("scheduler", "fixed"), ("tracker", "imm"), ("scheduler", "both")} <= set(names)
    finally:
        for name in ("fixed", "stiffness-damping", "both"):
            trackers.unregister(name)
        for name in ("imm", "both"):
            schedulers.unregister(name)


def test_what_is_registered_in_process_goes_before_what_is_installed(installed):
    installed(nothing="builtins:int")
    registry = Registry("thing", "test.group")
    registry.register("nothing")(Nothing)
    assert registry.get("nothing") is Nothing


def test_a_class_that_is_defined_again_takes_the_place_of_the_first(installed):
    installed()
    registry = Registry("thing", "test.group", dict)
    for _ in range(2):

        @registry.register("thing")
        class Thing(dict):
            pass

        assert registry.get("thing") is Thing
    with pytest.raises(TypeError, match="thing 'x' must be a dict class"):
        registry.register("x")(Nothing)


# -------------------------------------------------------------------- scripts

SCRIPT = """
from fuzzytrack.schedulers import GainScheduler, schedulers

@schedulers.register("scripted")
class Scripted(GainScheduler):
    source = "a script"
    def kernel(self, n_axes):
        return None
"""


@pytest.fixture
def script(tmp_path):
    """Write a script; what it registers as "scripted" is forgotten afterward."""

    def write(text, name="mine.py"):
        path = tmp_path / name
        path.write_text(text)
        return path

    yield write
    if "scripted" in schedulers.names():
        schedulers.unregister("scripted")


def test_a_script_registers_its_classes(script):
    path = script(SCRIPT)
    load_script(path)
    made = schedulers.get("scripted")
    assert issubclass(made, GainScheduler)
    (plugin,) = (p for p in schedulers if p.name == "scripted")
    assert (plugin.package, plugin.source) == (str(path), "a script")
    # Once more, by another way there, is harmless; changed, it is read again.
    load_script(path.parent / "." / "mine.py")
    assert schedulers.get("scripted") is made
    load_script(script(SCRIPT.replace("a script", "another")))
    assert schedulers.get("scripted").source == "another"


def test_another_process_gets_the_text_of_a_script(script):
    path = script(SCRIPT)
    load_script(path)
    (loaded,) = (s for s in loaded_scripts() if s.path == str(path))
    path.unlink()
    made = schedulers.get("scripted")
    load_scripts([Script(loaded.path, loaded.text + b"\n")])
    again = schedulers.get("scripted")
    assert again is not made
    assert again.__module__ == made.__module__ == loaded.module


def test_the_later_of_two_scripts_with_a_name_counts(script):
    load_script(script(SCRIPT))
    later = script(SCRIPT.replace("a script", "another"), "later.py")
    with pytest.warns(PluginWarning, match=r"'scripted' of .*later.py replaces that of .*mine.py"):
        load_script(later)
    assert schedulers.get("scripted").source == "another"


@pytest.mark.parametrize(
    ("text", "place", "message"),
    [
        ("x = 1\ny = (\n", "2:5", "SyntaxError: '(' was never closed"),
        ("x = 1\n  y = 2\n", "2:", "IndentationError: unexpected indent"),
        ("\n\nx = 1 / 0\n", "3:5", "ZeroDivisionError: division by zero"),
        ("import sys\nsys.exit('no')\n", "2:1", "SystemExit: no"),
        ("import json\njson.loads('{')\n", "2:1", "JSONDecodeError: Expecting property name"),
        (SCRIPT.replace("scripted", "fixed"), "4:2", "ValueError: scheduler 'fixed' is already"),
        ("x = '\0'", "1:", "null byte"),
    ],
)
def test_a_mistake_in_a_script_has_a_place(script, text, place, message):
    path = script(text)
    with pytest.raises(ValueError, match="null" if "null" in message else "Error|Exit") as caught:
        load_script(path)
    assert str(caught.value).startswith(f"{path}:{place}")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert Script(str(path), b"").module not in sys.modules


def test_an_interruption_is_no_fault_of_a_script(script):
    with pytest.raises(KeyboardInterrupt):
        load_script(script("raise KeyboardInterrupt"))
