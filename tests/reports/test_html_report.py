import base64
import math
import re
import xml.etree.ElementTree as ET
from datetime import UTC, datetime, timedelta, timezone
from html.parser import HTMLParser

import matplotlib
import numpy as np
import pytest

from fuzzytrack.reports import html_report as report
from fuzzytrack.reports import html_tables
from fuzzytrack.reports import pictures as report_pictures
from fuzzytrack.reports.html_report import write_report
from fuzzytrack.simulation.scenario import PlotNoise, Scenario
from fuzzytrack.testbed.montecarlo import monte_carlo
from fuzzytrack.testbed.results import Results, Sample
from fuzzytrack.trackers.catalog import make_tracker

NAMES = ("plain", "<b>bold & $x$</b>", "_hidden", "long " * 30 + "A", "long " * 30 + "B")
VOID = {"meta", "img", "br", "hr", "link", "wbr"}


@pytest.fixture(autouse=True)
def no_windows():
    from matplotlib import pyplot as plt

    matplotlib.use("Agg")
    before = dict(matplotlib.rcParams)
    yield
    assert dict(matplotlib.rcParams) == before
    assert plt.get_fignums() == []


def made_up(names=NAMES, runs=6, n_steps=9, n_axes=2, *, nis=True, velocity=True, seed=0):
    """Results with errors of known spread; tracker k has k + 1 times those of the first."""
    rng = np.random.default_rng(seed)
    shape = (len(names), runs, n_steps, n_axes)
    size = np.arange(1.0, len(names) + 1)[:, None, None, None]
    predicted = size * rng.normal(0, 10, shape)
    predicted[:, :, :2] = np.nan
    measured = rng.normal(0, 10, shape[1:])
    measured[0, 5] = measured[-1, 4] = np.nan
    truth = 100.0 * np.arange(n_steps)[:, None] + np.zeros(n_axes)
    gains = rng.uniform(0.2, 0.6, (len(names), n_steps, n_axes))
    return Results(
        scenario="bend <90°>",
        names=tuple(names),
        seed=7,
        first_scored=3,
        time=2.0 * np.arange(n_steps),
        predicted=predicted,
        filtered=0.5 * predicted,
        velocity=0.1 * predicted if velocity else None,
        measured=measured,
        nis=rng.chisquare(n_axes, shape[:3]) if nis else None,
        nees=rng.chisquare(n_axes, shape[:3]) if nis else None,
        sample=Sample(
            time=2.0 * np.arange(n_steps),
            truth=truth,
            plots=truth + measured[0],
            predicted=truth + predicted[:, 0],
            filtered=truth + 0.5 * predicted[:, 0],
            alpha=gains,
            beta=0.3 * gains,
            gamma=np.zeros_like(gains),
        ),
    )


class Page(HTMLParser):
    """A page taken apart; fails where tags are not closed in order."""

    def __init__(self, text):
        super().__init__()
        self.open, self.images, self.rows, self.links, self.ids = [], [], [], [], []
        self.best = []
        self.words = {}
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        assert len(given) == len(attrs)
        self.links += [v for k, v in attrs if k in ("src", "href", "srcset", "action", "data")]
        self.ids += [v for k, v in attrs if k == "id"]
        if tag == "img":
            assert given["alt"]
            self.images.append(given["src"])
        if tag == "tr":
            self.rows.append([])
        if tag in ("th", "td"):
            self.rows[-1].append("")
        if given.get("class") == "best":
            self.best.append((len(self.rows) - 1, len(self.rows[-1]) - 1))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        inside = self.open[-1] if self.open else ""
        self.words[inside] = self.words.get(inside, "") + data
        if inside in ("th", "td"):
            self.rows[-1][-1] += data


def written(tmp_path, results, **options):
    path = write_report(tmp_path / "report.html", results, **options)
    text = path.read_text(encoding="utf-8")
    return text, Page(text)


@pytest.fixture
def words_only(monkeypatch):
    """Leave the pictures out, where a test is not about them."""
    monkeypatch.setattr(report, "report_pictures", lambda results: {})


