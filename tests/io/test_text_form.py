import pytest

from fuzzytrack.io.text_form import MISSING, TextForm


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"delimiter": "x"}, "delimiter: must be a comma, semicolon, tab, .* got 'x'"),
        ({"decimal": "'"}, 'decimal: must be .* got "\'"'),
        ({"comment": "12"}, "comment: must be one or two marks as '#', got '12'"),
        ({"na": "null"}, "na: must be several texts, got 'null'"),
        ({"columns": "t"}, "columns: must be several texts"),
        ({"columns": ()}, "columns: needs at least one name"),
    ],
)
def test_what_cannot_be_is_refused(words, message):
    with pytest.raises(ValueError, match=message):
        TextForm(**words)


def test_twenty_tokens_stand_for_a_missing_number():
    assert len(MISSING) >= 20
    form = TextForm(na=["X", "-999", "1e36"])
    assert form.missing == MISSING | {"x", "-999", "1e36"}
    assert form.missing_numbers == (-999.0, 1e36)
    assert form == eval(repr(form))
