"""The core imports no dashboard, files are short, and everything public has a docstring."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CORE = sorted((ROOT / "granchain_core").rglob("*.py"))
ALL = [*CORE, *sorted((ROOT / "app").rglob("*.py"))]


def imported(path: Path) -> set[str]:
    """Dotted names of the modules a file imports, relative ones made absolute."""
    names: set[str] = set()
    package = path.relative_to(ROOT).with_suffix("").parts[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = ".".join(package[: len(package) - node.level + 1]) if node.level else ""
            names.add(".".join(p for p in (base, node.module or "") if p))
    return names


@pytest.mark.parametrize("path", CORE, ids=lambda p: str(p.relative_to(ROOT)))
def test_the_core_knows_no_dashboard_and_no_command_line(path: Path) -> None:
    roots = {name.split(".")[0] for name in imported(path)}
    assert not roots & {"panel", "bokeh", "param", "app", "tornado", "argparse", "click", "typer"}


@pytest.mark.parametrize("path", ALL, ids=lambda p: str(p.relative_to(ROOT)))
def test_a_file_can_be_held_and_says_what_it_is(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    assert text.count("\n") - lines_of_docstrings(tree) <= 300
    assert ast.get_docstring(tree) or not tree.body
    for node in ast.walk(tree):
        public = isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_")
        if public and node in tree.body:
            assert ast.get_docstring(node), f"{path.name}: {node.name} has no docstring"  # type: ignore[arg-type]


def lines_of_docstrings(tree: ast.Module) -> int:
    """Lines that are documentation: the better a file is documented, the longer it may be."""
    return sum(node.body[0].end_lineno - node.body[0].lineno + 1 for node in ast.walk(tree)
               if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node))


def test_an_edit_of_any_kernel_starts_an_empty_cache() -> None:
    from granchain_core.kernels.cache import CACHE_FOLDER, sources_hash

    assert CACHE_FOLDER is not None and sources_hash() in CACHE_FOLDER.name


def test_code_inlined_by_numba_is_called_at_one_place() -> None:
    """In two it would be compiled twice, in place of once for itself. Steps in t and steps of the flow have each one."""
    parts: set[str] = set()
    calls: list[tuple[str, str]] = []
    for path in CORE:
        if "kernels" not in path.parts:
            continue
        tree, here = ast.parse(path.read_text(encoding="utf-8")), _dotted(path)
        origin = {alias.asname or alias.name: f"{module}.{alias.name}" for module, alias in _names_imported(path, tree)}
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef) and any(ast.unparse(d) == "inline_numba" for d in node.decorator_list):
                parts.add(f"{here}.{node.name}")
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                calls.append((origin.get(node.func.id, f"{here}.{node.func.id}"), here))
    assert [call for call in calls if call[0] in parts and calls.count(call) > 1] == []
    callers = {name: [caller for called, caller in calls if called == name] for name in parts}
    assert all(1 <= len(found) <= 2 for found in callers.values()), callers


def test_kernels_take_few_arguments() -> None:
    """What belongs together is a named tuple: a step, a trajectory, the arrays that are written."""
    many = {f"{_dotted(path)}.{node.name}": len(node.args.args) for path in CORE if "kernels" in path.parts
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.FunctionDef) and len(node.args.args) > 8}
    assert many == {}


def _dotted(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


def _names_imported(path: Path, tree: ast.Module) -> list[tuple[str, ast.alias]]:
    """Module, absolute, and alias of every `from … import …` at the top of a file."""
    package = _dotted(path).split(".")[:-1]
    return [(".".join([*package[: len(package) - node.level + 1], node.module or ""]), alias)
            for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names]
