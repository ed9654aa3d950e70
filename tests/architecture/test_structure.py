"""The core imports no dashboard, files are short, and everything public has a docstring."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from source import ROOT, imports_in, parsed

CORE = sorted((ROOT / "granchain_core").rglob("*.py"))
ALL = [*CORE, *sorted((ROOT / "app").rglob("*.py"))]


@pytest.mark.parametrize("path", CORE, ids=lambda p: str(p.relative_to(ROOT)))
def test_the_core_knows_no_dashboard_and_no_command_line(path: Path) -> None:
    roots = {one.module.split(".")[0] for one in imports_in(path)}
    assert not roots & {"panel", "bokeh", "param", "app", "tornado", "argparse", "click", "typer"}


@pytest.mark.parametrize("path", ALL, ids=lambda p: str(p.relative_to(ROOT)))
def test_a_file_is_short_and_has_docstrings(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    assert text.count("\n") - lines_of_docstrings(tree) <= 300
    assert ast.get_docstring(tree) or not tree.body
    for node in ast.walk(tree):
        public = isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_")
        if public and node in tree.body:
            assert ast.get_docstring(node), f"{path.name}: {node.name} has no docstring"  # type: ignore[arg-type]


@pytest.mark.parametrize("path", sorted((ROOT / "tests").rglob("test_*.py")), ids=lambda p: str(p.relative_to(ROOT)))
def test_a_file_of_tests_has_tests(path: Path) -> None:
    """One that is emptied by mistake fails nowhere else."""
    assert any(isinstance(node, ast.FunctionDef) and node.name.startswith("test_") for node in ast.walk(parsed(path)))


@pytest.mark.parametrize("path", sorted((ROOT / "app").rglob("*.js")), ids=lambda p: p.name)
def test_a_script_is_short_and_begins_with_a_comment(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert text.count("\n") <= 300 and text.startswith("//")


def lines_of_docstrings(tree: ast.Module) -> int:
    """Lines that are documentation: the better a file is documented, the longer it may be."""
    return sum(node.body[0].end_lineno - node.body[0].lineno + 1 for node in ast.walk(tree)
               if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node))


def test_the_cache_is_named_by_the_sources_of_all_kernels() -> None:
    """What changes that hash is tested in tests/kernels/compiling/test_sources.py."""
    from granchain_core.kernels.compiling.cache_folder import CACHE_FOLDER
    from granchain_core.kernels.compiling.sources import sources_hash

    assert CACHE_FOLDER is not None and sources_hash() in CACHE_FOLDER.name


def test_code_inlined_by_numba_has_one_caller_or_one_of_each_kind_of_step() -> None:
    """Inlined into two callers, code is compiled twice. Two kernels of which a scene needs one may share it."""
    parts: set[str] = set()
    calls: list[tuple[str, str]] = []
    for path in CORE:
        if "kernels" not in path.parts:
            continue
        tree, here = parsed(path), _dotted(path)
        origin = {called: f"{module}.{name}" for module, names in imports_in(path, everywhere=False)
                  for name, called in names}
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef) and any(ast.unparse(d) == "inline_numba" for d in node.decorator_list):
                parts.add(f"{here}.{node.name}")
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                calls.append((origin.get(node.func.id, f"{here}.{node.func.id}"), here))
    assert [call for call in calls if call[0] in parts and calls.count(call) > 1] == []
    callers = {name: [caller for called, caller in calls if called == name] for name in parts}
    assert all(1 <= len(found) <= 2 for found in callers.values()), callers


def test_a_batch_takes_every_slot_in_the_order_of_its_field() -> None:
    """`batch_slots` fills `Slots` by place: one that it left out would be None, and the effect absent from curves."""
    tree = parsed(ROOT / "granchain_core" / "kernels" / "equations" / "motion.py")
    (slots,) = (node for node in tree.body if isinstance(node, ast.ClassDef) and node.name == "Slots")
    fields = [node.target.id for node in slots.body if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)]
    (function,) = (node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "batch_slots")
    read = [node for node in ast.walk(function) if isinstance(node, ast.Attribute)]
    assert [node.attr for node in sorted(read, key=lambda node: node.lineno)] == fields
    assert {ast.unparse(node.value) for node in read} == {"slots"}


def test_kernels_take_few_arguments() -> None:
    """At most 8: values that belong together are a named tuple, such as a step or the arrays that are written."""
    many = {f"{_dotted(path)}.{node.name}": len(node.args.args) for path in CORE if "kernels" in path.parts
            for node in ast.walk(parsed(path))
            if isinstance(node, ast.FunctionDef) and len(node.args.args) > 8}
    assert many == {}


def test_an_error_is_read_by_a_name_with_one_meaning() -> None:
    """`error_estimate` is the error of the displacements of one result and that of the output force of another."""
    assert [_dotted(path) for path in ALL for node in ast.walk(parsed(path))
            if isinstance(node, ast.Attribute) and node.attr == "error_estimate"] == []


def _dotted(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


def test_the_folders_of_quick_tests_are_there() -> None:
    """A folder of another name would drop out of the inner loop silently."""
    tests = ROOT / "tests"
    (quick,) = (ast.literal_eval(statement.value) for statement in parsed(tests / "conftest.py").body
                if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) == "QUICK")
    assert [folder for folder in quick if not (tests / folder).is_dir()] == []


def test_files_of_tests_have_names_of_their_own() -> None:
    """Those of two folders with one name are one module to pytest, which then refuses the second."""
    names = [path.name for path in (ROOT / "tests").rglob("test_*.py")]
    assert sorted({name for name in names if names.count(name) > 1}) == []
