import json
import math
from pathlib import Path

import numpy as np

from fuzzytrack.json_types import plain


def test_values_are_in_the_types_of_json():
    value = {
        1: (np.float32(0.5), np.int64(3), np.bool_(True)),
        "table": np.array([[1.0, np.nan, -2.0], [np.inf, 0.0, 4.0]]),
        "none": [None, math.inf, "text", Path("a", "b.csv")],
        "empty": np.array([]),
    }
    found = plain(value)
    assert found == {
        "1": [0.5, 3, True],
        "table": [[1.0, None, -2.0], [None, 0.0, 4.0]],
        "none": [None, None, "text", str(Path("a", "b.csv"))],
        "empty": [],
    }
    assert json.loads(json.dumps(found, allow_nan=False)) == found
