"""``python -m fuzzytrack``: the command line."""

from fuzzytrack.cli import main

main()
