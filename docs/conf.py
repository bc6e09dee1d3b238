"""The site of the documents: ``make docs``.

Pages are Markdown; those with a notebook's head are executed while the site is built, and a cell that fails ends the build.
The reference is taken from the docstrings.  Nothing on a page asks the network.
"""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

_ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(_ROOT))  # for benchmarks.reports
_PROJECT = tomllib.loads((_ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]

project = "Raceway"
author = _PROJECT["authors"][0]["name"]
release = version = _PROJECT["version"]

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "numpydoc", "benchmarks.reports"]
templates_path = ["_templates"]
exclude_patterns = ["_build", "_templates", "**.ipynb_checkpoints"]
nitpicky = False
# Commands and screens stand indented, without a language.
highlight_language = "text"

myst_heading_anchors = 4
myst_links_external_new_tab = False

nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 180
nb_execution_in_temp = True
# ROSS and others announce themselves on stderr; what fails raises.
nb_output_stderr = "remove"
# No widgets on any page, so no scripts from a content network.
nb_ipywidgets_js = {}

autosummary_generate = True
autosummary_imported_members = True
autodoc_typehints = "none"  # the docstrings carry type, shape and unit
autodoc_member_order = "bysource"
numpydoc_show_class_members = False  # autodoc shows them
# |Z| is a magnitude in the docstrings, no substitution.
rst_epilog = ".. |Z| replace:: \\|Z\\|\n"

html_theme = "furo"
html_title = f"Raceway {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
