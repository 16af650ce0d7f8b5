"""Undo and redo of texts."""

from fuzzytrack.studio import history
from fuzzytrack.studio.history import History, OpenText, Texts


def texts(rules, scenario="s"):
    return Texts(OpenText("r", rules), OpenText("t", scenario))


def test_undo_and_redo():
    states = [texts("a"), texts("b"), texts("b", "u")]
    found = History(states[0])
    assert not found.undo()
    found.put(states[1])
    found.put(states[1])
    found.put(states[2])
    assert found.steps == (2, 0)
    assert found.undo()
    assert found.now == states[1]
    assert found.undo()
    assert found.now == states[0]
    assert found.redo()
    assert found.now == states[1]
    found.put(texts("c"))
    assert found.steps == (2, 0)
    assert not found.redo()


def test_the_edits_of_a_drag_are_undone_together():
    found = History(texts("a"))
    for word in "bcd":
        found.put(texts(word), "drag 1")
    for word in "ef":
        found.put(texts(word), "drag 2")
    assert found.steps == (2, 0)
    found.undo()
    assert found.now == texts("d")
    found.put(texts("x"), "drag 2")
    assert found.steps == (2, 0)


def test_old_texts_are_forgotten(monkeypatch):
    monkeypatch.setattr(history, "MAX_STATES", 10)
    found = History(texts("0"))
    for number in range(30):
        found.put(texts(str(number)))
    assert found.steps == (9, 0)
    monkeypatch.setattr(history, "MAX_CHARACTERS", 1000)
    for number in range(5):
        found.put(texts(f"{number:400}"))
    assert found.steps == (1, 0)
