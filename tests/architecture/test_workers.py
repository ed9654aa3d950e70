"""What runs in a worker thread takes what it needs as arguments, and hands its results over (`Job.next_tick`)."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from source import ROOT, parsed

#: Where the state of a page is, which is used with the document locked.
FOLDERS = ("curve", "dashboard", "pages", "parts", "session")
PAGES = sorted(path for folder in FOLDERS for path in (ROOT / "app" / folder).rglob("*.py"))
#: Parameters by which a function is given to a thread. `Task` itself is such work, and writes nothing.
OF_A_THREAD = {"Job", "TurnFlag"}
SESSION = {"session", "_session"}


def faults(tree: ast.AST) -> Iterator[str]:
    """What the work of threads in a module writes of `self`, and where it reads the session."""
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


def test_what_would_be_a_fault_is_found() -> None:
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
