"""docs/add-a-theme.md is followed to the letter in a copy of the repository."""

from __future__ import annotations

from pathlib import Path

import pytest
from documents import ROOT
from edited_tree import copied, edited_copy, files_of, follow

PAGE = ROOT / "docs" / "add-a-theme.md"
_TESTS = ("-m", "pytest", "-p", "no:cacheprovider", str(Path("tests", "dashboard", "test_theme.py")))


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made."""
    copy = tmp_path_factory.mktemp("theme") / "tree"
    for part in ("granchain", "tests/dashboard/test_theme.py"):
        copied(part, copy)
    return edited_copy(PAGE, copy)


def test_the_page_edits_three_files_and_writes_none() -> None:
    edits, new = files_of(PAGE)
    assert edits == {"app/plots/theme.py", "app/parts/inline_scripts/shared.js", "granchain/pictures.py"} and not new
    assert PAGE.read_text(encoding="utf-8").splitlines()[0] == "# Add a theme: edit 3 files"


def test_the_new_theme_passes_the_tests_of_themes(tree: Path) -> None:
    assert "4 passed" in follow(tree, *_TESTS, "-k", "colours_of_its_pictures")
    follow(tree, *_TESTS)


def test_the_new_theme_is_known_to_links_the_command_line_and_figures(tree: Path) -> None:
    printed = follow(tree, "-c", """
import argparse
from app.cli import figure as command
from app.cli.waiting import answer
from app.session.share import decode
parser = argparse.ArgumentParser()
command.add_options(parser)
print("sepia" in parser.format_help(), decode("v=1&look=sepia")[1:], b"[data-theme=sepia]" in answer())
from app.plots.theme import THEMES
from app.plots.themed import apply_theme, empty_figure
print(apply_theme(empty_figure(), THEMES["sepia"]).background_fill_color)
""")
    assert printed.splitlines() == ["True ({'look': 'sepia'}, []) True", "#fbf5e6"]


@pytest.mark.parametrize(("path", "added"), [("app/parts/inline_scripts/shared.js", ', "sepia"]'), ("granchain/pictures.py", ' or "sepia".')])
def test_what_is_forgotten_is_named(tree: Path, path: str, added: str) -> None:
    file = tree / path
    text = file.read_text(encoding="utf-8")
    assert text.count(added) == 1
    file.write_text(text.replace(added, added[-1]), encoding="utf-8")
    try:
        with pytest.raises(AssertionError, match="sepia"):
            follow(tree, *_TESTS)
    finally:
        file.write_text(text, encoding="utf-8")
