"""The command ``fuzzytrack``."""

from __future__ import annotations

__all__ = ["main"]


def main() -> None:
    """Run the command line; the entry point of the installed command."""
    from fuzzytrack.cli.app import app

    app()
