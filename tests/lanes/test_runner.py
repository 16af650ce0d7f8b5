import numpy as np

import fuzzytrack as ft
from fuzzytrack.lanes import runner as module
from fuzzytrack.trackers.compilation import announce
from fuzzytrack.trackers.runners import runner


def test_many_small_jobs_are_compiled_like_one_large_one(monkeypatch):
    monkeypatch.setattr(module, "COMPILE_ABOVE", 100)
    compiled = []
    original = module.Runner._run_compiled

    def noted(self, *given):
        compiled.append(given[1].size)
        return original(self, *given)

    monkeypatch.setattr(module.Runner, "_run_compiled", noted)
    tracker = ft.AlphaBetaTracker(ft.FixedGains(0.4321, 0.1234))
    results = [tracker.run(np.arange(40), np.arange(40.0) ** 1.5) for _ in range(4)]
    assert compiled == [40, 40]
    assert runner(tracker, 1).work == 160
    np.testing.assert_array_equal(results[0].filtered, results[3].filtered)


def test_announced_work_is_compiled_from_its_first_part(monkeypatch):
    monkeypatch.setattr(module, "COMPILE_ABOVE", 100)
    compiled = []
    monkeypatch.setattr(
        module.Runner,
        "_run_compiled",
        lambda self, *given: compiled.append(1) or self._run_plain(*given[:5]),
    )
    tracker = ft.AlphaBetaTracker(ft.FixedGains(0.4322, 0.1234))
    announce(tracker, 2, 100)
    for _ in range(12):
        tracker.run(np.arange(4), np.zeros((4, 2)))
    assert compiled == []
    announce(tracker, 2, 5)
    tracker.run(np.arange(4), np.zeros((4, 2)))
    assert compiled == [1]
    announce(object(), 2, 101)
