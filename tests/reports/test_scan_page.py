"""The animated page of a scan tracker: what it holds, that nothing escapes, and that it runs."""

import base64
import json
import re
import shutil
import subprocess
from html.parser import HTMLParser

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.reports import write_scan_page
from fuzzytrack.reports.scan_page_data import Shown, as_script
from fuzzytrack.scan import Scan, TrackReports

VOID = {"meta", "link", "input", "br", "circle", "rect", "path"}


def reports_of(lengths, kinds=None, start=0):
    """Tracks 1, 2 …, each in so many scans from the first on; track n moves along y = n."""
    rows = [(k, n) for n, count in enumerate(lengths, 1) for k in range(start, start + count)]
    scan, track = (np.array(each, np.int64) for each in zip(*rows, strict=True))
    kinds = np.ones(len(lengths), np.uint8) if kinds is None else np.array(kinds, np.uint8)
    position = np.stack([10.0 * scan, 1000.0 + track], axis=1)
    return TrackReports(
        scan=scan,
        time=2.0 * scan,
        track_id=track,
        position=position,
        velocity=np.tile([5.0, 0.0], (len(scan), 1)),
        deviation=np.tile([3.0, 4.0, 1.0, 1.0], (len(scan), 1)),
        status=np.ones(len(scan), np.uint8),
        kind=kinds[track - 1],
        existence=np.where(track == 1, np.nan, 0.876),
        since_last=np.zeros(len(scan)),
        plot=track,
    )


def scans_of(count, plots=2):
    places = 7.0 * np.arange(2.0 * count * plots).reshape(count, plots, 2)
    return [Scan(2.0 * k, places[k], own=(1.0 * k, -5.0)) for k in range(count)]


class Elements(HTMLParser):
    """Elements with their attributes and texts; fails where one is not closed."""

    def __init__(self, text):
        super().__init__()
        self.open, self.found, self.texts = [], [], {}
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts[self.open[-1] if self.open else ""] = data


def page_of(path, *arguments, **options):
    return write_scan_page(path / "page.html", *arguments, **options).read_text("utf-8")


def data_of(page):
    return json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL)[1])


def numbers(text, kind):
    return np.frombuffer(base64.b64decode(text), kind)


def test_the_columns_come_back(tmp_path):
    reports = reports_of([3, 2])
    shuffled = reports.where(np.array([4, 0, 3, 2, 1]))
    data = data_of(page_of(tmp_path, shuffled, scans_of(3), axes_names=("x_m", "y_m")))
    found = data["reports"]
    track, start = numbers(found["track"], "<u4"), numbers(found["from"], "<u4")
    assert found["ids"] == ["1", "2"]
    np.testing.assert_array_equal(start, [0, 2, 4, 5])
    place = numbers(found["place"], "<f4").reshape(-1, 2) + data["origin"]
    scan = np.repeat(np.arange(3), np.diff(start))
    np.testing.assert_allclose(place, np.stack([10.0 * scan, 1001.0 + track], axis=1), atol=1e-3)
    assert sorted(zip(scan.tolist(), track.tolist(), strict=True)) == [
        (0, 0), (0, 1), (1, 0), (1, 1), (2, 0)
    ]  # fmt: skip
    np.testing.assert_allclose(numbers(found["deviation"], "<f4"), np.sqrt(12.5), rtol=1e-6)
    np.testing.assert_array_equal(numbers(found["existence"], "u1"), np.where(track, 88, 255))
    np.testing.assert_array_equal(numbers(data["times"], "<f8"), [0, 2, 4])
    own = numbers(data["own"], "<f4").reshape(-1, 2) + data["origin"]
    np.testing.assert_allclose(own, [[0, -5], [1, -5], [2, -5]], atol=1e-3)
    plots = numbers(data["plots"]["place"], "<f4").reshape(-1, 2) + data["origin"]
    np.testing.assert_allclose(plots, 7.0 * np.arange(12.0).reshape(-1, 2), atol=1e-3)
    np.testing.assert_array_equal(numbers(data["plots"]["from"], "<u4"), [0, 2, 4, 6])
    assert data["axes"] == ["x", "y"]
    assert data["scan"] == 2


