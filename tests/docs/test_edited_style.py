"""Code and text written by the pages docs/add-….md pass the project's own style checks."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from documents import ROOT, lines_outside_fences
from edited_tree import edit_files, files_of

PAGES = sorted((ROOT / "docs").glob("add-*.md"))


@pytest.fixture(scope="module")
def trees(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """For each page, a folder with ruff's settings and the files that the page edits or writes, after the edits."""
    made = tmp_path_factory.mktemp("pages")
    for page in PAGES:
        tree = made / page.stem
        edits, new = files_of(page)
        for name in {"pyproject.toml", *edits} - new:
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, tree / name)
        edit_files(page, tree)
    return made


def test_ruff_accepts_the_code_of_the_pages(trees: Path) -> None:
    done = subprocess.run([sys.executable, "-m", "ruff", "check", "--no-cache", "--output-format", "concise",
                           "--config", f"src = {['.', str(ROOT)]}",  # so that ruff recognises the project's other modules
                           "."], cwd=trees, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_no_line_that_the_pages_write_is_too_long(trees: Path) -> None:
    """This is about pages, with the rule of test_layout.py; ruff checks the lines of Python files."""
    pages = sorted(trees.rglob("*.md"))
    assert pages
    assert [f"{page.relative_to(trees)}:{number}" for page in pages for number, line in lines_outside_fences(page)
            if len(line) > 120 and not line.lstrip().startswith("|")] == []
