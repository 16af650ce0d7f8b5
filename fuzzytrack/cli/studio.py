"""The command that serves the studio."""

from __future__ import annotations

import threading
import webbrowser
from importlib import import_module
from typing import Annotated

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.output import say
from fuzzytrack.cli.studio_snippets import command_line

__all__ = ["studio"]

_NEEDED = ("starlette", "uvicorn", "websockets")


def studio(
    folder: Annotated[
        str,
        typer.Argument(
            metavar="FOLDER", help="Rule bases, scenarios and recordings; no others can be opened."
        ),
    ] = ".",
    port: Annotated[
        int | None,
        typer.Option(min=0, max=65535, help="0 for any free one. [default: 8098 if it is free]"),
    ] = None,
    browser: Annotated[bool, typer.Option(help="Open the page in the browser.")] = True,
    host: Annotated[
        str | None,
        typer.Option(
            metavar="H", help="Address for other computers too; needs --token. Without encryption."
        ),
    ] = None,
    token: Annotated[
        str | None,
        typer.Option(metavar="T", help="Secret in the address of the page. [default: random]"),
    ] = None,
    plugin: options.Plugins = None,
) -> None:
    """Edit rule bases, draw surfaces and run experiments on a page in the browser.

    Stop it with Ctrl-C. Only this computer can open the page unless --host is given.
    """
    for name in _NEEDED:
        try:
            import_module(name)
        except ImportError:
            raise ValueError(
                f"studio: needs {name}, which is not installed; pip install 'fuzzytrack[studio]'"
            ) from None
    from fuzzytrack.studio.server import serve

    options.load_plugins(plugin)

    def started(address: str) -> None:
        say(f"studio at {address}")
        say("stop it with Ctrl-C")
        if browser:
            # A browser that is started may keep its caller waiting.
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()

    serve(folder, host=host, port=port, token=token, started=started, command=command_line)
