"""docs/add-a-recorded-quantity.md is followed to the letter in a copy of the repository."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from documents import ROOT
from edited_tree import copied, edited_copy, files_of, follow

from granchain_core import run, save, scene

PAGE = ROOT / "docs" / "add-a-recorded-quantity.md"


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made, and a file written by the version without them."""
    copy = tmp_path_factory.mktemp("quantity") / "tree"
    copied("docs/result-files.md", copy)
    edited_copy(PAGE, copy)
    save(run(scene("sec2").evolve(N=2, f=2000.0), periods=4, record=1, samples=8), copy / "old.h5")
    return copy


def test_the_page_edits_one_module_and_the_table() -> None:
    edits, new = files_of(PAGE)
    assert edits == {"granchain_core/results/run.py", "docs/result-files.md"} and not new


def test_the_quantity_is_in_results_files_and_those_of_older_versions(tree: Path) -> None:
    printed = follow(tree, "-c", """
import h5py, numpy as np
from granchain_core import Run, load, run, save, scene
found = run(scene("sec2").evolve(N=2, f=2000.0), periods=4, record=1, samples=8)
save(found, "new.h5")
print(np.allclose(found.momentum, found.scene.masses()[0] * found.velocity.sum(axis=1)), found.momentum.any())
with h5py.File("new.h5") as file:
    column = file["run/momentum"]
    print(column.shape, column.attrs["units"], column.attrs["long_name"])
print(load("new.h5").momentum.tolist() == load("old.h5").momentum.tolist() == found.momentum.tolist())
print(found.to_xarray().momentum.dims, "momentum : " in Run.__doc__)
""", own_kernels=False).splitlines()
    assert printed == ["True True", "(9,) kg m/s momentum of all beads", "True", "('time',) True"]
    assert "| `momentum` | `time` | kg m/s | momentum of all beads |" in (tree / "docs" / "result-files.md").read_text("utf-8")


def test_the_places_for_a_field_of_the_kernels_are_all_that_name_one() -> None:
    """The page lists all modules that create `Samples` by its fields."""
    listed = set(re.findall(r"^\d\. `(granchain_core/[\w/]+\.py)`", PAGE.read_text("utf-8"), re.MULTILINE))
    makes = {path.relative_to(ROOT).as_posix() for path in (ROOT / "granchain_core").rglob("*.py")
             if re.search(r"(?<!\w)Samples\((?!NamedTuple)", path.read_text("utf-8"))}
    assert makes <= listed and all((ROOT / name).exists() for name in listed)
