"""The commands about configurations of scan trackers."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.complaints import Command, one_line
from fuzzytrack.cli.output import paragraph, print_json, print_table, say
from fuzzytrack.cli.scanner_tune import tune
from fuzzytrack.errors import ScannerError
from fuzzytrack.scan.scanners.loading import load_configuration, scanner_path, shipped_scanners
from fuzzytrack.scan.scanners.numbers import values
from fuzzytrack.scan.scanners.reader import SENSOR, Configuration
from fuzzytrack.scan.scanners.roles import MEANINGS, ROLES, CatalogPart, parts
from fuzzytrack.scan.scanners.writer import SCHEMA_FILE, part_name

__all__ = ["scanner"]

scanner = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    help="List, show, check, copy and tune configurations of scan trackers; list their parts.",
    rich_markup_mode=None,
)

Name = Annotated[str, typer.Argument(metavar="CONFIG", help="Shipped name, or file.")]


@scanner.command("list")
def list_(json: options.Json = False) -> None:
    """List the configurations that come with fuzzytrack."""
    found = [load_configuration(name) for name in shipped_scanners()]
    if json:
        print_json([_as_json(each) for each in found])
        return
    print_table(["name", "for"], [[each.name, each.description] for each in found], words=2)


@scanner.command()
def show(name: Name, plugin: options.Plugins = None, json: options.Json = False) -> None:
    """Show the parts of a configuration, and what each number means."""
    options.load_plugins(plugin)
    found = load_configuration(name)
    if json:
        print_json(_as_json(found))
        return
    say(name if name == found.name else f"{name}: {found.name}")
    if found.description:
        paragraph(found.description)
    for role, part in found.parts:
        known = _described(role, part)
        say()
        say(f"{role}: {known.name or MEANINGS[SENSOR]}")
        rows = [
            [key, _number(getattr(part, key)), told["unit"], told["meaning"]]
            for key, told in known.numbers().items()
        ]
        if rows:
            print_table(["number", "value", "unit", "meaning"], rows, words=4)


@scanner.command()
def check(
    files: Annotated[list[str], typer.Argument(metavar="FILE...", help="Files, or names.")],
    plugin: options.Plugins = None,
    json: options.Json = False,
) -> None:
    """Check configurations: print the parts of each, or the place of the first mistake."""
    options.load_plugins(plugin)
    found: list[dict[str, Any]] = []
    wrong = False
    for file in files:
        try:
            configuration = load_configuration(file)
        except ScannerError as error:
            wrong = True
            named = error.location or file in str(error)
            typer.echo(one_line(error if named else ScannerError(f"{file}: {error}")), err=True)
            found.append({"file": file, "ok": False, "error": str(error)})
            continue
        found.append({"file": file, "ok": True, **_as_json(configuration)})
        if not json:
            based = configuration.based_on
            say(f"{file}: ok{f', based on {based}' if based else ''}")
            names = ", ".join(f"{role} {name}" for role, name in _names(configuration).items())
            paragraph(f"  {names}")
    if json:
        print_json(found)
    if wrong:
        raise typer.Exit(2)


@scanner.command()
def new(
    file: Annotated[str, typer.Argument(metavar="MINE.yaml", help="The file; named after it.")],
    origin: Annotated[
        str, typer.Option("--from", metavar="NAME", help="Shipped name, or file, to begin with.")
    ] = "default",
    whole: Annotated[
        bool, typer.Option("--whole", help="Write all numbers, not only a file that changes some.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace files that exist.")] = False,
    plugin: options.Plugins = None,
    json: options.Json = False,
) -> None:
    """Begin a configuration of your own, with the JSON Schema for editors beside it."""
    from fuzzytrack.io.files import check_output, whole_file
    from fuzzytrack.scan.scanners.copying import new_configuration

    options.load_plugins(plugin)
    target, source = Path(file), scanner_path(origin)
    if target.suffix not in (".yaml", ".yml"):
        raise ValueError(f"{file} must end in .yaml, the suffix of configurations")
    text = new_configuration(origin, str(target), whole=whole)
    check_output(target, (source,))
    beside = target.with_name(SCHEMA_FILE)
    if target.exists() and not force:
        raise FileExistsError(None, "exists; name another file, or replace it with --force", file)
    for path, content in ((target, text), (beside, _schema_text())):
        with whole_file(path) as draft:
            draft.write_text(content, encoding="utf-8")
    if json:
        print_json({"from": str(source), "file": file, "schema": str(beside)})
        return
    say(f"wrote {file}")
    say(f"wrote {beside}: editors complete and check by it (in VS Code: extension YAML)")
    say("Next, after each change:")
    say(f"  fuzzytrack scanner check {shlex.quote(file)}")
    say(f"  fuzzytrack scan plots.csv --config {shlex.quote(file)}")


@scanner.command("parts")
def parts_(
    role: Annotated[
        str | None, typer.Argument(metavar="[ROLE]", help="Only those of a role, with numbers.")
    ] = None,
    plugin: options.Plugins = None,
    json: options.Json = False,
) -> None:
    """List the parts that configurations can name, plug-ins included."""
    options.load_plugins(plugin)
    if role is not None and role not in ROLES:
        raise ValueError(f"unknown role {role!r}; one of {', '.join(ROLES)}")
    found = [each for each in parts() if role in (None, each.role)]
    if json:
        print_json([_part_as_json(each) for each in found])
        return
    rows = [[each.role, each.name, _first_line(each)] for each in found]
    print_table(["role", "part", "what it does"], rows, words=3)
    for each in found if role else ():
        numbers = [
            [key, _number(told["default"]), told["unit"], told["meaning"], told["allowed"]]
            for key, told in each.numbers().items()
        ]
        if numbers:
            say()
            print_table(["number", "default", "unit", "meaning", "allowed"], numbers,
                        title=each.name, words=5)  # fmt: skip


@scanner.command()
def schema(
    output: Annotated[
        str | None, typer.Option("--output", "-o", metavar="FILE", help="Write it to a file.")
    ] = None,
    plugin: options.Plugins = None,
) -> None:
    """Print the JSON Schema of configurations, for editors; parts of plug-ins are in it."""
    options.load_plugins(plugin)
    text = _schema_text()
    if output is None:
        say(text.rstrip())
        return
    from fuzzytrack.io.files import whole_file

    with whole_file(output) as draft:
        draft.write_text(text, encoding="utf-8")
    say(f"wrote {output}")


scanner.command("tune", cls=Command)(tune)


def _schema_text() -> str:
    from fuzzytrack.scan.scanners.schema import dumps_scanner_schema
    from fuzzytrack.scan.sensor import Sensor

    return dumps_scanner_schema(Sensor, ROLES, MEANINGS, plugins=True)


def _names(configuration: Configuration) -> dict[str, str]:
    """Name of the part of each role."""
    return {
        role: part_name(role, part, ROLES) for role, part in configuration.parts if role != SENSOR
    }


def _described(role: str, part: Any) -> CatalogPart:
    name = "" if role == SENSOR else part_name(role, part, ROLES)
    return CatalogPart(role, name, type(part), part.source, "")


def _as_json(configuration: Configuration) -> dict[str, Any]:
    numbers: dict[str, dict[str, Any]] = {role: {} for role, _ in configuration.parts}
    for name, value in values(configuration).items():
        role, _, key = name.partition(".")
        numbers[role][key] = value
    return {
        "name": configuration.name,
        "description": configuration.description,
        "based_on": configuration.based_on,
        SENSOR: numbers[SENSOR],
        **{role: {"part": n, **numbers[role]} for role, n in _names(configuration).items()},
    }


def _part_as_json(part: CatalogPart) -> dict[str, Any]:
    return {
        "role": part.role,
        "part": part.name,
        "does": _first_line(part),
        "source": part.source,
        "package": part.package,
        "numbers": part.numbers(),
    }


def _first_line(part: CatalogPart) -> str:
    text = (part.kind.__doc__ or "").strip().partition("\n")[0].replace("`", "")
    return text if part.package == "fuzzytrack" else f"{text} (from {part.package})".strip()


def _number(value: object) -> str:
    return value if isinstance(value, str) else f"{value:g}"
