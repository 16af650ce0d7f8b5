"""The command `completion`: scripts with which a shell completes the words of this command line.

The scripts hand the line before the cursor back to this command, which prints the words that may
stand there. It imports the command that is typed, and what its values are named after, and nothing
else.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Sequence
from typing import Annotated, Any, NamedTuple

import typer

__all__ = ["Candidate", "candidates", "completion"]

_BASH = """\
_fuzzytrack_completion() {
    local IFS=$'\\n'
    COMPREPLY=( $("$1" completion bash --line "${COMP_LINE:0:COMP_POINT}" 2>/dev/null) )
}
complete -o default -F _fuzzytrack_completion fuzzytrack"""

_ZSH = """\
#compdef fuzzytrack
_fuzzytrack() {
    local -a found
    local line="${words[1,CURRENT-1]} $PREFIX"
    found=("${(@f)$("${words[1]}" completion zsh --line "$line" 2>/dev/null)}")
    if [[ -n "${found[1]}" ]]; then
        _describe fuzzytrack found
    else
        _files
    fi
}
if [[ "${funcstack[1]}" == _fuzzytrack ]]; then
    _fuzzytrack "$@"
else
    compdef _fuzzytrack fuzzytrack
fi"""

_FISH = """\
function __fuzzytrack_complete
    set -l words (commandline -opc)
    set -l line (commandline -cp | string collect)
    set -l found ($words[1] completion fish --line "$line" 2>/dev/null)
    if test (count $found) -gt 0
        printf '%s\\n' $found
    else
        __fish_complete_path (commandline -ct)
    end
