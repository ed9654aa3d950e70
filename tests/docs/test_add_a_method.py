"""docs/add-a-method.md is followed to the letter in a copy of the repository."""

from __future__ import annotations

from pathlib import Path

import pytest
from documents import ROOT
from edited_tree import edited_copy, files_of, follow

PAGE = ROOT / "docs" / "add-a-method.md"


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made."""
    return edited_copy(PAGE, tmp_path_factory.mktemp("method") / "tree")


def test_the_page_edits_two_files_and_writes_one() -> None:
    edits, new = files_of(PAGE)
    assert (len(edits), len(new)) == (2, 1)
    assert PAGE.read_text(encoding="utf-8").splitlines()[0] == "# Add a method of integration: edit 2 files, write 1"


def test_the_new_method_has_its_order_and_its_row(tree: Path) -> None:
    """Two halvings of the step against RK4 with 32 times the steps, with and without contact events."""
    printed = follow(tree, "-c", """
import numpy as np
from granchain_core import scene
from granchain_core.accuracy.compared_methods import compared_methods
from granchain_core.integrate import Engine, Setting, method_for
for knobs in ({"F0": 5.0}, {}):
    chain = scene("sec2").evolve(N=2, f=1130.0, **knobs)
    def moved(method, refine):
        return Engine(chain, Setting(method, refine), 8).record(16).displacement
    true = moved("rk4", 128)
    errors = [np.abs(moved("heun", refine) - true).max() for refine in (4, 8, 16)]
    print(np.log2(errors[0] / errors[2]) / 2.0)
print(compared_methods()["heun"].title, method_for(1e-6).method, sep="|")
""")
    smooth, events, row = printed.splitlines()
    assert 1.8 < float(smooth) < 2.3 and 1.8 < float(events) < 2.6  # the limit is 2; over coarse steps a part of order 3 is left
    assert row == "Heun's method in w|rk4-split"  # it is there, and not chosen by itself
