"""The installed Numba has every name in the table of docs/compiling.md, and the kernels use each one."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from app.library_internals import Internal, missing

_ROOT = Path(__file__).resolve().parents[3]
_CORE = _ROOT / "granchain_core"
_PAGE = (_ROOT / "docs" / "compiling.md").read_text(encoding="utf-8")
_PART = _PAGE.partition("\n## Undocumented names of Numba\n")[2].partition("\n## ")[0]


def rows() -> dict[str, list[Internal]]:
    """Read the table: owners and their names, by the file of the core that uses them."""
    found: dict[str, list[Internal]] = {}
    for what, where, without in re.findall(r"^\| (`numba[^|]+) \| `([\w/.]+)` \| ([^|]+) \|$", _PART, re.MULTILINE):
        for part in what.split("<br>"):
            owner, names = part.split(": ", 1)
            found.setdefault(where, []).append(Internal(owner.strip("`"), tuple(re.findall(r"`(\w+)`", names)), without))
    return found


ROWS = rows()


def test_the_table_is_read() -> None:
    assert len(ROWS) > 8
    assert missing([Internal("numba.core.codegen.JITCodeLibrary", ("_finalized", "_melted"), "")])[0][1].endswith("_melted")


@pytest.mark.parametrize("file", ROWS)
def test_the_installed_release_has_the_names_that_a_file_uses(file: str) -> None:
    assert [name for _, name in missing(ROWS[file])] == []


@pytest.mark.parametrize("file", ROWS)
def test_a_file_uses_the_names_of_its_rows(file: str) -> None:
    words = set(re.findall(r"\w+", (_CORE / file).read_text(encoding="utf-8")))
    assert {name for row in ROWS[file] for name in row.names} <= words


def test_modules_of_numba_beyond_its_documentation_are_in_the_table() -> None:
    """`numba.core` is not a public module; only its events are documented."""
    imported = {path.relative_to(_CORE).as_posix(): text for path in _CORE.rglob("*.py")
                if re.search(r"^ *from numba\.core\b(?! import event$)", text := path.read_text("utf-8"), re.MULTILINE)}
    assert set(imported) <= set(ROWS)


def test_the_table_of_llvm_has_the_names_that_kernels_use() -> None:
    """Intrinsics are listed by name, with widths and instruction names in braces as in the source."""
    used = {(name, path.relative_to(_CORE).as_posix()) for path in (_CORE / "kernels").rglob("*.py")
            for name in re.findall(r'f?"(llvm\.[\w.{}]+)"', path.read_text("utf-8"))}
    listed = set(re.findall(r"^\| `(llvm\.[\w.{}]+)` \| [^|]+ \| `([\w/.]+)` \|", _PART, re.MULTILINE))
    assert used == listed
