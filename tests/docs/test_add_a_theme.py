"""docs/add-a-theme.md is followed to the letter in a copy of the repository."""

from __future__ import annotations

from pathlib import Path

import pytest
from documents import ROOT
from edited_tree import copied, edited_copy, files_of, follow

PAGE = ROOT / "docs" / "add-a-theme.md"
_TESTS = ("-m", "pytest", "-p", "no:cacheprovider", str(Path("tests", "plots", "test_theme.py")))


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made."""
    copy = tmp_path_factory.mktemp("theme") / "tree"
    for part in ("docs/glossary.md", "granchain", "tests/plots/test_theme.py"):
        copied(part, copy)
    return edited_copy(PAGE, copy)


def test_the_page_edits_one_file_and_writes_none() -> None:
    edits, new = files_of(PAGE)
    assert edits == {"app/plots/theme.py"} and not new


def test_the_new_theme_passes_the_tests_of_themes(tree: Path) -> None:
    assert "4 passed" in follow(tree, *_TESTS, "-k", "colours_of_its_pictures")
    follow(tree, *_TESTS)


def test_the_new_theme_is_known_to_links_the_command_line_and_figures(tree: Path) -> None:
    printed = follow(tree, "-c", """
import argparse
from app.cli import figure as command
from app.cli.waiting import answer
from app.session.page_constants import page_constants
from app.session.share import decode
parser = argparse.ArgumentParser()
command.add_options(parser)
print("sepia" in parser.format_help(), decode("v=1&look=sepia")[1:], b"[data-theme=sepia]" in answer(), "sepia" in page_constants())
from app.plots.theme import THEMES
from app.plots.themed import apply_theme, empty_figure
print(apply_theme(empty_figure(), THEMES["sepia"]).background_fill_color)
""")
    assert printed.splitlines() == ["True ({'look': 'sepia'}, []) True True", "#fbf5e6"]
