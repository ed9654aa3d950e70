"""docs/add-a-drive.md is followed to the letter in a copy of the repository."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from documents import ROOT
from edited_tree import copied, edited_copy, files_of, follow

PAGE = ROOT / "docs" / "add-a-drive.md"


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made."""
    copy = tmp_path_factory.mktemp("drive") / "tree"
    for part in ("granchain", "granchain_start", "tools", "docs", "tests/prescribed_drive"):
        copied(part, copy)
    return edited_copy(PAGE, copy)


def test_the_page_edits_three_files_and_writes_none() -> None:
    edits, new = files_of(PAGE)
    assert len(edits) == 3 and not new


def test_a_chain_moves_under_the_new_drive_and_wrong_numbers_are_refused(tree: Path) -> None:
    """This covers the command line up to the stated error, the check common to all formulas, and the row's own check.
    """
    printed = follow(tree, "-c", """
from app.cli import main
raise SystemExit(main(["run", "sec2", "--set", "N=2", "--set", "accuracy=1e-5", "--drive", "pulse=2e-4:0.005", "--json"]))
""", own_kernels=False)
    found = json.loads(printed)
    assert found["drive"] == "Gaussian pulse of 0.0002 s in 0.005 s" and found["status"] == "done"
    assert found["max_output_force"] > 0.0 and 0.0 < found["error_estimate"] <= 1e-5
    refused = follow(tree, "-c", """
from granchain_core import BadInput
from granchain_core.prescribed_drive.formulas import formula_signal
for wrong in ("pulse=1e-3", "pulse=0:1", "pulse=1e-3:0.011"):
    try:
        formula_signal(wrong, 1e-7)
    except BadInput as problem:
        print(problem)
""", own_kernels=False).splitlines()
    assert ["pulse=width:duration" in one for one in refused] == [True, True, False] and "twelve widths" in refused[2]


def test_the_new_drive_is_in_the_help_and_in_the_docs(tree: Path) -> None:
    printed = follow(tree, "-c", """
from tools.update import pages
print("".join(pages().values()))
from app.cli import main
try:
    main(["run", "--help"])
except SystemExit:
    pass
""", own_kernels=False)
    assert "| `pulse=width:duration` | a Gaussian pulse" in printed and "pulse=width:duration, chirp=" in printed


def test_the_tests_of_signals_pass_with_the_new_one(tree: Path) -> None:
    printed = follow(tree, "-m", "pytest", "-p", "no:cacheprovider", "-rA", "tests/prescribed_drive", "-k", "follow_their_formulas",
                     own_kernels=False)
    assert len(re.findall(r"^PASSED \S+::test_signals_follow_their_formulas", printed, re.MULTILINE)) == 4
