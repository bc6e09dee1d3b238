"""The site of the documents: ``make docs``.

Pages are Markdown; those with a notebook's head and the scripts of examples/gallery are executed while the site is built, and what
fails ends the build.  The reference is taken from the docstrings.  Nothing on a page asks the network.
"""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path
from typing import Any

import nbformat

_ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(_ROOT))  # for checks.reports
_PROJECT = tomllib.loads((_ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]

project = "Raceway"
author = _PROJECT["authors"][0]["name"]
release = version = _PROJECT["version"]

extensions = [
    "checks.reports",
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
]
templates_path = ["_templates"]
# Of the gallery's files: its list of pages, which gallery.md replaces, and those to download.
exclude_patterns = ["_build", "_templates", "gallery/index.rst", "gallery/*.ipynb", "gallery/uses"]
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

sphinx_gallery_conf = {
    "examples_dirs": "../examples/gallery",
    "gallery_dirs": "gallery",
    "backreferences_dir": "gallery/uses",
    "doc_module": ("raceway",),
    "filename_pattern": r"\.py$",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_signature": False,
    "write_computation_times": False,
}

html_theme = "furo"
html_title = f"Raceway {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_copyright = False
html_show_search_summary = False  # it would be fetched, which pages opened as files may not
# A page's source is copied beside it; with an address of the repository in [project.urls], its links lead there, to edit too.
html_theme_options = {
    "source_repository": _PROJECT.get("urls", {}).get("Source", ""),
    "source_branch": "main",
    "source_directory": "docs/",
    "top_of_page_buttons": ["view", "edit"],
}


def _shown_cells_alone(app: Any, env: Any) -> None:
    """Leave, in the notebooks to download, what their pages show, and no links to files that only the site has."""
    for path in Path(env.mystnb_config.output_folder).rglob("*.ipynb"):
        notebook = nbformat.read(path, as_version=4)
        notebook.cells = [cell for cell in notebook.cells if "remove-cell" not in cell.metadata.get("tags", [])]
        for cell in notebook.cells:
            if cell.cell_type == "markdown":
                text = re.sub(r"\{nb-download\}`.*?`\n*", "", cell.source)
                cell.source = re.sub(r"\[((?:`[^`]*`|[^]`])+)\]\((?!https?:)[^)]+\)", r"\1", text)
        nbformat.write(notebook, path)


def setup(app: Any) -> None:
    app.connect("env-updated", _shown_cells_alone)
