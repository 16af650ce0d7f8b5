import pytest

from fuzzytrack.lanes.layout import OUTPUTS, Rows


@pytest.mark.parametrize(("n_axes", "gain_sets"), [(1, 1), (3, 1), (3, 3)])
def test_every_row_holds_one_thing(n_axes, gain_sets):
    rows = Rows(n_axes, 4, scratch=("ratio", "exponent"), gain_sets=gain_sets)
    widths = {
        "position": n_axes, "velocity": n_axes, "acceleration": n_axes, "last_plot": n_axes,
        "gap": 1, "plots": 1, "memory": 4, "predicted": n_axes, "innovation": n_axes,
        "gains": 3 * gain_sets, "now": 3 * n_axes, "last_time": 1, "plot": n_axes, "sigma": n_axes,
        "dt": 1,
    }  # fmt: skip
    taken = [getattr(rows, name) + k for name, width in widths.items() for k in range(width)]
    assert taken == list(range(rows.given))
    scratch = [rows.scratch_row(name) for name in rows.scratch]
    assert scratch == [rows.given, rows.given + 1]
    assert rows.total == rows.given + 2
    assert (rows.state, rows.results, rows.kept) == (rows.predicted, rows.now, rows.plot)


@pytest.mark.parametrize("gain_sets", [1, 2])
def test_outputs_have_rows_of_their_own(gain_sets):
    rows = Rows(2, 0, gain_sets=gain_sets)
    taken = [rows.output(name) + k for name in OUTPUTS for k in range(rows.width(name))]
    assert len(set(taken)) == len(taken) == 10 + 3 * gain_sets
    assert rows.output("gamma") == rows.gains + 2 * gain_sets
    assert max(taken) < rows.results


def test_what_is_shown_is_no_part_of_the_state():
    rows = Rows(2, 3)
    firsts = {name: rows.shown(name) for name in OUTPUTS}
    assert len(set(firsts.values())) == len(OUTPUTS)
    assert all(rows.state <= first < rows.last_time for first in firsts.values())
    moving = ("filtered", "velocity", "acceleration")
    assert [firsts[name] for name in moving] == [rows.now, rows.now + 2, rows.now + 4]
    for name in set(OUTPUTS) - set(moving):
        assert firsts[name] == rows.output(name)


def test_a_row_that_was_not_named_is_refused():
    with pytest.raises(ValueError, match="not in tuple"):
        Rows(1, 0, scratch=("ratio",)).scratch_row("exponent")
