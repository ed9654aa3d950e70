"""docs/add-a-damping-law.md is followed to the letter in a copy of the repository."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from documents import ROOT
from edited_tree import edited_copy, files_of, follow, import_with

PAGE = ROOT / "docs" / "add-a-damping-law.md"
_CHECKS = Path(__file__).parent / "added_law.py"


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made."""
    copy = edited_copy(PAGE, tmp_path_factory.mktemp("law") / "tree")
    shutil.copy(_CHECKS, copy / "tests" / "test_added_law.py")
    return copy


def test_the_page_edits_three_files_and_writes_none() -> None:
    edits, new = files_of(PAGE)
    assert (len(edits), len(new)) == (3, 0)
    mentioned = PAGE.read_text(encoding="utf-8").partition("\n## 4. ")[2]
    assert len(set(re.findall(r"\]\(([\w-]+\.md)\)", mentioned))) == 4  # CHANGELOG.md, not linked, is not counted


def test_the_new_law_is_right_in_every_kernel(tree: Path) -> None:
    """Energy, the order of split steps, tangents and the kink of a cut are right, and all ways to the steady state
    agree.
    """
    assert "6 passed" in follow(tree, "-m", "pytest", "-p", "no:cacheprovider", str(Path("tests", "test_added_law.py")))


def test_the_equations_of_the_paper_hold_with_the_new_law(tree: Path) -> None:
    """The quick tests with an independent reference take their cases from the table of laws."""
    printed = follow(tree, "-m", "pytest", "-p", "no:cacheprovider", str(Path("tests", "kernels", "equations")),
                     "-k", "three-quarters")
    assert " failed" not in printed and re.search(r"\b[1-9]\d* passed", printed)


def test_the_new_law_is_in_knob_equation_and_names_of_kernels(tree: Path) -> None:
    """It is a choice of the knob on the page, a term of the equation, and in the names of effects and kernels."""
    printed = follow(tree, "-c", """
from app.cli.explain import explanation
from app.parts.knobs.knobs import knob_state
from granchain_core import scene
from granchain_core.precompile.warm import structure
one = scene("sec2").evolve(dissipation="three-quarters")
print(one.effects[-1], one.equation_latex(), structure(one), sep="|")
print([spec["choices"] for spec in knob_state(one)["specs"] if spec["name"] == "dissipation"])
print(explanation(one, None, 96))
""")
    first, choices, *explained = printed.splitlines()
    name, equation, kernels = first.split("|")
    assert name == "damping with δ^(3/4)" and r"D\,(\delta_c/\delta_r)_+^{3/4}\,\dot\delta_c" in equation
    assert kernels == "three-quarters, vector of 16" and "'three-quarters'" in choices
    assert "contact damping (ThreeQuarters)" in explained[0]


@pytest.mark.parametrize(("path", "right", "wrong", "sentence"), [
    ("kernels/effects/dissipation.py", "@power.of(ThreeQuarters)\n", "",
     "ThreeQuarters (granchain_core.kernels.effects.dissipation) has no `power`"),
    ("kernels/effects/dissipation.py", "@exponent.of(ThreeQuarters)\n", "",
     "ThreeQuarters (granchain_core.kernels.effects.dissipation) has no `exponent`"),
    ("kernels/effects/dissipation.py", "return r * root(r)", "return root(r)", "damping law ThreeQuarters: `power` is not δ^0.75"),
    ("scene/laws.py", '    Law("three-quarters"', '    # Law("three-quarters"', "damping law ThreeQuarters has no line in laws.py"),
    ("scene/laws.py", 'δ^(3/4)", source=""', 'δ^(3/4)"', "Law.__init__() missing 1 required positional argument: 'source'"),
])
def test_a_forgotten_term_of_the_law_is_named(tree: Path, path: str, right: str, wrong: str, sentence: str) -> None:
    assert f"TypeError: {sentence}" in import_with(tree, path, right, wrong)
