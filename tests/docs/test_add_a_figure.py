"""docs/add-a-figure.md is followed to the letter in a copy of the repository."""

from __future__ import annotations

from pathlib import Path

import pytest
from documents import ROOT
from edited_tree import copied, edited_copy, files_of, follow

PAGE = ROOT / "docs" / "add-a-figure.md"


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made."""
    copy = tmp_path_factory.mktemp("figure") / "tree"
    for part in ("granchain", "tests/plots/test_any_result.py", "tests/pages/test_analysis.py", "tests/plots/test_probe.py", "tests/browser/test_probe_page.py",
                 "docs/glossary.md"):
        copied(part, copy)
    return edited_copy(PAGE, copy)


def test_the_page_edits_three_files_and_writes_two_and_more_for_other_figures() -> None:
    edits, new = files_of(PAGE, until="## 6. ")
    assert (len(edits), len(new)) == (3, 2)
    edits, new = files_of(PAGE)
    assert (len(edits), len(new)) == (17, 4)


def test_the_figure_is_drawn_in_a_notebook_in_a_file_and_on_the_page(tree: Path) -> None:
    """The test written by the page passes; no kernel is edited, so it uses those of the repository."""
    printed = follow(tree, "-m", "pytest", "-p", "no:cacheprovider", str(Path("tests", "plots", "test_phases_picture.py")),
                     own_kernels=False)
    assert "3 passed" in printed


def test_the_first_figure_of_a_spectrum_is_as_it_was(tree: Path) -> None:
    printed = follow(tree, "-m", "pytest", "-p", "no:cacheprovider", str(Path("tests", "plots", "test_any_result.py")),
                     "-k", "spectrum and figure_of_a_size", own_kernels=False)
    assert "1 passed" in printed


def test_the_probe_and_the_main_page_show_their_new_figures(tree: Path) -> None:
    tests = (str(Path("tests", *path)) for path in (("plots", "test_probe.py"), ("parts", "test_last_bead.py")))
    printed = follow(tree, "-m", "pytest", "-p", "no:cacheprovider", *tests, "-k", "last_bead or energy", own_kernels=False)
    assert "3 passed" in printed
