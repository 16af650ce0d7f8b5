"""Tables at any width: numbers stay whole, names break at their colons only."""

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.cells import cell_len

from fuzzytrack.cli import demo as demonstration
from fuzzytrack.cli import output
from fuzzytrack.cli.text_table import table_lines, wrapped
from fuzzytrack.papers.zhang_jiang import experiment

HEADS = ["RMSE (m)", "predicted", "filtered", "vs first"]
ROWS = [
    ["maneuver", "12.15 ± 0.31", "9.15 ± 0.31", ""],
    ["fixed:alpha=0.5377:beta=0.2018", "13.15 ± 0.32", "9.99 ± 0.32", "+12.3 %"],
    [],
    ["the plots themselves", "", "14.14", ""],
]


def test_columns_stand_side_by_side_where_there_is_room():
    assert table_lines(HEADS, ROWS, 80) == [
        "RMSE (m)                           predicted     filtered  vs first",
        "─" * 67,
        "maneuver                        12.15 ± 0.31  9.15 ± 0.31",
        "fixed:alpha=0.5377:beta=0.2018  13.15 ± 0.32  9.99 ± 0.32   +12.3 %",
        "",
        "the plots themselves                                14.14",
    ]


def test_a_name_is_broken_at_its_colons():
    assert table_lines(HEADS, ROWS, 60)[2:5] == [
        "maneuver                 12.15 ± 0.31  9.15 ± 0.31",
        "fixed:alpha=0.5377:      13.15 ± 0.32  9.99 ± 0.32   +12.3 %",
        "beta=0.2018",
    ]


def test_a_table_without_room_is_turned():
    assert table_lines(HEADS, ROWS, 30) == [
        "RMSE (m)",
        "─" * 30,
        "maneuver",
        "  predicted  12.15 ± 0.31",
        "  filtered   9.15 ± 0.31",
        "fixed:alpha=0.5377:beta=0.2018",
        "  predicted  13.15 ± 0.32",
        "  filtered   9.99 ± 0.32",
        "  vs first   +12.3 %",
        "",
        "the plots themselves",
        "  filtered   14.14",
    ]
    assert table_lines(HEADS, ROWS[1:2], 20)[2:6] == [
        "fixed:alpha=0.5377:",
        "  beta=0.2018",
        "  predicted",
        "    13.15 ± 0.32",
    ]


def test_columns_without_a_head_lead_a_turned_table():
    rows = [["Table 1", "α", "0.8333", "matches"], ["", "β", "0.5", ""]]
    assert table_lines(["", "", "published", "verdict"], rows, 20, words=2) == [
        "─" * 20,
        "Table 1 α",
        "  published  0.8333",
        "  verdict    matches",
        "β",
        "  published  0.5",
    ]


def test_an_empty_table_has_a_head():
    assert table_lines(["a", "b"], [], 80) == ["a  b", "────"]
    assert wrapped("", 10) == [""]


@pytest.mark.parametrize("name", ["a: b c", "omega:xi=.5", "名前:値=1 二", "a::b:"])
def test_wrapped_text_is_the_text(name):
    assert wrapped(name, 200) == [name]
    assert "".join(wrapped(name, 1)).replace(" ", "") == name.replace(" ", "")


words = st.lists(st.from_regex(r"[a-z0-9=.:±é-]{1,9}", fullmatch=True), min_size=1, max_size=4)


@settings(max_examples=40)
@given(
    st.lists(st.tuples(words.map(" ".join), words.map(" ".join)), min_size=1, max_size=3),
    st.integers(1, 60),
)
def test_nothing_is_wider_than_the_terminal_but_a_piece_of_a_name(rows, width):
    lines = table_lines(["what", "how much"], [list(row) for row in rows], width)
    pieces = _pieces(" ".join(["what how much", *map(" ".join, rows)]))
    longest = max(map(cell_len, pieces))
    assert max(map(cell_len, lines)) <= max(width, longest + 4)


# -------------------------------------------------------------------- tables of the commands


def _pieces(text):
    """What is never broken: words, and the parts of a name that end in a colon."""
    return [part for word in text.split() for part in re.findall(r"[^:]*:+(?=.)|.+", word)]


TRUTH = "t,x,y\n" + "".join(f"{k},{9 * k},{k * k}\n" for k in range(60))
FEW = ("--runs", 2, "--trackers", "fixed:alpha=0.5377:beta=0.2018,omega-schedule:period=1")
COMMANDS = {
    "track": ("track", "plots.csv"),
    "compare": ("compare", "plots.csv", "--noise", 3, *FEW),
    "compare recorded": ("compare", "plots.csv", "--sigma", 3, "--truth", "x,y", *FEW[2:]),
    "demo": ("demo", "-o", "made", "--runs", 1),
    "testbed": ("testbed", "report", *FEW),
    "testbed list": ("testbed",),
    "tune": ("tune", "mixed", "--tracker", "fixed", "--runs", 10, "--trials", 2, "--folds", 2),
    "gains": ("gains", "--alpha", 0.5, "--beta", 0.4, "--sigma", 10),
    "design": ("design", "kalata", "--index", 0.1),
    "certify": ("certify", "stiffness-damping-wide"),
    "rulebase list": ("rulebase", "list"),
    "rulebase show": ("rulebase", "show", "stiffness-damping"),
    "rulebase explain": ("rulebase", "explain", "stiffness-damping", "--at", "E=.3,dE=-.2"),
    "reproduce": ("reproduce", "zhang-jiang"),
    "trackers": ("trackers",),
}


@pytest.fixture(autouse=True)
def without_experiment(monkeypatch):
    """The experiment of Zhang & Jiang takes a minute, and is tested by itself."""
    monkeypatch.setattr(experiment, "experiment_rows", lambda *given: [])


@pytest.mark.parametrize("name", COMMANDS)
def test_tables_of_commands_fit_any_terminal(name, run, csv, tmp_path, monkeypatch):
    csv(TRUTH)
    seen = []
    monkeypatch.setattr(
        output, "table_lines", lambda *table: seen.append(table) or table_lines(*table)
    )
    monkeypatch.setattr(demonstration, "save_picture", lambda *given: None)
    monkeypatch.chdir(tmp_path)
    result = run(*COMMANDS[name])
    assert result.exit_code == 0, result.output
    assert seen
    for columns, rows, _, words in seen:
        cells = [cell for row in [columns, *rows] for cell in row]
        whole = {piece for cell in cells for piece in _pieces(cell)}
        for width in (40, 80, 200):
            lines = table_lines(columns, rows, width, words)
            text = [line for line in lines if set(line) - {"─"}]
            assert max(map(cell_len, lines)) <= width
            # Every word is there, and is whole.
            assert {piece for line in text for piece in _pieces(line)} == whole
