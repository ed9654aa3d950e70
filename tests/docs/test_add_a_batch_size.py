"""docs/add-a-batch-size.md is followed to the letter in a copy of the repository."""

from __future__ import annotations

from pathlib import Path

import pytest
from documents import ROOT
from edited_tree import copied, edited_copy, files_of, follow

PAGE = ROOT / "docs" / "add-a-batch-size.md"
#: The start of a process with batches of two: the size is read when the kernels are imported.
_OF_TWO = "import os; os.environ['GRANCHAIN_BATCH_SIZE'] = '2'; "


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made."""
    copy = tmp_path_factory.mktemp("width") / "tree"
    copied("tests/kernels/simd/test_root_by_series.py", copy)
    return edited_copy(PAGE, copy)


def test_the_page_edits_three_files_and_writes_none() -> None:
    edits, new = files_of(PAGE)
    assert len(edits) == 3 and not new


def test_the_new_width_passes_the_tests_of_roots(tree: Path) -> None:
    follow(tree, "-m", "pytest", "-p", "no:cacheprovider", "tests/kernels/simd/test_root_by_series.py")


def test_a_batch_of_two_has_the_curve_of_other_batches(tree: Path) -> None:
    """They agree within both stated errors; other recipes use the same small chain, so its kernels may exist already.
    """
    program = """
from granchain_core import resonance_curve, scene
found = resonance_curve(scene("sec2").evolve(N=2), [1800.0, 2000.0, 2200.0], workers=1)
print([(p.regime.period, p.max_output_force, p.force_errors.output) for p in found.points])
"""
    ours, theirs = (eval(follow(tree, "-c", begin + program)) for begin in ("", _OF_TWO))
    for (period, force, error), (same, other, its_error) in zip(ours, theirs, strict=True):
        assert period == same and force == pytest.approx(other, rel=error + its_error)