end
complete -c fuzzytrack -f -a '(__fuzzytrack_complete)'"""

_SCRIPTS = {"bash": _BASH, "zsh": _ZSH, "fish": _FISH}


class Candidate(NamedTuple):
    """A word that may stand at the cursor, and what it is in a few words, or nothing."""

    value: str
    help: str = ""


def completion(
    context: typer.Context,
    shell: Annotated[str, typer.Argument(metavar="bash|zsh|fish", help="The shell.")],
    line: Annotated[
        str | None, typer.Option(hidden=True, help="Print what completes this line.")
    ] = None,
) -> None:
    """Print the script with which a shell completes commands, options and names.

    In bash: source <(fuzzytrack completion bash). The scripts of all shells work with
    .venv/bin/fuzzytrack, too.
    """
    if shell not in _SCRIPTS:
        raise ValueError(f"no script for {shell!r}; allowed: {', '.join(_SCRIPTS)}")
    if line is None:
        typer.echo(_SCRIPTS[shell])
        return
    words = _split(line)
    for found in candidates(words[1:], context.find_root().command):
        typer.echo(_written(found, words[-1], shell))


def _split(line: str) -> list[str]:
    """Words of a line, of which the last one, perhaps empty, is to be completed."""
    for end in ("", "'", '"'):
        try:
            words = shlex.split(line + end)
        except ValueError:
            continue
        return [*words, ""] if not words or (line[-1:].isspace() and not end) else words
    return [*line.split(), ""]


def _written(found: Candidate, word: str, shell: str) -> str:
    """A candidate as the script of a shell takes it."""
    if shell == "bash":
        # To bash a word begins after the last colon or equals sign.
        before = len(word) - len(re.split("[:=]", word)[-1])
        return found.value[before:]
    if shell == "zsh":
        value = found.value.replace(":", "\\:")
        return f"{value}:{found.help}" if found.help else value
    return f"{found.value}\t{found.help}" if found.help else found.value


# -------------------------------------------------------------------- what may stand there


def candidates(words: Sequence[str], program: Any) -> list[Candidate]:
    """Words that may stand in the place of the last one.

    Parameters
    ----------
    words : sequence of str
        What was typed after the name of the program; the last word, perhaps empty, is completed.
    program : click.Group
        All commands. Where it has a method `loaded`, that imports a command by name.

    Returns
    -------
    list of Candidate
        Those that begin as the last word does; none where a file may stand, or anything.
    """
    *before, word = words or [""]
    command = program
    while hasattr(command, "commands"):
        below = command.commands
        if not before:
            return _beginning(
                word, [Candidate(n, c.get_short_help_str(90)) for n, c in below.items()]
            )
        name = before.pop(0)
        if name not in below:
            return []
        command = command.loaded(name) if hasattr(command, "loaded") else below[name]
    return _in_command(command, before, word)


def _in_command(command: Any, before: list[str], word: str) -> list[Candidate]:
    """Words after the options and arguments of a command that are complete."""
    options = {name: p for p in command.params for name in p.opts if name.startswith("-")}
    arguments = [p for p in command.params if p.param_type_name == "argument"]
    place, waiting, ended = 0, None, False
    for done in before:
        if waiting is not None:
            waiting = None
        elif done == "--" and not ended:
            ended = True
        elif done.startswith("-") and done != "-" and not ended:
            found = options.get(done)
            waiting = found if found is not None and not found.is_flag else None
        else:
            place += 1
    if waiting is not None:
        return _values(waiting, word)
    if word.startswith("-") and not ended:
        name, equals, start = word.partition("=")
        if not equals:
            return _options(command, before, word)
        found = options.get(name)
        values = _values(found, start) if found is not None and not found.is_flag else []
        return [Candidate(f"{name}={value}", help) for value, help in values]
    if not arguments or (place >= len(arguments) and arguments[-1].nargs != -1):
        return []
    return _values(arguments[min(place, len(arguments) - 1)], word)


def _options(command: Any, before: list[str], word: str) -> list[Candidate]:
    """Options that begin as a word does, but those that were given and may not be repeated."""
    found = [Candidate("--help", "Show what the command does.")]
    for option in command.params:
        given = any(name in before for name in option.opts)
        if option.param_type_name != "option" or option.hidden or (given and not option.multiple):
            continue
        long = next((name for name in option.opts if name.startswith("--")), option.opts[0])
        found.append(Candidate(long, re.split(r"(?<=\.)\s|\s\[", option.help or "")[0]))
    return _beginning(word, found)


def _beginning(word: str, found: Sequence[Candidate]) -> list[Candidate]:
    return [each for each in found if each.value.startswith(word)]


# -------------------------------------------------------------------- values


def _values(parameter: Any, word: str) -> list[Candidate]:
    """Values of an option or an argument."""
    key = parameter.opts[0] if parameter.param_type_name == "option" else parameter.metavar
    listed, comma = VALUES.get(key), ""
    if key in _LISTS:
        # The last name of several is completed.
        before, comma, word = word.rpartition(",")
        comma = before + comma
    names = listed() if listed else _words_of(parameter.metavar)
    return [Candidate(f"{comma}{each}") for each in names if each.startswith(word)]


def _words_of(metavar: str | None) -> list[str]:
    """Words out of which one is chosen, as `auto` and `none` in `K|auto|none`."""
    return [word for word in (metavar or "").split("|") if re.fullmatch("[a-z][a-z0-9-]*", word)]


def _trackers() -> Sequence[str]:
    from fuzzytrack.schedulers import schedulers
    from fuzzytrack.schedulers.catalog import scheduling_rulebases
    from fuzzytrack.trackers import trackers

    return sorted({*scheduling_rulebases(), *schedulers.names(), *trackers.names()})


def _rulebases() -> Sequence[str]:
    from fuzzytrack.fuzzy.loading import shipped_rulebases

    return shipped_rulebases()


def _scenarios() -> Sequence[str]:
    from fuzzytrack.simulation.scenario_files import shipped_scenarios

    return shipped_scenarios()


def _scenarios_and_scenes() -> Sequence[str]:
    from fuzzytrack.simulation.scene.files import shipped_scenes

    return sorted([*_scenarios(), *shipped_scenes()])


def _papers() -> Sequence[str]:
    from fuzzytrack.papers.catalog import PAPERS

    return [*PAPERS, "all"]


def _samples() -> Sequence[str]:
    from fuzzytrack.simulation.samples import SAMPLES

    return list(SAMPLES)


def _formats() -> Sequence[str]:
    from fuzzytrack.io.readers import readers

    return readers.names()


def _methods() -> Sequence[str]:
    from fuzzytrack.fuzzy.system import METHODS

    return METHODS


#: What the values of options, and of arguments by their metavar, are named after. Those of any
#: other option are the words of its metavar.
VALUES: dict[str, Callable[[], Sequence[str]]] = {
    "--tracker": _trackers,
    "--trackers": _trackers,
    "--format": _formats,
    "--method": _methods,
    "RULEBASE": _rulebases,
    "FROM": _rulebases,
    "SCENARIO": _scenarios,
    "SCENARIO|SCENE": _scenarios_and_scenes,
    "DATA|SCENARIO...": _scenarios,
    "PAPER": _papers,
    "[NAME]": _samples,
}

# Options that take several names with commas between them.
_LISTS = ("--trackers",)
