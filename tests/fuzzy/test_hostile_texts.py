"""Texts that mean harm, or might: refused, with a place and a short message."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from texts import LIST, TABLE, changed, refusal

from fuzzytrack import yamltree

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import fuzz_rulebases

BOMB = "a0: &a0 [x, x]\n" + "".join(
    f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]\n" for k in range(1, 12)
)
HOSTILE = {
    "empty": ("", (1, 1), "empty"),
    "comment": ("# nothing", (1, 1), "empty"),
    "two documents": (f"{TABLE}---\n{TABLE}", (31, 1), "second document"),
    "tag": (TABLE.replace("name: small", "name: !!python/name:os.system x"), (2, 7), "tag"),
    "local tag": (TABLE.replace("name: small", "name: ! small"), (2, 7), "tag"),
    "merge": (TABLE.replace("name: small", "<<: {name: small}"), (2, 1), "'<<'"),
    "list as key": ("[a]: b", (1, 1), "key must be a word"),
    "alias first": ("a: *a", (1, 4), "no anchor before"),
    "alias of itself": ("a: &a [*a]", (1, 8), "contains itself"),
    "anchor twice": ("a: &a b\nc: &a d", (2, 4), "twice"),
    "bomb": (BOMB, (5, 25), "more than"),
    "deep": ("a: " + "[" * 1000, (1, 15), "deeper than"),
    "deep by alias": ("a: &a [[[[[[x]]]]]]\nb: [[[[[[*a]]]]]]", (2, 10), "deeper than"),
    "long": ("#" + "x" * yamltree.MAX_BYTES, (1, 1), "128 KiB"),
    "long in bytes": ("#" + "é" * (yamltree.MAX_BYTES - 10), (1, 1), "128 KiB"),
    "many": ("a: [" + "x," * 20_000 + "]", (1, 20_003), "more than"),
    "NUL": ("a: b\nc: \0", (2, 4), "U+0000"),
    "escaped NUL": ('a: b\nc: "\\0"', (2, 4), "U+0000"),
    "line separator": ("a: b\u2028c", (1, 5), "U+2028"),
    "surrogate": ("a: \ud800", (1, 4), "U+D800"),
    "not UTF-8": (b"a: b\nc: \xc3\xa9\xff", (2, 5), "0xff"),
    "UTF-16": ("a: b".encode("utf-16"), (1, 1), "UTF-8"),
    "not YAML": ("a: [b\nc: d", (1, 4), "not YAML"),
    "list": ("- a", (1, 1), "mapping"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_texts(name):
    text, where, word = HOSTILE[name]
    error = refusal(text)
    assert word in error.message
    assert (error.location.line, error.location.column) == where


@pytest.mark.usefixtures("parser")
def test_impossible_escapes():
    for escape in ("\\UFFFFFFFF", "\\ud800", "\\q"):
        refusal(f'name: "{escape}"')


@pytest.mark.usefixtures("parser")
@pytest.mark.parametrize("filler", ["1,", "[1],", "{a: 1},", "x ", "\n", "#\n", "&a ", "\\n"])
def test_the_longest_texts_are_refused(filler):
    body = filler * ((yamltree.MAX_BYTES - 10) // len(filler))
    refusal("a: [" + body)


def test_error_messages_stay_short():
    error = refusal(TABLE.replace("scheduler:", "x" * 50_000 + ":"))
    assert len(error.message) < 300
    many = ", ".join(f"s{k}: {{singleton: [0]}}" for k in range(1000))
    text = changed(LIST, "{S: {trimf: [0, 0, 2]}, L: {trimf: [0, 2, 2]}}\n  v", f"{{{many}}}\n  v")
    assert len(refusal(text.replace("u: S}", "u: q}")).message) < 400


@pytest.mark.untraced
def test_fuzzed_texts_load_or_are_refused():
    report = fuzz_rulebases.run(seed=1, start=0, count=1500)
    assert report.failures == []
    assert report.total == 1500
    # a fuzzer whose texts all fail, or all pass, tests nothing
    assert report.accepted > 50
    assert report.refused > 500


@pytest.mark.untraced
@pytest.mark.parametrize("form", ["fis", "fll"])
def test_fuzzed_texts_of_other_formats_load_or_are_refused(form):
    report = fuzz_rulebases.run(seed=1, start=0, count=700, form=form)
    assert report.failures == []
    assert report.accepted > 50
    assert report.refused > 300
