"""Checks have names, and each can be a test of its own."""

import re
from pathlib import Path

import pytest
from subjects import Faulty, run_check, scheduler_of

import fuzzytrack as ft
from fuzzytrack.normalizations import normalizations
from fuzzytrack.schedulers import KalmanCV, schedulers
from fuzzytrack.testing import checks_for, parametrize_with_checks
from fuzzytrack.trackers import trackers


def test_checks_have_names():
    names = [check.name for check in checks_for(KalmanCV(0.5))]
    assert len(set(names)) == len(names)
    assert {"batch-equals-single", "streaming-equals-run", "gains-are-stable"} <= set(names)
    tracker = [check.name for check in checks_for(ft.AlphaBetaTracker(KalmanCV(0.5)))]
    assert set(tracker) - set(names) == {"program-uses-numbers-only"}
    of_lanes = {"compiled-equals-plain", "rows-left-out"}
    assert of_lanes <= set(tracker)
    assert not of_lanes & {check.name for check in checks_for(Faulty())}


def test_the_page_lists_every_check_and_every_kind_of_plugin():
    page = (Path(__file__).resolve().parents[2] / "docs" / "plugins.md").read_text()
    for subject in (ft.FixedGains(0.5, 0.2), ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2))):
        assert [check.name for check in checks_for(subject) if f"`{check.name}`" not in page] == []
    for registry in (schedulers, trackers, normalizations):
        assert f"| `{registry.group}` |" in page


@parametrize_with_checks({"good": ft.FixedGains(0.5, 0.2)})
def test_each_check_is_a_test(check, request):
    assert request.node.name == f"test_each_check_is_a_test[good-{check.name}]"
    if check.name not in ("compiled-equals-plain", "rows-left-out"):
        check()


def test_objects_of_a_class_are_numbered():
    mark = parametrize_with_checks([ft.FixedGains(0.5, 0.2), Faulty(), ft.FixedGains(0.4, 0.2)])
    ids = [parameters.id for parameters in mark.args[1]]
    assert len(set(ids)) == len(ids)
    for name in ("FixedGains-hashable", "Faulty-batch-equals-single", "FixedGains-2-hashable"):
        assert name in ids


def test_any_other_error_says_in_which_check():
    def raises(result, t, z):
        raise KeyError("z")

    with pytest.raises(
        AssertionError, match=r"^inputs-left-alone: Faulty raises KeyError: 'z'$"
    ) as caught:
        run_check("inputs-left-alone", Faulty(run=raises))
    assert isinstance(caught.value.__cause__, KeyError)


def test_an_error_of_the_compiler_is_one_sentence():
    def mixed(innovation, change, dt, sigma, memory):
        return (0.5 if abs(innovation) < 1e12 else "half"), 0.2, 0.0, 1.0, memory

    with pytest.raises(AssertionError) as caught:
        run_check("compiled-equals-plain", scheduler_of(mixed))
    assert re.match(
        r"compiled-equals-plain: Made raises TypingError: \S.*float64.*$", str(caught.value)
    )