@pytest.fixture(scope="module")
def results():
    return made_up()


@pytest.fixture(scope="module")
def both(results, tmp_path_factory):
    return written(tmp_path_factory.mktemp("report"), results)


@pytest.mark.untraced
def test_the_page_needs_nothing_else(both):
    text, page = both
    assert text.startswith("<!DOCTYPE html>")
    assert all(link.startswith("data:image/") for link in page.links)
    bare = re.sub(r"base64,[A-Za-z0-9+/=]+", "", text)
    assert not re.search(r"https?:|//|url\(|@import|<script|<link|<iframe", bare)
    assert len(set(page.ids)) == len(page.ids) == 6


def test_pictures_decode(both):
    _, page = both
    assert len(page.images) == 6
    for image in page.images:
        kind, data = re.fullmatch(r"data:image/(svg\+xml|png);base64,(.+)", image).groups()
        raw = base64.b64decode(data, validate=True)
        if kind == "png":
            assert raw.startswith(b"\x89PNG\r\n")
        else:
            assert ET.fromstring(raw).tag.endswith("svg")


def test_a_heavy_picture_goes_in_as_pixels(results, tmp_path, monkeypatch):
    monkeypatch.setattr(report, "HEAVY", 1)
    one = dict(list(report_pictures.report_pictures(results).items())[:1])
    monkeypatch.setattr(report, "report_pictures", lambda results: one)
    _, page = written(tmp_path, results)
    (image,) = page.images
    assert base64.b64decode(image.removeprefix("data:image/png;base64,")).startswith(b"\x89PNG")


def test_every_tracker_has_a_row_with_its_name(both):
    text, page = both
    errors, consistency = page.rows[:6], page.rows[6:]
    for rows in (errors, consistency):
        assert [row[0] for row in rows] == ["Tracker", *NAMES]
        assert len({len(row) for row in rows}) == 1
    assert "<b>" not in text
    assert page.words["h1"] == page.words["title"] == "bend <90°>"


def cell(page, name, column):
    head = next(row for row in page.rows if any(c.startswith(column) for c in row))
    start = page.rows.index(head)
    place = next(k for k, c in enumerate(head) if c.startswith(column))
    return next(row for row in page.rows[start:] if row[0] == name)[place].replace("−", "-")


def test_the_table_holds_the_numbers_of_the_results(both, results):
    _, page = both
    away = np.sqrt((results.predicted**2).sum(axis=-1))[:, :, 3:]
    root = np.sqrt((away**2).mean(axis=(1, 2)))
    for k, name in enumerate(NAMES):
        for column, expected in (
            ("Predicted RMSE", root[k]),
            ("Filtered RMSE", root[k] / 2),
            ("Velocity RMSE", root[k] / 10),
            ("Mean error", away[k].mean()),
            ("Cumulative error", away[k].sum(axis=1).mean()),
        ):
            value, error = map(float, cell(page, name, column).split(" ± "))
            assert abs(value - expected) <= 0.06 * error
            assert 0 < error < 0.5 * value
        assert float(cell(page, name, "Variance")) == pytest.approx(away[k].var(), rel=1e-3)
        curve = np.sqrt((away[k] ** 2).mean(axis=0))
        value, time = re.fullmatch(r"(\S+) at (\S+) s", cell(page, name, "Peak RMSE")).groups()
        assert float(value) == pytest.approx(curve.max(), rel=1e-3)
        assert float(time) == 2.0 * (3 + curve.argmax())
        assert float(cell(page, name, "NIS, mean")) == pytest.approx(
            results.nis[k, :, 3:].mean(), rel=1e-3
        )
    assert cell(page, NAMES[0], "Change against plain") == "–"
    runs = np.sqrt((away**2).mean(axis=2))
    change, low, high = map(
        float, re.findall(r"[-+][\d.]+", cell(page, NAMES[1], "Change against plain"))
    )
    assert change == pytest.approx((runs[1] - runs[0]).mean(), abs=0.06)
    assert low < change < high


