"""What `make docs` looks for in the built pages is found, and nothing else."""

import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = runpy.run_path(str(ROOT / ".ci" / "pages.py"))


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


def test_the_pictures_of_the_home_page_are_drawn(tmp_path):
    script = runpy.run_path(str(ROOT / "docs" / "images" / "home.py"))
    script["main"](tmp_path, runs=3)
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["errors-dark.png", "errors-light.png", "track-dark.png", "track-light.png"]
    for name in names:
        assert (ROOT / "docs" / "images" / name).exists()
        assert name in (ROOT / "docs" / "index.md").read_text()
