"""The commands about rule bases."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.complaints import Command, one_line
from fuzzytrack.cli.output import print_json, print_table, progress, say
from fuzzytrack.cli.pictures import save_picture
from fuzzytrack.cli.rulebase_export import export
from fuzzytrack.cli.rulebase_tables import print_explanation, print_rulebase, review_lines
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.as_json import rulebase_as_json
from fuzzytrack.fuzzy.loading import (
    SCHEMA_FILE,
    load_rulebase,
    loads_rulebase,
    rulebase_path,
    shipped_rulebases,
)
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.schedulers.review import Review, explanation, review

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["rulebase"]

rulebase = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    help="List, show, copy, check, explain, convert, edit and export rule bases.",
    rich_markup_mode=None,
)

Name = Annotated[str, typer.Argument(metavar="RULEBASE", help="Shipped name, or file.")]


@rulebase.command("list")
def list_(json: options.Json = False) -> None:
    """List the rule bases that come with fuzzytrack."""
    found = [load_rulebase(name) for name in shipped_rulebases()]
    if json:
        keys = ("name", "inputs", "outputs", "scheduler", "source", "description")
        print_json([{key: rulebase_as_json(rules)[key] for key in keys} for rules in found])
        return
    rows = [
        [
            r.name,
            ", ".join(r.input_names),
            ", ".join(r.output_names),
            dict(r.scheduler).get("normalization", "–"),
            str(len(r.rules)),
        ]
        for r in found
    ]
    print_table(["name", "inputs", "outputs", "normalization", "rules"], rows, words=4)


@rulebase.command()
def show(
    name: Name,
    plot: Annotated[
        str | None,
        typer.Option(metavar="FILE.png", help="Draw sets, rules and surfaces (or .pdf, .svg…)."),
    ] = None,
    json: options.Json = False,
) -> None:
    """Show variables, sets and rules."""
    rules = load_rulebase(name)
    if plot is not None:
        save_picture(plot, lambda: _picture(rules), (Path(name),))
    if json:
        print_json(rulebase_as_json(rules))
    else:
        # A copy of a shipped rule base may still have its name.
        print_rulebase(rules, name if name == rules.name else f"{name}: {rules.name}")
        if plot is not None:
            say(f"wrote {plot}")


def _picture(rules: RuleBase) -> Figure:
    from fuzzytrack.plotting import plot_rulebase

    return plot_rulebase(rules)[0]


@rulebase.command()
def check(
    files: Annotated[list[str], typer.Argument(metavar="FILE...", help="Files, or names.")],
    plugin: options.Plugins = None,
    json: options.Json = False,
) -> None:
    """Check rule bases: print facts about each, or the place of the first mistake."""
    options.load_plugins(plugin)
    reviews: list[dict[str, Any]] = []
    wrong = False
    for file in files:
        try:
            with progress("checking") as watch:
                found = review(load_rulebase(file), progress=watch)
        except (RuleBaseError, ValueError) as error:
            wrong = True
            typer.echo(_with_file(error, file), err=True)
            reviews.append({"file": file, "ok": False, "error": str(error)})
            continue
        said = [_with_file(mistake, file) for mistake in found.mistakes]
        wrong = wrong or bool(said)
        for line in said:
            typer.echo(line, err=True)
        why = {"error": "; ".join(said)} if said else {}
        reviews.append({"file": file, "ok": not said, **why, **found.as_json()})
        if not json:
            _print_review(file, found)
    if json:
        print_json(reviews)
    if wrong:
        raise typer.Exit(2)


def _with_file(error: Exception, file: str) -> str:
    """Message that names the file, also where the mistake has no single place in it."""
    if getattr(error, "location", None) or file in str(error):
        return one_line(error)
    return one_line(ValueError(f"{file}: {error}"))


def _print_review(file: str, found: Review) -> None:
    say(f"{file}: {'an output is NaN at some inputs' if found.mistakes else 'ok'}")
    lines = list(review_lines(found))
    width = max(len(key) for key, _ in lines)
    for key, text in lines:
        say(f"  {key:<{width}}  {text}")


@rulebase.command()
def explain(
    name: Name,
    at: Annotated[str, typer.Option(metavar="E=.3,dE=-.2", help="A value for each input.")],
    method: Annotated[str, typer.Option(metavar="M", help="exact, relation or table.")] = "exact",
    json: options.Json = False,
) -> None:
    """Show which rules fire at a point, and the outputs there."""
    system = FuzzySystem(load_rulebase(name), method)
    point = options.numbers_at(at, system.rules.input_names)
    found = explanation(system, point)
    if json:
        print_json(found)
    else:
        print_explanation(system, found)


@rulebase.command()
def new(
    origin: Annotated[
        str, typer.Argument(metavar="FROM", help="Shipped name, or file, to be copied.")
    ],
    output: Annotated[
        str, typer.Option("--output", "-o", metavar="MINE.yaml", help="The copy; named after it.")
    ],
    force: Annotated[bool, typer.Option("--force", help="Replace files that exist.")] = False,
    json: options.Json = False,
) -> None:
    """Copy a rule base to a file to be edited, with its JSON Schema for editors beside it."""
    from fuzzytrack.fuzzy.copying import copied_rulebase
    from fuzzytrack.io.files import check_output, whole_file

    source, target = rulebase_path(origin), Path(output)
    if target.suffix not in (".yaml", ".yml"):
        raise ValueError(f"--output: {output} must end in .yaml, the suffix of rule bases")
    load_rulebase(origin)  # its messages are about a file that may not exist
    copy = copied_rulebase(source.read_bytes().decode("utf-8"), target.stem, str(source))
    check_output(target, (source,))
    if target.exists() and not force:
        raise FileExistsError(None, "exists; name another file, or replace it with --force", output)
    with whole_file(target) as draft:
        draft.write_bytes(copy.encode("utf-8"))
    beside = target.with_name(SCHEMA_FILE)
    kept = beside.exists() and not force and beside.read_text("utf-8") != _schema_text()
    if not kept:
        with whole_file(beside) as draft:
            draft.write_text(_schema_text(), encoding="utf-8")
    if json:
        print_json({"from": str(source), "file": output, "schema": str(beside), "kept": kept})
        return
    say(f"wrote {output}")
    if kept:
        say(f"kept {beside}, which differs from the schema of this version; --force replaces it")
    else:
        say(f"wrote {beside}: editors complete and check by it (in VS Code: extension YAML)")
    _next_steps(output)


def _next_steps(file: str) -> None:
    """Print what is done with a new rule base."""
    name, rules = shlex.quote(file), load_rulebase(file)
    say("Next, after each change:")
    say(f"  fuzzytrack rulebase check {name}")
    # The first two inputs are drawn; the others need a value.
    others = ",".join(f"{variable}=0" for variable in rules.input_names[2:])
    say(f"  fuzzytrack surface {name}{others and f' --at {others}'} -o surface.png")
    if review(rules).schedules:
        say(f"  fuzzytrack track plots.csv --tracker {name}")


@rulebase.command()
def convert(
    origin: Annotated[
        str, typer.Argument(metavar="IN", help="Shipped name, or file: .yaml, .fis or .fll.")
    ],
    output: Annotated[
        str, typer.Argument(metavar="OUT", help="The file: .yaml, .fis (MATLAB), .fll (fuzzylite).")
    ],
    force: Annotated[bool, typer.Option("--force", help="Replace a file that exists.")] = False,
    json: options.Json = False,
) -> None:
    """Write a rule base in the format of another program, or read one; see the guide."""
    from fuzzytrack.fuzzy.formats.conversion import translated
    from fuzzytrack.io.files import check_output, whole_file

    rules, target = load_rulebase(origin), Path(output)
    found = translated(rules, target)
    source = rulebase_path(origin) if origin in shipped_rulebases() else Path(origin)
    check_output(target, (source,))
    if target.exists() and not force:
        raise FileExistsError(None, "exists; name another file, or replace it with --force", output)
    with whole_file(target) as draft:
        draft.write_bytes(found.text.encode("utf-8"))
    for note in found.notes:
        typer.echo(f"note: {note}", err=True)
    if json:
        print_json({"from": origin, "file": output, "notes": list(found.notes)})
    else:
        say(f"wrote {output}")


@rulebase.command("set")
def set_(
    file: Annotated[str, typer.Argument(metavar="FILE", help="The rule base.")],
    says: Annotated[
        str, typer.Argument(metavar="CONCLUSION", help="New conclusion of the rule: M-Z.")
    ],
    cell: Annotated[
        str, typer.Option(metavar="dE=ns,E=pl", help="The conditions of the rule, all of them.")
    ],
    output: Annotated[
        str | None,
        typer.Option("--output", "-o", metavar="OUT.yaml", help="Write here. [default: in place]"),
    ] = None,
) -> None:
    """Change one cell of a table, or one rule; comments stay."""
    from fuzzytrack.fuzzy.rule_edits import set_cell
    from fuzzytrack.io.files import whole_file

    where = options.pairs(cell, "--cell")
    source = rulebase_path(file)
    if output is None and file in shipped_rulebases():
        raise ValueError(f"{file} comes with fuzzytrack; write your own with -o my-{file}.yaml")
    raw = source.read_bytes()
    before = loads_rulebase(raw, str(source))
    changed = set_cell(raw.decode("utf-8"), where, says, file=str(source))
    key = frozenset(where.items())
    after = loads_rulebase(changed)
    (number,) = (n for n, r in enumerate(before.rules) if r.key == key)
    old, new = before.rules[number], after.rules[number]
    target = source if output is None else Path(output)
    if new != old or output is not None:
        with whole_file(target) as draft:
            draft.write_bytes(changed.encode("utf-8"))
    if new == old:
        say(f"no change: {old}")
    else:
        say(f"was  {old}")
        say(f"now  {new}")
    if new != old or output is not None:
        say(f"wrote {target}")


@rulebase.command()
def schema(
    output: Annotated[
        str | None, typer.Option("--output", "-o", metavar="FILE", help="Write it to a file.")
    ] = None,
) -> None:
    """Print the JSON Schema of rule-base files, for editors."""
    text = _schema_text()
    if output is None:
        say(text.rstrip())
        return
    from fuzzytrack.io.files import whole_file

    with whole_file(output) as draft:
        draft.write_text(text, encoding="utf-8")
    say(f"wrote {output}")


def _schema_text() -> str:
    from fuzzytrack.fuzzy.schema import dumps_schema
    from fuzzytrack.schedulers.settings import scheduler_schema

    return dumps_schema(scheduler_schema())


rulebase.command("export", cls=Command)(export)
