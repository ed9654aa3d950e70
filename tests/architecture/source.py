"""Read the imports and the named parts of the project's Python files, for the tests of its architecture."""

from __future__ import annotations

import ast
import functools
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]


class Import(NamedTuple):
    """One import: the absolute dotted module, and the names imported from it, each with its local name.

    For `import …`, there are no names.
    """

    module: str
    names: tuple[tuple[str, str], ...] = ()


@functools.cache
def parsed(path: Path) -> ast.Module:
    """Return the syntax tree of a file, which the tests share and do not change."""
    return ast.parse(path.read_text(encoding="utf-8"))


@functools.cache
def nodes(path: Path) -> tuple[ast.AST, ...]:
    """Return all nodes of a file's syntax tree."""
    return tuple(ast.walk(parsed(path)))


def by_folder(paths: Iterable[Path]) -> dict[str, list[Path]]:
    """Group files by folder, relative to the root: one test examines a folder, and its message names the file."""
    found: dict[str, list[Path]] = {}
    for path in paths:
        found.setdefault(path.parent.relative_to(ROOT).as_posix(), []).append(path)
    return found


@functools.cache
def imports_in(path: Path, everywhere: bool = True) -> tuple[Import, ...]:
    """Return what a file imports: everywhere, including functions and type checking, or only at the top level."""
    package = path.relative_to(ROOT).parts[:-1]
    found: list[Import] = []
    for node in nodes(path) if everywhere else parsed(path).body:
        if isinstance(node, ast.Import):
            found += [Import(alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else ()
            found.append(Import(".".join([*above, *([node.module] if node.module else [])]),
                                tuple((alias.name, alias.asname or alias.name) for alias in node.names)))
    return tuple(found)


def named_parts(path: Path) -> Iterator[tuple[str, ast.stmt]]:
    """Yield the functions, methods and constants of a file by name; `__init__` goes by the name of its class."""
    for node in parsed(path).body:
        for part in node.body if isinstance(node, ast.ClassDef) else (node,):
            if isinstance(part, ast.FunctionDef):
                yield node.name if part.name == "__init__" else part.name, part  # type: ignore[union-attr]
            elif isinstance(part, ast.Assign | ast.AnnAssign):
                yield ast.unparse(part.targets[0] if isinstance(part, ast.Assign) else part.target), part
