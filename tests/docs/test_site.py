"""The documentation as a site: it is built without warnings, its notebooks run, and nothing is loaded from elsewhere.

This takes about 30 s of processor time with compiled kernels, most of it in the four notebooks, which run only here.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest
from documents import PAGES, ROOT

import granchain
from granchain_core import former_names

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
#: Attributes by which a page loads something while it is shown.
LOADS = {"script": "src", "link": "href", "img": "src", "iframe": "src", "source": "src"}


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built site; the build fails at the first warning or failing cell."""
    out = tmp_path_factory.mktemp("site")
    done = subprocess.run([sys.executable, "-m", "tools.site", str(out)], cwd=ROOT, capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(ROOT)})
    assert done.returncode == 0, done.stderr[-4000:]
    return out


class Loaded(HTMLParser):
    """Collects the addresses that a page loads."""

    def __init__(self, page: Path) -> None:
        super().__init__()
        self.found: list[str] = []
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found += [value or "" for name, value in attrs if LOADS.get(tag) == name]


@pytest.mark.long
def test_every_page_and_notebook_is_there(site: Path) -> None:
    for page in [*PAGES, *NOTEBOOKS]:
        assert site.joinpath(page.relative_to(ROOT)).with_suffix(".html").exists(), page.name
    start = re.search(r'url=([^"]+)"', (site / "index.html").read_text(encoding="utf-8"))
    assert start is not None and (site / start[1]).exists()


def test_the_reference_has_every_public_name(site: Path) -> None:
    text = (site / "docs" / "site" / "api.html").read_text(encoding="utf-8")
    present = [name for name in granchain.__all__ if former_names.present(name) == name]
    assert [name for name in present if f'id="granchain.{name}"' not in text] == ["__version__"]


def test_no_page_loads_anything_from_elsewhere(site: Path) -> None:
    pages = sorted(site.rglob("*.html"))
    assert len(pages) > 30
    outside = {one for page in pages for one in Loaded(page).found if re.match(r"(https?:)?//", one)}
    assert outside == set()
    for sheet in (site / "_static").rglob("*.css"):
        assert not re.search(r"@import|url\([\"']?(https?:)?//", sheet.read_text(encoding="utf-8")), sheet.name


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_outputs_and_shown_with_its_figures(notebook: Path, site: Path) -> None:
    cells = [cell for cell in json.loads(notebook.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]
    assert len(cells) >= 5 and all(cell["outputs"] == [] and cell["execution_count"] is None for cell in cells)
    page = site.joinpath(notebook.relative_to(ROOT)).with_suffix(".html").read_text(encoding="utf-8")
    drawn = sum("show(" in "".join(cell["source"]) for cell in cells)
    assert page.count('data-root-id="') == drawn and page.count('class="cell_output') >= drawn