def test_north_is_upwards(tmp_path):
    reports = reports_of([2])
    truth = [0.0, 2.0], ["a", "a"], [[1.0, 2.0], [3.0, 4.0]]
    data = data_of(page_of(tmp_path, reports, None, truth, ("north", "east")))
    assert data["axes"] == ["east", "north"]
    place = numbers(data["reports"]["place"], "<f4").reshape(-1, 2) + data["origin"]
    np.testing.assert_allclose(place, reports.position[:, ::-1], atol=1e-3)
    np.testing.assert_array_equal(numbers(data["reports"]["velocity"], "<f4"), [0, 5, 0, 5])
    true = numbers(data["truth"]["place"], "<f4").reshape(-1, 2) + data["origin"]
    np.testing.assert_allclose(true, [[2, 1], [4, 3]], atol=1e-3)


def test_targets_are_told_apart_and_in_order_of_time(tmp_path):
    truth = [4.0, 0.0, 2.0], ["b", "a", "b"], [[5.0, 0.0], [1.0, 0.0], [3.0, 0.0]]
    data = data_of(page_of(tmp_path, reports_of([3]), None, truth))["truth"]
    assert data["names"] == ["a", "b"]
    np.testing.assert_array_equal(numbers(data["from"], "<u4"), [0, 1, 3])
    np.testing.assert_array_equal(numbers(data["time"], "<f8"), [0, 2, 4])


@pytest.mark.parametrize(
    ("lengths", "kinds", "most", "kept"),
    [
        ([5, 3, 4], [1, 1, 1], 9, ["1", "3"]),
        ([5, 3, 4], [2, 1, 0], 4, ["2"]),
        ([5, 3, 4], [2, 1, 0], 8, ["1", "2"]),
        ([5, 3, 4], [2, 1, 0], 12, ["1", "2", "3"]),
    ],
)
def test_of_too_many_tracks_the_longest_are_kept_whole(tmp_path, lengths, kinds, most, kept):
    page = page_of(tmp_path, reports_of(lengths, kinds), most_rows=most)
    assert data_of(page)["reports"]["ids"] == kept
    told = f"{len(kept)} of 3 tracks are shown: the longest ones, moving ones before all others."
    assert (told in page) == (len(kept) < 3)


def test_of_too_many_plots_some_are_left_out_and_the_page_says_so(tmp_path):
    page = page_of(tmp_path, reports_of([5]), scans_of(5), most_plots=4)
    assert "One of 3 plots is shown, out of 10." in page
    data = data_of(page)["plots"]
    places = numbers(data["place"], "<f4").reshape(-1, 2)
    assert len(places) == 4
    np.testing.assert_array_equal(numbers(data["from"], "<u4"), [0, 1, 2, 2, 3, 4])


def test_times_of_scans_without_a_report_are_those_of_the_scan_before():
    found = Shown.of(reports_of([2], start=2), None, 10, 10)
    np.testing.assert_array_equal(found.times, [4, 4, 4, 6])

    class Result:
        reports = reports_of([2])
        times = np.array([0.0, 2.0, 4.0])
        own = np.array([7.0, 8.0])

    found = Shown.of(Result(), None, 10, 10)
    np.testing.assert_array_equal(found.times, [0, 2, 4])
    np.testing.assert_array_equal(found.own, [[7, 8]] * 3)


def test_names_and_titles_stay_text(tmp_path):
    bad = "</script><script>alert(1)</script>&\u2028"
    truth = [0.0], [bad], [[0.0, 0.0]]
    page = page_of(tmp_path, reports_of([2]), None, truth, (bad, "y"), title=bad)
    elements = Elements(page)
    assert [tag for tag, _ in elements.found].count("script") == 2
    assert elements.texts["title"] == elements.texts["h1"] == bad
    data = data_of(page)
    assert data["truth"]["names"] == [bad]
    assert data["axes"][0] == bad


