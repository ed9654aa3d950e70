"""docs/add-a-command.md is followed to the letter in a copy of the repository."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from documents import ROOT, blocks
from edited_tree import copied, edited_copy, files_of, follow

PAGE = ROOT / "docs" / "add-a-command.md"


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made."""
    return edited_copy(PAGE, tmp_path_factory.mktemp("command") / "tree")


def test_the_page_edits_two_files_and_writes_one() -> None:
    edits, new = files_of(PAGE, until="## Add an option\n")
    assert (len(edits), len(new)) == (2, 1)


def test_an_option_edits_four_files_and_writes_one() -> None:
    before = len(blocks(PAGE, until="## Add an option\n"))
    files = [block.path for block in blocks(PAGE)[before:]]
    assert len(files) == len(set(files)) == 4 + 1
    assert "An option needs edits in 4 files and a new or edited test file." in PAGE.read_text(encoding="utf-8")


def test_the_option_passes_its_tests(tree: Path) -> None:
    printed = follow(tree, "-m", "pytest", "-p", "no:cacheprovider", "tests/cli/test_beads.py",
                     "tests/cli/test_json_keys.py::test_the_keys_are_those_of_the_page[beads, one]")
    assert printed.startswith("....") and "F" not in printed


def test_the_new_command_prints_its_result(tree: Path) -> None:
    beads = json.loads(follow(tree, "-m", "app.cli", "beads", "sec2", "--set", "N=2", "--json"))["beads"]
    assert len(beads) == 2 and set(beads[0]) == {"mass", "radius"}
    assert len(follow(tree, "-m", "app.cli", "beads", "sec2", "--set", "N=2").splitlines()) == 3


_LISTS = ("tests/cli/test_command_lists.py::test_a_command_has_an_example[beads]",
          "tests/cli/test_command_lists.py::test_a_hostile_base_of_every_command_gets_past_the_parser[beads]",
          "tests/cli/test_json_keys.py::test_every_command_has_a_table_or_no_json")


def test_the_tests_over_all_commands_include_the_new_one(tree: Path) -> None:
    printed = follow(tree, "-m", "pytest", "-p", "no:cacheprovider", *_LISTS,
                     "tests/cli/test_json_keys.py::test_the_keys_are_those_of_the_page[beads]")
    assert printed.startswith("....") and "F" not in printed


def test_the_tables_of_commands_get_the_new_one(tree: Path) -> None:
    """`python -m tools.update` writes these tables."""
    copied("tools/command_tables.py", tree)
    code = "from tools.command_tables import table_of_commands, table_of_json; print(table_of_commands(), table_of_json())"
    printed = follow(tree, "-c", code)
    assert "| `granchain beads SCENE` | mass and radius of every bead of a scene ([docs/scenes.md](docs/scenes.md)) |" in printed
    assert "| `granchain beads sec2 --set N=2` | [beads](#beads) |" in printed


@pytest.mark.parametrize(("file", "words", "test"), [
    ("app/cli/commands.py", '"sec2 --set N=2", "scenes.md"', _LISTS[0]), ("docs/command-line.md", "## beads", _LISTS[2])])
def test_a_list_without_the_command_is_named(file: str, words: str, test: str, tree: Path) -> None:
    right = (tree / file).read_text(encoding="utf-8")
    (tree / file).write_text(right.replace(words, words.replace("beads", "bonds").replace("sec2", "--sec2")), encoding="utf-8")
    try:
        printed = follow(tree, "-c", f"import pytest; print(int(pytest.main(['-p', 'no:cacheprovider', {test!r}])))")
    finally:
        (tree / file).write_text(right, encoding="utf-8")
    assert printed.startswith("F") and printed.endswith("1\n")
