"""Faults of built pages: marks that were not rendered, what is missing, what comes from a network.

    python .ci/pages.py docs/_build/html

Prints one line for each fault, and fails if there is one.
"""

import re
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

# What a reader must not see outside of code.
MARKS = {
    "a fence": r":::|```",
    "a role": r"\{\w+(?::\w+)*\}(?=[`\s]|$)|:(?:py:)?(?:doc|ref|class|func|meth|mod|math|term):",
    "a formula": r"\$\$|\$[^$\s][^$]*\$|\\(?:frac|sqrt|sum|bar|text|left|right|begin|end|quad)\b",
    "a link": r"\]\([\w./#:-]+\)|`_(?:\W|$)",
    "emphasis": r"\*\*\w[^*]*\*\*|`\w",
}
# Elements whose text is shown as it is, or not at all.
CODE = {"pre", "code", "script", "style", "title", "annotation", "kbd"}
# Attributes from which a browser loads by itself.
LOADED = {"script": "src", "img": "src", "link": "href", "iframe": "src", "source": "srcset"}


class Page(HTMLParser):
    """The text outside of code, the addresses, and the faults of elements of one page."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.texts: list[str] = []
        self.links: set[str] = set()
        self.faults: list[str] = []
        self._code = 0
        self.feed(html)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Look at an element and its attributes."""
        given = {name: value or "" for name, value in attrs}
        self._code += tag in CODE
        address = given.get(LOADED.get(tag, "href"), "")
        by_itself = tag in LOADED and given.get("rel") not in {"canonical", "next", "prev"}
        if by_itself and re.match(r"(https?:)?//", address):
            self.faults.append(f"loads {address}")
        # An empty text is for what words stand beside, as the logo; Sphinx writes the address.
        if tag == "img" and given.get("alt", address) == address:
            self.faults.append(f"a picture without words: {address}")
        if "system-message" in given.get("class", ""):
            self.faults.append("a message of docutils")
        if address:
            self.links.add(address)

    def handle_endtag(self, tag: str) -> None:
        """Leave code, where text is shown as it is."""
        self._code -= tag in CODE

    def handle_data(self, data: str) -> None:
        """Keep text outside of code."""
        if not self._code:
            self.texts.append(data)


def faults_of_text(html: str) -> Iterator[str]:
    """Faults that a page has by itself."""
    page = Page(html)
    yield from page.faults
    for text in page.texts:
        for what, pattern in MARKS.items():
            if found := re.search(pattern, text):
                around = text[max(found.start() - 20, 0) : found.end() + 40]
                yield f"{what} that is not rendered: {' '.join(around.split())}"


def faults_of_links(html: str, path: Path) -> Iterator[str]:
    """Links of a page to files that are not there."""
    for link in sorted(Page(html).links):
        parts = urlsplit(link)
        target = path.parent / unquote(parts.path)
        if not parts.scheme and not parts.netloc and parts.path and not target.exists():
            yield f"a link to nothing: {link}"


def faults(folder: Path) -> Iterator[str]:
    """Faults of all pages of a folder."""
    for path in sorted(folder.rglob("*.html")):
        if path.relative_to(folder).parts[0] == "_static":
            continue
        html = path.read_text(encoding="utf-8")
        for fault in (*faults_of_text(html), *faults_of_links(html, path)):
            yield f"{path.relative_to(folder)}: {fault}"


def main(folder: Path) -> int:
    """Print the faults, and return the exit status."""
    if not (folder / "index.html").exists():
        print(f"error: {folder} has no index.html; `make docs` builds it", file=sys.stderr)
        return 2
    found = list(faults(folder))
    print("\n".join(found) or "No mark is left over, and nothing is missing.")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