def test_facts(both):
    _, page = both
    facts = page.words["dd"]
    from fuzzytrack import __version__

    for fact in ("bend <90°>", "9, scored from scan 4 (t = 6 s) on", f"fuzzytrack {__version__}"):
        assert fact in facts


def test_title(results, tmp_path, words_only):
    _, page = written(tmp_path, results, title="Mine & 'yours'")
    assert page.words["h1"] == page.words["title"] == "Mine & 'yours'"


@pytest.mark.untraced
def test_the_same_results_with_the_same_date_give_the_same_bytes(tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    few = made_up(names=("a", "b"), nis=False)
    text, page = written(tmp_path, few)
    assert text == written(tmp_path, few)[0]
    assert "2023-11-14 22:13 UTC" in page.words["dd"]


def test_the_page_is_dated(results, tmp_path, words_only, monkeypatch):
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    before = datetime.now(UTC).replace(second=0, microsecond=0)
    _, page = written(tmp_path, results)
    (found,) = re.findall(r"\d{4}-\d\d-\d\d \d\d:\d\d UTC", page.words["dd"])
    assert before <= datetime.strptime(found, "%Y-%m-%d %H:%M UTC").replace(tzinfo=UTC)
    mine = datetime(2024, 5, 1, 1, 30, tzinfo=timezone(timedelta(hours=2)))
    assert "2024-04-30 23:30 UTC" in written(tmp_path, results, date=mine)[1].words["dd"]
    with pytest.raises(ValueError, match="date: needs a time zone"):
        written(tmp_path, results, date=datetime(2024, 5, 1))


@pytest.mark.parametrize("seconds", ["soon", "1.5", "9" * 30])
def test_a_date_that_is_none(seconds, results, tmp_path, words_only, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", seconds)
    with pytest.raises(ValueError, match=f"SOURCE_DATE_EPOCH: must be .* got '{seconds}'"):
        written(tmp_path, results)


def test_the_command_is_shown(results, tmp_path, words_only):
    _, page = written(tmp_path, results, command="fuzzytrack testbed 'a & b'")
    assert page.words["code"] == "fuzzytrack testbed 'a & b'"


def test_the_best_of_each_column_is_marked(tmp_path, words_only):
    few = made_up(names=("b", "a", "c:d=1"), nis=False)
    few.predicted[1] = 0.5 * few.predicted[0]
    text, page = written(tmp_path, few)
    best = {}
    for row, column in page.best:
        best.setdefault(page.rows[0][column], []).append(page.rows[row][0])
    errors = [head for head in page.rows[0] if "Filtered" not in head and head != "Tracker"]
    assert {name: best[name] for name in errors if "Velocity" not in name} == {
        name: ["a"] for name in errors if "Velocity" not in name
    }
    # Those of the filtered position and of the velocity are least for the first.
    assert best["Filtered RMSE (m)"] == best["Velocity RMSE (m/s)"] == ["b"]
    # A long name may break between its words.
    assert "c:<wbr>d=1" in text


def test_one_tracker_is_not_the_best(tmp_path, words_only):
    assert written(tmp_path, made_up(names=("a",), nis=False))[1].best == []


def test_trackers_worse_than_the_plots_are_marked(tmp_path, words_only):
    few = made_up(names=("good", "bad"), nis=False)
    few.filtered[0] *= 0.1
    few.filtered[1] *= 10
    text, page = written(tmp_path, few)
    assert page.words["span"] == "worse than the plots"
    assert 'bad<span class="worse">' in text


def test_means_inside_of_their_interval_are_marked(tmp_path, words_only):
    few = made_up(names=("a", "b"))
    few.nis[1] *= 9.0
    found = few.nis_consistency(0.95)
    assert (found.mean[1] > found.high[1]) & (found.low[0] < found.mean[0] < found.high[0])
    _, page = written(tmp_path, few)
    start = next(k for k, row in enumerate(page.rows) if "NIS, mean" in row)
    column = page.rows[start].index("NIS, mean")
    assert [r - start for r, c in page.best if r > start and c == column] == [1]


def test_colors_have_a_value_in_light_and_in_dark_mode(both):
    text, _ = both
    light, dark = re.findall(r":root \{(.*?)\}", text, flags=re.S)
    used = set(re.findall(r"var\((--\w+)\)", text))
    assert used
    assert "prefers-color-scheme: dark" in text
    assert all(f"{name}:" in mode for name in used for mode in (light, dark))


@pytest.mark.parametrize("n_axes", [1, 3])
def test_other_axes_of_space_without_what_need_not_be_known(tmp_path, n_axes):
    few = made_up(names=("a",), n_axes=n_axes, nis=False, velocity=False)
    text, page = written(tmp_path, few)
    assert len(page.images) == 5
    assert "Velocity RMSE (m/s)" not in text
    assert "<h2>Consistency" not in text


def test_a_single_run_has_no_standard_errors(tmp_path):
    few = made_up(names=("a", "b"), runs=1, nis=False)
    away = np.sqrt((few.predicted**2).sum(axis=-1))[1, :, 3:]
    text, page = written(tmp_path, few)
    assert float(cell(page, "b", "Predicted RMSE")) == pytest.approx(
        math.sqrt((away**2).mean()), rel=1e-3
    )
    assert "nan" not in text.split("<h2>Pictures")[0].lower()


def test_runs_without_a_scored_scan_are_told(tmp_path, words_only):
    few = made_up(names=("a", "b & c"), nis=False)
    few.predicted[1, 2:4] = np.nan
    _, page = written(tmp_path, few)
    assert "b & c predicted no scored scan in 2 of 6 runs." in page.words["p"]
    assert "2 of 6 runs have no scan in which every tracker" in page.words["p"]


def test_nothing_scored_at_all_is_still_a_page(tmp_path):
    few = made_up(names=("a", "b"), nis=True)
    few.predicted[:] = few.nis[:] = few.nees[:] = np.nan
    _, page = written(tmp_path, few)
    assert cell(page, "b", "Predicted RMSE") == "–"
    assert cell(page, "b", "Peak RMSE") == "–"
    assert len(page.images) == 5


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (258.314, 0.417, "258.31 ± 0.42"),
        (258.314, 41.7, "258 ± 42"),
        (0.012341, 0.00042, "0.01234 ± 0.00042"),
        (31489.2, 512.0, "31489 ± 512"),
        (2.5e9, 3.14e8, "2.5e+09 ± 3.1e+08"),
        (3.0, 0.0, "3 ± 0"),
        (31489.2, math.nan, "31489"),
        (math.nan, math.nan, "–"),
        (math.inf, math.nan, "–"),
    ],
)
def test_digits_that_the_standard_error_leaves(value, error, text):
    (found,) = html_tables.estimates(np.array([value]), np.array([error]))
    assert found == text


