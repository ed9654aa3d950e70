"""Work in a worker thread gets everything it needs as arguments, and hands over its results (`Job.next_tick`)."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from source import ROOT, parsed

#: Folders with the state of pages, which is used only while the document is locked.
FOLDERS = ("curve", "dashboard", "pages", "parts", "session")
PAGES = sorted(path for folder in FOLDERS for path in (ROOT / "app" / folder).rglob("*.py"))
#: Types of parameters that only the work of a thread has.
OF_A_THREAD = {"Job", "TurnFlag"}
SESSION = {"session", "_session"}


def faults(tree: ast.AST) -> Iterator[str]:
    """Yield the places where thread work in a module writes to `self` or reads the session."""
    for function in ast.walk(tree):
        if not isinstance(function, ast.FunctionDef) or not OF_A_THREAD & {
                ast.unparse(one.annotation) for one in function.args.args if one.annotation is not None}:
            continue
        for node in ast.walk(function):
            if isinstance(node, (ast.Attribute, ast.Subscript)) and not isinstance(node.ctx, ast.Load) \
                    and ast.unparse(node).startswith("self."):
                yield f"{function.name} writes {ast.unparse(node)}"
            elif isinstance(node, ast.Attribute) and node.attr in SESSION:
                yield f"{function.name} reads {ast.unparse(node)}"


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_the_work_of_a_thread_changes_nothing_of_its_page(path: Path) -> None:
    assert list(faults(parsed(path))) == []


def test_a_change_of_the_page_by_a_thread_is_found() -> None:
    source = """
def work(self, job: Job):
    self.sent, mine = 0.0, self.found
    self.done[3] += 1
    scene = self._host.session.scene
def locked(self):
    self.sent = self._host.session.scene
"""
    assert set(faults(ast.parse(source))) == {"work writes self.sent", "work writes self.done[3]",
                                              "work reads self._host.session"}
