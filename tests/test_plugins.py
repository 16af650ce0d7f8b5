from importlib.metadata import EntryPoint

import pytest

from fuzzytrack import PluginWarning, plugins
from fuzzytrack.plugins import Registry


class Nothing:
    source = "nowhere"


@pytest.fixture
def installed(monkeypatch):
    """Lets a test say which entry points installed packages have."""

    def install(**points):
        found = [EntryPoint(name, value, "test.group") for name, value in points.items()]
        monkeypatch.setattr(plugins, "entry_points", lambda group: found)

    return install


def test_a_decorator_registers_in_process(installed):
    installed()
    registry = Registry("thing", "test.group")
    assert registry.register("nothing")(Nothing) is Nothing
    registry.register("nothing")(Nothing)
    assert registry.get("nothing") is Nothing
    (plugin,) = registry
    assert (plugin.name, plugin.source, plugin.package) == ("nothing", "nowhere", "test_plugins")
    with pytest.raises(ValueError, match="thing 'nothing' is already registered"):
        registry.register("nothing")(int)
    registry.unregister("nothing")
    assert registry.names() == ()


def test_entry_points_are_loaded_and_broken_ones_are_named_and_skipped(installed):
    installed(good="builtins:int", missing="no_such_module:thing", wrong="builtins:no_such_name")
    registry = Registry("thing", "test.group")
    with pytest.warns(PluginWarning) as caught:
        assert registry.names() == ("good",)
    text = " | ".join(str(w.message) for w in caught)
    assert "thing 'missing' of no_such_module could not be loaded and is skipped" in text
    assert "thing 'wrong' of builtins" in text
    # Reported once, not at every look.
    assert registry.get("good") is int
    assert next(iter(registry)).source == ""


def test_an_unknown_name_lists_the_known_ones(installed):
    installed(good="builtins:int")
    with pytest.raises(ValueError, match="unknown thing 'bad'; one of good"):
        Registry("thing", "test.group").get("bad")


def test_what_is_registered_in_process_goes_before_what_is_installed(installed):
    installed(nothing="builtins:int")
    registry = Registry("thing", "test.group")
    registry.register("nothing")(Nothing)
    assert registry.get("nothing") is Nothing
