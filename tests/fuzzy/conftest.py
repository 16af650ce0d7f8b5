import pytest
import yaml

from fuzzytrack import yamltree

LOADERS = [yaml.SafeLoader, getattr(yaml, "CSafeLoader", yaml.SafeLoader)]


@pytest.fixture(params=LOADERS, ids=lambda loader: loader.__name__)
def parser(request, monkeypatch):
    """Both of PyYAML's parsers: a platform may lack libyaml."""
    monkeypatch.setattr(yamltree, "_LOADER", request.param)
