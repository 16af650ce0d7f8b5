"""Sphinx configuration; the build uses no network."""

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_extensions"))

# The gallery draws, and must not wait for a display.
os.environ.setdefault("MPLBACKEND", "Agg")

# Examples that warn are wrong. Other warnings may come from the packages that build the pages.
import warnings

import fuzzytrack
from fuzzytrack.errors import NoRuleFiresWarning

for category in (NoRuleFiresWarning, RuntimeWarning):
    warnings.simplefilter("error", category)

project = "fuzzytrack"
author = "The fuzzytrack developers"
copyright = "2026, the fuzzytrack developers"
version = release = fuzzytrack.__version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.viewcode",
    "mathml",
    "pictures",
    "cli_reference",
    "scene_settings",
    "numpydoc",
    "myst_parser",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
]
templates_path = ["_templates"]
exclude_patterns = [
    "_build",
    "_extensions",
    "gallery/**/*.ipynb",
    "gallery/**/*.py",
    "gallery/**/*.codeobj.json",
]
nitpicky = False

# Pages are Markdown; the API pages are reStructuredText, as docstrings are.
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

html_math_renderer = "mathml"

autosummary_generate = True
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
# Spelled out, what numpy takes for an array fills several lines for each argument.
autodoc_type_aliases = {name: name for name in ("ArrayLike", "Array", "Mask", "NDArray")}
# Members are listed by autodoc; numpydoc would list them twice.
numpydoc_show_class_members = False

sphinx_gallery_conf = {
    "examples_dirs": "../examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"plot_",
    "subsection_order": [
        f"../examples/{folder}" for folder in ("start", "rules", "tracking", "gains", "papers")
    ],
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "copyfile_regex": r".*\.(csv|yaml)",
    "download_all_examples": False,
    "remove_config_comments": True,
    "show_memory": False,
    "thumbnail_size": (560, 400),
    "min_reported_time": 5,
    # A picture is shown; what it is called in memory says nothing.
    "ignore_repr_types": r"matplotlib|tuple",
    # Its tables of times load scripts from the network.
    "write_computation_times": False,
}

html_theme = "pydata_sphinx_theme"
html_title = "fuzzytrack"
html_logo = "_static/logo.svg"
html_favicon = "_static/logo.svg"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_theme_options = {
    "logo": {"text": "fuzzytrack"},
    "navigation_with_keys": False,
    "show_toc_level": 2,
    # As many as docs/index.md names, on one line at 1280 pixels.
    "header_links_before_dropdown": 7,
    "secondary_sidebar_items": {"**": ["page-toc"], "index": [], "gallery/index": []},
    "footer_start": ["copyright"],
    "footer_end": [],
}
html_sidebars = {"index": []}
html_copy_source = False
