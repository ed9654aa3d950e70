"""The hash that names compiled code covers everything in the sources that can change an instruction, and nothing else.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from granchain_core.kernels.compiling import sources

SOURCE = '''"""Module."""

from jit import kernel

#: A comment.
FACTOR = 2.0


@kernel(fast=True)
def force(x, power=1.5):
    """Docstring."""
    name = "a text"
    return FACTOR * x**power + 1.0  # of a spring
'''


def hashed(folder: Path, text: str) -> str:
    """Return the hash of a kernel folder that contains one file."""
    folder.mkdir(exist_ok=True)
    (folder / "force.py").write_text(text, encoding="utf-8")
    return sources.sources_hash(folder)


@pytest.mark.parametrize(("old", "new"), [
    ("#: A comment.", "#: Another comment,\n#: of two lines."), ("  # of a spring", ""), ('"""Docstring."""', '"""Other words."""'),
    ('"""Module."""\n', ""), ("\n\n\n", "\n\n\n\n"), ("x**power", "x ** power"),
    ("FACTOR * x**power + 1.0", "(FACTOR * x**power\n            + 1.0)"),
])
def test_comments_and_layout_keep_the_hash(old: str, new: str, tmp_path: Path) -> None:
    assert old in SOURCE
    assert hashed(tmp_path, SOURCE) == hashed(tmp_path, SOURCE.replace(old, new))


@pytest.mark.parametrize(("old", "new"), [
    ("2.0", "2.5"), ("2.0", "2"), ("1.5", "2.5"), ("* x", "- x"), ("fast=True", "fast=False"), ("FACTOR *", "FACTOR +"),
    ("import kernel", "import internal"), ("a text", "another"), ("@kernel(fast=True)\n", ""), ("power", "exponent"),
])
def test_an_edit_that_can_change_an_instruction_changes_the_hash(old: str, new: str, tmp_path: Path) -> None:
    assert old in SOURCE
    assert hashed(tmp_path, SOURCE) != hashed(tmp_path, SOURCE.replace(old, new))


def test_a_file_that_cannot_be_parsed_counts_with_its_bytes(tmp_path: Path) -> None:
    assert hashed(tmp_path, "def (") != hashed(tmp_path, "def (  # a comment")


@pytest.mark.parametrize("name", ["BATCH_SIZE", "processor"])
def test_another_batch_size_or_processor_changes_the_hash(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = hashed(tmp_path, SOURCE)
    monkeypatch.setattr(sources, name, 2 * sources.BATCH_SIZE if name == "BATCH_SIZE" else lambda: "another")
    assert hashed(tmp_path, SOURCE) != before


@pytest.mark.parametrize("name", sources._NOT_IN_CODE)
def test_sources_that_only_store_and_call_keep_the_hash(name: str, tmp_path: Path) -> None:
    before = hashed(tmp_path, SOURCE)
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text("changed = True", encoding="utf-8")
    assert sources.sources_hash(tmp_path) == before


def test_another_compiler_changes_the_hash(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = hashed(tmp_path, SOURCE)
    for module in (sources.numba, sources.llvmlite):
        with monkeypatch.context() as patch:
            patch.setattr(module, "__version__", "0.0")
            assert sources.sources_hash(tmp_path) != before


@pytest.mark.parametrize("level", [0, 1, "max"])
def test_another_optimisation_level_changes_the_hash(level: int | str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = hashed(tmp_path, SOURCE), sources.source_bytes_hash(tmp_path)
    usual = sources.numba.config.OPT
    assert level != usual
    monkeypatch.setattr(sources.numba.config, "OPT", type(usual)(level))
    assert sources.sources_hash(tmp_path) != before[0] and sources.source_bytes_hash(tmp_path) != before[1]


@pytest.mark.parametrize("name", ["BOUNDSCHECK", "DEBUGINFO_DEFAULT", "SLP_VECTORIZE", "LOOP_VECTORIZE", "ENABLE_AVX"])
def test_a_setting_that_changes_the_code_changes_the_hash(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise NUMBA_BOUNDSCHECK=1 would find no error with a cache that was filled without bounds checks."""
    before = hashed(tmp_path, SOURCE), sources.source_bytes_hash(tmp_path)
    monkeypatch.setattr(sources.numba.config, name, not getattr(sources.numba.config, name))
    assert sources.sources_hash(tmp_path) != before[0] and sources.source_bytes_hash(tmp_path) != before[1]


def made(body: str):
    """Return the function `f` that a source defines."""
    names: dict = {}
    exec(body, names)
    return names["f"]


def test_functions_of_one_name_differ_by_their_names_and_constants() -> None:
    one = made('def f(x):\n    "Words."\n    return a(x) + 1.0')
    assert sources.constants_hash(one) == sources.constants_hash(made('\n\ndef f(x):\n    "Others."\n    return a(x) + 1.0'))
    for other in ("return a(x) + 2.0", "return b(x) + 1.0", "return a(x) + 1", "return (lambda: 3.0)() + a(x) + 1.0"):
        assert sources.constants_hash(one) != sources.constants_hash(made(f'def f(x):\n    "Words."\n    {other}'))
    inner = [made(f"def f(x):\n    return [y + {number} for y in x]") for number in (1.0, 1.0, 2.0)]
    assert sources.constants_hash(inner[0]) == sources.constants_hash(inner[1]) != sources.constants_hash(inner[2])
