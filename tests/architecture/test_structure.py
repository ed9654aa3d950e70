"""The core imports no dashboard, files are short, and everything public has a docstring."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from source import ROOT, by_folder, imports_in, nodes, parsed

CORE = sorted((ROOT / "granchain_core").rglob("*.py"))
ALL = [*CORE, *sorted((ROOT / "app").rglob("*.py"))]
CORE_FOLDERS, ALL_FOLDERS = by_folder(CORE), by_folder(ALL)


@pytest.mark.parametrize("folder", CORE_FOLDERS)
def test_the_core_imports_no_dashboard_and_no_command_line(folder: str) -> None:
    others = {"panel", "bokeh", "param", "app", "tornado", "argparse", "click", "typer"}
    assert [(path.name, one.module) for path in CORE_FOLDERS[folder] for one in imports_in(path)
            if one.module.split(".")[0] in others] == []


@pytest.mark.parametrize("folder", ALL_FOLDERS)
def test_files_are_short_and_have_docstrings(folder: str) -> None:
    faults = []
    for path in ALL_FOLDERS[folder]:
        tree = parsed(path)
        if path.read_text(encoding="utf-8").count("\n") - lines_of_docstrings(path) > 300:
            faults.append(f"{path.name} has more than 300 lines without docstrings")
        if tree.body and not ast.get_docstring(tree):
            faults.append(f"{path.name} has no docstring")
        faults += [f"{path.name}: {node.name} has no docstring" for node in tree.body
                   if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_") and not ast.get_docstring(node)]
    assert faults == []


@pytest.mark.parametrize("folder", by_folder(sorted((ROOT / "tests").rglob("test_*.py"))))
def test_files_of_tests_have_tests(folder: str) -> None:
    """No other test would notice a file that was emptied by mistake."""
    assert [path.name for path in (ROOT / folder).glob("test_*.py")
            if not re.search(r"^ *def test_", path.read_text(encoding="utf-8"), re.MULTILINE)] == []


@pytest.mark.parametrize("folder", by_folder(sorted((ROOT / "app").rglob("*.js"))))
def test_scripts_are_short_and_begin_with_a_comment(folder: str) -> None:
    texts = {path.name: path.read_text(encoding="utf-8") for path in (ROOT / folder).glob("*.js")}
    assert [name for name, text in texts.items() if text.count("\n") > 300 or not text.startswith("//")] == []


def lines_of_docstrings(path: Path) -> int:
    """Count the lines of docstrings: the better a file is documented, the longer it may be."""
    return sum(node.body[0].end_lineno - node.body[0].lineno + 1 for node in nodes(path)
               if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node))


def test_the_cache_is_named_by_the_sources_of_all_kernels() -> None:
    """tests/kernels/compiling/test_sources.py tests what changes that hash."""
    from granchain_core.kernels.compiling.cache_folder import CACHE_FOLDER
    from granchain_core.kernels.compiling.sources import sources_hash

    assert CACHE_FOLDER is not None and sources_hash() in CACHE_FOLDER.name


def test_code_inlined_by_numba_has_one_caller_or_one_of_each_kind_of_step() -> None:
    """Code inlined into two callers is compiled twice. Two kernels may share it if a scene needs only one of them."""
    parts: set[str] = set()
    calls: list[tuple[str, str]] = []
    for path in CORE:
        if "kernels" not in path.parts:
            continue
        here = _dotted(path)
        origin = {called: f"{module}.{name}" for module, names in imports_in(path, everywhere=False)
                  for name, called in names}
        for node in nodes(path):
            if isinstance(node, ast.FunctionDef) and any(ast.unparse(d) == "inline_numba" for d in node.decorator_list):
                parts.add(f"{here}.{node.name}")
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                calls.append((origin.get(node.func.id, f"{here}.{node.func.id}"), here))
    assert [call for call in calls if call[0] in parts and calls.count(call) > 1] == []
    callers = {name: [caller for called, caller in calls if called == name] for name in parts}
    assert all(1 <= len(found) <= 2 for found in callers.values()), callers


def test_a_batch_takes_every_slot_in_the_order_of_its_field() -> None:
    """`batch_slots` fills `Slots` by position: an omitted slot would be None, and the effect missing from curves."""
    tree = parsed(ROOT / "granchain_core" / "kernels" / "equations" / "motion.py")
    (slots,) = (node for node in tree.body if isinstance(node, ast.ClassDef) and node.name == "Slots")
    fields = [node.target.id for node in slots.body if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)]
    (function,) = (node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "batch_slots")
    read = [node for node in ast.walk(function) if isinstance(node, ast.Attribute)]
    assert [node.attr for node in sorted(read, key=lambda node: node.lineno)] == fields
    assert {ast.unparse(node.value) for node in read} == {"slots"}


def test_kernels_take_few_arguments() -> None:
    """They take at most 8: related values form a named tuple, for example a step or the output arrays."""
    many = {f"{_dotted(path)}.{node.name}": len(node.args.args) for path in CORE if "kernels" in path.parts
            for node in nodes(path)
            if isinstance(node, ast.FunctionDef) and len(node.args.args) > 8}
    assert many == {}


def test_an_error_is_read_by_a_name_with_one_meaning() -> None:
    """`error_estimate` would be the displacement error in one result and the output-force error in another."""
    assert [_dotted(path) for path in ALL for node in nodes(path)
            if isinstance(node, ast.Attribute) and node.attr == "error_estimate"] == []


def _dotted(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


def test_the_folders_of_quick_tests_are_there() -> None:
    """A renamed folder would silently drop out of the inner loop."""
    tests = ROOT / "tests"
    (quick,) = (ast.literal_eval(statement.value) for statement in parsed(tests / "conftest.py").body
                if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) == "QUICK")
    assert [folder for folder in quick if not (tests / folder).is_dir()] == []


def test_files_of_tests_have_names_of_their_own() -> None:
    """pytest treats files of the same name in two folders as one module, and refuses the second."""
    names = [path.name for path in (ROOT / "tests").rglob("test_*.py")]
    assert sorted({name for name in names if names.count(name) > 1}) == []
