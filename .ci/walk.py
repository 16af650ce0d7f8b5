"""Walk README.md and the quickstart as a newcomer does: in a fresh clone, with PATH alone.

    python .ci/walk.py [PAGE...]

Every command of a page is run exactly as printed, in the order of the page, and then its Python
code. A command must end with status 0, and write every file that its options name; files and
folders that the text of the page names must be there at the end. Each command is printed with its
time.
"""

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGES = ("README.md", "docs/quickstart.md")
# After so long a command hangs. It takes minutes; on a machine at work on other things, more.
LONGEST = 1800.0  # s
WRITTEN = re.compile(r"(?:^| )(?:-o|--output|--plot|--csv|--truth|--state)[ =]([^-\s]\S*)")


def blocks(text: str, language: str) -> list[str]:
    """Blocks of code of a page in Markdown."""
    return re.findall(rf"^```(?:{language})\n(.*?)^```", text, flags=re.M | re.S)


def commands(text: str) -> Iterator[tuple[str, list[str]]]:
    """Commands of a page, each with the lines of its output that are shown.

    In a block `sh` every line is a command; in a block `console` those after `$`.
    """
    for language, block in re.findall(r"^```(sh|console)\n(.*?)^```", text, flags=re.M | re.S):
        if language == "sh":
            yield from ((line, []) for line in block.splitlines() if line.strip())
        else:
            for command in re.split(r"^\$ ", block, flags=re.M)[1:]:
                words, _, output = command.replace("\\\n", " ").partition("\n")
                yield words, output.splitlines()


def named_files(text: str) -> set[str]:
    """Files and folders of results that the text of a page names in backquotes."""
    prose = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    return set(re.findall(r"`([\w-]+(?:/|\.(?:csv|png|yaml|json|html)))`", prose))


def missing(names: set[str], folder: Path) -> list[str]:
    """Those files that are not there, or have nothing in them."""
    return sorted(name for name in names if not filled(folder / name))


def filled(path: Path) -> bool:
    """Whether a file has anything in it, and a folder such files alone."""
    if path.is_dir():
        files = [each for each in path.rglob("*") if each.is_file()]
        return bool(files) and all(each.stat().st_size for each in files)
    return path.is_file() and path.stat().st_size > 0


def run(command: str, folder: Path, home: Path, code: str = "") -> str:
    """Run a command, print its time, and return what is wrong with it."""
    # Not the user's home: nothing there may help, and nothing may be left there.
    environment = {"PATH": os.environ["PATH"], "HOME": str(home)}
    begin = time.monotonic()
    try:
        done = subprocess.run(
            ["sh", "-c", command], cwd=folder, env=environment, input=code, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=LONGEST,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"hangs: no end after {LONGEST:.0f} s"
    print(f"{time.monotonic() - begin:7.1f} s  {command}", flush=True)
    if done.returncode:
        return f"ends with status {done.returncode}\n{done.stdout}"
    if lost := missing(set(WRITTEN.findall(command)), folder):
        return f"does not write {', '.join(lost)}\n{done.stdout}"
    return ""


def walk(page: str, folder: Path, home: Path) -> list[str]:
    """Run what a page of a clone says; return what is wrong."""
    text = (folder / page).read_text(encoding="utf-8")
    steps = [(command, "") for command, _ in commands(text)]
    if code := "\n".join(blocks(text, "python")):
        steps.append((".venv/bin/python -", code))
    for command, code in steps:
        # The next ones need its files: the first fault is the one to look at.
        if fault := run(command, folder, home, code):
            return [f"{page}: {command}: {fault}"]
    return [f"{page}: there is no {name}" for name in missing(named_files(text), folder)]


def main(pages: list[str]) -> int:
    """Walk the pages in one clone, each without the files of the others."""
    faults = []
    with tempfile.TemporaryDirectory() as scratch:
        home, clone = Path(scratch) / "home", Path(scratch) / "fuzzytrack"
        home.mkdir()
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
        for page in pages or PAGES:
            print(f"{page}:", flush=True)
            faults += walk(page, clone, home)
            tidy = ["git", "clean", "-qxdf", "--exclude=.venv"]
            subprocess.run(tidy, cwd=clone, check=True)
    print("\n".join(faults) or "Every command runs as printed, and every file is there.")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
