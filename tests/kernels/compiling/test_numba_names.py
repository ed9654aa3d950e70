"""The installed Numba has every name of tools/numba_names.py, and the kernels use each one."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from app.library_internals import Internal, missing
from tools.numba_names import LLVM, NUMBA, names_in

_ROOT = Path(__file__).resolve().parents[3]
_CORE = _ROOT / "granchain_core"


def test_a_missing_name_is_noticed() -> None:
    assert missing([Internal("numba.core.codegen.JITCodeLibrary", ("_finalized", "_melted"), "")])[0][1].endswith("_melted")


@pytest.mark.parametrize("file", NUMBA)
def test_the_installed_release_has_the_names_that_a_file_uses(file: str) -> None:
    assert [name for _, name in missing(NUMBA[file])] == []


@pytest.mark.parametrize("file", NUMBA)
def test_a_file_uses_the_names_of_its_rows(file: str) -> None:
    words = set(re.findall(r"\w+", (_CORE / file).read_text(encoding="utf-8")))
    assert names_in(file) <= words


def test_modules_of_numba_beyond_its_documentation_are_in_the_table() -> None:
    """`numba.core` is not a public module; only its events are documented."""
    imported = {path.relative_to(_CORE).as_posix(): text for path in _CORE.rglob("*.py")
                if re.search(r"^ *from numba\.core\b(?! import event$)", text := path.read_text("utf-8"), re.MULTILINE)}
    assert set(imported) <= set(NUMBA)


def test_the_table_of_llvm_has_the_names_that_kernels_use() -> None:
    """Intrinsics are listed by name, with widths and instruction names in braces as in the source."""
    used = {(name, path.relative_to(_CORE).as_posix()) for path in (_CORE / "kernels").rglob("*.py")
            for name in re.findall(r'f?"(llvm\.[\w.{}]+)"', path.read_text("utf-8"))}
    assert used == {(name, file) for name, _, file in LLVM}
