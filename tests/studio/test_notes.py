"""Warnings of the work of a page."""

import threading
import warnings

import numpy as np

from fuzzytrack.errors import CacheWarning, TrackWarning
from fuzzytrack.studio import notes
from fuzzytrack.studio.notes import noted, warnings_to_notes


def warn(text, category=TrackWarning):
    warnings.warn(text, category, stacklevel=2)


def test_each_text_is_noted_once_and_not_without_end(monkeypatch):
    monkeypatch.setattr(notes, "MOST_NOTES", 3)
    with warnings_to_notes(), noted() as found:
        for text in "abacd":
            warn(text)
        with noted() as inner:
            warn("of a part")
    assert found == ["a", "b", "c"]
    assert inner == ["of a part"]


def test_another_thread_has_notes_of_its_own():
    def work():
        with noted() as found:
            warn("there")
        told.extend(found)

    told = []
    with warnings_to_notes(), noted() as found:
        thread = threading.Thread(target=work)
        thread.start()
        thread.join()
        warn("here")
    assert (found, told) == (["here"], ["there"])


def test_the_console_is_told_of_the_cache_and_of_nothing_else():
    def work():
        with warnings_to_notes():
            warnings.simplefilter("always")
            warn("no notes are taken here")
            with noted() as found:
                np.float64(1e308) * 10
                warn("not kept", CacheWarning)
        return found

    with warnings.catch_warnings(record=True) as shown:
        assert work() == []
    assert [(w.category, str(w.message)) for w in shown] == [(CacheWarning, "not kept")]
