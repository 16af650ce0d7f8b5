import subprocess
import sys

import pytest

import fuzzytrack as ft


@pytest.mark.parametrize("name", ft.__all__)
def test_every_public_name_is_there(name):
    value = getattr(ft, name)
    if name != "__version__":
        assert value.__name__ == name


def test_dir_lists_the_public_names():
    assert dir(ft) == sorted(ft.__all__)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'fuzzytrack' has no attribute 'nothing'"):
        _ = ft.nothing


def test_importing_fuzzytrack_stays_light():
    heavy = ("matplotlib", "numba", "scipy", "skfuzzy", "typer", "rich")
    # Also with a tracker in use: what is heavy waits for pictures and large batches.
    code = (
        "import sys, fuzzytrack as ft; "
        "rules = ft.load_rulebase('stiffness-damping'); "
        "tracker = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2)); "
        "tracker.run([0, 1, 2], [0, 1, 2]); "
        f"print([m for m in {heavy!r} if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "[]"
