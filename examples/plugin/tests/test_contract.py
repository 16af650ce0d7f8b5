import pytest
from fuzzytrack_two_speed import Averaged, FirstCome, SoftSign, SonarLog, TwoSpeed

import fuzzytrack as ft
from fuzzytrack.fuzzy.saving import dumps_rulebase
from fuzzytrack.io import open_table
from fuzzytrack.io.readers import readers
from fuzzytrack.normalizations import normalizations
from fuzzytrack.scan.association import associations
from fuzzytrack.schedulers import schedulers
from fuzzytrack.testing import check_scheduler, parametrize_with_checks
from fuzzytrack.trackers import ParallelBank, trackers


def test_entry_points_are_found():
    assert schedulers.get("two-speed") is TwoSpeed
    assert trackers.get("averaged") is Averaged
    assert normalizations.get("soft-sign") is SoftSign
    assert readers.get("sonar-log") is SonarLog
    assert associations.get("first-come") is FirstCome


@parametrize_with_checks([TwoSpeed(threshold=2.0), Averaged(quiet=0.2), FirstCome(bonus=1.0)])
def test_contract(check):
    check()


def test_the_tracker_is_the_mean_of_two_filters():
    times, plots = [0.0, 1.0, 2.5, 3.0, 5.0], [0.0, 10.0, 27.0, 30.0, float("nan")]
    mean = Averaged(0.3, 0.8).run(times, plots)
    one, other = (ParallelBank(alpha, alpha, members=1, selection="best").run(times, plots)
                  for alpha in (0.3, 0.8))  # fmt: skip
    for name in ("predicted", "filtered", "velocity"):
        expected = (getattr(one, name) + getattr(other, name)) / 2
        assert getattr(mean, name) == pytest.approx(expected, nan_ok=True)


def test_the_normalization_feeds_a_rule_base():
    text = dumps_rulebase(ft.load_rulebase("stiffness-damping"))
    assert "chan" in text
    rules = ft.loads_rulebase(text.replace("normalization: chan", "normalization: soft-sign"))
    check_scheduler(ft.FuzzyScheduler(rules))


def test_the_reader_is_chosen_by_the_end_of_the_name(tmp_path):
    file = tmp_path / "run.slog"
    file.write_text("0 A7 1500 44\n-- link lost --\n2 A7 1510 44.5\n")
    with open_table(str(file)) as source:
        (table,) = source.tables({"id": "word", "range": "gaps"}, rows=None)
    assert list(table.words["id"]) == ["A7", "A7"]
    assert list(table.numbers["range"]) == [1500.0, 1510.0]
    assert source.notes == [f"{file}: lines that are no plot: 1 left out, first at line 2"]
