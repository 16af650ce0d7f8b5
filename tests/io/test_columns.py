import pytest
from data_files import written

from fuzzytrack import DataError
from fuzzytrack.io import read_tracks


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"time": "tt"}, "`time`: no column 'tt'; did you mean 't'"),
        ({"axes": ["x", "q"]}, "`axes`: no column 'q'; allowed: t, id, x, none"),
        ({"axes": []}, "`axes`: needs at least one"),
        ({"id": "idd"}, "`id`: no column 'idd'; did you mean 'id'"),
        ({"axes": ["x", "x"]}, "column 'x' cannot serve twice"),
        ({"id": "none"}, "column none: no row has an identity"),
    ],
)
def test_bad_columns(tmp_path, columns, message):
    with pytest.raises(DataError, match=message):
        read_tracks(written(tmp_path, "t,id,x,none\n0,a,0,\n1,,0, \n"), **columns)
