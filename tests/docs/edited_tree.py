"""Copy the repository, make a page's edits in the copy, and run commands there."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest
from documents import ROOT, blocks, edited
from forked import python

from granchain_core.kernels.compiling.cache_folder import CACHE_FOLDER

_PARTS = ("granchain_core", "app", "assets", "tests/chains.py", "tests/conftest.py", "pyproject.toml", "README.md", ".ci/test-command", "docs/model.md",
          "tests/numerics/test_orders.py", "docs/command-line.md",
          "tests/cli/test_json_keys.py", "tests/cli/test_command_lists.py", "tools/__init__.py", "tools/fuzzing", "tools/hostile",
          "tests/kernels/equations", "tests/reference/reference.npz")
#: Libraries that most commands in such a tree import.
_LIBRARIES = ("numba", "pytest", "panel", "bokeh.plotting")


def files_of(page: Path, until: str = "") -> tuple[set[str], set[str]]:
    """Return the files that a page edits, and those it writes, before the heading `until`."""
    found = [block for block in blocks(page, until) if block.language != "console"]
    return {block.path for block in found if not block.is_new_file}, {block.path for block in found if block.is_new_file}


def _lasts(file: Path) -> bool:
    """Return whether a file can be copied: not an unfinished file of Python's, or one of pytest's with its source's
    path.
    """
    return "__pycache__" not in file.parts or (file.suffix == ".pyc" and "-pytest-" not in file.name)


def copied(part: str, tree: Path) -> None:
    """Copy a file or folder of the repository into a tree; existing files are kept.

    Files keep their times, so that Python's compiled modules, which are copied too, remain valid.
    """
    source, target = ROOT / part, tree / part
    for file in [source] if source.is_file() else sorted(one for one in source.rglob("*") if one.is_file() and _lasts(one)):
        there = target / file.relative_to(source) if source.is_dir() else target
        if not there.exists():
            there.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(file, there)


def edited_copy(page: Path, copy: Path, until: str = "") -> Path:
    """Copy the repository and make the page's edits before the heading `until`; each must fit at exactly one place."""
    for part in _PARTS:
        copied(part, copy)
    edit_files(page, copy, until)
    return copy


def edit_files(page: Path, tree: Path, until: str = "") -> None:
    """Make the page's edits in a tree that has the edited files."""
    for block in blocks(page, until):
        if block.language == "console":
            continue
        file = tree / block.path
        if block.is_new_file:
            assert not file.exists(), f"{block.path} is there already"
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(block.text, encoding="utf-8")
        else:
            file.write_text(edited(file.read_text(encoding="utf-8"), block.text), encoding="utf-8")


def follow(tree: Path, *arguments: str, own_kernels: bool = True) -> str:
    """Run a command in the edited tree and return what it prints.

    Its compiled kernels are kept: their folder is named by the sources, so an edited tree finds its own kernels again
    until a kernel or the page changes. Without optimisation (NUMBA_OPT=0), Numba could not keep them. Without
    `own_kernels`, those of the repository are used, which are the same if the page edits none.
    """
    cache = tree / "cache" if CACHE_FOLDER is None else CACHE_FOLDER.parent / "edited-trees"
    kernels = {"GRANCHAIN_CACHE": str(cache), "NUMBA_OPT": "1"} if own_kernels else {}
    done = python(*arguments, folder=tree, environment={**os.environ, "PYTHONPATH": str(tree), **kernels}, libraries=_LIBRARIES)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout


def import_with(tree: Path, path: str, right: str, wrong: str) -> str:
    """Return what the first import of the core prints if a part of one of its files is replaced; it must fail."""
    file = tree / "granchain_core" / path
    text = file.read_text(encoding="utf-8")
    assert text.count(right) == 1
    file.write_text(text.replace(right, wrong), encoding="utf-8")
    try:
        with pytest.raises(AssertionError) as failed:
            follow(tree, "-c", "from granchain_core import run")
    finally:
        file.write_text(text, encoding="utf-8")
    return str(failed.value)