@given(st.dictionaries(st.text(), st.text()))
def test_any_text_comes_back_from_the_script(values):
    text = as_script(values)
    assert json.loads(text) == values
    assert not set("<>&\u2028\u2029") & set(text)


def test_the_page_loads_nothing_and_names_its_controls(tmp_path):
    page = page_of(tmp_path, reports_of([4]), scans_of(4))
    elements = Elements(page)
    assert "default-src 'none'" in page
    assert not re.search(r"https?://|src=\"|url\(|@import", page)
    labeled = re.findall(r"<label>(?:[^<]*)<(?:select|input) id=\"(\w+)\"", page)
    for tag, attributes in elements.found:
        if tag in ("select", "input"):
            assert attributes["id"] in labeled or attributes.get("aria-label")
        if tag in ("canvas", "aside", "section"):
            assert attributes["aria-label"]
    assert all("aria-hidden" in a for tag, a in elements.found if tag == "svg")
    assert ("html", {"lang": "en"}) in elements.found
    buttons = re.findall(r"<button([^>]*)>([^<]*)</button>", page)
    assert all(re.search("[a-z]", text) or "aria-label" in more for more, text in buttons)


def test_the_facts_are_counted(tmp_path):
    class Result:
        reports = reports_of([4, 2, 2], [1, 2, 1])
        times = 2.0 * np.arange(4)
        own = np.zeros((4, 2))
        tracker = "default"

    page = page_of(tmp_path, Result())
    assert "4 scans · tracks: 2 moving, 1 static · 0 plots · scan tracker default ·" in page


def test_without_a_track_or_a_scan(tmp_path):
    data = data_of(page_of(tmp_path, TrackReports.none()))
    assert data["reports"]["ids"] == []
    assert data["times"] == ""
    page = page_of(tmp_path, TrackReports.none(), [Scan(0.0, np.empty((0, 2)))])
    assert "1 scan · no track · 0 plots" in page


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        (("tracks",), {}, "result: must be the result of a scan tracker, or TrackReports; got str"),
        ((reports_of([4]), scans_of(3)), {}, "reports of scans 0 to 3, and there are 3 scans"),
        ((reports_of([4]),), {"scan": 4}, "scan: must be from 0 to 3, got 4"),
        ((reports_of([4]),), {"axes_names": ["x"]}, "axes_names: needs 2 names, got 1: x"),
        (
            (reports_of([4]), None, ([0.0], ["a"], [[1.0, 2.0, 3.0]])),
            {},
            "truth: positions have 3 axes; a map needs two",
        ),
    ],
)
def test_what_is_wrong_is_said_and_no_file_is_left(tmp_path, arguments, options, message):
    with pytest.raises(ValueError, match=message):
        write_scan_page(tmp_path / "page.html", *arguments, **options)
    assert list(tmp_path.iterdir()) == []


BROWSER = shutil.which("chromium") or shutil.which("google-chrome")


@pytest.mark.skipif(BROWSER is None, reason="no browser")
def test_it_runs_in_a_browser(tmp_path):
    reports = reports_of([4, 4, 2], [1, 2, 1])
    truth = 2.0 * np.arange(4), ["a"] * 4, reports.position[:4]
    target = write_scan_page(tmp_path / "page.html", reports, scans_of(4), truth, scan=3)
    options = ["--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'b'}"]
    done = subprocess.run(
        [BROWSER, *options, "--virtual-time-budget=3000", "--dump-dom", target.as_uri()],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    body = re.search(r'<tbody id="tracks">(.*?)</tbody>', done.stdout, re.DOTALL)[1]
    cells = [re.findall(r">([^<>]+)<", row) for row in body.split("</tr>")[:-1]]
    assert cells == [
        ["1", "moving", "confirmed", "5.0", "90°"],
        ["2", "static", "confirmed", "5.0", "–"],
    ]
    assert ">scan 4 of 4, 6.0 s</output>" in done.stdout