def test_a_failure_leaves_the_file_as_it_was(results, tmp_path, monkeypatch):
    path = tmp_path / "report.html"
    path.write_text("before")

    def fail(*_):
        raise RuntimeError("no pictures")

    monkeypatch.setattr(report, "report_pictures", fail)
    with pytest.raises(RuntimeError, match="no pictures"):
        write_report(path, results)
    assert [p.read_text() for p in tmp_path.iterdir()] == ["before"]
    # Found out before the pictures are drawn.
    with pytest.raises(FileNotFoundError, match="there is no folder"):
        write_report(tmp_path / "none" / "report.html", results)


def test_only_the_close_up_marks_every_scan(results):
    whole, close = report_pictures.report_pictures(results)["trajectories"].axes

    def marked(ax):
        lines = {line.get_label(): line.get_marker() for line in ax.lines}
        return [bool(marker) for name, marker in lines.items() if re.match(r"\d\. ", name)]

    assert marked(whole) == [False] * 4
    assert marked(close) == [True] * 4


def test_pictures_name_every_tracker_and_keep_their_colors(results):
    pictures = report_pictures.report_pictures(results)
    assert list(pictures) == list(report_pictures.CAPTIONS)
    colors = []
    del pictures["comparison"]
    for key, figure in pictures.items():
        legend = next(a.get_legend() for a in figure.axes if a.get_legend())
        handles = dict(
            zip([t.get_text() for t in legend.get_texts()], legend.legend_handles, strict=True)
        )
        own = {n: h for n, h in handles.items() if re.match(r"\d\. ", n)}
        assert len(own) == (4 if key == "trajectories" else 5)
        colors.append([matplotlib.colors.to_hex(h.get_color()) for h in own.values()][:4])
    assert all(c == colors[0] for c in colors)
    assert len(set(colors[0])) == 4


