from dataclasses import replace

import pytest

import fuzzytrack as ft
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.copying import copied_rulebase
from fuzzytrack.fuzzy.loading import rulebase_path, shipped_rulebases
from fuzzytrack.fuzzy.saving import SCHEMA_LINE


@pytest.mark.parametrize("name", shipped_rulebases())
def test_a_copy_has_another_name_and_the_rest_of_the_text(name):
    text = rulebase_path(name).read_text("utf-8")
    copy = copied_rulebase(text, "mine", name)
    assert ft.loads_rulebase(copy) == replace(ft.load_rulebase(name), name="mine")
    assert copy.splitlines()[:2] == [SCHEMA_LINE, f"# A copy of {name}, to be edited."]
    assert copy.splitlines()[4:] == text.splitlines()[3:]


@pytest.mark.parametrize("name", ["no", "7", "a: b # c", 'with "quotes"', "größer", "a\\b"])
def test_names_that_yaml_could_misread_are_kept(name):
    text = rulebase_path("tipper").read_text("utf-8")
    assert ft.loads_rulebase(copied_rulebase(text, name)).name == name


def test_line_ends_and_byte_order_marks_are_understood():
    text = rulebase_path("tipper").read_text("utf-8")
    copy = copied_rulebase("\ufeff" + text.replace("\n", "\r\n"), "mine")
    assert "\n" not in copy.replace("\r\n", "")
    assert copy.replace("\r\n", "\n") == copied_rulebase(text, "mine")


def test_a_text_without_a_schema_gets_one():
    text = rulebase_path("tipper").read_text("utf-8").partition("\n")[2]
    assert copied_rulebase(text, "mine").count(SCHEMA_LINE) == 1


@pytest.mark.parametrize(
    ("text", "name"), [("rulebase: 1\n", "mine"), (None, ""), (None, "a\tb\0")]
)
def test_what_is_no_rule_base_or_no_name_is_refused(text, name):
    text = text or rulebase_path("tipper").read_text("utf-8")
    with pytest.raises(RuleBaseError):
        copied_rulebase(text, name)
