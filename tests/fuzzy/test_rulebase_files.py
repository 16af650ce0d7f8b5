"""Rule bases in files: shipped ones by name, others by path."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from texts import LIST, TABLE

from fuzzytrack import shipped
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.loading import load_rulebase, rulebase_path, shipped_rulebases


def test_names_and_paths(tmp_path, monkeypatch):
    assert "stiffness-damping" in shipped_rulebases()
    assert rulebase_path("tipper").is_file()
    monkeypatch.chdir(tmp_path)
    Path("mine.yaml").write_text(TABLE)
    Path("mine").write_text(LIST)
    assert load_rulebase("mine.yaml").name == "small"
    assert load_rulebase("./mine").name == "list"
    assert load_rulebase(Path("mine")).name == "list"


def test_unknown_name():
    with pytest.raises(RuleBaseError, match=r"mean 'tipper'.*valve"):
        load_rulebase("tiper")


@pytest.mark.parametrize("name", ["missing.yaml", "a/b", "nul\0.yaml", "."])
def test_unreadable_files(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(RuleBaseError, match="cannot read"):
        load_rulebase(Path(name))


def test_huge_files_are_not_read_whole(tmp_path):
    path = tmp_path / "huge.yaml"
    with open(path, "wb") as stream:
        stream.truncate(10**10)
    with pytest.raises(RuleBaseError, match="128 KiB"):
        load_rulebase(path)


def test_errors_name_the_file(tmp_path):
    path = tmp_path / "bad.yaml"
    path.write_text(TABLE.replace("label:", "lable:"))
    with pytest.raises(RuleBaseError) as caught:
        load_rulebase(path)
    assert str(caught.value).startswith(f"{path}:5:5: ")


def test_an_installed_package_carries_its_own(monkeypatch, tmp_path):
    shutil.copytree(rulebase_path("tipper").parent, tmp_path / "package" / "rulebases")
    (tmp_path / "package" / "rulebases" / "valve.yaml").unlink()
    monkeypatch.setattr(shipped, "__file__", str(tmp_path / "package" / "shipped.py"))
    assert rulebase_path("tipper") == tmp_path / "package" / "rulebases" / "tipper.yaml"
    assert "valve" not in shipped_rulebases()


def test_missing_directory(monkeypatch, tmp_path):
    monkeypatch.setattr(shipped, "__file__", str(tmp_path / "a" / "b" / "shipped.py"))
    with pytest.raises(RuleBaseError, match="shipped rule bases are missing"):
        shipped_rulebases()


def test_loading_imports_nothing_heavy():
    code = (
        "import sys; from fuzzytrack.fuzzy.loading import load_rulebase; "
        "load_rulebase('stiffness-damping'); load_rulebase('tipper'); "
        "print(*{'skfuzzy', 'scipy', 'numba', 'matplotlib'} & set(sys.modules))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == ""
