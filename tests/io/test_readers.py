from contextlib import contextmanager
from importlib.metadata import EntryPoint

import pytest
from data_files import written

from fuzzytrack import PluginWarning
from fuzzytrack.io.csv import open_source
from fuzzytrack.io.formats import CsvReader, ParquetReader, open_table
from fuzzytrack.io.readers import Reader, make_reader, reader_of, readers
from fuzzytrack.plugins import Registry, registry


class Bars(Reader):
    """CSV with bars for commas."""

    suffixes = (".bars",)

    def __init__(self, mark: str = "|") -> None:
        self.mark = mark

    @contextmanager
    def open_source(self, file):
        with open(file) as stream, open(file + ".csv", "w") as copy:
            copy.write(stream.read().replace(self.mark, ","))
        with open_source(file + ".csv") as source:
            yield source


class Nothing(Reader):
    def __init__(self, needed: int) -> None:
        self.needed = needed

    def open_source(self, file):
        raise AssertionError("opened, although it cannot be made")


@pytest.fixture
def installed(monkeypatch):
    """Puts a registry of the built-in readers, and plug-ins that a test names, in place."""

    def install(**points):
        found = [EntryPoint(name, value, "fuzzytrack.readers") for name, value in points.items()]
        monkeypatch.setattr(registry, "entry_points", lambda group: found)
        fresh = Registry("reader", "fuzzytrack.readers", Reader)
        fresh._local, fresh._own = dict(readers._local), dict(readers._own)
        monkeypatch.setattr("fuzzytrack.io.readers.readers", fresh)

    return install


@pytest.mark.parametrize(
    ("file", "reader"),
    [
        ("a.csv", CsvReader),
        ("A.CSV", CsvReader),
        ("b.parquet", ParquetReader),
        ("b.PQ", ParquetReader),
    ],
)
def test_a_suffix_says_the_format(file, reader):
    assert type(reader_of(file)) is reader


def test_what_no_reader_knows_is_csv(tmp_path):
    assert reader_of("plots.dat") is None
    with open_table(str(written(tmp_path, "t,x\n0,1\n", "plots.dat"))) as source:
        assert tuple(source.types) == ("t", "x")


def test_a_format_goes_before_the_suffix(tmp_path):
    with open_table(str(written(tmp_path, "t,x\n0,1\n", "plots.parquet")), format="csv") as source:
        assert tuple(source.types) == ("t", "x")


@pytest.mark.parametrize(
    ("format", "message"),
    [
        ("parket", r"format: unknown 'parket'; did you mean 'parquet'\? allowed: .*csv"),
        ("csv:rows=3", r"format 'csv:rows=3': unknown parameter 'rows'"),
        ("csv:rows", r"format 'csv:rows': 'rows' is no parameter"),
    ],
)
def test_an_unknown_format_is_an_error_with_the_known_ones(format, message):
    with pytest.raises(ValueError, match=message):
        open_table("plots.csv", format=format)


def test_a_reader_of_a_package_is_found_by_suffix_and_by_name(installed, tmp_path):
    installed(bars=f"{__name__}:Bars")
    file = str(written(tmp_path, "t|x\n0|1\n", "plots.bars"))
    for format in (None, "bars", "bars:mark=|"):
        with open_table(file, format=format) as source:
            assert tuple(source.types) == ("t", "x")
    assert make_reader("bars:mark=;").mark == ";"


def test_a_reader_that_cannot_be_loaded_is_named_and_skipped(installed):
    installed(broken="no_such_module:Reader", bars=f"{__name__}:Bars")
    # Not looked at for files that a built-in reader reads.
    assert type(reader_of("plots.csv")) is CsvReader
    with pytest.warns(PluginWarning, match="reader 'broken' of package no_such_module could not"):
        assert type(reader_of("plots.bars")) is Bars
    with pytest.raises(ValueError, match="reader 'broken' of package no_such_module could not"):
        make_reader("broken")


def test_a_reader_that_needs_a_parameter_says_so(installed):
    installed(nothing=f"{__name__}:Nothing")
    with pytest.warns(PluginWarning, match="reader 'nothing' of package .* cannot be used.*needed"):
        assert reader_of("plots.other") is None
    with pytest.raises(ValueError, match="format 'nothing': needs needed; write it as"):
        make_reader("nothing")


def test_a_factory_that_makes_no_reader_is_named(installed):
    installed(text="builtins:repr")
    with pytest.raises(ValueError, match=r"reader 'text'|format 'text'"):
        make_reader("text")
