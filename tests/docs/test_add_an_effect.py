"""docs/add-an-effect.md is followed to the letter in a copy of the repository."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from documents import ROOT, blocks, edited

PAGE = ROOT / "docs" / "add-an-effect.md"
_PARTS = ("granchain_core", "app", "assets", "tests/chains.py", "tests/conftest.py", "pyproject.toml")


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made."""
    copy = tmp_path_factory.mktemp("effect") / "tree"
    for part in _PARTS:
        source, target = ROOT / part, copy / part
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, target)
    for block in blocks(PAGE):
        if block.language == "console":
            continue
        file = copy / block.path
        if block.is_new_file:
            assert not file.exists(), f"{block.path} is there already"
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(block.text, encoding="utf-8")
        else:
            file.write_text(edited(file.read_text(encoding="utf-8"), block.text), encoding="utf-8")
    return copy


def follow(tree: Path, *arguments: str) -> str:
    """What a command prints in the edited tree."""
    done = subprocess.run([sys.executable, *arguments], cwd=tree, capture_output=True, text=True, timeout=400,
                          env={**os.environ, "PYTHONPATH": str(tree), "GRANCHAIN_CACHE": str(tree / "cache"), "NUMBA_OPT": "1"})
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout


def test_the_page_has_five_steps():
    text = PAGE.read_text(encoding="utf-8")
    assert [line[3] for line in text.splitlines() if line.startswith("## ")] == list("12345")


def test_the_new_effect_passes_the_tests_the_page_writes(tree: Path):
    """Force, energy and tangent of the page's effect are right in every kernel."""
    assert "3 passed" in follow(tree, "-m", "pytest", "-p", "no:cacheprovider", "tests/physics/test_drag.py")


def test_the_new_effect_is_seen_and_its_absence_leaves_nothing(tree: Path):
    """The scene names it, the equation shows it, a scene without it has no slot."""
    told = follow(tree, "-c", """
from app.cli.explain import explanation
from granchain_core import scene
from granchain_core.lower import lower
one = scene("drag")
print(one.effects, one.equation_latex(), one.evolve(c=0.0).effects)
print(lower(one.evolve(c=0.0)).slots.drag)
print(explanation(one, None))
""")
    first, absent, *explained = told.splitlines()
    assert "ground drag" in first.split("]")[0] and r"- c\,\dot u_i" in first
    assert "ground drag" not in first.rsplit("[", 1)[1] and absent == "None"
    assert "ground drag (Drag)" in explained[0]
