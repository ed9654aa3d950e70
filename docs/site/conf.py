"""How Sphinx builds the documentation: `python -m tools.site`; docs/python.md says why Sphinx.

The sources are the repository's own Markdown files where they are, so that their links work there, here and on a page
that shows the repository. Nothing is fetched: fonts are the reader's, and the scripts of figures stand in the pages.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from granchain import __version__  # noqa: E402

project, author, release = "granchain", "The granchain authors", __version__
project_copyright = "The granchain authors, MIT licence"

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "docs/site/index"
include_patterns = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/*.md", "docs/site/*.md", "notebooks/*.ipynb",
                    "tests/benchmarks/README.md"]
exclude_patterns = [".venv", ".git", ".*_cache", "build"]
html_extra_path = ["start"]  # index.html, which leads to root_doc

# Markdown as a page that shows the repository reads it: headings have anchors, links to source files are downloads.
myst_heading_anchors = 4
#: Pages may begin at any level; Bokeh gives its scripts a second time for notebooks that do not run plain ones.
suppress_warnings = ["myst.header", "mystnb.unknown_mime_type"]
default_role = "code"

# Notebooks are kept without outputs and run while the site is built; a cell that fails ends it.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_ipywidgets_js: dict[str, Any] = {}

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings say the types, with shapes and units
napoleon_google_docstring = False
napoleon_use_rtype, napoleon_use_ivar = False, True

html_theme = "furo"
html_title = f"granchain {release}"
html_static_path, html_css_files = ["static"], ["site.css"]
html_copy_source = False
html_show_sourcelink = False


def escaped(app: Any, what: str, name: str, found: Any, options: Any, lines: list[str]) -> None:
    """Docstrings are plain text: bars, stars and underscores at the end of a word mean themselves."""
    for place, line in enumerate(lines):
        if line.lstrip().startswith((">>>", "...")):
            continue
        parts = line.split("`")
        parts[::2] = [re.sub(r"([|*])", r"\\\1", re.sub(r"(?<=\w)_(?=\W|$)", r"\\_", one)) for one in parts[::2]]
        lines[place] = "`".join(parts)


def setup(app: Any) -> None:
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", escaped, priority=1)  # before napoleon
