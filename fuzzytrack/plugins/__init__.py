"""Plug-ins: schedulers, trackers and normalizations of packages, of scripts and of this process."""

from fuzzytrack.plugins.registry import Plugin, Registry
from fuzzytrack.plugins.scripts import Script, load_script, load_scripts, loaded_scripts

__all__ = ["Plugin", "Registry", "Script", "load_script", "load_scripts", "loaded_scripts"]
