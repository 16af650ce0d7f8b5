"""Rule bases with what the page cannot draw are complained of, not drawn by half."""

import pytest

from fuzzytrack.fuzzy.loading import rulebase_path
from fuzzytrack.studio.complaints import complaints_of_rules

TEXT = rulebase_path("tipper").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "{if any: {service: poor, food: rancid},     ",
            "{if: {service: poor}, or: [{food: rancid}],",
            "rules with 'or'",
        ),
        ("{gaussmf: [5, 1.5]}", "{not gaussmf: [5, 1.5]}", "shape not gaussmf of 'good'"),
        ("{gaussmf: [5, 1.5]}", "{spike: [5, 1.5]}", "shape spike of 'good'"),
        (
            'unit: "%"',
            "operators: {and: min, or: sum, defuzzification: centroid}",
            "operators of their own",
        ),
    ],
)
def test_what_is_not_shown_is_said(old, new, said):
    assert complaints_of_rules(TEXT, "tip.yaml")[1] == ()
    assert old in TEXT
    rules, (complaint,) = complaints_of_rules(TEXT.replace(old, new), "tip.yaml")
    assert rules is None
    assert said in complaint.message
