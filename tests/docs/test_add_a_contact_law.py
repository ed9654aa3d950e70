"""The edits of docs/add-a-contact-law.md are made in a copy of the repository; it names all places of the exponent."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from documents import ROOT
from edited_tree import copied, edited_copy, files_of, follow

PAGE = ROOT / "docs" / "add-a-contact-law.md"


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made."""
    copy = tmp_path_factory.mktemp("contact") / "tree"
    copied("tests/kernels/effects/test_exponent.py", copy)
    return edited_copy(PAGE, copy)


def test_the_page_edits_four_files_and_writes_none() -> None:
    edits, new = files_of(PAGE)
    assert len(edits) == 4 and not new


def test_force_slope_and_energy_have_the_new_exponent(tree: Path) -> None:
    printed = follow(tree, "-m", "pytest", "-p", "no:cacheprovider", "tests/kernels/effects/test_exponent.py", "-k", "force_slope")
    assert "3 passed" in printed


def test_static_overlaps_scales_and_words_follow(tree: Path) -> None:
    printed = follow(tree, "-c", """
from granchain_core import scene
from granchain_core.integrate.scaling import scales_of
one = scene("sec2").evolve(F0=4.0)
print(float(one.static_overlap()[0]) / (4.0 / one.K) ** 0.5, scales_of(one).force / (one.K * one.A0**2))
print(one.equation_latex())
""")
    numbers, equation = printed.splitlines()
    assert [float(number) for number in numbers.split()] == pytest.approx([1.0, 1.0], rel=1e-14)
    assert r"[\delta_c]_+^2" in equation and "(F_0/K)^{1/2}" in equation and "3/2" not in equation


def test_the_page_names_every_place_of_the_design_notes() -> None:
    """It names files and functions; functions of a file that a block edits, e.g. `elastic_force`, are in that block."""
    page = PAGE.read_text(encoding="utf-8")
    table = (ROOT / "docs" / "design.md").read_text("utf-8").partition("### The exponent 3/2\n")[2].partition("\n[add-a-contact")[0]
    files = re.findall(r"`([\w/]+\.py)`", table)
    names = {name for names in re.findall(r"\.py` \(([^)]*)\)", table) for name in re.findall(r"`(\w+)`", names)}
    edited = "".join((ROOT / path).read_text(encoding="utf-8") for path in files_of(PAGE)[0])
    assert len(files) > 15 and len(names) > 25
    assert not [file for file in files if file not in page]
    assert not [name for name in names if f"`{name}`" not in page and not re.search(rf"(def )?\b{name}\b", edited)]