def test_one_run_is_also_shown_close_up_where_a_tracker_erred_most():
    few = made_up(names=("a", "b"), nis=False)
    for positions in (few.sample.truth, few.sample.plots, few.sample.predicted):
        positions[:] += 9000.0 * np.arange(9)[:, None]
    few.sample.predicted[:, :2] = np.nan
    # Larger, but not scored.
    few.sample.predicted[0, 2] += 900.0
    few.sample.predicted[1, 6] += (300.0, 0.0)
    whole, close = report_pictures.report_pictures(few)["trajectories"].axes
    true = next(line for line in close.lines if line.get_label() == "true")
    np.testing.assert_array_equal(np.array(true.get_data()).T[6], [0.0, 0.0])
    assert close.get_title() == "around the largest error, at t = 12 s"
    assert close.get_xlim()[1] > 3 * 250
    assert whole.get_legend() is None


def test_no_close_up_where_it_would_show_the_whole_path():
    few = made_up(names=("a", "b"), nis=False)
    few.sample.predicted[1, 6] += 300.0
    (whole,) = report_pictures.report_pictures(few)["trajectories"].axes
    assert whole.get_legend() is not None


def test_comparison_has_intervals_of_two_standard_errors(results):
    panels = report_pictures.report_pictures(results)["comparison"].axes
    for panel, quantity in zip(panels, ("predicted", "filtered"), strict=True):
        assert len(panel.get_yticks()) == len(NAMES)
        value, error = results.rmse(quantity), results.rmse_se(quantity)
        bars = [bar.get_segments()[0][:, 0] for bar in panel.collections]
        np.testing.assert_allclose(bars, np.stack([value - 2 * error, value + 2 * error], axis=1))


def test_a_target_and_trackers_at_rest_are_drawn():
    few = made_up(names=("a",), nis=False)
    for array in (few.sample.truth, few.sample.plots, few.sample.predicted):
        array[:] = 5.0
    figure = report_pictures.report_pictures(few)["trajectories"]
    figure.canvas.draw()
    assert figure.axes[1].get_xlim() == (-1.0, 1.0)


def test_fixed_gains_lie_on_top_of_scheduled_ones():
    few = made_up(names=("fixed", "scheduled"), nis=False)
    few.sample.alpha[0], few.sample.beta[0] = 0.4, 0.12
    plane = report_pictures.report_pictures(few)["gain-plane"].axes[0]
    for panel in (plane, *plane.child_axes):
        lines = {line.get_label(): line for line in panel.lines}
        assert lines["fixed"].get_zorder() > lines["scheduled"].get_zorder()


def test_a_real_experiment(tmp_path):
    time = 2.0 * np.arange(16)
    scenario = Scenario(
        "straight",
        time,
        np.stack([30 * time, 5 * time], axis=-1),
        PlotNoise(10.0, detection=0.8),
        velocity=np.tile([30.0, 5.0], (16, 1)),
        process_sigma=0.1,
    )
    names = ("fixed:alpha=0.5377:beta=0.2018", "stiffness-damping")
    found = monte_carlo(scenario, {name: make_tracker(name) for name in names}, 12, 3)
    text, page = written(tmp_path, found)
    assert [row[0] for row in page.rows[1:3]] == list(names)
    value = float(cell(page, names[1], "Predicted RMSE").split(" ± ")[0])
    assert value == pytest.approx(found.rmse()[1], abs=0.06 * found.rmse_se()[1])
    assert len(text) < 1_000_000
