"""What `make docs` looks for in built pages is found, and what `make walk` looks for on a walk."""

import runpy
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = runpy.run_path(str(ROOT / ".ci" / "pages.py"))
WALK = runpy.run_path(str(ROOT / ".ci" / "walk.py"))


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("<p>:::{admonition} Expect</p>", "a fence"),
        ("<p>```{toctree}</p>", "a fence"),
        ("<p>see {doc}<code>page</code></p>", "a role"),
        ("<p>see {py:class}`Page`</p>", "a role"),
        ("<p>see :class:<code>Page</code></p>", "a role"),
        ("<td>$$ y = x $$</td>", "a formula"),
        ("<p>where $x_k$ is</p>", "a formula"),
        (r"<p><math><mi>\frac</mi></math></p>", "a formula"),
        ("<p>[page](page.md)</p>", "a link"),
        ("<p>this is **bold**</p>", "emphasis"),
        ("<p>the `word</p>", "emphasis"),
        ('<script src="https://cdn.example.org/x.js"></script>', "loads https://cdn"),
        ('<img src="//example.org/x.png" alt="x">', "loads //example"),
        ('<img src="a.png">', "a picture without words"),
        ('<img src="a.png" alt="a.png">', "a picture without words"),
        ('<div class="system-message">no</div>', "a message of docutils"),
    ],
)
def test_what_is_not_rendered_is_found(text, fault):
    assert any(fault in found for found in PAGES["faults_of_text"](text))


@pytest.mark.parametrize(
    "text",
    [
        "<p>8 % of 3 €, $5, a: b, {a, b}, 2 ** 3 and C:\\temp</p>",
        "<pre>$ fuzzytrack track - :::{x} ``` {doc}`page` $$ **x**</pre>",
        "<p><code>:class:`Page`</code> and <code>$x$</code></p>",
        '<a href="https://example.org">there</a>',
        '<img src="logo.svg" alt="">',
        "<math><mi>x</mi></math>",
        "<dt>run(<em>**options</em>)</dt>",
    ],
)
def test_what_is_right_is_not_found(text):
    assert list(PAGES["faults_of_text"](text)) == []


def test_links_to_nothing_are_found(tmp_path):
    (tmp_path / "there.html").write_text("")
    links = ("there.html", "there.html#part", "#here", "mailto:a@example.org", "gone.html")
    html = "".join(f'<a href="{link}">x</a>' for link in links)
    found = list(PAGES["faults_of_links"](html, tmp_path / "page.html"))
    assert found == ["a link to nothing: gone.html"]


def test_the_script_fails_where_there_is_a_fault(tmp_path, capsys):
    main = PAGES["main"]
    assert main(tmp_path) == 2
    (tmp_path / "index.html").write_text("<p>good</p>")
    assert main(tmp_path) == 0
    (tmp_path / "_static").mkdir()
    (tmp_path / "_static" / "template.html").write_text('<a href="gone.html">x</a>')
    assert main(tmp_path) == 0
    (tmp_path / "bad.html").write_text("<p>:::</p>")
    assert main(tmp_path) == 1
    assert "bad.html: a fence that is not rendered: :::" in capsys.readouterr().out


def page_with(*lines, rest=""):
    return "\n".join(("```sh", *lines, "```", rest))


def test_commands_of_a_page_and_what_they_show():
    text = page_with("make demo", "", "ls -l") + "```console\n$ a \\\n b\nout\n$ c\n```\n    d\n"
    assert list(WALK["commands"](text)) == [
        ("make demo", []), ("ls -l", []), ("a   b", ["out"]), ("c", [])
    ]  # fmt: skip


def test_files_that_a_page_names():
    text = page_with(
        "x > `code.csv`", rest="`a.csv`, `demo/`, `--plot`, [`b.md`](docs/b.md), `ft.run`"
    )
    assert WALK["named_files"](text) == {"a.csv", "demo/"}


@pytest.mark.parametrize(
    ("lines", "rest", "fault"),
    [
        (["echo 1 > a.csv", "cp a.csv b.csv"], "`b.csv`", None),
        (["mkdir d", "echo 1 > d/a", "true -o d --truth -o d/a"], "`d/`", None),
        (["false", "echo 1 > a.csv"], "", "false: ends with status 1"),
        (["true -o a.csv"], "", "does not write a.csv"),
        (["touch a.png; true --plot=a.png"], "", "does not write a.png"),
        (["mkdir d; true -o d"], "", "does not write d"),
        (["true"], "`a.csv`", "there is no a.csv"),
        (['test "$(env | grep -c ^FUZZY)" = 0'], "", None),
    ],
)
def test_a_walk(lines, rest, fault, tmp_path, monkeypatch):
    monkeypatch.setenv("FUZZY_SECRET", "not here")
    (tmp_path / "page.md").write_text(page_with(*lines, rest=rest))
    found = WALK["walk"]("page.md", tmp_path, tmp_path)
    assert [fault in each for each in found] == ([True] if fault else [])


def test_a_command_that_hangs_ends_a_walk(tmp_path, monkeypatch):
    monkeypatch.setitem(WALK["run"].__globals__, "LONGEST", 0.1)
    (tmp_path / "page.md").write_text(page_with("sleep 60"))
    (fault,) = WALK["walk"]("page.md", tmp_path, tmp_path)
    assert "hangs" in fault


def test_code_of_a_page_is_run_after_its_commands(tmp_path):
    (tmp_path / ".venv" / "bin").mkdir(parents=True)
    (tmp_path / ".venv" / "bin" / "python").symlink_to(sys.executable)
    text = "```python\nopen('b.csv', 'w').write(open('a.csv').read())\n```\n"
    (tmp_path / "page.md").write_text(text + page_with("echo 1 > a.csv", rest="`b.csv`"))
    assert WALK["walk"]("page.md", tmp_path, tmp_path) == []


def test_the_walk_is_long_enough():
    for page in WALK["PAGES"]:
        commands = [words for words, _ in WALK["commands"]((ROOT / page).read_text())]
        assert sum(words.startswith(".venv/bin/fuzzytrack ") for words in commands) >= 4
        assert all(words.startswith((".venv/bin/fuzzytrack ", "make ")) for words in commands)


def test_the_pictures_of_the_home_page_are_drawn(tmp_path):
    script = runpy.run_path(str(ROOT / "docs" / "images" / "home.py"))
    script["main"](tmp_path, runs=3)
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["errors-dark.png", "errors-light.png", "track-dark.png", "track-light.png"]
    for name in names:
        assert (ROOT / "docs" / "images" / name).exists()
        assert name in (ROOT / "docs" / "index.md").read_text()
