"""The page of all options: ``docs/cli-reference.md``, made from the commands themselves.

Sphinx makes it before it reads the pages; run as a script with the name of a folder, this file
writes it there.
"""

import re
import sys
from pathlib import Path

#: Options in a text, and a default at its end: ``[default: one track]``, ``[auto: 20]``.
OPTION = re.compile(r"(?<![\w`-])--?[a-z][\w-]*(?!`)")
DEFAULT = re.compile(r"\s*\[(default|auto): ([^\]]*)\]")


def commands(program, path="fuzzytrack"):
    """Commands of a program, each after the one it belongs to: what is typed, and the command."""
    yield path, program
    for name, below in getattr(program, "commands", {}).items():
        found = program.loaded(name) if hasattr(program, "loaded") else below
        yield from commands(found, f"{path} {name}")


def section(path, command):
    """Text about one command."""
    parameters = [p for p in command.params if not getattr(p, "hidden", False)]
    arguments = [p for p in parameters if p.param_type_name == "argument"]
    options = [p for p in parameters if p.param_type_name == "option"]
    group = hasattr(command, "commands")
    words = [argument.metavar for argument in arguments] + ["COMMAND"] * group
    lines = [
        f"{'##' if path.count(' ') < 2 else '###'} {path}",
        "",
        *(marked(" ".join(part.split())) + "\n" for part in (command.help or "").split("\n\n")),
        *("```text", f"{path} {' '.join(['[OPTIONS]' * bool(options), *words]).strip()}", "```"),
        "",
    ]
    if group and path != "fuzzytrack":
        lines += [f"Commands: {', '.join(f'`{name}`' for name in command.commands)}.", ""]
    for parameter in (*arguments, *options):
        lines += [f"{spelled(parameter)}", f": {told(parameter)}", ""]
    return "\n".join(lines)


def marked(text):
    """Text with its options as code, so that their hyphens stay."""
    return OPTION.sub(r"`\g<0>`", text)


def spelled(parameter):
    """Option and its value as they are typed."""
    if parameter.param_type_name == "argument":
        return f"`{parameter.metavar}`"
    opts = [*sorted(parameter.opts, key=len), *parameter.secondary_opts]
    names = ", ".join(f"`{name}`" for name in opts)
    if parameter.is_flag:
        return names
    kind = type(parameter.default).__name__ if parameter.default is not None else "n"
    value = parameter.metavar or {"float": "X", "str": "TEXT"}.get(kind, "N")
    return f"{names} `{value}`"


def told(parameter):
    """What an option does, what it may be, and what it is unless given."""
    help = parameter.help or ""
    text = marked(DEFAULT.sub("", help).rstrip(".") + ".")
    # Where limits are depends on the version of typer.
    limits = parameter if hasattr(parameter, "min") else parameter.type
    low, high = (getattr(limits, name, None) for name in ("min", "max"))
    if low is not None and high is not None:
        text += f" From {low:g} to {high:g}."
    elif low is not None:
        text += f" At least {low:g}."
    if parameter.multiple:
        text += "" if "repeated" in help else " May be repeated."
    if parameter.required:
        return text if parameter.param_type_name == "argument" else f"{text} Required."
    written = DEFAULT.findall(help)
    if written and written[0][0] == "default":
        default = marked(written[0][1])
        return f"{text} Default: {default}{'' if default.endswith('…') else '.'}"
    if parameter.default is None or parameter.default is False:
        return text
    default = parameter.default
    if default is True:
        return f"{text} Default: `{parameter.opts[0]}`."
    shown = f"{default:g}" if isinstance(default, float) else str(default)
    of_auto = f" ({written[0][1]})" if written else ""
    return f"{text} Default: `{shown}`{of_auto}."


def page(program):
    """The page."""
    return "\n".join([HEAD, *(section(*each) for each in commands(program))])


def write(folder):
    """Write ``cli-reference.md``."""
    from typer.main import get_command

    from fuzzytrack.cli.app import app

    file = Path(folder) / "cli-reference.md"
    file.write_text(page(get_command(app)), encoding="utf-8")


def setup(app):
    """Write the page when Sphinx begins."""
    write(app.srcdir)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


HEAD = """\
# All commands and options

You find what each command takes, with units and defaults. {doc}`cli` says how trackers are named,
and what the commands print and write. Every command has `--help` (`-h`), which says the same. This
page is generated from the commands when the documentation is built.
"""

if __name__ == "__main__":
    write(sys.argv[1])
